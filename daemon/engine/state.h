/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What an engine holds: shared by engine.c, the methods and the passes, and by nobody else. */
#ifndef PURSUIT_ENGINE_STATE_H
#define PURSUIT_ENGINE_STATE_H

#include "daemon/engine/context.h"
#include "daemon/engine/convert.h"
#include "daemon/engine/engine.h"
#include "daemon/engine/plan.h"
#include "daemon/engine/program.h"
#include "daemon/engine/target.h"
#include "daemon/engine/timer.h"
#include "daemon/engine/warp_mesh.h"

#define MAX_LEVELS 6

/* In the order of the report. */
enum pass_id {
	PASS_ANALYSE = 0,
	PASS_UPLOAD,
	PASS_PYRAMID,
	PASS_COMPENSATE,
	PASS_WARP,
	PASS_UI,
	PASS_READ,
	PASS_COUNT,
};

struct method;

/* What the passes are asked to do now; set by the method or engine.c before each run. */
struct job {
	const struct frame *frame;    /* engine_begin() only */
	double phase;                 /* warp */
	const struct target *picture; /* warp, ui, read: what they take */
	struct engine_image *image;   /* read */
};

/* A rectangle of pixels; empty if left >= right. */
struct bounds {
	uint32_t left, top, right, bottom;
};

struct engine {
	struct engine_params params; /* all defaults filled in */
	const struct method *method;
	struct context *context;
	struct program_cache programs;
	struct timer timer;
	struct engine_report report;
	struct job job;

	struct convert color_convert, ui_convert;
	uint8_t *staging; /* a block of rows on its way up */
	size_t staging_bytes;

	struct plan plan;
	struct warp_mesh mesh;
	struct target color;              /* the original */
	struct target real, between;      /* E and B, valid if `compensated` */
	struct target levels[MAX_LEVELS]; /* levels[i] is level i + 1 of the pyramid */
	struct target low;                /* L, where it was asked for */
	GLuint tile_array, tile_vertices; /* rectangles to fill */
	float *tile_numbers;              /* on their way there */
	size_t tile_capacity;
	struct target shown;             /* the displayed frame, if it is not one of the above */
	GLuint both_framebuffer;         /* `real` and `between` at once */
	GLuint no_attributes;            /* a vertex array with nothing in it */
	GLuint depth, depth_framebuffer; /* `shown` with depth; 0 until the first fold */
	uint32_t depth_width, depth_height;
	struct target ui;
	struct bounds ui_bounds; /* pixels of the UI that are not wholly transparent */

	/* The frame begun last. */
	bool begun;
	uint32_t n;
	double last_phase;
	uint64_t real_interval_ns; /* as the pacer knows it; 0: as the frame says */
	bool moves;                /* there is a plan with vertices */
	bool has_depth;            /* depths differ, so that they settle what lies before what */
	bool compensated;          /* E and B differ from the original */
	enum { LEVELS_NONE = 0, LEVELS_MARKED, LEVELS_ALL } levels_made;
	bool levels_everywhere; /* the next pyramid must cover all, not only the marked tiles */
	double boost;           /* k */
};

static inline const struct gl *engine_gl(const struct engine *engine)
{
	return &engine->context->gl;
}

#endif
