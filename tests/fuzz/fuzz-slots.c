/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The shared memory of a client that writes whatever it likes, whenever it
 * likes. Input: steps, each a byte and what it needs: headers patched, the slot
 * word set, frames taken, reports written, and a second thread that scribbles
 * over headers while they are copied.
 */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "daemon/intake.h"
#include "daemon/record/recording.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/good-frame.h"

#define SLOTS 4u
#define SLOT_BYTES GOOD_FRAME_BYTES
#define MOST_STEPS 64
#define SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL)

struct sandbox {
	int control_fd, planes_fd;
	struct pursuit_shm_control *control; /* as the client sees it */
	uint8_t *planes;
	struct stream *stream;
	uint64_t last_id;
};

/* ---- the thread that scribbles ---- */

static _Atomic(struct pursuit_shm_control *) victim; /* NULL: at rest */
static atomic_uint scribbles;
static atomic_bool resting;

static void *scribble(void *data)
{
	(void)data;
	for (uint64_t noise = 88172645463325252u;; atomic_fetch_add(&scribbles, 1)) {
		struct pursuit_shm_control *control = atomic_load(&victim);
		atomic_store(&resting, control == NULL);
		if (!control) {
			usleep(20);
			continue;
		}
		noise ^= noise << 13;
		noise ^= noise >> 7;
		noise ^= noise << 17;
		uint32_t *words = (uint32_t *)(void *)&control->headers[noise % SLOTS];
		__atomic_store_n(&words[noise / 8 % 194], (uint32_t)(noise >> 32) & 0x1ff, __ATOMIC_RELAXED);
	}
	return NULL;
}

/* A moment's patience on a machine of several cores; then the core, if there is only one. */
static void let_it_run(unsigned spins)
{
	if (spins > 20000)
		sched_yield();
}

static void start_scribbling(struct pursuit_shm_control *control)
{
	static bool running;
	pthread_t thread;
	if (!running)
		running = pthread_create(&thread, NULL, scribble, NULL) == 0 && pthread_detach(thread) == 0;
	const unsigned before = atomic_load(&scribbles);
	atomic_store(&victim, control);
	for (unsigned spins = 0; running && atomic_load(&scribbles) - before < 3; spins++)
		let_it_run(spins);
}

static void stop_scribbling(void)
{
	if (!atomic_exchange(&victim, NULL))
		return;
	atomic_store(&resting, false);
	for (unsigned spins = 0; !atomic_load(&resting); spins++)
		let_it_run(spins);
}

/* ---- the stream ---- */

static void *map_memfd(int *fd, size_t bytes)
{
	*fd = memfd_create("fuzz", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	FUZZ_EXPECT(*fd >= 0 && ftruncate(*fd, (off_t)bytes) == 0 && fcntl(*fd, F_ADD_SEALS, SEALS) == 0);
	void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, *fd, 0);
	FUZZ_EXPECT(memory != MAP_FAILED);
	return memory;
}

static void open_sandbox(struct sandbox *sandbox)
{
	const struct stream_params params = {.client_id = 1,
										 .stream_id = 1,
										 .client_name = "fuzz",
										 .slot_count = SLOTS,
										 .slot_bytes = SLOT_BYTES,
										 .max_slot_bytes = UINT64_C(1) << 20};
	struct refusal refusal;
	sandbox->control = map_memfd(&sandbox->control_fd, sizeof(*sandbox->control));
	sandbox->planes = map_memfd(&sandbox->planes_fd, SLOTS * SLOT_BYTES);
	sandbox->last_id = 0;
	sandbox->control->magic = PURSUIT_SHM_MAGIC;
	sandbox->control->version = PURSUIT_SHM_VERSION;
	sandbox->control->slot_count = SLOTS;
	sandbox->control->slot_bytes = SLOT_BYTES;
	sandbox->control->latest = 1;
	for (uint32_t i = 0; i < SLOTS; i++)
		good_frame(&sandbox->control->headers[i]);
	sandbox->stream = stream_create(&params, sandbox->control_fd, sandbox->planes_fd, &refusal);
	FUZZ_EXPECT(sandbox->stream != NULL);
}

