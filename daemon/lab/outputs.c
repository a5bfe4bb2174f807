/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/state.h"

#define LATE_NS UINT64_C(1000000)
/* A pulse that lasts into the next refresh would swallow the next edge. */
#define PULSE_PERIODS 0.5

static uint32_t count_lines(const struct lab_settings *settings)
{
	struct error error;
	const int count =
		*settings->gpio_line ? chip_count_lines(settings->gpio_chip, settings->gpio_line, "gpio-line", &error) : 1;
	return count > 0 ? (uint32_t)count : 1;
}

static uint32_t initial_levels(const struct lab_settings *settings)
{
	return settings->initial_level ? (1u << count_lines(settings)) - 1 : 0;
}

struct lines outputs_marker(const struct lab *lab, const struct lab_settings *settings)
{
	return (struct lines){
		.params = {.chip = settings->gpio_chip,
				   .lines = settings->gpio_line,
				   .option = "gpio-line",
				   .active_low = settings->active_low,
				   .levels = initial_levels(settings)},
		.log = lab->params.log,
		.wanted = *settings->gpio_line != '\0',
	};
}

struct lines outputs_strobe(const struct lab *lab, const struct lab_settings *settings)
{
	return (struct lines){
		.params = {.chip = settings->gpio_chip,
				   .lines = settings->strobe_line,
				   .option = "strobe-line",
				   .active_low = settings->strobe_active_low},
		.log = lab->params.log,
		.wanted = *settings->strobe_line != '\0',
	};
}

void outputs_init(struct lab *lab)
{
	const struct lab_settings *settings = &lab->settings;
	lab->marker = outputs_marker(lab, settings);
	lab->strobe_lines = outputs_strobe(lab, settings);
	strobe_init(&lab->strobe, settings->strobe_phase, settings->strobe_duty, settings->strobe_limit, lab->period_ns);
	outputs_change(lab, true, true);
}

void outputs_change(struct lab *lab, bool other_marker, bool other_strobe)
{
	const struct lab_settings *settings = &lab->settings;
	if (other_marker)
		lab->levels = initial_levels(settings);
	lab->pattern = (struct pattern){
		.kind = (enum pattern_kind)settings->pattern,
		.lines = count_lines(settings),
		.pulse_ns = (uint64_t)settings->pulse_us * 1000,
		.offset_ns = (uint64_t)settings->offset_us * 1000,
		.levels = other_marker ? lab->levels : lab->pattern.levels,
	};
	strobe_change(&lab->strobe, settings->strobe_phase, settings->strobe_duty, settings->strobe_limit);
	if (other_strobe)
		lab->strobe_due_ns = lab->strobe_off_ns = LAB_NEVER;
}

bool outputs_flip(struct lab *lab, const struct pattern_flip *flip)
{
	struct pattern_change change;
	lab->strobe.period_ns = lab->period_ns;
	/* A pulse that has not begun when the next flip comes is left behind by it. */
	if (lab->strobe_lines.chip)
		lab->strobe_due_ns = strobe_due(&lab->strobe, flip->flip_ns);
	if (!lab->marker.wanted || !pattern_add_flip(&lab->pattern, flip, &change))
		return false;
	if ((double)change.pulse_ns > PULSE_PERIODS * lab->period_ns)
		change.pulse_ns = (uint64_t)(PULSE_PERIODS * lab->period_ns);
	/* One that is dropped is an edge that the row waits for in vain. */
	pattern_schedule(&lab->pattern, &lab->schedule, &change);
	return true;
}

/* ---- the strobe ---- */

static void set_strobe(struct lab *lab, bool on)
{
	const int result = lab->strobe_lines.chip ? chip_set(lab->strobe_lines.chip, on) : 0;
	if (result < 0)
		lines_lose(&lab->strobe_lines, result, clock_now(lab->params.clock));
}

static void work_strobe(struct lab *lab, uint64_t now_ns)
{
	if (now_ns >= lab->strobe_off_ns) {
		set_strobe(lab, false);
		strobe_end(&lab->strobe, clock_now(lab->params.clock));
		lab->strobe_off_ns = LAB_NEVER;
		now_ns = clock_now(lab->params.clock);
	}
	if (now_ns < lab->strobe_due_ns)
		return;
	const uint64_t off_ns = strobe_begin(&lab->strobe, lab->strobe_due_ns, now_ns);
	lab->strobe_due_ns = LAB_NEVER;
	if (off_ns == 0)
		return;
	lab->strobe_off_ns = off_ns;
	set_strobe(lab, true);
}

