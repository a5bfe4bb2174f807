/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The passes in their order: a real frame in, displayed pictures out (docs/method.md, 6 and 7). */
#include "reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void fill_weight(struct reference *reference)
{
	const struct reference_grid *grid = &reference->grid;
	const size_t count = (size_t)reference->width * reference->height;
	struct reference_hit *hits = reference_alloc(count, sizeof(*hits));
	reference_warp(grid, reference->width, reference->height, 0.0, hits);
	free(reference->weight);
	reference->weight = reference_alloc(count, sizeof(double));
	/* A frame that is not extrapolated has w = 0, with `everywhere` too (5, 8). */
	for (size_t i = 0; i < count && reference->blur_hold; i++)
		reference->weight[i] = reference->blur == ENGINE_BLUR_OFF ? 0.0 : 1.0;
	for (size_t i = 0; i < count && reference->geometry.moves && !reference->blur_hold; i++)
		reference->weight[i] =
			reference_weight(grid, grid->triangles[hits[i].triangle].v, reference->timing.last_phase, reference->blur);
	free(hits);
}

static void fill_pictures(struct reference *reference)
{
	const size_t count = (size_t)reference->width * reference->height;
	reference_low(&reference->low, &reference->original, reference->blur_level, 0.0);
	reference_picture_init(&reference->real, reference->width, reference->height);
	reference_picture_init(&reference->between, reference->width, reference->height);
	for (size_t i = 0; i < count * 4; i++) {
		double between, real;
		reference_compensate(&reference->compensation, reference->original.data[i] / 255.0,
							 reference->low.data[i] / 255.0, reference->weight[i / 4], &between, &real);
		reference->between.data[i] = reference_code8(between, 0.0);
		reference->real.data[i] = reference_code8(real, 0.0);
	}
}

static struct reference_transfer display_transfer(const struct engine_params *params)
{
	const double gamma = (double)params->gamma;
	if (params->curve == ENGINE_CURVE_SRGB)
		return (struct reference_transfer){PURSUIT_CURVE_SRGB, 0.0};
	return (struct reference_transfer){PURSUIT_CURVE_GAMMA, gamma < 1.0 ? 1.0 : gamma > 5.0 ? 5.0 : gamma};
}

static void take_params(struct reference *reference, const struct engine_params *params)
{
	const double real_s = reference->timing.real_s;
	reference->hold = params->method && strcmp(params->method, "hold") == 0;
	reference->blur_hold = params->method && strcmp(params->method, "blur-hold") == 0;
	reference->blur = params->blur;
	reference->blur_level = params->blur_level ? params->blur_level : 2;
	reference->compensation = (struct reference_compensation){
		.display = display_transfer(params),
		.n = reference->timing.n,
		.k = 1.0 - reference_smoothstep(0.030, 0.050, real_s),
		.off = params->no_compensation,
	};
}

void reference_begin(struct reference *reference, const struct frame *frame, const struct engine_params *params,
					 const struct engine_begin_params *begin)
{
	const struct pursuit_frame_header *header = &frame->header;
	const int color = frame_find_plane(header, PURSUIT_ROLE_COLOR), ui = frame_find_plane(header, PURSUIT_ROLE_UI);
	const double display_mm = params->display_width_mm > 0.0f ? (double)params->display_width_mm : 531.0;
	const double distance_mm = params->viewing_distance_mm > 0.0f ? (double)params->viewing_distance_mm : 600.0;

	reference->width = header->planes[color].width;
	reference->height = header->planes[color].height;
	reference_timing(&reference->timing, header, begin);
	take_params(reference, params);
	reference_convert_color(&reference->original, &header->planes[color], frame->planes[color],
							&reference->compensation.display);
	reference->has_ui = ui >= 0;
	if (reference->has_ui)
		reference_convert_ui(&reference->ui, &header->planes[ui], frame->planes[ui]);
	reference_geometry_init(&reference->geometry, frame, &reference->timing, display_mm, distance_mm);
	if (reference->blur_hold)
		reference_geometry_stop(&reference->geometry);
	reference_grid_init(&reference->grid, &reference->geometry, params->cell ? params->cell : 8,
						params->threshold_quarter ? params->threshold_quarter : 2);
	fill_weight(reference);
	fill_pictures(reference);
}

