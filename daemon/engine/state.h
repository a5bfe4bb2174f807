/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What an engine holds: shared by engine.c, the methods, the executors and their passes, and by nobody else. */
#ifndef PURSUIT_ENGINE_STATE_H
#define PURSUIT_ENGINE_STATE_H

#include "daemon/engine/arrival.h"
#include "daemon/engine/bend.h"
#include "daemon/engine/bounds.h"
#include "daemon/engine/convert.h"
#include "daemon/engine/executor.h"
#include "daemon/engine/now.h"
#include "daemon/engine/pixel_state.h"
#include "daemon/engine/plan.h"
#include "daemon/engine/warp_mesh.h"

#define MAX_LEVELS 6

struct method;

/* What the passes are asked to do now; set by the method or engine.c before each run. */
struct job {
	const struct frame *frame;  /* engine_begin() only */
	double phase;               /* warp */
	enum picture_id picture;    /* warp, ui, read: what they take */
	struct engine_image *image; /* engine_render() only; an executor may make SHOWN right there */
	uint64_t held, holds;       /* read: what the image held, and holds then, as struct engine_image says */
	struct arrival *arrival;    /* read: where to note what is missing when it returns; NULL: nothing may be */
	/* paint: fills engine->pixels.shown; 0 or a negative errno with a sentence */
	int (*paint)(struct engine *engine, struct error *error);
};

/* What is known to have changed since the frame begun before. */
struct damage {
	bool known;      /* else everything may have */
	bool found;      /* by looking at colour and UI; nobody looked at depth and motion */
	bool comparable; /* ORIGINAL and UI are what the frame before, of the same stream and kind, left there */
	uint32_t count;
	struct pursuit_rectangle rectangles[PURSUIT_MAX_DAMAGE];
};

/* What engine_set_params() asked for, until a frame is begun. */
struct next_params {
	struct engine_params params; /* all defaults filled in */
	const struct method *method; /* NULL: nothing was */
	bool forgets_pixels, forgets_bend;
};

struct engine {
	struct next_params next;
	struct engine_params params; /* all defaults filled in */
	const struct method *method;
	struct executor *executor;
	struct engine_report report;
	struct job job;
	struct arrivals arrivals;

	struct convert color_convert, ui_convert;
	struct plan plan;
	struct warp_mesh mesh;
	struct pixel_state pixels;
	struct bend bend; /* of the vertices, with the quadratic motion model */

	/* The frame begun last. */
	bool begun;
	uint64_t frame_id, stream;                  /* stream 0: ORIGINAL and UI are not what that frame left there */
	uint64_t sequence;                          /* the stream that it was of, whatever is left of it */
	struct pursuit_plane color_plane, ui_plane; /* as they were taken; role 0: none */
	struct damage damage;
	uint64_t number;         /* given last: engine_new_number() */
	uint64_t content;        /* a number of ORIGINAL with its UI, never used twice */
	uint64_t content_before; /* of the frame before */
	bool rested;             /* the frame before did not move */
	uint32_t width, height;  /* of its colour */
	struct bounds ui_bounds; /* pixels of the UI that are not wholly transparent */
	uint32_t n;
	double last_phase;
	uint64_t real_interval_ns; /* as the pacer knows it; 0: as the frame says */
	bool moves;                /* there is a plan with vertices */
	bool has_depth;            /* depths differ, so that they settle what lies before what */
	bool compensated;          /* REAL and BETWEEN differ from ORIGINAL */
	enum { LEVELS_NONE = 0, LEVELS_MARKED, LEVELS_ALL } levels_made;
	bool levels_everywhere; /* the next pyramid must cover all, not only the marked tiles */
	double boost;           /* k */
};

/* For what a picture shows: none that this engine gave before, and by the clock none of an engine that is gone. */
static inline uint64_t engine_new_number(struct engine *engine)
{
	const uint64_t now = now_ns();
	engine->number = now > engine->number ? now : engine->number + 1;
	return engine->number;
}

#endif
