/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The KMS presenter with a display controller that is the test's: its threads against each other, which the sanitizers
 * watch here and cannot in the rig. No picture is torn, none is lost, nothing stays behind.
 */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "daemon/present/kms.h"
#include "tests/daemon/fake-kms.h"
#include "tests/test.h"

#define MS UINT64_C(1000000)
#define PERIOD_NS (4 * MS)
#define PICTURES 300u
#define SWITCHES 12u
#define PATIENCE_S 60
#define WANTED 1024u

static struct clock real_clock;
static struct log quiet;

/* What the presenter has told. */
static struct {
	atomic_uint_fast64_t vblank, serial, flips;
	atomic_uint disorder, late, untrue;  /* untrue: said to be late or not, and it is the other */
	atomic_uint_fast64_t wanted[WANTED]; /* by serial number: the vblank that the picture was queued for */
	atomic_bool lost, gone;              /* gone: it may tell nothing any more */
} heard;

static void on_flip(void *data, const struct presenter_flip *flip)
{
	const uint64_t before = atomic_exchange(&heard.vblank, flip->vblank);
	const uint64_t serial = atomic_exchange(&heard.serial, flip->serial);
	if (flip->vblank <= before || flip->serial < serial || atomic_load(&heard.gone))
		atomic_fetch_add(&heard.disorder, 1);
	atomic_fetch_add(&heard.flips, 1);
	if (flip->shown != PRESENTER_PICTURE || flip->skipped)
		return;
	atomic_fetch_add(&heard.late, flip->late);
	if (flip->late != (flip->vblank > atomic_load(&heard.wanted[flip->serial % WANTED])))
		atomic_fetch_add(&heard.untrue, 1);
}

static void on_lost(void *data, const char *sentence)
{
	if (atomic_exchange(&heard.lost, true))
		atomic_fetch_add(&heard.disorder, 1);
}

static struct presenter *open_presenter_with(bool share_gl)
{
	struct error error = {""};
	const struct presenter_params params = {.clock = &real_clock,
											.log = &quiet,
											.refresh_numerator = 250,
											.refresh_denominator = 1,
											.options = {.share_gl = share_gl},
											.flip = on_flip,
											.lost = on_lost};
	atomic_store(&heard.vblank, 0);
	atomic_store(&heard.serial, 0);
	atomic_store(&heard.flips, 0);
	atomic_store(&heard.late, 0);
	atomic_store(&heard.untrue, 0);
	atomic_store(&heard.lost, false);
	atomic_store(&heard.gone, false);
	struct presenter *presenter = presenter_create("kms", &params, &error);
	CHECK_STRING(error.text, "present: the list is empty");
	return presenter;
}

static struct presenter *open_presenter(void)
{
	return open_presenter_with(false);
}

static void close_presenter(struct presenter *presenter)
{
	presenter_destroy(&presenter);
	atomic_store(&heard.gone, true);
	CHECK_INT(atomic_load(&fake_kms.devices), 0);
	CHECK_INT(atomic_load(&fake_kms.buffers), 0);
	CHECK_INT(atomic_load(&fake_kms.torn), 0);
	CHECK_INT(atomic_load(&fake_kms.intruding), 0);
	CHECK_INT(atomic_load(&heard.disorder), 0);
	CHECK_INT(atomic_load(&heard.untrue), 0);
}

static uint32_t next(uint32_t *seed)
{
	*seed = *seed * 1664525 + 1013904223;
	return *seed >> 8;
}

static void fill(const struct presenter_image *image, uint32_t colour)
{
	for (uint32_t y = 0; y < image->height; y++)
		memset(image->data + y * image->stride, (int)(colour & 0xff), (size_t)image->width * 4);
}

