/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/pacer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SECOND_NS INT64_C(1000000000)
/* Intervals outside are pauses or nonsense and teach nothing. */
#define INTERVAL_MIN_NS UINT64_C(500000)
#define INTERVAL_MAX_NS UINT64_C(1000000000)
/* T is a median over so many: short enough to follow a change of rate. */
#define INTERVAL_WINDOW 9u
/* Until so many frames were shown the display delay is simply their median. */
#define DELAY_LEARNING 8u
/* A delay so far off means another time base, not a slower client. */
#define DELAY_JUMP_NS INT64_C(250000000)
/* Beyond it (a century) a time is nonsense; sums and differences of limited ones do not overflow. */
#define DELAY_LIMIT_NS INT64_C(4000000000000000000)
/* At most so much real time faster than the display: still shown as it comes. */
#define PASS_THROUGH_RATIO 1.04

void pacer_init(struct pacer *pacer, const struct pacer_params *params)
{
	memset(pacer, 0, sizeof(*pacer));
	pacer->params = *params;
	pacer->params.grid = (struct grid){.numerator = 120, .denominator = 1};
	pacer_set_grid(pacer, &params->grid);
	if (!(pacer->params.max_phase > 0.0))
		pacer->params.max_phase = 2.0;
	pacer->delay_ns = params->fixed_delay ? params->delay_ns : 0;
}

/* ---- the grid ---- */

void pacer_set_grid(struct pacer *pacer, const struct grid *grid)
{
	if (grid->numerator != 0 && grid->denominator != 0)
		pacer->params.grid = *grid;
}

uint64_t pacer_vblank_time(const struct pacer *pacer, uint64_t vblank)
{
	return grid_time(&pacer->params.grid, vblank);
}

uint64_t pacer_vblank_at_or_after(const struct pacer *pacer, uint64_t time_ns)
{
	return grid_at_or_after(&pacer->params.grid, time_ns);
}

static double vblank_ns(const struct pacer *pacer)
{
	return grid_period_ns(&pacer->params.grid);
}

/* ---- history ---- */

static int compare_signed(const void *a, const void *b)
{
	const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
	return (x > y) - (x < y);
}

/* The delays kept, sorted; how many. */
static uint32_t sorted_delays(const struct pacer *pacer, int64_t sorted[PACER_HISTORY])
{
	const uint32_t count = pacer->delay_count < PACER_HISTORY ? pacer->delay_count : PACER_HISTORY;
	memcpy(sorted, pacer->delays, count * sizeof(sorted[0]));
	qsort(sorted, count, sizeof(sorted[0]), compare_signed);
	return count;
}

static void learn_interval(struct pacer *pacer, uint64_t interval_ns)
{
	int64_t window[INTERVAL_WINDOW];
	if (interval_ns < INTERVAL_MIN_NS || interval_ns > INTERVAL_MAX_NS)
		return;
	pacer->intervals[pacer->interval_count++ % PACER_HISTORY] = interval_ns;
	const uint32_t count = pacer->interval_count < INTERVAL_WINDOW ? pacer->interval_count : INTERVAL_WINDOW;
	for (uint32_t i = 0; i < count; i++)
		window[i] = (int64_t)pacer->intervals[(pacer->interval_count - 1 - i) % PACER_HISTORY];
	qsort(window, count, sizeof(window[0]), compare_signed);
	pacer->interval_ns = (uint64_t)window[count / 2];
}

static int64_t limit(int64_t value, int64_t most)
{
	return value > most ? most : value < -most ? -most : value;
}

/* Moves the display delay towards the median of what was seen. */
static void track_delay(struct pacer *pacer, uint64_t now_ns)
{
	int64_t sorted[PACER_HISTORY];
	const uint32_t count = sorted_delays(pacer, sorted);
	const int64_t off = sorted[count / 2] - pacer->delay_ns;
	const int64_t elapsed = now_ns > pacer->tracked_ns ? (int64_t)(now_ns - pacer->tracked_ns) : 0;

	pacer->tracked_ns = now_ns;
	if (pacer->delay_count <= DELAY_LEARNING || fabs((double)off) > 2.0 * vblank_ns(pacer))
		pacer->delay_ns += off; /* half the history agrees that it is elsewhere now */
	else if (fabs((double)off) > vblank_ns(pacer) / 4.0) /* a steady client that slipped to the next vblank, say */
		pacer->delay_ns += limit(off, limit(elapsed, SECOND_NS) / 50);
	else
		pacer->delay_ns += limit(off, limit(elapsed, SECOND_NS) / 500);
}

static void learn_delay(struct pacer *pacer, int64_t delay_ns, uint64_t now_ns)
{
	const int64_t before = pacer->delays[(pacer->delay_count + PACER_HISTORY - 1) % PACER_HISTORY];
	delay_ns = limit(delay_ns, DELAY_LIMIT_NS);
	if (pacer->delay_count > 0 && llabs(delay_ns - before) > DELAY_JUMP_NS)
		pacer->delay_count = 0;
	pacer->delays[pacer->delay_count++ % PACER_HISTORY] = delay_ns;
	if (!pacer->params.fixed_delay)
		track_delay(pacer, now_ns);
}

/* ---- frames in ---- */

