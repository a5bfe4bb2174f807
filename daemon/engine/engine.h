/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The engine: real frames in, displayed frames out, a report of what ran.
 * The only header of engine/ that the rest of the daemon includes.
 *
 * One engine lives on one thread at a time: the one that made it, until engine_leave()
 * (it may own a GL context, which is current on the thread after each call: who
 * draws there with another context makes that one current again). Nothing in it is irreplaceable: it can be destroyed
 * and made anew at any moment.
 *
 *   engine_begin(engine, frame, ...)       once per real frame
 *   engine_render(engine, request, image)  once per displayed frame
 *   engine_take(engine, image)             once per displayed frame that engine_render() did not wait for
 *
 * What is computed: docs/method.md. Source: Didyk et al. 2010, Sections 5, 6.
 */
#ifndef PURSUIT_ENGINE_H
#define PURSUIT_ENGINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"
#include "daemon/frame.h"

enum engine_context_kind {
	ENGINE_CONTEXT_AUTO = 0, /* an EGL device with a GPU, else the CPU */
	ENGINE_CONTEXT_EGL_SURFACELESS,
	ENGINE_CONTEXT_EGL_DEVICE,
	ENGINE_CONTEXT_OSMESA,
	ENGINE_CONTEXT_CPU, /* without GL */
};

enum engine_blur {
	ENGINE_BLUR_DOUBTFUL = 0, /* driven by grid distortion */
	ENGINE_BLUR_EVERYWHERE,   /* w = 1: the paper's full blur */
	ENGINE_BLUR_OFF,
};

/* How motion is continued (docs/method.md, 10). Of the methods with a grid. */
enum engine_motion_model {
	ENGINE_MOTION_LINEAR = 0,
	ENGINE_MOTION_QUADRATIC, /* with its change since the frame before */
};

/* Who finds discontinuities and vertices in motion and depth (docs/method.md, 12). The plan is the same. */
enum engine_analysis {
	ENGINE_ANALYSIS_AUTO = 0, /* whoever has the planes at hand: the CPU, as long as they come in its memory */
	ENGINE_ANALYSIS_CPU,
	ENGINE_ANALYSIS_GPU, /* GL, where it draws and has compute shaders, else the CPU */
};

enum engine_curve {
	ENGINE_CURVE_SRGB = 0,
	ENGINE_CURVE_GAMMA,
};

/*
 * A GL context (4.3 core) that somebody else made and keeps, in a share group with the one that shows the pictures, so
 * that these need not leave GL. All functions are called on the engine's thread; between calls of the engine others may
 * bind textures of unit 0 and framebuffers there, and nothing else.
 */
struct engine_context {
	const char *name;            /* static */
	bool (*enter)(void *data);   /* makes it current on this thread; false: it is lost */
	void (*release)(void *data); /* leaves none current; also once it is lost */
	void (*(*find)(const char *name))(void);
	void *data;
};

/* A zeroed struct means the defaults. */
struct engine_params {
	enum engine_context_kind context;
	/*
	 * Lives longer than the engine. Taken instead of a context of the engine's own for EGL_SURFACELESS, and for AUTO if
	 * it is that of a GPU; NULL: none.
	 */
	const struct engine_context *brought;
	uint32_t device;  /* index, for ENGINE_CONTEXT_EGL_DEVICE */
	bool gles;        /* a GLES 3.1 context instead of GL 4.3 core */
	uint32_t threads; /* on the CPU, the caller's among them, 1 to 8; 0: one for each CPU that we may run on */
	const char
		*level; /* of its kernels, for tests: "plain", "avx2", "avx512", "neon"; NULL: the best. All give equal bits */
	const char *method; /* name; NULL: "pursuit" */
	enum engine_blur blur;
	enum engine_motion_model motion_model;
	enum engine_analysis analysis;
	bool no_compensation;       /* E = c, B = mix */
	uint32_t cell;              /* 4 to 64; 0: 8 */
	uint32_t blur_level;        /* pyramid level of L, 1 to 6; 0: 2 */
	uint32_t threshold_quarter; /* snapping threshold, quarter pixels; 0: 2 */
	float display_width_mm;     /* 0: 531 */
	float viewing_distance_mm;  /* 0: 600 */
	enum engine_curve curve;    /* transfer of the display */
	float gamma;                /* 1 to 5, with ENGINE_CURVE_GAMMA */
	bool leave_nothing_out; /* all triangles, depths and layers, needed or not; to measure what leaving out is worth */
	bool finish_each_pass;  /* wait after each pass, so that CPU clocks tell its time; for benchmarks */
	bool query_software;    /* timer queries of a CPU renderer too, though they tell little; for tests */
	bool buffer_software;   /* pixels come back through buffers from a CPU renderer too, which is slower; for tests */
};

