/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What carries out the passes: GL (gl/) or the CPU (cpu/). Methods are written
 * once: they name pictures and run passes by id, and know neither where a
 * picture lies nor who makes it. An executor is a table of passes, the pictures
 * that they work on in its own way, and what the engine must know about it.
 */
#ifndef PURSUIT_ENGINE_EXECUTOR_H
#define PURSUIT_ENGINE_EXECUTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/engine.h"
#include "daemon/error.h"

struct arrival;
struct engine;
struct pool;

/* In the order of the report; pass.c has their names. */
enum pass_id {
	PASS_ANALYSE = 0,
	PASS_FIELD,      /* displacement, depth and colour at each pixel into engine->pixels; the same for all executors */
	PASS_UPLOAD,     /* ORIGINAL and UI from the frame's planes */
	PASS_PYRAMID,    /* LOW from ORIGINAL, or what it is made of, in the marked tiles or everywhere */
	PASS_COMPENSATE, /* REAL and BETWEEN from ORIGINAL and LOW */
	PASS_PAINT,      /* engine->pixels.shown by job.paint; the same for all executors */
	PASS_PUT,        /* SHOWN from engine->pixels.shown */
	PASS_WARP,       /* SHOWN from job.picture and LOW, by the mesh */
	PASS_UI,         /* UI over job.picture; job.picture is SHOWN afterwards */
	PASS_READ,       /* job.picture to job.image: there when it returns, unless job.arrival says that it need not be */
	PASS_COPY,       /* job.picture to the texture of job.image, done when it returns */
	PASS_COUNT,
};

/*
 * Pictures, all 8-bit BGRA and as large as the frame's colour. Who holds them is the executor's affair. REAL and
 * BETWEEN may share what they have in common with ORIGINAL: a pass takes only one of the three at a time.
 */
enum picture_id {
	PICTURE_ORIGINAL = 0, /* the real frame */
	PICTURE_REAL,         /* E, valid if engine->compensated */
	PICTURE_BETWEEN,      /* B, the same */
	PICTURE_LOW,          /* L, where it was asked for */
	PICTURE_UI,
	PICTURE_SHOWN, /* the displayed frame, if it is not one of the above */
	PICTURE_COUNT,
};

/* A pass as an executor does it: one file each. A pass knows the engine's state and no other pass. */
struct pass {
	bool on_cpu; /* the executor's own clock has nothing to measure in it */
	/* NULL if it has something to do, else why not (docs/method.md, 8). NULL function: it always has. */
	const char *(*prepare)(struct engine *engine);
	/* Mandatory. 0 or a negative errno with a sentence. */
	int (*run)(struct engine *engine, struct error *error);
};

struct executor;

/* All functions are mandatory and called on the engine's thread; all but enter() and destroy() after enter(). */
struct executor_ops {
	/* By pass_id; NULL: this executor cannot do it (-ENOTSUP). */
	const struct pass *passes[PASS_COUNT];
	/* Once before each engine_begin() and engine_render(). 0, or -EIO with a sentence: all is lost. */
	int (*enter)(struct executor *executor, struct error *error);
	/* Leaves the thread; the next call may come on another one. */
	void (*leave)(struct executor *executor);
	void (*destroy)(struct executor **executor);
	/* Before engine_begin() returns, whatever it returns: nothing reads the frame's planes any more. */
	void (*release_planes)(struct engine *engine);
	/* Everything asked for is on its way, though nobody waits for it. */
	void (*flush)(struct executor *executor);
	/* It is done. 0, or -EIO with a sentence: all is lost. */
	int (*finish)(struct executor *executor, struct error *error);
	/* Nothing of it is missing any more, nor of what was asked for before. 0, or -EIO with a sentence: see forget(). */
	int (*receive)(struct executor *executor, struct arrival *arrival, struct error *error);
	/* What is missing in any picture never comes: these are lost, their memory is let alone. Even if enter() fails. */
	void (*forget)(struct executor *executor);
	/* Around each pass; they do not nest. What cannot be known yet comes with collect_times(), or never, with drop. */
	void (*time_begin)(struct executor *executor, struct engine_pass_report *pass, bool on_cpu);
	void (*time_end)(struct executor *executor);
	void (*collect_times)(struct executor *executor);
	void (*drop_times)(struct executor *executor);
	/* Static: "timer-query", "finish", "cpu". */
	const char *(*time_source)(const struct executor *executor);
};

/* The head of each kind's own struct. */
struct executor {
	const struct executor_ops *ops;
	struct engine_info info;
	uint32_t max_size; /* of pictures, pixels a side, at most PURSUIT_MAX_SIZE */
	uint64_t bytes;    /* that its pictures and buffers take: GL's memory, or the process's; 0: not counted */
	struct pool *pool; /* threads for what is done on the CPU whoever the executor is; NULL: none */
};

/* The one that the params ask for, entered. NULL with a sentence. */
struct executor *executor_create(const struct engine_params *params, struct error *error);

/* NULL is accepted. */
void executor_destroy(struct executor **executor);

/* The kinds, for executor.c only. */
struct executor *executor_gl_create(const struct engine_params *params, struct error *error);
struct executor *executor_cpu_create(const struct engine_params *params, struct error *error);

#endif
