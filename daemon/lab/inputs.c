/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <string.h>

#include "daemon/lab/state.h"

#define READ_MOST 16
/* Flip events may come so much later than the edges that they cause. */
#define HOLD_NS UINT64_C(40000000)
/* An edge is read so much later than it was, at most. */
#define TRIGGER_HOLD_NS UINT64_C(10000000)

struct lines inputs_line(const struct lab *lab, const struct lab_settings *settings, unsigned which)
{
	const struct {
		const char *line, *option;
		bool active_low;
	} inputs[] = {
		{settings->photodiode_line, "photodiode-line", settings->photodiode_active_low},
		{settings->trigger_line, "trigger-line", settings->trigger_active_low},
		{settings->vsync_line, "vsync-line", false},
	};
	return (struct lines){
		.params = {.chip = settings->gpio_chip,
				   .lines = inputs[which].line,
				   .option = inputs[which].option,
				   .input = true,
				   .active_low = inputs[which].active_low},
		.log = lab->params.log,
		.wanted = *inputs[which].line != '\0',
	};
}

void inputs_init(struct lab *lab)
{
	lab->photodiode = inputs_line(lab, &lab->settings, 0);
	lab->trigger = inputs_line(lab, &lab->settings, 1);
	lab->vsync_lines = inputs_line(lab, &lab->settings, 2);
	inputs_change(lab);
}

void inputs_change(struct lab *lab)
{
	lab->match.least_ns = (uint64_t)lab->settings.photon_least_us * 1000;
	lab->match.debounce_ns = (uint64_t)lab->settings.debounce_us * 1000;
	lab->rows.hold_ns = lab->trigger.wanted ? TRIGGER_HOLD_NS : 0;
}

/* An alternating patch tells two neighbours apart by direction; without a patch any edge may be any flip's. */
static uint64_t window_end(const struct lab *lab)
{
	if (lab->settings.photon_most_us)
		return (uint64_t)lab->settings.photon_most_us * 1000;
	const double periods = lab->settings.patch == LAB_PATCH_OFF ? 1.0 : 2.0;
	return lab->match.least_ns + (uint64_t)(periods * lab->period_ns);
}

void inputs_flip(struct lab *lab, struct row *row, bool changed)
{
	enum match_want want = MATCH_EITHER;
	/* Edges that are older are read before the row goes, whatever the last poll said. */
	lab->trigger.readable = true;
	if (!lab->photodiode.chip)
		return;
	if (lab->settings.patch != LAB_PATCH_OFF)
		want = !changed ? MATCH_NONE : row->points.level ? MATCH_RISING : MATCH_FALLING;
	lab->match.most_ns = window_end(lab);
	row->photon_open = true;
	row->points.time[POINT_PHOTON] = POINT_NOT_YET;
	match_add_flip(&lab->match, row->points.vblank, row->points.time[POINT_FLIP], want);
}

static void take_photon(struct lab *lab, const struct chip_edge *edge)
{
	match_add_edge(&lab->match, edge->time_ns, edge->rising);
}

/* The leading edge is the trigger; an input says which by active-low. Of too many that wait the oldest goes. */
static void take_trigger(struct lab *lab, const struct chip_edge *edge)
{
	if (!edge->rising)
		return;
	lab->triggers++;
	if (lab->trigger_count == LAB_TRIGGERS)
		memmove(&lab->trigger_ns[0], &lab->trigger_ns[1], --lab->trigger_count * sizeof(lab->trigger_ns[0]));
	lab->trigger_ns[lab->trigger_count++] = edge->time_ns;
}

/* To their flips, as far as these have come. */
static void give_triggers(struct lab *lab)
{
	uint32_t left = 0;
	for (uint32_t i = 0; i < lab->trigger_count; i++)
		if (!rows_trigger(&lab->rows, lab->trigger_ns[i]))
			lab->trigger_ns[left++] = lab->trigger_ns[i];
	lab->trigger_count = left;
}

static void take_vsync(struct lab *lab, const struct chip_edge *edge)
{
	if (edge->rising == (lab->settings.vsync_edge == 0))
		vsync_add_edge(lab->vsync, edge->time_ns);
}

static void read_line(struct lab *lab, struct lines *lines, uint64_t now_ns,
					  void (*take)(struct lab *lab, const struct chip_edge *edge))
{
	struct chip_edge edges[READ_MOST];
	int count = 0;
	if (!lines->chip || !lines->readable)
		return;
	do {
		count = chip_read(lines->chip, edges, READ_MOST);
		for (int i = 0; i < count; i++)
			take(lab, &edges[i]);
	} while (count == READ_MOST);
	if (count < 0)
		lines_lose(lines, count, now_ns);
}

static void check_vsync(struct lab *lab, uint64_t now_ns)
{
	char sentence[VSYNC_SENTENCE];
	if (!lab->vsync_lines.wanted || !vsync_check(lab->vsync, now_ns, sentence))
		return;
	if (vsync_get_counts(lab->vsync).state == VSYNC_TRUSTED)
		log_info(lab->params.log, "%s", sentence);
	else
		log_warning(lab->params.log, "%s", sentence);
}

static void settle(struct lab *lab, uint64_t now_ns)
{
	struct match_result result;
	while (match_next(&lab->match, now_ns, HOLD_NS, &result)) {
		struct row *row = result.fate == MATCH_STRAY ? NULL : rows_find(&lab->rows, result.number);
		if (!row)
			continue;
		row->photon_open = false;
		row->points.time[POINT_PHOTON] = result.edge_ns;
		row->points.photon_lost = result.fate == MATCH_LOST && lab->settings.patch != LAB_PATCH_OFF;
	}
}

void inputs_work(struct lab *lab, uint64_t now_ns)
{
	struct lines *const all[] = {&lab->vsync_lines, &lab->photodiode, &lab->trigger};
	read_line(lab, &lab->vsync_lines, now_ns, take_vsync);
	read_line(lab, &lab->photodiode, now_ns, take_photon);
	read_line(lab, &lab->trigger, now_ns, take_trigger);
	give_triggers(lab);
	check_vsync(lab, now_ns);
	settle(lab, now_ns);
	for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++) {
		lines_check(all[i], now_ns);
		lines_revive(all[i], now_ns);
	}
}

static uint64_t earlier(uint64_t a, uint64_t b)
{
	return a < b ? a : b;
}

uint64_t inputs_next(const struct lab *lab)
{
	uint64_t next =
		earlier(lines_next(&lab->vsync_lines), earlier(lines_next(&lab->photodiode), lines_next(&lab->trigger)));
	if (lab->vsync_lines.wanted)
		next = earlier(next, vsync_next(lab->vsync));
	if (lab->match.flip_count > 0)
		next = earlier(next, lab->match.flips[0].flip_ns + lab->match.most_ns + HOLD_NS);
	return next;
}

void inputs_finish(struct lab *lab)
{
	lines_finish(&lab->photodiode);
	lines_finish(&lab->trigger);
	lines_finish(&lab->vsync_lines);
}
