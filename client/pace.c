/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/pace.h"

#include <stdbool.h>
#include <stddef.h>

#define MS UINT64_C(1000000)
#define AHEAD_MOST (250 * MS)
#define AGE_MOST (1000 * MS)
#define WORK_MOST (250 * MS)
#define INTERVAL_LEAST MS
/* Wake-ups are late by so much, and no two frames take the same. */
#define SPARE (MS / 2)

void shim_pace_begin(struct shim_pace *pace, uint64_t frame_id, uint64_t now_ns)
{
	pace->begun[frame_id % SHIM_PACE_FRAMES].frame_id = frame_id;
	pace->begun[frame_id % SHIM_PACE_FRAMES].begun_ns = now_ns;
}

void shim_pace_publish(struct shim_pace *pace, uint64_t frame_id, uint64_t now_ns)
{
	const uint64_t begun_ns = pace->begun[frame_id % SHIM_PACE_FRAMES].begun_ns;

	if (pace->begun[frame_id % SHIM_PACE_FRAMES].frame_id != frame_id || begun_ns == 0 || now_ns < begun_ns) {
		return;
	}
	uint64_t work_ns = now_ns - begun_ns;
	if (work_ns <= WORK_MOST) {
		pace->work_ns[pace->count++ % SHIM_PACE_RUNS] = work_ns;
	}
	pace->begun[frame_id % SHIM_PACE_FRAMES].begun_ns = 0;
}

/* The longest of the last frames: one that comes a vblank late costs more than one that comes a little early. */
static uint64_t expected_work(const struct shim_pace *pace)
{
	uint64_t most = 0;

	for (uint32_t i = 0; i < SHIM_PACE_RUNS; i++) {
		most = pace->work_ns[i] > most ? pace->work_ns[i] : most;
	}
	return most;
}

static bool read_hint(const struct pursuit_shm_control *control, struct pursuit_hint *hint)
{
	const struct pursuit_hint *shared = &control->hint;

	for (int tries = 0; tries < 4; tries++) {
		hint->sequence = __atomic_load_n(&shared->sequence, __ATOMIC_ACQUIRE);
		hint->frame_id = __atomic_load_n(&shared->frame_id, __ATOMIC_RELAXED);
		hint->next_submit_ns = __atomic_load_n(&shared->next_submit_ns, __ATOMIC_RELAXED);
		hint->interval_ns = __atomic_load_n(&shared->interval_ns, __ATOMIC_RELAXED);
		__atomic_thread_fence(__ATOMIC_ACQUIRE);
		if (hint->sequence % 2 == 0 && __atomic_load_n(&shared->sequence, __ATOMIC_RELAXED) == hint->sequence) {
			return hint->sequence != 0 && hint->next_submit_ns != 0;
		}
	}
	return false;
}

uint64_t shim_pace_start(const struct shim_pace *pace, const struct pursuit_shm_control *control, uint64_t frame_id,
						 uint64_t now_ns)
{
	struct pursuit_hint hint;

	/* The daemon may not have drawn the frame yet that was just published: the hint is about an earlier one. */
	if (!read_hint(control, &hint) || frame_id <= hint.frame_id || frame_id - hint.frame_id > SHIM_PACE_FRAMES ||
		hint.next_submit_ns > now_ns + AHEAD_MOST) {
		return 0;
	}
	uint64_t later = frame_id - hint.frame_id - 1;
	if (later > 0 && (hint.interval_ns < INTERVAL_LEAST || hint.interval_ns > AHEAD_MOST)) {
		return 0;
	}
	uint64_t submit_ns = hint.next_submit_ns + later * hint.interval_ns;
	uint64_t lead_ns = expected_work(pace) + SPARE;
	if (submit_ns > now_ns + AHEAD_MOST || submit_ns + AGE_MOST < now_ns || submit_ns <= lead_ns) {
		return 0;
	}
	return submit_ns - lead_ns;
}
