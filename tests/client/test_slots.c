/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The exchange of slots: every order of events up to a depth, two threads at full speed, and a lying daemon. */

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/slots.h"
#include "tests/test.h"

#define DEPTH 20

static struct shim_layout small_layout(uint32_t slot_count)
{
	struct shim_layout layout;
	struct pursuit_stream_params params = {.width = 16, .height = 16, .slot_count = slot_count};

	CHECK(shim_layout_init(&layout, &params));
	return layout;
}

/* The whole state of both sides; the shared word and our table of owners are the code's own. */
struct model {
	uint32_t latest;
	enum shim_slot_owner owners[PURSUIT_MAX_SLOTS];
	uint32_t taken;
	uint64_t frames[PURSUIT_MAX_SLOTS]; /* the frame id in each slot */
	uint32_t held;                      /* by the daemon */
	bool saw_fresh;                     /* the daemon looked and is about to exchange */
	int filling;                        /* slot that the client fills, -1: none */
	uint64_t published;
	uint64_t seen; /* newest id that the daemon took */
};

static struct shim_layout model_layout;
static struct shim_slots *model_slots;
static uint64_t model_states;

static void load(const struct model *model)
{
	model_slots->control->latest = model->latest;
	model_slots->taken = model->taken;
	memcpy(model_slots->owners, model->owners, sizeof(model->owners));
	for (uint32_t i = 0; i < model_slots->slot_count; i++) {
		model_slots->control->headers[i].frame_id = model->frames[i];
	}
}

static void save(struct model *model)
{
	model->latest = model_slots->control->latest;
	model->taken = model_slots->taken;
	memcpy(model->owners, model_slots->owners, sizeof(model->owners));
	for (uint32_t i = 0; i < model_slots->slot_count; i++) {
		model->frames[i] = model_slots->control->headers[i].frame_id;
	}
}

/* Every slot has one owner: the daemon, the shared word, or the client. */
static void check_owners(const struct model *model)
{
	uint32_t named = model->latest & PURSUIT_SLOT_INDEX_MASK, taken = 0;

	CHECK(named != model->held);
	for (uint32_t i = 0; i < model_slots->slot_count; i++) {
		bool away = i == model->held || i == named;
		CHECK_INT(model->owners[i] == SHIM_SLOT_AWAY, away);
		taken += model->owners[i] == SHIM_SLOT_TAKEN;
	}
	CHECK_INT(model->taken, taken);
}

static bool client_takes(struct model *model)
{
	if (model->filling >= 0) {
		return false;
	}
	load(model);
	struct pursuit_frame *frame = shim_slots_take(model_slots, &model_layout);
	CHECK(frame != NULL);
	model->filling = shim_slots_index(model_slots, frame);
	save(model);
	return true;
}

static bool client_publishes(struct model *model)
{
	struct pursuit_frame_header header = {.frame_id = model->published + 1};
	bool unseen = model->seen < model->published;

	if (model->filling < 0) {
		return false;
	}
	load(model);
	enum shim_published result = shim_slots_publish(model_slots, model->filling, &header);
	CHECK_INT(result, unseen ? SHIM_PUBLISHED_OVER : SHIM_PUBLISHED);
	save(model);
	model->published++;
	model->filling = -1;
	return true;
}

static bool daemon_looks(struct model *model)
{
	if (model->saw_fresh || !(model->latest & PURSUIT_SLOT_FRESH)) {
		return false;
	}
	model->saw_fresh = true;
	return true;
}

static bool daemon_exchanges(struct model *model)
{
	if (!model->saw_fresh) {
		return false;
	}
	uint32_t got = model->latest;
	model->latest = model->held;
	model->held = got & PURSUIT_SLOT_INDEX_MASK;
	model->saw_fresh = false;
	CHECK(got & PURSUIT_SLOT_FRESH);
	/* The newest one wins, and time never runs backwards. */
	CHECK_INT(model->frames[model->held], model->published);
	CHECK(model->frames[model->held] > model->seen);
	model->seen = model->frames[model->held];
	return true;
}