void reference_bend(struct reference *reference, const struct reference *before, double gap_s)
{
	const struct reference_times times = {reference->timing.real_s, reference->timing.motion_s, before->timing.real_s,
										  before->timing.motion_s, gap_s};
	reference_grid_bend(&reference->grid, &reference->geometry, &before->geometry, &times);
	fill_weight(reference);
	fill_pictures(reference);
}

void reference_finish(struct reference *reference)
{
	reference_geometry_finish(&reference->geometry);
	reference_grid_finish(&reference->grid);
	reference_picture_finish(&reference->original);
	reference_picture_finish(&reference->ui);
	reference_picture_finish(&reference->low);
	reference_picture_finish(&reference->real);
	reference_picture_finish(&reference->between);
	free(reference->weight);
	*reference = (struct reference){0};
}

double reference_phase(const struct engine_request *request)
{
	const double phase = isnan(request->phase) ? 0.0 : fmax(-1.0, fmin(8.0, request->phase));
	if (request->show == ENGINE_SHOW_PLAIN)
		return 0.0;
	return request->show == ENGINE_SHOW_REAL && fabs(phase) <= 0.05 ? 0.0 : phase;
}

static void compose(const struct reference *reference, const double steps[3], size_t pixel, uint8_t *out)
{
	for (int c = 0; c < 3; c++) {
		out[c] = reference_code8(steps[c] / 255.0, 0.0);
		if (reference->has_ui) {
			const uint8_t *ui = &reference->ui.data[pixel * 4];
			out[c] = reference_code8(reference_over(ui[c] / 255.0, ui[3] / 255.0, out[c] / 255.0), 0.0);
		}
	}
	out[3] = 255;
}

static void render_still(const struct reference *reference, const struct reference_picture *picture, uint8_t *pixels)
{
	for (size_t i = 0; i < (size_t)picture->width * picture->height; i++) {
		const double steps[3] = {picture->data[i * 4], picture->data[i * 4 + 1], picture->data[i * 4 + 2]};
		compose(reference, steps, i, &pixels[i * 4]);
	}
}

void reference_mix(const struct reference *reference, double phase, const struct reference_layers *layers)
{
	const size_t count = (size_t)reference->width * reference->height;
	struct reference_hit *hits = reference_alloc(count, sizeof(*hits));
	reference_warp(&reference->grid, reference->width, reference->height, phase, hits);
	for (size_t i = 0; i < count; i++) {
		const uint32_t *v = reference->grid.triangles[hits[i].triangle].v;
		const double t = reference_tear(&reference->grid, v, phase, reference->blur);
		double x[3], low[3];
		layers->sample(layers->picture, hits[i].x, hits[i].y, x);
		layers->sample(layers->low, hits[i].x, hits[i].y, low);
		for (int c = 0; c < 3; c++)
			x[c] = (1.0 - t) * x[c] + t * low[c];
		layers->put(layers->data, i, x);
	}
	free(hits);
}

static void sample_steps(const void *picture, double x, double y, double out[3])
{
	reference_sample(picture, x, y, out);
}

struct composition {
	const struct reference *reference;
	uint8_t *pixels;
};

static void put_composed(void *data, size_t pixel, const double steps[3])
{
	const struct composition *composition = data;
	compose(composition->reference, steps, pixel, &composition->pixels[pixel * 4]);
}

static void render_warped(const struct reference *reference, const struct reference_picture *picture, double phase,
						  uint8_t *pixels)
{
	struct composition composition = {reference, pixels};
	const struct reference_layers layers = {picture, &reference->low, sample_steps, put_composed, &composition};
	reference_mix(reference, phase, &layers);
}

void reference_render(const struct reference *reference, const struct engine_request *request, uint8_t *pixels)
{
	const double phase = reference_phase(request);
	const bool real = request->show == ENGINE_SHOW_REAL;
	if (reference->hold || request->show == ENGINE_SHOW_PLAIN)
		render_still(reference, &reference->original, pixels);
	else if (real && phase == 0.0)
		render_still(reference, &reference->real, pixels);
	else
		render_warped(reference, real ? &reference->real : &reference->between, phase, pixels);
}
