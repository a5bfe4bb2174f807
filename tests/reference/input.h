/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Frames for tests: a picture, a motion field and a depth, all functions of a
 * seed, in any formats and sizes. The same spec gives the same bytes anywhere.
 */
#ifndef PURSUIT_REFERENCE_INPUT_H
#define PURSUIT_REFERENCE_INPUT_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/frame.h"

enum input_field {
	INPUT_STILL = 0,
	INPUT_TRANSLATE, /* (3, -2) pixels everywhere */
	INPUT_SMOOTH,    /* sines without folds */
	INPUT_ROTATE,    /* around the middle */
	INPUT_ZOOM,      /* towards the middle: stretch without discontinuity */
	INPUT_LAYERS,    /* shapes with motion and depth of their own */
	INPUT_VIOLENT,   /* independent at each pixel, up to 40 pixels */
	INPUT_SHAKE,     /* independent at each pixel, up to 5 pixels: vertices snap anywhere in their cells */
	INPUT_BROKEN,    /* layers with NaN, infinities and absurd numbers sprinkled in */
};

enum input_image {
	INPUT_WAVES = 0, /* low frequencies */
	INPUT_NOISE,     /* independent bytes */
	INPUT_EDGES,     /* black and white shapes on waves */
	INPUT_FLAT,      /* one colour */
};

/* Zero: absent or the default; only width and height are needed. */
struct input_spec {
	uint32_t width, height;
	uint64_t seed;
	enum input_field field;
	enum input_image image;
	uint32_t color_format;                /* 0: BGRA8 */
	struct pursuit_transfer transfer;     /* 0: sRGB */
	uint32_t motion_format;               /* 0: RG32F */
	uint32_t motion_kind;                 /* 0: backward */
	uint32_t motion_width, motion_height; /* 0: as colour */
	bool no_motion;
	uint32_t depth_format;              /* 0: DEPTH32F */
	uint32_t depth_kind;                /* 0: device */
	uint32_t depth_width, depth_height; /* 0: as colour */
	bool no_depth;
	float near_distance, far_distance;
	uint32_t ui_format; /* 0: no UI */
	uint32_t flags;
	uint64_t real_interval_ns; /* 0: 1/60 s; 1: unknown */
	uint64_t motion_interval_ns;
};

struct input {
	struct frame frame;
	uint8_t *memory;
};

/* The frame is valid by frame_validate(). Aborts if it is not, or without memory. */
void input_make(struct input *input, const struct input_spec *spec);
void input_finish(struct input *input);

/*
 * A display on which these small pictures have pixels of common size (0.27 mm),
 * and at least 1 mm as the engine demands, so that motion of tens of pixels is not damped away as untrackable.
 */
float input_display_mm(uint32_t width);

/* xorshift64*; state not 0. */
uint64_t input_random(uint64_t *state);
double input_uniform(uint64_t *state); /* [0, 1) */
uint16_t input_half(double value);

#endif
