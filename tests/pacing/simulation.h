/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The pacer and the learned vblanks against simulated displays and clients:
 * no hardware, no clock, the same result on every machine.
 *
 * The daemon in between is the renderer's rule in one line: the newest frame
 * that is ready for a vblank is shown there. A frame is ready when it has
 * arrived and its picture, which takes cost_ms, is drawn. The daemon knows
 * vblanks only as it learned them from stamps; where its guess is late, a
 * picture misses its vblank and comes at the next.
 */
#ifndef PURSUIT_TESTS_PACING_SIMULATION_H
#define PURSUIT_TESTS_PACING_SIMULATION_H

#include <stdbool.h>
#include <stdint.h>

struct simulated_display {
	const char *name;
	double hz, wished_hz;     /* true; as the mode says (0: the true rate) */
	double step_hz;           /* true rate from the middle of the run on; 0: none */
	double suspend_s;         /* in the middle of the run nothing is shown for so long */
	double noise_us, tail_us; /* of time stamps: normal; late with a heavy tail */
	double miss;              /* share of vblanks at which the display fails to flip */
	bool counts;              /* stamps carry the display's own count */
};

struct simulated_client {
	const char *name;
	double fps;
	double step_fps;           /* from the middle of the run on; 0: none */
	bool ramps;                /* to step_fps steadily, from a quarter to three quarters of the run */
	bool declares;             /* says its interval */
	double noise_ms;           /* of the moments that frames depict, normal */
	double uneven;             /* intervals are so much of themselves longer or shorter, normal: a game without vsync */
	double age_ms;             /* from the moment depicted until arrival; 0: 5 */
	double step_age_ms;        /* from the middle on; 0: the same */
	double jitter_ms, tail_ms; /* of arrival: normal; late with a heavy tail */
	double stall_ms;           /* every two seconds it stops for so long */
	uint32_t burst;            /* so many frames arrive at once, with the last of them; 0, 1: none */
};

struct simulation {
	struct simulated_display display;
	struct simulated_client client;
	uint64_t vblanks; /* true ones, 10,000 */
	double cost_ms;   /* of a real frame's picture; 0: 2 */
	uint64_t seed;
	/*
	 * Optional: each picture that was shown, at the end, in order. time_s: since the start or, where there is one, the
	 * step; error: how far its moment is from the march that settle_s is judged by, in real intervals.
	 */
	void (*note)(void *data, double time_s, double error, bool real);
	void *data;
};

struct simulation_result {
	uint64_t vblanks, real, in_betweens, repeats; /* vblanks by what was shown first there */
	uint64_t frames;                              /* that the client sent */
	uint64_t superseded;                          /* a newer one was ready for the same vblank */
	uint64_t dropped;                             /* never shown for any other reason */
	uint64_t doubled;   /* vblanks that showed the same again although frames come and are slower than the display */
	uint64_t late;      /* real frames shown after the first vblank that they could reach */
	uint32_t most_late; /* by so many vblanks */
	uint64_t missed;    /* pictures whose vblank was over: guesses of the grid that were late */
	uint64_t wrong_n;   /* real frames that filled another number of vblanks than predicted */
	uint64_t plain;     /* real frames first shown unwarped */
	/*
	 * Distance of the displayed moment from an even march at the constant delay, in real intervals; last quarter.
	 * Where two crystals differ by less than 1 in 4000 the delay follows, and the march is faster or slower by that.
	 * 0 for streams that pass through.
	 */
	double phase_p50, phase_p99, phase_most;
	double
		settle_s; /* after the start or, where there is one, the step or ramp: until such distances stay below 0.05 */
	double delay_ms;      /* the pacer's, at the end */
	double delay_span_ms; /* how far it moved within the last quarter */
	double interval_ms;   /* T as the pacer has it, at the end */
	double vblank_us_off; /* the learned next vblank against the true one: 99 of 100 are nearer, last quarter */
};

/* Runs it. Out of memory ends the program. */
void simulation_run(const struct simulation *simulation, struct simulation_result *result);

/* Those of the table, ended by a NULL name. */
extern const struct simulated_display simulated_displays[];
extern const struct simulated_client simulated_clients[];

#endif