static void explore(const struct model *model, int depth)
{
	bool (*const events[])(struct model *) = {client_takes, client_publishes, daemon_looks, daemon_exchanges};

	model_states++;
	check_owners(model);
	for (size_t i = 0; depth > 0 && i < sizeof(events) / sizeof(*events); i++) {
		struct model next = *model;
		if (events[i](&next)) {
			explore(&next, depth - 1);
		}
	}
}

static void test_every_order(void)
{
	for (uint32_t slot_count = PURSUIT_MIN_SLOTS; slot_count <= PURSUIT_MIN_SLOTS + 2; slot_count++) {
		struct model model = {.filling = -1};
		model_layout = small_layout(slot_count);
		model_slots = shim_slots_create_shared(&model_layout);
		CHECK(model_slots != NULL);
		save(&model);
		explore(&model, DEPTH);
		shim_slots_destroy(&model_slots);
	}
	printf("       %llu states\n", (unsigned long long)model_states);
}

/* Until the daemon's thread took this many, or so many were published without it getting there. */
#define RACE_TAKEN 1000
#define RACE_MAX 5000000

struct race {
	struct shim_slots *slots;
	struct shim_layout layout;
	bool over;
	uint64_t taken;
	uint64_t torn;
	uint64_t backwards;
};

/* The daemon's side: every byte of a frame must be of that frame. */
static void *race_daemon(void *argument)
{
	struct race *race = argument;
	uint32_t *latest = &race->slots->control->latest;
	uint32_t held = 0;
	uint64_t seen = 0;

	while (!__atomic_load_n(&race->over, __ATOMIC_RELAXED)) {
		if (!(__atomic_load_n(latest, __ATOMIC_RELAXED) & PURSUIT_SLOT_FRESH)) {
			continue;
		}
		held = __atomic_exchange_n(latest, held, __ATOMIC_ACQ_REL) & PURSUIT_SLOT_INDEX_MASK;
		uint64_t id = race->slots->control->headers[held].frame_id;
		const uint8_t *pixels = race->slots->planes + race->layout.slot_bytes * held;
		for (uint64_t i = 0; i < race->layout.slot_bytes; i++) {
			race->torn += pixels[i] != (uint8_t)id;
		}
		race->backwards += id <= seen;
		__atomic_fetch_add(&race->taken, 1, __ATOMIC_RELAXED);
		seen = id;
	}
	return NULL;
}

static void test_two_threads(void)
{
	struct race race = {.layout = small_layout(3)};
	uint64_t id = 0;
	pthread_t thread;

	race.slots = shim_slots_create_shared(&race.layout);
	CHECK_INT(pthread_create(&thread, NULL, race_daemon, &race), 0);
	while (id < RACE_MAX && __atomic_load_n(&race.taken, __ATOMIC_RELAXED) < RACE_TAKEN) {
		struct pursuit_frame_header header = {.frame_id = ++id};
		struct pursuit_frame *frame = shim_slots_take(race.slots, &race.layout);
		memset(frame->color.data, (int)(id & 0xff), race.layout.slot_bytes);
		shim_slots_publish(race.slots, shim_slots_index(race.slots, frame), &header);
	}
	__atomic_store_n(&race.over, true, __ATOMIC_RELAXED);
	pthread_join(thread, NULL);
	CHECK_INT(race.torn, 0);
	CHECK_INT(race.backwards, 0);
	printf("       %llu of %llu frames taken\n", (unsigned long long)race.taken, (unsigned long long)id);
	shim_slots_destroy(&race.slots);
}

