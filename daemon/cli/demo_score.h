/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Scores what a daemon displayed: the real frames of its recording are played
 * again at the phases of its timeline, and each in-between is compared with the
 * scene rendered at that very moment.
 */
#ifndef PURSUIT_CLI_DEMO_SCORE_H
#define PURSUIT_CLI_DEMO_SCORE_H

#include <jansson.h>

#include "daemon/measure/measure.h"
#include "daemon/options.h"
#include "scene_source.h"
#include "timeline.h"

struct demo_score_params {
	const char *recording;
	const struct timeline *timeline;
	const struct settings *settings;
	struct scene_source *source;
	struct arg_size size;
	uint64_t epoch_ns;   /* CLOCK_MONOTONIC of the scene's time 0 */
	const char *title;   /* of the contact sheet */
	const char *contact; /* path of the contact sheet */
};

struct demo_score {
	struct quality quality;
	json_t *scored;                /* a row for each scored in-between; the caller's */
	uint32_t first_row, row_count; /* of the timeline: the vblanks that the recording covers; 0 rows: none */
};

/* 0 or a negative errno with a sentence. */
int demo_score(const struct demo_score_params *params, struct demo_score *score, struct error *error);

#endif