enum engine_show {
	ENGINE_SHOW_REAL = 0,   /* E, warped if |phase| > 0.05 */
	ENGINE_SHOW_IN_BETWEEN, /* B, warped */
	ENGINE_SHOW_PLAIN,      /* the original: what a missed in-between gets */
};

struct engine_request {
	enum engine_show show;
	double phase; /* -1 to 8, others are clamped, NaN is 0 */
};

/* Where a displayed frame goes. BGRA8, rows top to bottom, alpha 255. */
struct engine_image {
	uint8_t *data; /* caller's memory, stride x height bytes; NULL: to `texture`, or only to the engine's own picture */
	size_t stride; /* bytes, at least 4 x width, a multiple of 4 */
	/*
	 * What memory or texture holds, as engine_render() left it here; 0: unknown, which is always right. What it holds
	 * already of the picture that is asked for, as a whole or by tiles, is not written: keep it with the memory, set it
	 * to 0 where something else is written.
	 */
	uint64_t holds;
	/*
	 * With data NULL, of an engine in a brought context: a texture of its share group, BGRA8, at least as large as the
	 * frame's colour, row 0 on top. 0: none. The pixels are there when engine_render() returns: whoever binds it sees
	 * them.
	 */
	uint32_t texture;
	uint32_t texture_x, texture_y; /* of a larger one: where the picture begins */
	/*
	 * engine_render() need not wait for the pixels. Those of a texture are there after engine_finish(). With data the
	 * memory is the engine's until engine_take() gives it back, oldest first: the caller neither reads, writes nor
	 * frees it, nor has the engine draw anything else to any of its pixels; `holds` is 0 until then.
	 */
	bool unfinished;
};

/* Pictures in memory that may be unfinished at a time. */
#define ENGINE_MAX_UNFINISHED 2

struct engine_begin_params {
	uint32_t n;                /* N, 1 to 8, clamped */
	double last_phase;         /* of the last in-between expected; < 0: (N - 1) / N */
	uint64_t real_interval_ns; /* T; 0: as the frame says */
};

#define ENGINE_MAX_PASSES 16
#define ENGINE_MAX_LEFT_OUT 16

/* What ran for one real frame, from its engine_begin() to the next. */
struct engine_report {
	uint64_t frame_id;
	uint32_t pass_count;
	struct engine_pass_report {
		const char *name; /* "analyse", "upload", "pyramid", "compensate", "warp", "ui", "read", "copy"; static */
		uint32_t runs;
		double ms; /* GPU time (timer queries), else CPU time with finish_each_pass, else CPU time of the call */
	} passes[ENGINE_MAX_PASSES];
	uint32_t left_out_count;
	struct engine_left_out {
		const char *name; /* docs/method.md, 8 */
		const char *reason;
	} left_out[ENGINE_MAX_LEFT_OUT];
	const char *time_source; /* "timer-query", "finish", "cpu" */
	double total_ms;         /* CPU wall time inside engine_begin, _render, _take and _finish so far */
	uint32_t vertices, triangles, snapped, folded, doubtful;
	uint64_t invalid_pixels;
	uint64_t bytes_up, bytes_down;
	uint64_t bytes_kept;   /* of displayed pictures that were there already: neither written nor in bytes_down */
	uint64_t memory_bytes; /* that pictures and buffers take now, in GL's memory if it draws with GL; 0: not counted */
	uint64_t plan_bytes;   /* of the process that the plan, its triangles and what a method keeps by pixel take now */
};

