/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/pacer.h"

#include <math.h>
#include <string.h>

#define SECOND_NS INT64_C(1000000000)
/* Beyond it (a century) a time is nonsense; sums and differences of limited ones do not overflow. */
#define TIME_LIMIT_NS INT64_C(4000000000000000000)
/* Real frames at most so much slower than the display's are shown as they come, until they are slower still. */
#define PASS_THROUGH_RATIO 1.04
#define PASS_THROUGH_UNTIL 1.06

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

static int64_t limit(int64_t value, int64_t most)
{
	return value > most ? most : value < -most ? -most : value;
}

static int64_t age_of(const struct pacer_frame *frame, uint64_t time_ns)
{
	return limit((int64_t)(time_ns - frame->time_ns), TIME_LIMIT_NS);
}

/* ---- frames in ---- */

void pacer_add_frame(struct pacer *pacer, const struct pacer_frame *frame)
{
	struct pacer_frame next = *frame;
	if (next.time_ns == 0)
		next.time_ns = next.intake_ns;
	if (next.ready_ns == 0)
		next.ready_ns = next.intake_ns;
	interval_add(&pacer->interval, next.frame_id, next.time_ns, next.interval_ns);
	if (pacer->interval.stepped)
		ratio_restart(&pacer->ratio, next.frame_id, next.time_ns, pacer->interval.interval_ns);
	else if (pacer->interval.interval_ns != 0)
		ratio_add(&pacer->ratio, next.frame_id, next.time_ns);
	if (pacer->interval.interval_ns != 0)
		ratio_compare(&pacer->ratio, &pacer->params.grid);
	pacer->interval_ns = pacer->interval.interval_ns;
	const double ratio = (double)pacer->interval_ns / vblank_ns(pacer);
	pacer->passes_through = ratio > 0.0 && ratio <= (pacer->passes_through ? PASS_THROUGH_UNTIL : PASS_THROUGH_RATIO);
	pacer->frame = next;
	pacer->has_frame = true;
	pacer->frame_is_new = true;
}

/* ---- decisions ---- */

bool pacer_passes_through(const struct pacer *pacer)
{
	return pacer->passes_through;
}

static double phase_at(const struct pacer *pacer, uint64_t target_ns)
{
	if (pacer->interval_ns == 0)
		return 0.0;
	return ((double)(int64_t)(target_ns - pacer->frame.time_ns) - (double)pacer->delay_ns) / (double)pacer->interval_ns;
}

uint64_t pacer_next_real_vblank(const struct pacer *pacer)
{
	if (!pacer->has_frame || pacer->frame_is_new || pacer->interval_ns == 0 || pacer->delay.count == 0)
		return 0;
	/* From the first showing rather than from the epoch: the sum stays small whatever the client says. */
	const uint64_t shown_ns = pacer_vblank_time(pacer, pacer->first_vblank);
	const int64_t later = delay_reachable(&pacer->delay, vblank_ns(pacer)) - age_of(&pacer->frame, shown_ns);
	const int64_t wait = (int64_t)pacer->interval_ns + limit(later, 2 * SECOND_NS);
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
	const struct delay_sample sample = {.age_ns = age_of(&pacer->frame, decision->target_ns),
										.ready_ns = age_of(&pacer->frame, pacer->frame.ready_ns),
										.time_ns = decision->target_ns};
	delay_add(&pacer->delay, &sample, pacer->ratio.fraction, vblank_ns(pacer));
	if (!pacer->params.fixed_delay)
		pacer->delay_ns = pacer->delay.delay_ns;
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
	delay_undo(&pacer->delay);
}
