/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Synthetic frames for the engine's tests and its benchmark. */
#ifndef PURSUIT_TESTS_ENGINE_PICTURE_H
#define PURSUIT_TESTS_ENGINE_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/frame.h"

/* A frame with its memory. Planes are packed; motion is RG32F, depth DEPTH32F. */
struct picture {
	struct frame frame;
	uint8_t *memory;
	uint32_t width, height;
};

#define PICTURE_DEPTH 1u
#define PICTURE_UI 2u
#define PICTURE_MOTION 4u

/* Colour in that format, sRGB (RGBA16F: linear), the other planes as asked for; all zero. 40 frames a second. */
void picture_init(struct picture *picture, uint32_t width, uint32_t height, uint32_t format, unsigned planes);
void picture_finish(struct picture *picture);

/* The first byte of row y of the plane with that role. */
uint8_t *picture_row(const struct picture *picture, uint32_t role, uint32_t y);

void picture_set_motion(const struct picture *picture, uint32_t x, uint32_t y, float mx, float my);
void picture_set_depth(const struct picture *picture, uint32_t x, uint32_t y, float depth);

/* Every bit random; the same for the same seed. */
void picture_fill_random(const struct picture *picture, uint32_t role, uint32_t seed);
uint32_t picture_random(uint32_t *state);

/*
 * Layers at time t (in real intervals): a finely textured ground seen in perspective, panning, zooming and turning
 * slightly, and discs that cross it at several depths. Colour BGRA8, with motion and depth if there are planes for
 * them. Everything moves. Motion is backward and exact.
 */
void picture_draw_layers(const struct picture *picture, double t);

/* Without the ground's motion: only the discs move. */
void picture_draw_discs(const struct picture *picture, double t);

bool picture_write_png(const char *path, const uint8_t *bgra, uint32_t width, uint32_t height);

#endif
