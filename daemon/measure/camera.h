/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The pursuit camera: what an eye in smooth pursuit sees of a hold-type
 * display. Didyk et al. 2010, Sections 2 and 3 and Figure 1: the eye moves
 * continuously with what it looks at, the display shows each picture still for
 * its hold time, and what falls on one place of the retina meanwhile is added
 * up; a picture that does not move with the eye is smeared along the motion.
 *
 * Here each pixel is tracked for itself along its true motion: the pixel's
 * path through a window of time is a parabola through its places at the
 * beginning, the middle and the end of the window, which the scene knows; the
 * light of the displayed pictures is sampled along that path and averaged.
 * The same for a truth of 960 pictures a second is what would be seen of the
 * scene itself; the difference of the two is the perceived error.
 *
 * Beyond 70 to 90 degrees a second the eye cannot follow (Daly 1998, as used
 * in Section 6): the path shrinks as the engine's displacements do.
 *
 * Pure, any thread.
 */
#ifndef PURSUIT_MEASURE_CAMERA_H
#define PURSUIT_MEASURE_CAMERA_H

#include "light.h"
#include "regions.h"

/* The paths of all pixels of the picture in the middle of a window; packed rows, two floats a pixel, pixels. */
struct camera_path {
	uint32_t width, height;
	float *before; /* place at the beginning of the window minus place in its middle; finite */
	float *after;  /* place at its end minus place in its middle; finite */
};

/* Damps the paths to what an eye can follow. */
void camera_path_damp(const struct camera_path *path, double window_s, double degrees_per_pixel);

/* Pixels that can be judged: their path stays inside the picture. 1 or 0 a pixel, packed. */
void camera_path_valid(const struct camera_path *path, uint8_t *valid);

/* Exposes the camera, which starts zeroed, to a picture for a share of the window: adds weight x light. */
struct camera_exposure {
	const light_pixel *picture;
	float moment;      /* in the window: -1 its beginning, 1 its end */
	float weight;      /* all weights of a window sum to 1 */
	uint32_t row_step; /* only rows that are a multiple of it; 1: all */
};
void camera_expose(const struct camera_path *path, const struct camera_exposure *exposure, light_pixel *camera);

/* Speeds by which errors are told apart: pixels per second up to each limit, the last without one. */
#define CAMERA_SPEEDS 8u
extern const double camera_speed_limits[CAMERA_SPEEDS - 1];

/* Adds the errors of valid pixels by the speed of their paths; bins start zeroed. */
void camera_errors_by_speed(const struct camera_path *path, double window_s, const uint8_t *valid,
							const struct picture *seen, const struct picture *truth,
							struct squared_error bins[CAMERA_SPEEDS]);

#endif
