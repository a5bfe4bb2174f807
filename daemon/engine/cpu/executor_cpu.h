/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The executor that needs no GL: what its passes share. */
#ifndef PURSUIT_ENGINE_CPU_EXECUTOR_CPU_H
#define PURSUIT_ENGINE_CPU_EXECUTOR_CPU_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/cpu/bins.h"
#include "daemon/engine/cpu/canvas.h"
#include "daemon/engine/contents.h"
#include "daemon/engine/cpu/layers.h"
#include "daemon/engine/cpu/levels.h"
#include "daemon/engine/cpu/light.h"
#include "daemon/engine/cpu/weights.h"
#include "daemon/engine/pool.h"
#include "daemon/engine/state.h"

/* The planes on their way in: a task of the pool that runs while the frame is analysed. */
struct intake {
	struct engine *engine;
	int color, ui;          /* places in the header; ui: -1 if there is none */
	uint32_t color_items;   /* blocks of rows of colour, before those of the UI */
	struct bounds *bounds;  /* of each block of rows of the UI */
	size_t bounds_capacity; /* blocks */
	uint32_t first_item;    /* those before it were taken by the caller alone */
	bool under_way;
	uint64_t bytes; /* of the pictures */
	/* Rows that are as they were, of a picture that did not move: pass_upload.c. */
	uint64_t (*hash_row)(const uint8_t *row, size_t bytes);
	uint64_t *hashes; /* of rows of colour, then of the UI */
	size_t hashes_capacity;
	bool looks;          /* hashes are made of this frame */
	bool compares;       /* and compared with those of the frame before */
	bool hashed;         /* those of the frame taken last are there */
	atomic_bool differs; /* from the frame before, which then need not be looked at further */
	uint32_t not_before; /* frames that pass before it looks again */
};

struct executor_cpu {
	struct executor base;
	const struct cpu_kernels *kernels;
	char renderer[64];
	struct engine_pass_report *timed;
	uint64_t began_ns;

	/* ORIGINAL, REAL and BETWEEN are one canvas, whose blocks with a blur weight change: cpu_picture(). */
	struct canvas pictures[PICTURE_COUNT];
	struct canvas levels[MAX_LEVELS]; /* levels[i] is level i + 1 of the pyramid */
	struct layers layers;
	struct contents contents;
	struct sheet sheet; /* where SHOWN is made */
	bool sheet_is_open; /* in this engine_render() */
	struct weights weights;
	struct light light;
	struct scene scene;
	struct scene_scratch *scratch; /* by thread */
	struct intake intake;
};

static inline struct executor_cpu *cpu_of(const struct engine *engine)
{
	return (struct executor_cpu *)engine->executor;
}

/* The picture of that name, ready to be read, whatever is still on its way. Of ORIGINAL, REAL and BETWEEN only the one
 * asked for last is. */
const struct canvas *cpu_picture(struct engine *engine, enum picture_id id);

/* Where SHOWN is made: in the caller's image if there is one, else in memory of our own. 0 or -ENOMEM. */
int cpu_shown(struct engine *engine, const struct sheet **shown, struct error *error);

/* Copies a picture as large as the frame to where SHOWN is made, but for tiles that are there; `id`: what it is. */
void cpu_copy(struct executor_cpu *executor, enum picture_id id, const struct canvas *from);

/* Waits until the frame's planes have been taken. */
void cpu_finish_intake(struct engine *engine);

extern const struct pass cpu_pass_upload, cpu_pass_analyse, cpu_pass_pyramid, cpu_pass_compensate, cpu_pass_put,
	cpu_pass_warp, cpu_pass_ui, cpu_pass_read;

#endif
