/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The reading end of the feedback ring of proto/shm.h. The daemon may write any nonsense at any moment. */
#ifndef PURSUIT_CLIENT_FEEDBACK_H
#define PURSUIT_CLIENT_FEEDBACK_H

#include <stdbool.h>
#include <stdint.h>

#include "client/pursuit.h"
#include "proto/shm.h"

/* Number of the next report to read; 0 for a new control page. */
struct shim_feedback {
	uint64_t next;
};

/* The oldest whole report that is still in the ring. Looks at no more than the ring's entries. */
bool shim_feedback_poll(struct shim_feedback *feedback, const struct pursuit_shm_control *control,
						struct pursuit_feedback_report *report);

#endif
