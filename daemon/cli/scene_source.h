/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A built-in scene as a source of real frames and of truth, in a GL context of
 * its own. One thread; makes its context current in every call that renders.
 */
#ifndef PURSUIT_CLI_SCENE_SOURCE_H
#define PURSUIT_CLI_SCENE_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "args.h"
#include "client/scenes/scene.h"
#include "daemon/error.h"
#include "daemon/frame.h"

/* The moment of frame 0 in recordings: not 0, which would mean unknown. */
#define SCENE_SOURCE_EPOCH_NS UINT64_C(1000000000)

/* Only name, size and rate must be set. */
struct scene_source_params {
	const char *scene;
	struct arg_size size;
	struct arg_rate rate;
	bool forward;           /* forward motion instead of backward */
	uint32_t color_format;  /* PURSUIT_FORMAT_*; 0: BGRA8 */
	uint32_t depth_format;  /* 0: DEPTH32F */
	uint32_t motion_format; /* 0: RG16F */
	bool object_id;
	uint32_t antialias; /* colour and UI are means of this many samples along each side; 0: 1 */
};

struct scene_source;

/* NULL with a sentence. */
struct scene_source *scene_source_create(const struct scene_source_params *params, struct error *error);
void scene_source_destroy(struct scene_source **source);
/* Another size from the next frame on, of a source with antialias 0 or 1. False with a sentence: good for nothing more.
 */
bool scene_source_resize(struct scene_source *source, const struct arg_size *size, struct error *error);

/* Real frame `index` (id index + 1). Its planes belong to the source, valid until the next call. False: GL failed. */
bool scene_source_frame(struct scene_source *source, uint64_t index, struct frame *frame);

/* The truth at a moment, in seconds: BGRA8 with the UI over it, packed rows, alpha 255, into width x height x 4 bytes.
 */
bool scene_source_truth(struct scene_source *source, double time, uint8_t *picture);

/*
 * Any moment with motion from any other, read back as scene_read() does what `wanted` asks for; colour has the UI over
 * it and alpha 255. Where the UI covers what is behind it by half or more, the motion is that of the UI, 0, and the
 * object SCENE_SOURCE_UI_OBJECT. False: GL failed.
 */
#define SCENE_SOURCE_UI_OBJECT UINT32_MAX
bool scene_source_moment(struct scene_source *source, const struct scene_request *request,
						 const struct scene_pixels *wanted);

/*
 * Renders a moment, with motion since time_previous, and leaves it in textures
 * for a reader of its own (the client shim's), the context current.
 */
bool scene_source_render(struct scene_source *source, double time, double time_previous,
						 struct scene_textures *textures, struct scene_camera *camera);
/* The task scene's keys and score (scene.h). */
void scene_source_key(struct scene_source *source, double time, int key);
bool scene_source_get_score(const struct scene_source *source, double time, struct scene_score *score);
scene_gl_lookup scene_source_lookup(const struct scene_source *source);

/* GL_RENDERER of the context; of a CPU renderer? */
const char *scene_source_renderer(struct scene_source *source, bool *software);

/* Nanoseconds from frame 0 to frame `index` at a rate, rounded down; exact. */
uint64_t scene_source_time(const struct arg_rate *rate, uint64_t index);

/* The names of all scenes, ended by NULL: choices of an option. */
#define SCENE_SOURCE_NAMES 16
void scene_source_names(const char *names[SCENE_SOURCE_NAMES]);

/* "there is no scene x; there are a, b, c" */
void scene_source_unknown(const char *name, struct error *error);

#endif
