/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Plays a schedule through an engine, one picture after the other, and hands
 * each to an observer, with its truth where there is one. On a GPU the pictures
 * of a real frame are drawn while those before come back; nobody looks at one
 * meanwhile, so that its time is the engine's alone.
 */
#ifndef PURSUIT_CLI_PLAYER_H
#define PURSUIT_CLI_PLAYER_H

#include "daemon/measure/measure.h"
#include "real_frame.h"

/* One displayed picture. Everything is valid during the call only. */
struct player_picture {
	const struct beginning *beginning;
	const struct showing *showing;
	struct picture shown;
	const struct picture *truth; /* NULL: there is none */
};

/* One real frame, after its last picture. */
struct player_frame {
	const struct beginning *beginning;
	double engine_ms; /* from the start of engine_begin() to the last picture readable; nothing else counted */
	const struct engine_report *report;
	const char *plan; /* one JSON object */
};

struct player_observer {
	void *context;
	/* 0, or a negative errno with a sentence: playing stops with it. */
	int (*picture)(void *context, const struct player_picture *picture, struct error *error);
	int (*frame)(void *context, const struct player_frame *frame, struct error *error);
};

/* Where truth comes from: the picture of a showing, valid until the next call; NULL if there is none. */
struct player_truth {
	void *context;
	const struct picture *(*get)(void *context, const struct beginning *beginning, const struct showing *showing);
};

struct player {
	struct recording_reader *reader;
	const struct recorded_frames *frames;
	const struct schedule *schedule;
	struct engine *engine;
	struct player_truth truth; /* get NULL: none */
	struct player_observer observer;
	const char *progress; /* what is counted, NULL: quiet */
};

/* 0 or a negative errno with a sentence. Frames that cannot be read any more are named on stderr and left out. */
int player_run(struct player *player, struct error *error);

/* Truth out of the recording itself: the recorded frame of that moment, made by an engine of its own as it would be
 * displayed plain. Uses slot 2 of the reader. */
struct recorded_truth;
struct recorded_truth *recorded_truth_create(struct recording_reader *reader, const struct recorded_frames *frames,
											 const struct engine_params *params, struct error *error);
void recorded_truth_destroy(struct recorded_truth **truth);
struct player_truth recorded_truth_source(struct recorded_truth *truth);

#endif
