/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * demo_score() in a process of its own, made before the demo gives way to its
 * daemon: whoever has made itself nicer does not get back, and neither do the
 * renderer's threads. It answers once, and ends with the demo.
 */
#ifndef PURSUIT_CLI_DEMO_SCORER_H
#define PURSUIT_CLI_DEMO_SCORER_H

#include <sys/types.h>

#include "demo_score.h"

struct demo_scorer {
	pid_t pid; /* 0: there is none */
	int to, from;
};

/* What is known only when all has been shown. */
struct demo_scorer_request {
	struct arg_size size;
	struct arg_rate rate;
	uint64_t epoch_ns; /* CLOCK_MONOTONIC of the scene's time 0 */
	char title[200];   /* of the contact sheet */
};

/*
 * Makes the process: to be called before there is any thread. `scene`, the settings, and the paths of the recording and
 * of the contact sheet are those of this moment. 0 or a negative errno with a sentence.
 */
int demo_scorer_start(struct demo_scorer *scorer, const char *scene, const struct settings *settings,
					  const char *recording, const char *contact, struct error *error);

/* Scores, and waits for it; what demo_score() says. */
int demo_scorer_ask(struct demo_scorer *scorer, const struct demo_scorer_request *request,
					const struct timeline *timeline, struct demo_score *score, struct error *error);

void demo_scorer_finish(struct demo_scorer *scorer);

#endif
