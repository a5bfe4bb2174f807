/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A short run of real frames, what is displayed of them, and the truth about
 * it: made once, then played by every method. Plain data in memory.
 */
#ifndef PURSUIT_CLI_REPORT_CLIP_H
#define PURSUIT_CLI_REPORT_CLIP_H

#include "daemon/engine/engine.h"
#include "daemon/measure/camera.h"
#include "player.h"
#include "scene_source.h"

struct clip_real {
	struct frame frame; /* its planes are copies, in `planes` */
	uint8_t *planes;
	struct engine_begin_params begin;
	uint32_t first_shown, shown_count;
};

/* One displayed picture. Truth and masks may be NULL: unknown. */
struct clip_shown {
	struct engine_request request;
	double time;      /* that it should depict, s */
	bool scored;      /* an in-between with its truth, after the frames that only warm up */
	uint8_t *truth;   /* packed BGRA8 */
	uint8_t *regions; /* of this picture with respect to its real frame (measure/regions.h) */
	float *motion;    /* of the real frame's pixels to their place here */
	uint8_t *hidden;  /* regions of the real frame with respect to this picture */
};

/* A window of the pursuit camera, one real interval long. */
struct clip_site {
	double time, window_s; /* its beginning and length */
	uint32_t first_shown;  /* the picture shown at its beginning */
	struct camera_path path;
	uint8_t *valid; /* camera_path_valid() */
	uint8_t *truth; /* what is seen of the truth, packed BGRA8 */
};

struct clip {
	uint32_t width, height;
	double refresh_hz;
	uint32_t
		samples; /* of the pursuit camera for each displayed picture: truth has samples x refresh_hz pictures a s */
	bool approximate; /* regions are guessed */
	struct clip_real *reals;
	uint32_t real_count;
	struct clip_shown *shown;
	uint32_t shown_count;
	struct clip_site *sites;
	uint32_t site_count;
};

void clip_destroy(struct clip **clip);

/* Zeroed arrays; NULL: out of memory. For those who make clips. */
struct clip *clip_create(uint32_t width, uint32_t height, uint32_t reals, uint32_t shown, uint32_t sites,
						 struct error *error);
int clip_keep_frame(struct clip_real *real, const struct frame *frame, struct error *error);

/* A picture's worth of `bytes` a pixel; NULL with a sentence. */
void *clip_plane(const struct clip *clip, size_t bytes, struct error *error);

struct clip_scene_params {
	uint64_t first; /* index of the first real frame at the source's rate */
	uint32_t reals; /* 4 or more: the first only warms up, the last two only follow */
	uint32_t n;
	double refresh_hz;
	double degrees_per_pixel; /* of visual angle */
	double gamma;             /* of the display, 0: sRGB */
};

/* Everything exact. The source gives object ids. NULL with a sentence. */
struct clip *clip_of_scene(struct scene_source *source, const struct arg_size *size,
						   const struct clip_scene_params *params, struct error *error);

/*
 * Frames of a recording, each predicting the next one (phase 1, N = 2), at most `reals` of them; regions are guessed,
 * and there is no pursuit camera, since nothing is known of the moments between.
 */
struct clip *clip_of_recording(const char *path, uint32_t reals, const struct engine_params *engine,
							   struct error *error);

/* Plays all of it; pictures[i]: packed BGRA8 of shown[i], memory of the caller. 0 or a negative errno. */
int clip_play(const struct clip *clip, struct engine *engine, uint8_t *const *pictures, struct error *error);

/* The same of a game that renders every displayed frame; the clip is of a scene. */
void clip_show_truth(const struct clip *clip, uint8_t *const *pictures);

#endif