static void close_sandbox(struct sandbox *sandbox)
{
	stop_scribbling();
	stream_release(&sandbox->stream);
	munmap(sandbox->control, sizeof(*sandbox->control));
	munmap(sandbox->planes, SLOTS * SLOT_BYTES);
	close(sandbox->control_fd);
	close(sandbox->planes_fd);
}

/* ---- steps ---- */

/* The frame is a copy that nobody can change any more, and lies in the slot that was taken. */
static void check_frame(const struct sandbox *sandbox, const struct frame *frame)
{
	const uint8_t *start = sandbox->stream->planes + sandbox->stream->held_slot * SLOT_BYTES;
	struct pursuit_frame_header again = frame->header;
	struct error error;
	FUZZ_EXPECT(frame_validate(&again, SLOT_BYTES, NULL, NULL, &error) == 0);
	for (uint32_t i = 0; i < frame->header.plane_count; i++) {
		FUZZ_EXPECT(frame->planes[i] >= start && frame->planes[i] + frame->header.planes[i].size <= start + SLOT_BYTES);
		fuzz_touch(frame->planes[i], frame->header.planes[i].size);
	}
	const uint64_t bytes = recording_packed_bytes(frame);
	uint8_t *packed = bytes < UINT64_C(1) << 20 ? malloc(bytes) : NULL;
	if (packed)
		recording_pack(frame, packed);
	free(packed);
}

/* False: the stream is to be ended. */
static bool take(struct sandbox *sandbox, uint64_t now_ns)
{
	struct frame frame;
	struct refusal refusal = {0};
	const int result = stream_take(sandbox->stream, now_ns, &frame, &refusal);
	FUZZ_EXPECT(sandbox->stream->held_slot < SLOTS);
	if (result == 1)
		check_frame(sandbox, &frame);
	else if (result < 0)
		FUZZ_EXPECT(refusal.code && refusal.field && memchr(refusal.text, 0, sizeof(refusal.text)));
	return result != -EPROTO;
}

static void patch_header(struct sandbox *sandbox, struct fuzz_input *input)
{
	const uint8_t choice = fuzz_u8(input);
	struct pursuit_frame_header header;
	good_frame(&header);
	header.frame_id = ++sandbox->last_id;
	good_frame_patch(&header, input, choice >> 4);
	sandbox->control->headers[choice % SLOTS] = header;
}

static void report(struct sandbox *sandbox, uint64_t id)
{
	const struct pursuit_feedback feedback = {.frame_id = id, .state = PURSUIT_FEEDBACK_SHOWN};
	stream_feedback(sandbox->stream, &feedback);
}

static bool do_step(struct sandbox *sandbox, struct fuzz_input *input)
{
	struct pursuit_shm_control *control = sandbox->control;
	const uint8_t step = fuzz_u8(input);
	switch (step & 7) {
	case 0:
		patch_header(sandbox, input);
		return true;
	case 1:
		__atomic_store_n(&control->latest, (uint32_t)fuzz_number(input), __ATOMIC_RELEASE);
		return true;
	case 2: /* publish slot by slot, as a client that does not care what is whose */
		__atomic_exchange_n(&control->latest, (step >> 3) % SLOTS | PURSUIT_SLOT_FRESH, __ATOMIC_ACQ_REL);
		return true;
	case 3:
		start_scribbling(control);
		return true;
	case 4:
		report(sandbox, fuzz_number(input));
		return true;
	case 5: /* anywhere in the control page */
		((volatile uint32_t *)(void *)control)[fuzz_u16(input) % (sizeof(*control) / 4)] = fuzz_u32(input);
		return true;
	case 6:
		stop_scribbling();
		return true;
	default:
		return take(sandbox, fuzz_number(input));
	}
}

int fuzz_one(const uint8_t *data, size_t size)
{
	struct fuzz_input input = {data, size};
	struct sandbox sandbox;
	const int open_fds = fuzz_open_fds();
	open_sandbox(&sandbox);
	for (int i = 0; i < MOST_STEPS && input.size > 0; i++)
		if (!do_step(&sandbox, &input))
			break;
	close_sandbox(&sandbox);
	FUZZ_EXPECT(fuzz_open_fds() == open_fds);
	return 0;
}
