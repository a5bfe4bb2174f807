/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Other settings of a lab while it runs. On the owner's thread; what is the lab thread's is changed while that stands.
 */

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "daemon/lab/state.h"

enum { MARKER, STROBE, FIRST_INPUT, VSYNC = FIRST_INPUT + 2 };

static struct lines *line_of(struct lab *lab, unsigned which)
{
	struct lines *const all[LAB_LINES] = {&lab->marker, &lab->strobe_lines, &lab->photodiode, &lab->trigger,
										  &lab->vsync_lines};
	return all[which];
}

static struct lines wish_of(const struct lab *lab, const struct lab_settings *settings, unsigned which)
{
	if (which == MARKER)
		return outputs_marker(lab, settings);
	return which == STROBE ? outputs_strobe(lab, settings) : inputs_line(lab, settings, which - FIRST_INPUT);
}

static bool are_same(const struct lines *a, const struct lines *b)
{
	if (!a->wanted || !b->wanted)
		return a->wanted == b->wanted;
	return strcmp(a->params.chip, b->params.chip) == 0 && strcmp(a->params.lines, b->params.lines) == 0 &&
		   a->params.active_low == b->params.active_low;
}

/* ---- parking ---- */

static void park(struct lab *lab)
{
	atomic_store(&lab->park, true);
	lab_wake(lab);
	while (sem_wait(&lab->parked) < 0)
		;
	atomic_store(&lab->park, false);
}

static void unpark(struct lab *lab)
{
	sem_post(&lab->go_on);
	lab_wake(lab);
}

/* ---- lines ---- */

/* "gpiochip0" of "gpiochip0 (gpio-sim.0)". */
static void keep_name(char name[CHIP_NAME_BYTES], const char *text)
{
	snprintf(name, CHIP_NAME_BYTES, "%.*s", (int)strcspn(text, " "), text);
}

/* Those that change and are there let go of what they hold, and wait. */
static void give_lines_up(struct lab *lab)
{
	park(lab);
	for (unsigned i = 0; i < LAB_LINES; i++) {
		struct lines *lines = line_of(lab, i);
		if (!lab->prepared.lines[i].other || !lines->chip)
			continue;
		if (i == STROBE)
			chip_set(lines->chip, 0);
		if (i == MARKER)
			keep_name(lab->prepared.marker_chip, chip_text(lines->chip));
		chip_close(&lines->chip);
		lines->retry_ns = UINT64_MAX;
		lab->prepared.lines[i].early = true;
	}
	unpark(lab);
}

/* The thread opens them again at once. */
static void take_lines_back(struct lab *lab)
{
	bool any = false;
	for (unsigned i = 0; i < LAB_LINES; i++)
		any |= lab->prepared.lines[i].early;
	if (!any)
		return;
	park(lab);
	for (unsigned i = 0; i < LAB_LINES; i++)
		if (lab->prepared.lines[i].early)
			line_of(lab, i)->retry_ns = 0;
	unpark(lab);
}

static bool open_line(struct lab *lab, unsigned which, struct error *error)
{
	const struct lines wish = wish_of(lab, &lab->prepared.settings, which);
	if (!lab->prepared.lines[which].other || !wish.wanted || lab->prepared.lines[which].chip)
		return true;
	lab->prepared.lines[which].chip = chip_open(&wish.params, error);
	return lab->prepared.lines[which].chip != NULL;
}

static bool open_lines(struct lab *lab, struct error *error)
{
	bool all = true;
	for (unsigned i = 0; i < LAB_LINES && all; i++)
		all = open_line(lab, i, error);
	return all;
}

static int prepare_lines(struct lab *lab, struct error *error)
{
	bool any_there = false;
	for (unsigned i = 0; i < LAB_LINES; i++) {
		const struct lines wish = wish_of(lab, &lab->prepared.settings, i);
		lab->prepared.lines[i].other = !are_same(line_of(lab, i), &wish);
		any_there |= lab->prepared.lines[i].other && line_of(lab, i)->wanted;
	}
	if (open_lines(lab, error))
		return 0;
	if (!any_there)
		return -EBUSY;
	/* What is in the way may be a line of our own. */
	give_lines_up(lab);
	return open_lines(lab, error) ? 0 : -EBUSY;
}

/* ---- what else is made beside ---- */

static int prepare_log(struct lab *lab, const char *header, struct error *error)
{
	const char *path = lab->prepared.settings.latency_log;
	lab->prepared.other_log = strcmp(path, lab->settings.latency_log) != 0;
	if (!lab->prepared.other_log || !*path)
		return 0;
	lab->prepared.latency_log = latency_log_create(path, header, lab->params.log, error);
	return lab->prepared.latency_log ? 0 : -EIO;
}

static int prepare_guard(struct lab *lab, struct error *error)
{
	const struct lines wish = outputs_strobe(lab, &lab->prepared.settings);
	lab->prepared.other_guard = !are_same(&lab->strobe_lines, &wish);
	if (!lab->prepared.other_guard || !wish.wanted)
		return 0;
	return guard_start(&lab->prepared.guard, &wish.params, error);
}

