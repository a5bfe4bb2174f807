/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The independent reference: every pass of the method `grid` in plain double
 * precision on the CPU, written from docs/method.md and from Didyk et al. 2010,
 * Sections 5 and 6, and not from the engine. Slow, obvious, deterministic.
 *
 *   reference_begin(&reference, frame, engine_params, begin_params)   once per real frame
 *   reference_render(&reference, request, pixels)                     once per displayed frame
 *
 * It takes the engine's own parameter structs, so that a test hands both the
 * same. All intermediate planes stay in the struct to be looked at. Numbers in
 * brackets are sections of docs/method.md.
 */
#ifndef PURSUIT_REFERENCE_H
#define PURSUIT_REFERENCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/engine.h"
#include "daemon/frame.h"

/* A curve from code values to light: to_light, from_light [0]. */
struct reference_transfer {
	uint32_t curve; /* PURSUIT_CURVE_* */
	double gamma;   /* for PURSUIT_CURVE_GAMMA */
};

double reference_to_light(const struct reference_transfer *transfer, double code);
/* The most that rounding a code value (0 to 1) to 8 bits moves its light: half a step. */
double reference_half_step(const struct reference_transfer *transfer, double code);
double reference_from_light(const struct reference_transfer *transfer, double light);
double reference_smoothstep(double a, double b, double x);
/* code8 [0]. `bias` (0 in the method) shifts the rounding: floor(255 clamp(x) + 0.5 + bias). */
uint8_t reference_code8(double x, double bias);
double reference_half(uint16_t half);

/* 8-bit code values, 4 bytes a pixel, B G R A, rows packed from the top. */
struct reference_picture {
	uint32_t width, height;
	uint8_t *data;
};

void reference_picture_init(struct reference_picture *picture, uint32_t width, uint32_t height);
void reference_picture_finish(struct reference_picture *picture);
/* Bilinear, clamped at the edge, position in pixels with centres at .5; B G R in steps (0 to 255). */
void reference_sample(const struct reference_picture *picture, double x, double y, double out[3]);

/* Colour of a plane in code values of the display [0]; alpha becomes 255. */
void reference_convert_color(struct reference_picture *out, const struct pursuit_plane *plane, const uint8_t *data,
							 const struct reference_transfer *display);
/* The UI layer, premultiplied, code values as they are. */
void reference_convert_ui(struct reference_picture *out, const struct pursuit_plane *plane, const uint8_t *data);

/* T and S in seconds, 0 unknown [1]. */
struct reference_timing {
	double real_s, motion_s;
	uint32_t n;
	double last_phase;
};
void reference_timing(struct reference_timing *timing, const struct pursuit_frame_header *header,
					  const struct engine_begin_params *begin);

/* Speed on the display in degrees a second, and the tracking factor f [1]. */
double reference_speed(double pixels, double seconds, double width, double display_width_mm, double distance_mm);
double reference_tracking(double degrees_per_second);
/* Normalised depth of a decoded depth [1]. */
double reference_depth(uint32_t kind, double near_distance, double far_distance, double value);

/* Effective displacement and depth at each pixel of colour [1]. */
struct reference_geometry {
	uint32_t width, height;
	double *ux, *uy, *z;
	uint64_t invalid;
	bool moves;     /* some u is not 0 */
	bool known;     /* backward motion that was looked at */
	bool has_depth; /* there is a depth plane; z is 0.5 without */
};
void reference_geometry_init(struct reference_geometry *geometry, const struct frame *frame,
							 const struct reference_timing *timing, double display_width_mm, double distance_mm);
/* u = 0 everywhere. */
void reference_geometry_stop(struct reference_geometry *geometry);
void reference_geometry_finish(struct reference_geometry *geometry);

struct reference_vertex {
	double x, y, ux, uy, z;
	double ax, ay; /* change of u [10], 0: linear */
	bool snapped;
	bool either; /* float and double may come to different vertices: a value lies at a boundary of a decision */
};

struct reference_triangle {
	uint32_t v[3];
	bool either; /* float may split its quad along the other diagonal */
};

/* The snapped grid [2]. */
struct reference_grid {
	uint32_t columns, rows;
	struct reference_vertex *vertices;
	double span; /* S / T [10]; 0: no vertex has a change */
	uint32_t triangle_count;
	struct reference_triangle *triangles; /* two a quad, in drawing order */
	uint32_t snapped;
};
/* Quantised discontinuity q at a pixel; gx, gy may be NULL. */
uint32_t reference_discontinuity(const struct reference_geometry *geometry, uint32_t i, uint32_t j, double *gx,
								 double *gy);
