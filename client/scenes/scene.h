/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Built-in test scenes: procedural, deterministic, pure functions of time.
 *
 * Each scene can be rendered at any moment and size, with the exact motion
 * towards any other moment, so the truth at the display rate is one more
 * rendering. Surfaces are textured with fine detail, analytically filtered so
 * that still pictures do not shimmer. Includes no engine code.
 *
 * Stimuli after Didyk et al. 2010, Figure 7, as scenes of our own.
 */
#ifndef PURSUIT_SCENE_H
#define PURSUIT_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Names and one-line descriptions of all scenes, NULL-terminated by name. Static. */
struct scene_info {
	const char *name;
	const char *description;
};
const struct scene_info *scene_list(void);
bool scene_exists(const char *name);

/* Looks up a GL or GLES function of the current context. */
typedef void *(*scene_gl_lookup)(const char *name);

/*
 * The textures of one rendered frame, in GL orientation (row 0 at the bottom),
 * owned by the renderer and valid until the next scene_render() or destroy.
 */
struct scene_textures {
	uint32_t color;     /* RGBA8, sRGB code values, opaque; the 3D scene without UI */
	uint32_t depth;     /* R32F, device depth, 0 at near, 1 at far */
	uint32_t backward;  /* RG32F, pixels, +x right +y DOWN: position now minus position at time_previous */
	uint32_t forward;   /* RG32F, pixels: position at time_next minus position now; 0 if not asked for */
	uint32_t object_id; /* R32UI, 0 background */
	uint32_t ui;        /* RGBA8 premultiplied; 0 if the scene has no UI layer */
};

struct scene_request {
	double time;          /* seconds from the start of the scene */
	double time_previous; /* for backward motion */
	double time_next;     /* for forward motion */
	bool forward;         /* render forward motion too */
};

struct scene_camera {
	float view_projection[16];          /* column-major, at `time` */
	float previous_view_projection[16]; /* at `time_previous` */
	float near_distance;
	float far_distance;
	bool cut; /* the scene has a cut between time_previous and time */
};

struct scene;

/*
 * Makes a renderer for the named scene in the current context (GL 3.3 core or
 * GLES 3.1 and later), all GL objects included. width and height 1 to 16384.
 * NULL on failure, with a sentence in error (error_size bytes, may be NULL).
 * All calls on the thread that owns the context.
 */
struct scene *scene_create(const char *name, uint32_t width, uint32_t height, scene_gl_lookup lookup, char *error,
						   size_t error_size);
void scene_destroy(struct scene **scene);

/*
 * Another size, 1 to 16384, of all pictures from now on, the same bits as of a new scene, for a small part of the work
 * of making one. False with a sentence in error (error_size bytes, may be NULL); then nothing is rendered until another
 * size is taken.
 */
bool scene_resize(struct scene *scene, uint32_t width, uint32_t height, char *error, size_t error_size);

/* Renders one moment. The same request gives the same bits on one renderer. */
bool scene_render(struct scene *scene, const struct scene_request *request, struct scene_textures *textures,
				  struct scene_camera *camera);

/* Key presses of the task scene `rings`: 'o' open ring, 'c' closed ring. Others ignore it. */
void scene_key(struct scene *scene, double time, int key);

/* Score of the task experiment (Didyk et al. 2010, Section 7.2); false for other scenes. */
struct scene_score {
	uint32_t shown;         /* rings that have left the picture */
	uint32_t hits;          /* right key while a ring was in sight */
	uint32_t misses;        /* no key while it was in sight */
	uint32_t false_answers; /* wrong key */
};
bool scene_get_score(const struct scene *scene, double time, struct scene_score *score);

/*
 * Reads the last rendered frame back into memory, rows from top to bottom.
 * Any pointer may be NULL. color and ui: 4 bytes a pixel, BGRA; depth: float;
 * backward and forward: two floats, x right, y down; object_id: uint32.
 * Rows are packed (stride = width x pixel size). Waits for the GPU.
 */
struct scene_pixels {
	uint8_t *color;
	float *depth;
	float *backward;
	float *forward;
	uint32_t *object_id;
	uint8_t *ui;
};
bool scene_read(struct scene *scene, const struct scene_pixels *pixels);
/* Frees the memory of all of them, each NULL or of malloc(), and clears. */
void scene_pixels_finish(struct scene_pixels *pixels);

#endif