/* What a daemon may not give back: the slot just published, one that we fill, one that does not exist. */
static void test_lying_daemon(void)
{
	const uint32_t lies[] = {2, 3, 4, 0xff, 0x100, 0x7fffffff, PURSUIT_SLOT_FRESH | 2, 0xffffffff};
	struct shim_layout layout = small_layout(4);

	for (size_t i = 0; i < sizeof(lies) / sizeof(*lies); i++) {
		struct pursuit_frame_header header = {.frame_id = 1};
		struct shim_slots *slots = shim_slots_create_shared(&layout);
		struct pursuit_frame *one = shim_slots_take(slots, &layout);
		struct pursuit_frame *two = shim_slots_take(slots, &layout);

		CHECK_INT(shim_slots_index(slots, one), 2);
		CHECK_INT(shim_slots_index(slots, two), 3);
		slots->control->latest = lies[i];
		CHECK_INT(shim_slots_publish(slots, 2, &header), SHIM_PUBLISH_BROKEN);
		CHECK_INT(shim_slots_index(slots, two), 3);
		shim_slots_destroy(&slots);
	}
}

static void test_limits(void)
{
	struct shim_layout layout = small_layout(5);
	struct shim_slots *sets[2] = {shim_slots_create_plain(&layout), shim_slots_create_shared(&layout)};

	for (int i = 0; i < 2; i++) {
		struct pursuit_frame *frames[3];
		for (int k = 0; k < 3; k++) {
			frames[k] = shim_slots_take(sets[i], &layout);
			CHECK(frames[k] != NULL);
		}
		CHECK(shim_slots_take(sets[i], &layout) == NULL);
		CHECK(frames[0]->color.data != frames[1]->color.data && frames[1]->color.data != frames[2]->color.data);
		shim_slots_give(sets[i], shim_slots_index(sets[i], frames[1]));
		CHECK_INT(shim_slots_index(sets[i], frames[1]), -1);
		CHECK(shim_slots_take(sets[i], &layout) == frames[1]);
		CHECK_INT(shim_slots_index(sets[i], frames[0] + 100), -1);
		shim_slots_destroy(&sets[i]);
	}
}

static void test_memory_is_sealed(void)
{
	struct shim_layout layout = small_layout(4);
	struct shim_slots *slots = shim_slots_create_shared(&layout);
	struct stat status;

	CHECK_INT(fcntl(slots->planes_fd, F_GET_SEALS), F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL);
	CHECK_INT(fcntl(slots->control_fd, F_GET_SEALS), F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL);
	CHECK(ftruncate(slots->planes_fd, 0) < 0);
	CHECK_INT(fstat(slots->planes_fd, &status), 0);
	CHECK_INT(status.st_size, layout.slot_bytes * 4);
	CHECK_INT(fcntl(slots->planes_fd, F_GETFD) & FD_CLOEXEC, FD_CLOEXEC);
	CHECK_INT(fcntl(slots->control_fd, F_GETFD) & FD_CLOEXEC, FD_CLOEXEC);
	shim_slots_forget_fds(slots);
	CHECK_INT(slots->planes_fd, -1);
	slots->planes[layout.slot_bytes * 4 - 1] = 1;
	shim_slots_destroy(&slots);
	CHECK(slots == NULL);
	shim_slots_destroy(&slots);
	shim_slots_destroy(NULL);
}

/* What an address cannot count is not there: a product that wraps would be memory that is too small. */
static void test_too_large(void)
{
	struct shim_layout layout = small_layout(4);

	layout.slot_bytes = (UINT64_C(1) << 62) + 4096;
	errno = 0;
	CHECK(shim_slots_create_shared(&layout) == NULL);
	CHECK_INT(errno, ENOMEM);
	layout.slot_bytes = (UINT64_C(1) << 63) + 4096;
	errno = 0;
	CHECK(shim_slots_create_plain(&layout) == NULL);
	CHECK_INT(errno, ENOMEM);
}

int main(void)
{
	RUN(test_every_order);
	RUN(test_two_threads);
	RUN(test_lying_daemon);
	RUN(test_limits);
	RUN(test_memory_is_sealed);
	RUN(test_too_large);
	return test_result();
}