void reference_grid_init(struct reference_grid *grid, const struct reference_geometry *geometry, uint32_t cell,
						 uint32_t threshold_quarter);
/* How two frames lie in time [10]: T, S, T', S', and D from one to the other. */
struct reference_times {
	double real_s, span_s, real_before_s, span_before_s, gap_s;
};
/* Change of motion at the vertices from the frame before [10]. */
void reference_grid_bend(struct reference_grid *grid, const struct reference_geometry *now,
						 const struct reference_geometry *before, const struct reference_times *times);
void reference_grid_finish(struct reference_grid *grid);
/* Corner of a triangle at a phase, and its doubled signed area there. */
void reference_displaced(const struct reference_grid *grid, const uint32_t v[3], double phase, double x[3],
						 double y[3]);
double reference_area2(const struct reference_grid *grid, const uint32_t v[3], double phase);
/* Singular values (larger first) of the linear part of the map source -> displaced [3]. */
void reference_singular(const struct reference_grid *grid, const uint32_t v[3], double phase, double sigma[2]);

/* What shows at one pixel. */
struct reference_hit {
	int32_t triangle; /* -1: none */
	double x, y;      /* source position */
	double z;
};
/* The warp [3]: width x height hits. */
void reference_warp(const struct reference_grid *grid, uint32_t width, uint32_t height, double phase,
					struct reference_hit *hits);

/* One step of the binomial pyramid, and the low-frequency layer L [4]. `bias` as in reference_code8(), 0: the method.
 */
void reference_reduce(struct reference_picture *out, const struct reference_picture *in, double bias);
void reference_low(struct reference_picture *out, const struct reference_picture *picture, uint32_t level, double bias);

/* Uniform cubic B-spline: weights of the four texels about a place, f in [0, 1) from the second [4]. */
void reference_spline_weights(double f, double w[4]);

/* Blur weight and tear of a stretch, and of one triangle [5]. */
double reference_weight_of(double stretch);
double reference_tear_of(double stretch);
double reference_weight(const struct reference_grid *grid, const uint32_t v[3], double last_phase,
						enum engine_blur blur);
double reference_tear(const struct reference_grid *grid, const uint32_t v[3], double phase, enum engine_blur blur);

/* The split of light [6]: o and l in light, b and e in light. */
void reference_split(double o, double l, uint32_t n, double *b, double *e);

/* All that compensation depends on besides c, L and w. */
struct reference_compensation {
	struct reference_transfer display;
	uint32_t n;
	double k;
	bool off;
};
/* Code values in [0, 1], before rounding [6]. */
void reference_compensate(const struct reference_compensation *compensation, double c, double low, double w,
						  double *between, double *real);

/* One channel with the UI over it [7], code values in [0, 1], before rounding. */
double reference_over(double ui, double ui_alpha, double under);

struct reference {
	uint32_t width, height;
	bool hold;
	bool blur_hold; /* w = 1 and u = 0 at every pixel [9.3] */
	enum engine_blur blur;
	uint32_t blur_level;
	struct reference_timing timing;
	struct reference_compensation compensation;
	struct reference_geometry geometry;
	struct reference_grid grid;
	double *weight; /* w at each pixel */
	bool has_ui;
	struct reference_picture original, ui, low, real, between; /* c, UI, L, E, B */
};

/* `reference` zeroed or begun before. Frame validated. Aborts without memory: it is a test. */
void reference_begin(struct reference *reference, const struct frame *frame, const struct engine_params *params,
					 const struct engine_begin_params *begin);
/*
 * The quadratic motion model [10]: `before` was begun with a frame that lies gap_s before. After reference_begin().
 */
void reference_bend(struct reference *reference, const struct reference *before, double gap_s);
void reference_finish(struct reference *reference);
/* Phase of a request as it counts: NaN 0, -1 to 8; 0 for what is shown undisplaced. */
double reference_phase(const struct engine_request *request);
/* Displayed picture, BGRA8, packed, alpha 255. */
void reference_render(const struct reference *reference, const struct engine_request *request, uint8_t *pixels);

/* A displayed picture's two sources, in any form, and what becomes of each of its pixels. */
struct reference_layers {
	const void *picture, *low; /* what is displaced, and L */
	void (*sample)(const void *layer, double x, double y, double out[3]);
	void (*put)(void *data, size_t pixel, const double mixed[3]);
	void *data;
};
/* The warp [3], and L where it tears [5]. */
void reference_mix(const struct reference *reference, double phase, const struct reference_layers *layers);

/* calloc that aborts. */
void *reference_alloc(size_t count, size_t size);

#endif
