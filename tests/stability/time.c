/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Intervals from nothing to very long, phases beyond one: the engine's side of time. */
#include <math.h>
#include <stdio.h>

#include "suite.h"

static void check_intervals(struct suite *suite)
{
	/* real, motion; 1 is unknown. The last but one is a clock that ran backwards and wrapped. */
	static const uint64_t intervals[][2] = {{1000, 0},
											{10000000000u, 0},
											{1, 0},
											{16666667, 1000},
											{16666667, 10000000000u},
											{1000, 10000000000u},
											{10000000000u, 1000},
											{UINT64_MAX - 5, 0},
											{16666667, UINT64_MAX - 5}};
	char name[TABLE_TEXT];
	for (size_t i = 0; i < sizeof(intervals) / sizeof(intervals[0]); i++) {
		struct input input;
		input_make(&input, &(struct input_spec){.width = 96,
												.height = 64,
												.field = INPUT_LAYERS,
												.image = INPUT_EDGES,
												.seed = 8,
												.real_interval_ns = intervals[i][0],
												.motion_interval_ns = intervals[i][1]});
		snprintf(name, sizeof(name), "interval %llu ns, motion %llu ns: steps off the reference",
				 (unsigned long long)input.frame.header.real_interval_ns,
				 (unsigned long long)input.frame.header.motion_interval_ns);
		suite_against_reference(suite, name, &input.frame, &(struct engine_params){0}, 2.0 / 3.0);
		suite_all_methods(suite, "intervals of all kinds: undefined pixels", &input.frame);
		input_finish(&input);
	}
}

static void check_phases(struct suite *suite)
{
	static const double phases[] = {1.0, 1.5, 3.0, 8.0, 1e9, HUGE_VAL};
	char name[TABLE_TEXT];
	for (size_t i = 0; i < sizeof(phases) / sizeof(phases[0]); i++) {
		struct input input;
		input_make(&input, &(struct input_spec){
							   .width = 96, .height = 64, .field = INPUT_LAYERS, .image = INPUT_EDGES, .seed = 9});
		snprintf(name, sizeof(name), "phase %g: steps off the reference", phases[i]);
		suite_against_reference(suite, name, &input.frame, &(struct engine_params){0}, fmin(phases[i], 8.0));
		input_finish(&input);
	}
}

void time_run(struct suite *suite)
{
	check_intervals(suite);
	check_phases(suite);
}
