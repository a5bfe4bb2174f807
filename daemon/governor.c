/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/governor.h"

#include <string.h>

#define SECOND_NS UINT64_C(1000000000)
#define LOAD_HIGH 0.9
#define LOAD_LOW 0.65
/* Below it what is late is so for another reason, and less work would not mend it. */
#define LOAD_TO_BLAME 0.5
#define LOAD_MEMORY 8.0
#define LATE_FRAMES 16u
#define LATE_MOST 3u
#define FRAMES_LEAST 8u
#define PATIENCE_FIRST (SECOND_NS)
#define PATIENCE_MOST (32 * SECOND_NS)
#define TRIAL_NS (2 * SECOND_NS)
/* A level that is borne this many times as long as it takes to lose patience may be left although it is well used. */
#define BEARABLE_TIMES 4u

enum level { FULL, COARSE, PLAIN, FEWER, HOLD };

void governor_init(struct governor *governor, bool automatic, uint32_t level)
{
	memset(governor, 0, sizeof(*governor));
	governor->automatic = automatic;
	governor->least = governor->level = level < GOVERNOR_LEVELS ? level : GOVERNOR_LEVELS - 1;
	governor->patience_ns = PATIENCE_FIRST;
}

static void change(struct governor *governor, uint32_t level, uint64_t now_ns)
{
	governor->level = level;
	governor->changed_ns = now_ns;
	governor->frames = 0;
	memset(governor->late, 0, sizeof(governor->late));
}

void governor_configure(struct governor *governor, bool automatic, uint32_t level, uint64_t now_ns)
{
	governor->automatic = automatic;
	governor->least = level < GOVERNOR_LEVELS ? level : GOVERNOR_LEVELS - 1;
	governor->trying = false;
	governor->patience_ns = PATIENCE_FIRST;
	if (!automatic || governor->level < governor->least)
		change(governor, governor->least, now_ns);
}

static void raise(struct governor *governor, uint64_t now_ns)
{
	if (governor->trying && governor->patience_ns < PATIENCE_MOST)
		governor->patience_ns *= 2;
	governor->trying = false;
	governor->raised++;
	change(governor, governor->level + 1, now_ns);
}

static void lower(struct governor *governor, uint64_t now_ns)
{
	governor->trying = true;
	governor->lowered++;
	governor->lowered_ns = now_ns;
	change(governor, governor->level - 1, now_ns);
}

static uint32_t count_late(const struct governor *governor)
{
	uint32_t late = 0;
	for (uint32_t i = 0; i < LATE_FRAMES; i++)
		late += governor->late[i];
	return late;
}

static void learn(struct governor *governor, const struct governor_sample *sample)
{
	const double load = sample->time_ns ? (double)sample->work_ns / (double)sample->time_ns : 0.0;
	/* Of a new level nothing is known: the first frames weigh more. */
	const double memory = governor->frames + 1.0 < LOAD_MEMORY ? governor->frames + 1.0 : LOAD_MEMORY;
	governor->load += ((load < 10.0 ? load : 10.0) - governor->load) / memory;
	governor->late[governor->frames_at[governor->level] % LATE_FRAMES] = sample->late_in_betweens;
	governor->frames_at[governor->level]++;
	governor->frames++;
}

uint32_t governor_add(struct governor *governor, const struct governor_sample *sample)
{
	const uint64_t now_ns = sample->now_ns;
	learn(governor, sample);
	if (!governor->automatic || governor->frames < FRAMES_LEAST)
		return governor->level;
	if (governor->trying && now_ns - governor->lowered_ns > TRIAL_NS) {
		governor->trying = false;
		governor->patience_ns = PATIENCE_FIRST;
	}
	const uint32_t late = count_late(governor);
	const uint64_t since_ns = now_ns - governor->changed_ns;
	const bool calm = governor->load < LOAD_LOW || since_ns > BEARABLE_TIMES * governor->patience_ns;
	const bool high = governor->load > LOAD_HIGH || (late >= LATE_MOST && governor->load > LOAD_TO_BLAME);
	if (high && governor->level < GOVERNOR_LEVELS - 1)
		raise(governor, now_ns);
	else if (governor->level > governor->least && governor->load <= LOAD_HIGH && late == 0 && calm &&
			 since_ns > governor->patience_ns)
		lower(governor, now_ns);
	return governor->level;
}

const char *governor_level_name(uint32_t level)
{
	static const char *const names[GOVERNOR_LEVELS] = {"full", "coarse", "plain", "fewer", "hold"};
	return level < GOVERNOR_LEVELS ? names[level] : "";
}

void governor_apply(uint32_t level, struct engine_params *params)
{
	if (level >= COARSE) {
		const uint32_t cell = params->cell ? params->cell : 8;
		params->cell = cell <= 32 ? cell * 2 : 64;
	}
	if (level >= PLAIN) {
		params->blur = ENGINE_BLUR_OFF;
		params->no_compensation = true;
	}
	if (level >= HOLD)
		params->method = "hold";
}

bool governor_draws(uint32_t level, uint64_t k)
{
	return level < FEWER || (level == FEWER && k % 2 == 1);
}
