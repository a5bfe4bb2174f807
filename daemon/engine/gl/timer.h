/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * How long each pass takes: by timer queries on a GPU, else by the CPU clock.
 * A CPU renderer's queries tell nothing, since it works while others draw.
 */
#ifndef PURSUIT_ENGINE_GL_TIMER_H
#define PURSUIT_ENGINE_GL_TIMER_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/engine.h"
#include "daemon/engine/gl/gl.h"

#define TIMER_QUERIES 64

struct timer {
	bool queries, finish;
	GLuint ids[TIMER_QUERIES];
	struct engine_pass_report *owners[TIMER_QUERIES];
	uint32_t pending;
	struct engine_pass_report *open; /* the pass now measured */
	bool open_query;
	uint64_t began_ns;
};

/* `queries`: if the renderer has them. `finish`: wait after each pass instead. */
void timer_init(struct timer *timer, const struct gl *gl, bool queries, bool finish);
void timer_finish(struct timer *timer, const struct gl *gl);

/* Static: "timer-query", "finish", "cpu". */
const char *timer_source(const struct timer *timer);

/* Between them a pass runs; they do not nest. What the CPU alone does is measured by its clock. */
void timer_begin(struct timer *timer, const struct gl *gl, struct engine_pass_report *pass, bool on_cpu);
void timer_end(struct timer *timer, const struct gl *gl);

/* Waits for queries under way and adds them to their passes; not if the GPU says that it lost count of time. */
void timer_collect(struct timer *timer, const struct gl *gl);
/* Forgets queries under way. */
void timer_drop(struct timer *timer);

#endif