static int prepare_all(struct lab *lab, const char *header, struct error *error)
{
	int result = lab_check(&lab->prepared.settings, error);
	if (result < 0 || !lab_is_wanted(&lab->prepared.settings))
		return result;
	if (!lab->running) {
		result = lab_start_thread(lab, error);
		lab->prepared.started = result == 0;
	}
	if (result == 0)
		result = prepare_log(lab, header, error);
	if (result == 0)
		result = prepare_guard(lab, error);
	return result < 0 ? result : prepare_lines(lab, error);
}

int lab_prepare(struct lab *lab, const struct lab_settings *fresh, double period_ns, const char *header,
				struct error *error)
{
	lab->prepared = (struct lab_prepared){.settings = *fresh, .period_ns = period_ns};
	const int result = prepare_all(lab, header, error);
	if (result < 0)
		lab_abandon(lab);
	return result;
}

void lab_abandon(struct lab *lab)
{
	struct lab_prepared *prepared = &lab->prepared;
	for (unsigned i = 0; i < LAB_LINES; i++)
		chip_close(&prepared->lines[i].chip);
	take_lines_back(lab);
	guard_dismiss(&prepared->guard);
	latency_log_destroy(&prepared->latency_log);
	if (prepared->started)
		lab_stop_thread(lab);
	*prepared = (struct lab_prepared){.period_ns = 0.0};
}

/* ---- taking it over ---- */

static void leave_line(struct lab *lab, unsigned which)
{
	if (which == MARKER)
		outputs_leave_marker(lab);
	else if (which == STROBE)
		outputs_leave_strobe(lab);
	else
		lines_finish(line_of(lab, which));
}

static void take_lines(struct lab *lab)
{
	struct lab_prepared *prepared = &lab->prepared;
	for (unsigned i = 0; i < LAB_LINES; i++) {
		if (!prepared->lines[i].other)
			continue;
		*line_of(lab, i) = wish_of(lab, &lab->settings, i);
		lines_adopt(line_of(lab, i), prepared->lines[i].chip, clock_now(lab->params.clock));
		prepared->lines[i].chip = NULL;
	}
	outputs_change(lab, prepared->lines[MARKER].other, prepared->lines[STROBE].other);
	inputs_change(lab);
}

static void take_vsync(struct lab *lab, const struct lab_settings *before)
{
	const struct lab_settings *now = &lab->settings;
	if (lab->prepared.period_ns > 0.0)
		vsync_expect(lab->vsync, lab->prepared.period_ns);
	if (lab->prepared.lines[VSYNC].other || now->vsync_edge != before->vsync_edge ||
		now->vsync_offset_us != before->vsync_offset_us)
		vsync_restart(lab->vsync, now->vsync_offset_us * 1e3);
}

/* While the thread stands. Gives the log of before. */
static struct latency_log *take_all(struct lab *lab, const struct lab_settings *before)
{
	struct latency_log *log = NULL;
	for (unsigned i = 0; i < LAB_LINES; i++)
		if (lab->prepared.lines[i].other)
			leave_line(lab, i);
	lab->settings = lab->prepared.settings;
	take_lines(lab);
	take_vsync(lab, before);
	if (lab->prepared.other_log) {
		log = lab->latency_log;
		lab->latency_log = lab->prepared.latency_log;
	}
	if (lab->prepared.other_guard) {
		guard_dismiss(&lab->guard);
		lab->guard = lab->prepared.guard;
	}
	lab_publish_patch(lab);
	if (before->priority != lab->settings.priority && lab->running)
		lab_set_priority(lab, lab->thread);
	return log;
}

/*
 * The marker's lines were given up before it was known whether all could be had, and kept their levels for that. Those
 * that nobody took again get the final one now.
 */
static void leave_dropped(const struct lab *lab, const struct lab_settings *before)
{
	struct lines dropped = outputs_marker(lab, before);
	const char *list = before->gpio_line;
	char name[CHIP_NAME_BYTES];
	struct error error;
	if (before->final_level == LAB_FINAL_KEEP)
		return;
	dropped.params.chip = lab->prepared.marker_chip;
	dropped.params.lines = name;
	dropped.params.levels = before->final_level == LAB_FINAL_HIGH;
	while (chip_next_line(&list, name) == 1) {
		struct chip *chip = chip_open(&dropped.params, &error);
		chip_close(&chip);
	}
}

struct latency_log *lab_commit(struct lab *lab)
{
	const struct lab_settings before = lab->settings;
	struct latency_log *log = NULL;
	if (lab->running && lab_is_wanted(&lab->prepared.settings)) {
		park(lab);
		log = take_all(lab, &before);
		unpark(lab);
		if (lab->prepared.lines[MARKER].early)
			leave_dropped(lab, &before);
		atomic_store(&lab->active, true);
	} else if (lab->running) {
		lab_stop_thread(lab);
		lab->prepared.other_log = true;
		lab->prepared.other_guard = true;
		log = take_all(lab, &before);
	} else {
		take_all(lab, &before);
	}
	lab->prepared = (struct lab_prepared){.period_ns = 0.0};
	return log;
}
