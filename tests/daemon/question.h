/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What a daemon answers to a control request, over a connection that was greeted (raw_greet()). */
#ifndef PURSUIT_TESTS_QUESTION_H
#define PURSUIT_TESTS_QUESTION_H

#include <jansson.h>
#include <stdbool.h>

/* The whole answer, the caller's; NULL if it is no JSON. */
json_t *question_ask(int connection, const char *request);
/* A number of the answer, or the length of an array: "streams", "passes.copy". A check fails if there is none. */
json_int_t question_figure(int connection, const char *request, const char *path);
/*
 * "set ..." of what a presenter must be made anew for, again and again while the display server is too busy to answer
 * (ENODEV). The status of the last answer.
 */
int question_set_at_last(int connection, const char *request);
/* Waits until the picture stays: nothing more is shown. A check fails if that does not come. */
void question_wait_for_rest(int connection);
/* Do the settings hold this text? "\ncell = 8\n" */
bool question_setting(int connection, const char *text);

#endif
