/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/facts.h"

#include <math.h>

#include "daemon/engine/analysis/rows.h"

struct plan_intervals plan_intervals_of(const struct pursuit_frame_header *header, uint64_t real_interval_ns)
{
	uint64_t own = header->real_interval_ns;
	uint64_t motion = header->motion_interval_ns ? header->motion_interval_ns : own;
	uint64_t real = real_interval_ns ? real_interval_ns : own;
	return (struct plan_intervals){real ? real : motion, motion ? motion : real};
}

enum plan_rest plan_rest_of(const struct frame *frame, const struct plan_intervals *intervals)
{
	const struct pursuit_frame_header *header = &frame->header;
	int motion = plan_find_plane(header, PURSUIT_ROLE_MOTION);
	if (header->flags & PURSUIT_FRAME_CUT)
		return PLAN_CUT;
	if (header->flags & PURSUIT_FRAME_MOTION_INVALID)
		return PLAN_MOTION_INVALID;
	if (motion < 0 || header->motion_kind == PURSUIT_MOTION_NONE || !frame->planes[motion])
		return PLAN_NO_MOTION;
	return intervals->real ? PLAN_MOVES : PLAN_NO_INTERVAL;
}

uint32_t plan_threshold(const struct plan_params *params)
{
	uint32_t threshold = params->threshold_quarter ? params->threshold_quarter : 2;
	return threshold < 63 ? threshold : 63;
}

struct plan_depth plan_depth_of(const struct pursuit_frame_header *header)
{
	int index = plan_find_plane(header, PURSUIT_ROLE_DEPTH);
	float near_distance = header->near_distance, far_distance = header->far_distance;
	struct plan_depth depth = {.format = index < 0 ? 0 : header->planes[index].format,
							   .near_distance = near_distance,
							   .range = far_distance - near_distance};
	if (header->depth_kind == PURSUIT_DEPTH_DEVICE_REVERSED)
		depth.map = PLAN_DEPTH_REVERSED;
	else if (header->depth_kind != PURSUIT_DEPTH_LINEAR)
		depth.map = PLAN_DEPTH_AS_IS;
	else if (near_distance > 0 && far_distance > near_distance)
		depth.map = isinf(far_distance) ? PLAN_DEPTH_INFINITE : PLAN_DEPTH_RANGE;
	else
		depth.map = PLAN_DEPTH_OPEN;
	return depth;
}