/* Of the display's size, or larger; queued for a vblank soon, or as the standby picture, or not at all. */
static void show_something(struct presenter *presenter, uint64_t serial, uint32_t choice)
{
	const struct presenter_impl *impl = presenter->impl;
	const uint32_t scale = choice % 5 == 0 ? 2 : 1;
	const struct grid grid = impl->get_grid(presenter);
	struct presenter_image image;
	if (impl->acquire(presenter, FAKE_WIDTH * scale, FAKE_HEIGHT * scale, &image) < 0) {
		clock_wait_until(&real_clock, clock_now(&real_clock) + 4 * MS);
		return;
	}
	fill(&image, (uint32_t)serial * 37);
	const uint64_t vblank = grid_at_or_after(&grid, clock_now(&real_clock) + impl->get_lead(presenter) + MS);
	atomic_store(&heard.wanted[serial % WANTED], vblank + choice % 2);
	if (choice % 7 == 0)
		impl->set_standby(presenter, &image, serial, serial);
	else if (choice % 11 == 0 || impl->present(presenter, &image, vblank + choice % 2, serial, serial) < 0)
		impl->release(presenter, &image);
	if (choice % 13 == 0)
		impl->clear_standby(presenter);
	if (choice % 17 == 0)
		impl->pause(presenter);
	if (choice % 3 == 0)
		clock_wait_until(&real_clock, grid_time(&grid, vblank));
}

/* From this serial number on. */
static void show_pictures(struct presenter *presenter, uint64_t first, uint32_t seed)
{
	for (uint64_t serial = first; serial < first + PICTURES; serial++)
		show_something(presenter, serial, next(&seed));
}

static void test_pictures(void)
{
	struct presenter *presenter = open_presenter();
	if (!presenter)
		return;
	show_pictures(presenter, 1, 1);
	CHECK(atomic_load(&heard.flips) > 0);
	CHECK(atomic_load(&fake_kms.flips) > 0);
	CHECK(!atomic_load(&heard.lost));
	close_presenter(presenter);
}

/* A flip that is refused is tried again at the next vblank, and is late then. */
static void test_busy(void)
{
	struct presenter *presenter = open_presenter();
	if (!presenter)
		return;
	const uint64_t end_ns = clock_now(&real_clock) + PATIENCE_S * 1000 * MS;
	for (uint64_t serial = 1; serial < PICTURES / 8 || (!atomic_load(&heard.late) && clock_now(&real_clock) < end_ns);
		 serial++) {
		atomic_store(&fake_kms.busy, 1);
		show_something(presenter, serial, 2);
		clock_wait_until(&real_clock, clock_now(&real_clock) + 5 * PERIOD_NS);
	}
	CHECK(atomic_load(&heard.late) > 0);
	close_presenter(presenter);
	atomic_store(&fake_kms.busy, 0);
}

static unsigned count_logged(const char *text)
{
	static char content[8192];
	unsigned count = 0;
	const ssize_t got = pread(quiet.fd, content, sizeof(content) - 1, 0);
	content[got > 0 ? got : 0] = 0;
	for (const char *at = content; (at = strstr(at, text)) != NULL; at++)
		count++;
	return count;
}

/* Takes all pictures that there are. */
static void take_all(struct presenter *presenter, int result)
{
	struct presenter_image images[FLIPS_IMAGES];
	unsigned count = 0;
	int got = 0;
	for (unsigned i = 0; i < 5 * FLIPS_IMAGES && count < FLIPS_IMAGES; i++) {
		got = presenter->impl->acquire(presenter, FAKE_WIDTH, FAKE_HEIGHT, &images[count]);
		count += got == 0;
	}
	CHECK_INT(got, result);
	while (count > 0)
		presenter->impl->release(presenter, &images[--count]);
}

/* No memory for a picture: said once, however often it is tried, and once that there is. */
static void test_full(void)
{
	const struct log before = quiet;
	quiet = (struct log){.fd = memfd_create("log", MFD_CLOEXEC), .level = LOG_LEVEL_INFO};
	struct presenter *presenter = open_presenter();
	if (!presenter)
		return;
	atomic_store(&fake_kms.full, true);
	take_all(presenter, -ENOMEM);
	atomic_store(&fake_kms.full, false);
	take_all(presenter, 0);
	take_all(presenter, 0);
	close_presenter(presenter);
	CHECK_INT(count_logged("kms: the test gives no buffer"), 1);
	CHECK_INT(count_logged("kms: there is memory for pictures again"), 1);
	close(quiet.fd);
	quiet = before;
}

