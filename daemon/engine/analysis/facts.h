/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the header alone says about motion (docs/method.md, 1). */
#ifndef PURSUIT_ANALYSIS_FACTS_H
#define PURSUIT_ANALYSIS_FACTS_H

#include "daemon/engine/analysis/levels.h"

/* The nanoseconds T and S, each 0 only if neither is known. */
struct plan_intervals {
	uint64_t real, motion;
};

/* `real_interval_ns`: T as the pacer knows it, 0: the frame's own. */
struct plan_intervals plan_intervals_of(const struct pursuit_frame_header *header, uint64_t real_interval_ns);

/* Why nothing moves, as far as that is known without a look at the planes. */
enum plan_rest plan_rest_of(const struct frame *frame, const struct plan_intervals *intervals);

/* q_min in quarter pixels, 1 to 63. */
uint32_t plan_threshold(const struct plan_params *params);

/* How the frame's depth values become z. */
struct plan_depth plan_depth_of(const struct pursuit_frame_header *header);

#endif
