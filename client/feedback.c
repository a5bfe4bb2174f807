/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/feedback.h"

#include <string.h>

/* False if the entry is being written, holds another report, or holds no known state. */
static bool read_entry(const struct pursuit_shm_control *control, uint64_t number, struct pursuit_feedback *copy)
{
	const struct pursuit_feedback *entry = &control->feedback[number % PURSUIT_FEEDBACK_ENTRIES];
	uint64_t whole = 2 * number + 2;

	if (__atomic_load_n(&entry->sequence, __ATOMIC_ACQUIRE) != whole) {
		return false;
	}
	memcpy(copy, entry, sizeof(*copy));
	__atomic_thread_fence(__ATOMIC_ACQUIRE);
	return __atomic_load_n(&entry->sequence, __ATOMIC_RELAXED) == whole && copy->state >= PURSUIT_FEEDBACK_SHOWN &&
		   copy->state <= PURSUIT_FEEDBACK_REFUSED;
}

static void fill_report(struct pursuit_feedback_report *report, const struct pursuit_feedback *copy)
{
	memset(report, 0, sizeof(*report));
	report->frame_id = copy->frame_id;
	report->submit_ns = copy->submit_ns;
	report->intake_ns = copy->intake_ns;
	report->target_ns = copy->target_ns;
	report->ready_ns = copy->ready_ns;
	report->flip_ns = copy->flip_ns;
	report->vblank = copy->vblank;
	report->shown = (enum pursuit_shown)copy->state;
	report->vblanks = copy->vblanks;
	report->in_betweens = copy->in_betweens;
	report->late_in_betweens = copy->late_in_betweens;
	report->next_submit_ns = copy->next_submit_ns;
}

bool shim_feedback_poll(struct shim_feedback *feedback, const struct pursuit_shm_control *control,
						struct pursuit_feedback_report *report)
{
	uint64_t count = __atomic_load_n(&control->feedback_count, __ATOMIC_ACQUIRE);
	struct pursuit_feedback copy;

	if (count < feedback->next) {
		return false;
	}
	if (count - feedback->next > PURSUIT_FEEDBACK_ENTRIES) {
		feedback->next = count - PURSUIT_FEEDBACK_ENTRIES;
	}
	while (feedback->next < count) {
		if (read_entry(control, feedback->next++, &copy)) {
			fill_report(report, &copy);
			return true;
		}
	}
	return false;
}