/* An event of long ago, which lay there to be read, moves nothing. */
static void test_old_event(void)
{
	struct presenter *presenter = open_presenter();
	if (!presenter)
		return;
	atomic_store(&fake_kms.old_event, true);
	show_pictures(presenter, 1, 5);
	close_presenter(presenter);
	atomic_store(&fake_kms.old_event, false);
}

/* ---- pictures that are larger than the display ---- */

/* What the memory of a picture of this size holds, which holds 77 from now on. */
static uint64_t use(struct presenter *presenter, bool in_gl, uint32_t scale)
{
	const struct presenter_impl *impl = presenter->impl;
	const uint32_t width = FAKE_WIDTH * scale, height = FAKE_HEIGHT * scale;
	struct presenter_image image;
	CHECK_INT((in_gl ? impl->acquire_texture : impl->acquire)(presenter, width, height, &image), 0);
	const uint64_t holds = image.holds;
	image.holds = 77;
	impl->release(presenter, &image);
	return holds;
}

/* Memory that went, for pictures that need none, has come back empty. */
static void test_larger_again(void)
{
	for (int in_gl = 0; in_gl < 2; in_gl++) {
		struct presenter *presenter = open_presenter_with(true);
		if (!presenter)
			return;
		CHECK_INT(use(presenter, in_gl, 2), 0);
		CHECK_INT(use(presenter, in_gl, 2), 77);
		CHECK_INT(use(presenter, in_gl, 1), 0);
		CHECK_INT(use(presenter, in_gl, 2), 0);
		CHECK_INT(use(presenter, in_gl, 3), 0);
		close_presenter(presenter);
	}
}

/* ---- while a GPU draws ---- */

/* More than a flip may take that waits for nothing. */
#define LONG_VBLANKS 300u

/* Queues a picture that is drawn when `drawn` can be read, which is the presenter's from now on; -1: it is drawn. */
static void show_unfinished(struct presenter *presenter, int drawn)
{
	const struct presenter_impl *impl = presenter->impl;
	const struct grid grid = impl->get_grid(presenter);
	const uint64_t vblank = grid_at_or_after(&grid, clock_now(&real_clock) + 20 * PERIOD_NS);
	struct kms *kms = (struct kms *)presenter;
	struct presenter_image image;
	CHECK_INT(impl->acquire(presenter, FAKE_WIDTH, FAKE_HEIGHT, &image), 0);
	fill(&image, 99);
	CHECK_INT(impl->present(presenter, &image, vblank, 1, 1), 0);
	pthread_mutex_lock(&kms->lock);
	kms->pictures[image.index].fence = drawn;
	pthread_mutex_unlock(&kms->lock);
}

static bool wait_for(const atomic_uint_fast64_t *count, uint64_t least)
{
	const uint64_t end_ns = clock_now(&real_clock) + PATIENCE_S * 1000 * MS;
	while (atomic_load(count) < least && clock_now(&real_clock) < end_ns)
		clock_wait_until(&real_clock, clock_now(&real_clock) + MS / 4);
	return atomic_load(count) >= least;
}

/* Just after a vblank, so that the presenter looks at it before the flip can end. */
static void test_slow_gpu(void)
{
	struct presenter *presenter = open_presenter();
	int drawn[2];
	if (!presenter)
		return;
	CHECK_INT(pipe2(drawn, O_CLOEXEC), 0);
	show_unfinished(presenter, drawn[0]);
	CHECK(wait_for(&heard.flips, LONG_VBLANKS));
	CHECK(!atomic_load(&heard.lost));
	CHECK(wait_for(&heard.flips, atomic_load(&heard.flips) + 1));
	CHECK_INT(write(drawn[1], "", 1), 1);
	CHECK(wait_for(&heard.serial, 1));
	CHECK(wait_for(&heard.flips, atomic_load(&heard.flips) + 8));
	CHECK(!atomic_load(&heard.lost));
	close_presenter(presenter);
	close(drawn[1]);
}

