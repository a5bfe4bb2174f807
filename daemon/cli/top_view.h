/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What `pursuit top` shows: figures of the last moment from a daemon's answers,
 * their course over the last minute, and the text of it. Knows no terminal and
 * no socket.
 */
#ifndef PURSUIT_CLI_TOP_VIEW_H
#define PURSUIT_CLI_TOP_VIEW_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "daemon/lab/latency_read.h"

#define TOP_TREND 48u

enum top_figure {
	TOP_DISPLAYED_HZ,
	TOP_REAL_HZ,
	TOP_ON_TIME,
	TOP_PHASE,
	TOP_READY_BEFORE,
	TOP_SUBMIT_TO_FLIP,
	TOP_SUBMIT_TO_FLIP_99,
	TOP_ENGINE,
	TOP_ENGINE_99,
	TOP_FLIP_TO_EDGE,
	TOP_FLIP_TO_EDGE_99,
	TOP_FLIP_TO_PHOTON,
	TOP_FIGURES,
};

struct top_view {
	json_t *status, *before;              /* the newest, and that of the round before; owned */
	double trend[TOP_FIGURES][TOP_TREND]; /* the newest last; NAN: not known */
	uint64_t rounds;
};

/*
 * Takes in a round: the status (kept), the timeline's new rows (may be NULL)
 * and the lab's new rows (may be empty).
 */
void top_view_add(struct top_view *view, json_t *status, const json_t *timeline, const struct latency_table *rows);
/* A newer status within a round, kept. */
void top_view_replace_status(struct top_view *view, json_t *status);
void top_view_finish(struct top_view *view);

/* Lines of at most `columns` characters; titles are bold with `color`. */
void top_view_print(const struct top_view *view, unsigned columns, bool color, FILE *out);
/* One such line: nothing in it that a terminal would obey. */
void top_view_print_line(unsigned columns, const char *text, FILE *out);
/* {"now": {figure: value}, "status": ...}; the caller's. */
json_t *top_view_json(const struct top_view *view);

#endif
