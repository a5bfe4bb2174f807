/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The log of the task experiment (Didyk et al. 2010, Section 7.2; scene
 * `rings`): every ring answered or missed, with the method that was shown, and
 * the counts per method. What a key means is the scene's business; an event is
 * told from how its score changes.
 */
#ifndef PURSUIT_CLI_TASK_H
#define PURSUIT_CLI_TASK_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "daemon/error.h"

/* As the scene counts them (client/scenes/scene.h). */
struct task_score {
	uint32_t shown, hits, misses, false_answers;
};

struct task;

/* NULL: no memory. */
struct task *task_create(void);
void task_destroy(struct task **task);

/* Does this differ from the score told last? */
bool task_changed(const struct task *task, const struct task_score *score);

/*
 * The score as it is at `time` (seconds of the scene), told after every key and every frame. method: what is shown.
 * key: what was pressed, 0 none.
 */
void task_note(struct task *task, double time, const struct task_score *score, uint32_t key, const char *method);

/* Rows of time, ring, event (hit, miss, false), key, method. 0 or -errno with a sentence. */
int task_write_csv(const struct task *task, const char *path, struct error *error);

/* {"methods": {NAME: {"shown", "hits", "misses", "false_answers"}}, "events": [...]} */
json_t *task_json(const struct task *task);

/* "12 rings, 9 hits, 2 misses, 1 false": all methods together. */
void task_describe(const struct task *task, char *text, size_t size);

#endif
