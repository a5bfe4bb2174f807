/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/pattern.h"

#include <string.h>

uint32_t pattern_lines(enum pattern_kind kind)
{
	if (kind == PATTERN_COUNTER)
		return 0;
	return kind == PATTERN_THREE_LINES ? 3 : 1;
}

static bool is_pulse(enum pattern_kind kind)
{
	return kind == PATTERN_PULSE || kind == PATTERN_PULSE_REAL || kind == PATTERN_THREE_LINES;
}

static void pulse(const struct pattern *pattern, struct pattern_change *change, uint32_t mask)
{
	change->mask = change->levels = mask;
	change->pulse_ns = mask ? pattern->pulse_ns : 0;
}

/* Levels that stay; no change if they are the same. */
static void hold(struct pattern *pattern, struct pattern_change *change, uint32_t levels)
{
	change->mask = pattern->levels ^ levels;
	change->levels = levels & change->mask;
	pattern->levels = levels;
}

static uint32_t real_level(const struct pattern *pattern, uint8_t show)
{
	if (show == POINTS_REAL)
		return 1;
	return show == POINTS_REPEAT || show == POINTS_KEPT ? pattern->levels : 0;
}

bool pattern_add_flip(struct pattern *pattern, const struct pattern_flip *flip, struct pattern_change *change)
{
	const bool real = flip->show == POINTS_REAL, between = flip->show == POINTS_IN_BETWEEN;
	*change = (struct pattern_change){.time_ns = flip->flip_ns + pattern->offset_ns, .vblank = flip->vblank};
	switch (pattern->kind) {
	case PATTERN_TOGGLE:
		hold(pattern, change, pattern->levels ^ 1);
		break;
	case PATTERN_PULSE:
		pulse(pattern, change, 1);
		break;
	case PATTERN_PULSE_REAL:
		pulse(pattern, change, real);
		break;
	case PATTERN_LEVEL_REAL:
		hold(pattern, change, real_level(pattern, flip->show));
		break;
	case PATTERN_THREE_LINES:
		pulse(pattern, change, 1u | (uint32_t)real << 1 | (uint32_t)between << 2);
		break;
	case PATTERN_COUNTER:
		hold(pattern, change, (uint32_t)flip->vblank & ((1u << pattern->lines) - 1));
		break;
	case PATTERN_SEQUENCE:
		hold(pattern, change, flip->level);
		break;
	case PATTERN_KINDS:
		break;
	}
	return change->mask != 0;
}

bool schedule_add(struct schedule *schedule, const struct pattern_change *change)
{
	uint32_t place = schedule->count;
	if (schedule->count == SCHEDULE_CHANGES) {
		schedule->dropped++;
		return false;
	}
	while (place > 0 && schedule->changes[place - 1].time_ns > change->time_ns)
		place--;
	memmove(&schedule->changes[place + 1], &schedule->changes[place],
			(schedule->count - place) * sizeof(schedule->changes[0]));
	schedule->changes[place] = *change;
	schedule->count++;
	return true;
}

bool pattern_schedule(struct pattern *pattern, struct schedule *schedule, const struct pattern_change *change)
{
	const bool room = schedule_add(schedule, change);
	if (!room && !is_pulse(pattern->kind))
		pattern->levels ^= change->mask;
	return room;
}

uint64_t schedule_next(const struct schedule *schedule)
{
	return schedule->count ? schedule->changes[0].time_ns : UINT64_MAX;
}

bool schedule_take(struct schedule *schedule, uint64_t now_ns, struct pattern_change *change)
{
	if (schedule->count == 0 || schedule->changes[0].time_ns > now_ns)
		return false;
	*change = schedule->changes[0];
	schedule->count--;
	memmove(&schedule->changes[0], &schedule->changes[1], schedule->count * sizeof(schedule->changes[0]));
	return true;
}