/* ---- the marker ---- */

/* The edge of a vblank is out (or lost with its line). */
static void note_edge(struct lab *lab, uint64_t vblank, uint64_t before_ns, uint64_t after_ns)
{
	struct row *row = rows_find(&lab->rows, vblank);
	if (!row || !row->edge_open)
		return;
	row->edge_open = false;
	row->points.time[POINT_EDGE] = after_ns;
	row->points.set_ns = after_ns ? (uint32_t)(after_ns - before_ns) : 0;
	row->points.edge_lost = after_ns == 0;
}

/* Gives the time after it back. */
static uint64_t apply(struct lab *lab, const struct pattern_change *change)
{
	const uint64_t before_ns = clock_now(lab->params.clock);
	/* A pulse that begins while the one before lasts is none on the wire. */
	const bool turns = ((lab->levels ^ change->levels) & change->mask) == change->mask;
	lab->levels = (lab->levels & ~change->mask) | change->levels;
	const int result = lab->marker.chip ? chip_set(lab->marker.chip, lab->levels) : -1;
	const uint64_t after_ns = clock_now(lab->params.clock);
	if (lab->marker.chip && result < 0)
		lines_lose(&lab->marker, result, after_ns);
	const bool marks = change->vblank != UINT64_MAX, is_edge = result == 0 && turns;
	if (marks)
		note_edge(lab, change->vblank, before_ns, is_edge ? after_ns : 0);
	lab->edges += marks && is_edge;
	lab->late_changes += marks && before_ns > change->time_ns + LATE_NS;
	if (change->pulse_ns) {
		/* From when it really was set: a pulse is never shortened by a late start. */
		const struct pattern_change end = {
			.time_ns = after_ns + change->pulse_ns, .vblank = UINT64_MAX, .mask = change->mask};
		schedule_add(&lab->schedule, &end);
	}
	return after_ns;
}

static void revive(struct lab *lab, uint64_t now_ns)
{
	lab->marker.params.levels = lab->levels;
	lines_revive(&lab->marker, now_ns);
	lines_revive(&lab->strobe_lines, now_ns);
}

void outputs_work(struct lab *lab, uint64_t now_ns)
{
	struct pattern_change change;
	work_strobe(lab, now_ns);
	while (schedule_take(&lab->schedule, now_ns, &change)) {
		now_ns = apply(lab, &change);
		work_strobe(lab, now_ns);
	}
	revive(lab, now_ns);
}

static uint64_t earlier(uint64_t a, uint64_t b)
{
	return a < b ? a : b;
}

uint64_t outputs_next(const struct lab *lab)
{
	const uint64_t strobe_ns = earlier(lab->strobe_due_ns, lab->strobe_off_ns);
	const uint64_t lines_ns = earlier(lines_next(&lab->marker), lines_next(&lab->strobe_lines));
	return earlier(schedule_next(&lab->schedule), earlier(strobe_ns, lines_ns));
}

void outputs_leave_strobe(struct lab *lab)
{
	set_strobe(lab, false);
	strobe_end(&lab->strobe, clock_now(lab->params.clock));
	lab->strobe_due_ns = lab->strobe_off_ns = LAB_NEVER;
	lines_finish(&lab->strobe_lines);
}

void outputs_leave_marker(struct lab *lab)
{
	const uint32_t all = (1u << lab->pattern.lines) - 1;
	struct pattern_change change;
	while (schedule_take(&lab->schedule, UINT64_MAX, &change))
		if (change.vblank != UINT64_MAX)
			note_edge(lab, change.vblank, 0, 0);
	if (lab->marker.chip && lab->settings.final_level != LAB_FINAL_KEEP)
		chip_set(lab->marker.chip, lab->settings.final_level == LAB_FINAL_HIGH ? all : 0);
	lines_finish(&lab->marker);
}

void outputs_finish(struct lab *lab)
{
	outputs_leave_strobe(lab);
	outputs_leave_marker(lab);
}