struct engine_info {
	const char *context;  /* "egl-surfaceless", "egl-device", "osmesa", "cpu"; of a brought one its name */
	const char *renderer; /* GL_RENDERER; of the CPU: instruction set and threads */
	const char *version;  /* GL_VERSION; "" */
	bool software;        /* a CPU renderer */
	bool brought;         /* in the context that was brought */
};

struct engine;

/* Names and one-line descriptions, NULL-terminated by name. Static. */
struct engine_method_info {
	const char *name;
	const char *description;
	uint32_t lag; /* real frames that it is late by: 1 for what needs the next one */
};
const struct engine_method_info *engine_methods(void);

/* Makes context and engine, compiles what every frame needs. NULL with a sentence. */
struct engine *engine_create(const struct engine_params *params, struct error *error);
/* NULL accepted. Nothing is written to the memory of unfinished pictures any more. */
void engine_destroy(struct engine **engine);
/* It may live on another thread from now on: that which calls the next function, of unfinished pictures too. */
void engine_leave(struct engine *engine);

const struct engine_info *engine_get_info(const struct engine *engine);

/*
 * Takes a real frame: analyses depth and motion, uploads colour and UI. When it
 * returns the frame's planes are no longer needed. Sizes may change from frame to frame.
 * 0, or a negative errno with a sentence (-ENOMEM, -EIO: the context is lost; -EINVAL: size beyond the renderer's).
 */
int engine_begin(struct engine *engine, const struct frame *frame, const struct engine_begin_params *params,
				 struct error *error);

/* Size of displayed frames: that of the colour plane of the frame begun; 0 x 0 before the first. */
void engine_get_size(const struct engine *engine, uint32_t *width, uint32_t *height);

/*
 * Makes one displayed frame of the real frame begun last. With image->data it returns when the pixels are there, or, if
 * it is unfinished, as soon as they are asked for: they come back while the next picture is drawn, or the next real
 * frame begun. With an executor that writes there itself (the CPU, GL on the CPU) they are there at once, and are taken
 * all the same. 0, or a negative errno with a sentence (-EINVAL: the image or what is asked for; -EBUSY:
 * ENGINE_MAX_UNFINISHED pictures are unfinished, or a pixel of one lies where one of this would; -ENOMEM; -EIO: the
 * context is lost): then the memory is the caller's.
 */
int engine_render(struct engine *engine, const struct engine_request *request, struct engine_image *image,
				  struct error *error);

/*
 * Waits for the oldest unfinished picture in memory and gives it back: *image is what engine_render() was given, with
 * what it holds now. Real frames begun since, of whatever size, with other settings or on another thread, do not matter
 * to it. 0, or with a sentence -ENOENT: there is none, *image is empty; -EIO: it is lost, perhaps with the context, and
 * *image, which holds nothing to be relied on, is the caller's again. One that is lost is so at once: nobody waits for
 * each of them.
 */
int engine_take(struct engine *engine, struct engine_image *image, struct error *error);

/* Gives up all unfinished pictures in memory: nothing is written there any more, and nothing is left to take. */
void engine_drop(struct engine *engine);

/*
 * Waits until all that was rendered is done; unfinished pictures in memory are there then, but still to be taken. 0, or
 * -EIO with a sentence: the context is lost.
 */
int engine_finish(struct engine *engine, struct error *error);

/*
 * What ran since engine_begin(), engine_take() with it. Owned by the engine, valid until the next call. Waits for timer
 * queries, and with them for unfinished pictures.
 */
const struct engine_report *engine_get_report(struct engine *engine);

/* Changes method, blur, compensation or cell from the next engine_begin() on; context and device stay. */
int engine_set_params(struct engine *engine, const struct engine_params *params, struct error *error);

/* The plan of the frame begun last, as one line of JSON, into text (size bytes); "" without one. Truncates. */
void engine_print_plan(const struct engine *engine, char *text, size_t size);

#endif