/* It waits for nothing, and does not end. */
static void test_stuck_flip(void)
{
	struct presenter *presenter = open_presenter();
	if (!presenter)
		return;
	atomic_store(&fake_kms.stuck, true);
	show_unfinished(presenter, -1);
	const uint64_t end_ns = clock_now(&real_clock) + PATIENCE_S * 1000 * MS;
	while (!atomic_load(&heard.lost) && clock_now(&real_clock) < end_ns)
		clock_wait_until(&real_clock, clock_now(&real_clock) + MS);
	CHECK(atomic_load(&heard.lost));
	atomic_store(&fake_kms.stuck, false);
	close_presenter(presenter);
}

/* ---- while consoles are switched ---- */

static bool wait_until_left(void)
{
	struct timespec end;
	clock_gettime(CLOCK_REALTIME, &end);
	end.tv_sec += PATIENCE_S;
	return sem_timedwait(&fake_kms.left, &end) == 0;
}

static void *switch_consoles(void *data)
{
	const struct timespec while_away = {0, 15000000};
	bool fine = true;
	for (uint32_t i = 0; i < SWITCHES && fine; i++) {
		fine = write(fake_kms.terminal[1], "L", 1) == 1 && wait_until_left();
		nanosleep(&while_away, NULL);
		fine = fine && write(fake_kms.terminal[1], "R", 1) == 1;
		nanosleep(&while_away, NULL);
	}
	*(bool *)data = fine;
	return NULL;
}

static void test_other_console(void)
{
	struct presenter *presenter = open_presenter();
	pthread_t thread;
	bool switched = false;
	if (!presenter)
		return;
	CHECK_INT(pthread_create(&thread, NULL, switch_consoles, &switched), 0);
	show_pictures(presenter, 1, 2);
	pthread_join(thread, NULL);
	show_pictures(presenter, PICTURES + 1, 3);
	CHECK(switched);
	CHECK(!atomic_load(&heard.lost));
	close_presenter(presenter);
}

/* Ends while something is under way, again and again. */
static void test_one_after_another(void)
{
	for (uint32_t i = 0; i < 20; i++) {
		struct presenter *presenter = open_presenter();
		uint32_t seed = i;
		if (!presenter)
			return;
		for (uint64_t serial = 1; serial <= i; serial++)
			show_something(presenter, serial, next(&seed));
		if (i % 4 == 1)
			CHECK_INT(write(fake_kms.terminal[1], "L", 1), 1);
		close_presenter(presenter);
		char rest[4];
		while (read(fake_kms.terminal[0], rest, sizeof(rest)) > 0)
			continue;
		while (sem_trywait(&fake_kms.left) == 0)
			continue;
	}
}

static void test_unplugged(void)
{
	struct presenter *presenter = open_presenter();
	struct presenter_image image;
	if (!presenter)
		return;
	show_pictures(presenter, 1, 4);
	atomic_store(&fake_kms.unplugged, true);
	const uint64_t end_ns = clock_now(&real_clock) + PATIENCE_S * 1000 * MS;
	for (uint64_t serial = PICTURES + 1; !atomic_load(&heard.lost) && clock_now(&real_clock) < end_ns; serial++)
		show_something(presenter, serial, 3);
	CHECK(atomic_load(&heard.lost));
	CHECK_INT(presenter->impl->acquire(presenter, FAKE_WIDTH, FAKE_HEIGHT, &image), 0);
	CHECK_INT(presenter->impl->present(presenter, &image, atomic_load(&heard.vblank) + 1000, 9999, 9999), -ENODEV);
	presenter->impl->release(presenter, &image);
	close_presenter(presenter);
	atomic_store(&fake_kms.unplugged, false);
}

int main(void)
{
	clock_init_real(&real_clock);
	log_init(&quiet, LOG_LEVEL_ERROR);
	if (pipe2(fake_kms.terminal, O_NONBLOCK | O_CLOEXEC) != 0 || sem_init(&fake_kms.left, 0, 0) != 0)
		return 1;
	RUN(test_pictures);
	RUN(test_busy);
	RUN(test_full);
	RUN(test_old_event);
	RUN(test_larger_again);
	RUN(test_slow_gpu);
	RUN(test_stuck_flip);
	RUN(test_other_console);
	RUN(test_one_after_another);
	RUN(test_unplugged);
	return test_result();
}