void pacer_add_frame(struct pacer *pacer, const struct pacer_frame *frame)
{
	struct pacer_frame next = *frame;
	if (next.time_ns == 0)
		next.time_ns = next.intake_ns;
	if (next.interval_ns != 0)
		learn_interval(pacer, next.interval_ns);
	else if (pacer->has_frame && next.time_ns > pacer->frame.time_ns)
		learn_interval(pacer, next.time_ns - pacer->frame.time_ns);
	pacer->frame = next;
	pacer->has_frame = true;
	pacer->frame_is_new = true;
}

/* ---- decisions ---- */

bool pacer_passes_through(const struct pacer *pacer)
{
	return pacer->interval_ns != 0 && (double)pacer->interval_ns <= vblank_ns(pacer) * PASS_THROUGH_RATIO;
}

static double phase_at(const struct pacer *pacer, uint64_t target_ns)
{
	if (pacer->interval_ns == 0)
		return 0.0;
	return ((double)(int64_t)(target_ns - pacer->frame.time_ns) - (double)pacer->delay_ns) / (double)pacer->interval_ns;
}

/*
 * How old a frame must be when it can be shown. Frames so far were first shown
 * at ages in [least, least + one vblank), so every age from (largest seen - one
 * vblank) to (smallest seen) explains them; the middle of these. Outliers at
 * both ends are left out.
 */
static int64_t reachable_age(const struct pacer *pacer)
{
	int64_t sorted[PACER_HISTORY];
	const uint32_t count = sorted_delays(pacer, sorted);
	const uint32_t low = count / 10, high = count - 1 - low;
	return (int64_t)(((double)sorted[low] + (double)sorted[high] - vblank_ns(pacer)) / 2.0);
}

uint64_t pacer_next_real_vblank(const struct pacer *pacer)
{
	if (!pacer->has_frame || pacer->frame_is_new || pacer->interval_ns == 0 || pacer->delay_count == 0)
		return 0;
	/* From the first showing rather than from the epoch: the sum stays small whatever the client says. */
	const uint64_t shown_ns = pacer_vblank_time(pacer, pacer->first_vblank);
	const int64_t age = limit((int64_t)(shown_ns - pacer->frame.time_ns), DELAY_LIMIT_NS);
	const int64_t wait = (int64_t)pacer->interval_ns + limit(reachable_age(pacer) - age, 2 * SECOND_NS);
	const uint64_t vblank = pacer_vblank_at_or_after(pacer, wait > 0 ? shown_ns + (uint64_t)wait : shown_ns);
	return vblank > pacer->first_vblank ? vblank : pacer->first_vblank + 1;
}

/* N and the phase of the last in-between, for the frame that is shown first now. */
static void predict(struct pacer *pacer)
{
	const uint64_t next = pacer_next_real_vblank(pacer);
	pacer->n = 1;
	pacer->last_phase = 0.0;
	if (next == 0 || pacer_passes_through(pacer))
		return;
	pacer->n = next - pacer->first_vblank > 8 ? 8 : (uint32_t)(next - pacer->first_vblank);
	pacer->last_phase =
		fmin(phase_at(pacer, pacer_vblank_time(pacer, pacer->first_vblank + pacer->n - 1)), pacer->params.max_phase);
}

static void decide_real(struct pacer *pacer, struct pacer_decision *decision)
{
	learn_delay(pacer, (int64_t)(decision->target_ns - pacer->frame.time_ns), decision->target_ns);
	pacer->frame_is_new = false;
	predict(pacer);
	decision->show = PACER_REAL;
	decision->phase = pacer_passes_through(pacer) ? 0.0 : phase_at(pacer, decision->target_ns);
	if (fabs(decision->phase) <= PACER_PLAIN_PHASE)
		decision->phase = 0.0;
	decision->phase = fmax(-1.0, fmin(decision->phase, pacer->params.max_phase));
}

static void decide_later(const struct pacer *pacer, uint64_t vblank, struct pacer_decision *decision)
{
	decision->phase = fmax(-1.0, phase_at(pacer, decision->target_ns));
	const bool over = vblank - pacer->first_vblank >= 8 || decision->phase > pacer->params.max_phase;
	decision->show = pacer->interval_ns == 0 || pacer_passes_through(pacer) || over ? PACER_REPEAT : PACER_IN_BETWEEN;
}

struct pacer_decision pacer_decide(struct pacer *pacer, uint64_t vblank)
{
	struct pacer_decision decision = {
		.show = PACER_NOTHING,
		.target_ns = pacer_vblank_time(pacer, vblank),
		.n = 1,
	};
	if (!pacer->has_frame)
		return decision;
	if (pacer->frame_is_new) {
		pacer->first_vblank = vblank;
		decide_real(pacer, &decision);
	} else {
		decide_later(pacer, vblank, &decision);
	}
	decision.frame_id = pacer->frame.frame_id;
	decision.n = pacer->n;
	decision.last_phase = pacer->last_phase;
	decision.interval_ns = pacer->interval_ns;
	return decision;
}

void pacer_missed(struct pacer *pacer, const struct pacer_decision *decision)
{
	if (decision->show != PACER_REAL || !pacer->has_frame || pacer->frame_is_new ||
		decision->frame_id != pacer->frame.frame_id)
		return;
	pacer->frame_is_new = true;
	if (pacer->delay_count > 0)
		pacer->delay_count--;
}
