/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A displayed picture against all that may be displayed. */
#include "bounds.h"

#include <math.h>
#include <stdlib.h>

/* Steps a pixel, across and down together, above which a pixel is not called plain. */
#define PLAIN_SLOPE 16.0

/* One comparison under way; arrays have one entry a pixel. */
struct compare {
	const struct bounds *bounds;
	const struct reference *reference;
	const struct reference_picture *least, *most; /* of what is warped */
	double phase;
	const uint8_t *pixels;
	size_t stride;
	uint8_t *want; /* the reference's picture */
	double *cut;   /* nothing behind this depth can show */
	double *flat;  /* least depth of flat triangles, 2: none, and the first of them to be drawn */
	uint32_t *flat_first;
	double *outside; /* steps outside the best candidate's interval */
	uint8_t *candidates;
	double *span; /* widest interval of any candidate and channel */
	bool *plain;
	bool *excused;
};

/* A triangle where it is drawn. */
struct drawn {
	const struct bounds_triangle *triangle;
	double x[3], y[3], length[3]; /* length[k]: of the edge opposite to corner k */
	double sign, area;            /* area > 0, doubled */
	double sigma[2];
	double depth_slope; /* depth per pixel of distance */
	bool is_flat;       /* no depth plane: one depth for all, interpolated without rounding, so that ties are ties */
};

/* An interval for each channel, in steps. */
struct interval {
	double least[3], most[3];
};

static bool make_drawn(struct drawn *drawn, const struct compare *compare, const struct bounds_triangle *triangle)
{
	const struct reference_grid *grid = &compare->reference->grid;
	const double signed_area = reference_area2(grid, triangle->v, compare->phase);
	double longest = 0.0;
	drawn->triangle = triangle;
	reference_displaced(grid, triangle->v, compare->phase, drawn->x, drawn->y);
	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;
		drawn->length[k] = fmax(1e-9, hypot(drawn->x[b] - drawn->x[a], drawn->y[b] - drawn->y[a]));
		longest = fmax(longest, drawn->length[k]);
	}
	drawn->sign = signed_area < 0.0 ? -1.0 : 1.0;
	drawn->area = fabs(signed_area);
	/* Turned over: drawn only if it is so thin that rounding may turn it back. */
	if (signed_area <= 0.0 && drawn->area / longest > 2.0 * BOUNDS_EDGE)
		return false;
	reference_singular(grid, triangle->v, compare->phase, drawn->sigma);
	const double z0 = grid->vertices[triangle->v[0]].z, z1 = grid->vertices[triangle->v[1]].z;
	const double z2 = grid->vertices[triangle->v[2]].z;
	drawn->is_flat = !compare->reference->geometry.has_depth;
	const double gx = (z1 - z0) * (drawn->y[2] - drawn->y[0]) - (z2 - z0) * (drawn->y[1] - drawn->y[0]);
	const double gy = (z2 - z0) * (drawn->x[1] - drawn->x[0]) - (z1 - z0) * (drawn->x[2] - drawn->x[0]);
	drawn->depth_slope = drawn->area > 0.0 ? hypot(gx, gy) / drawn->area : 1e9;
	return true;
}

/* Barycentric coordinates (sum 1) and the distance to the nearest edge, positive inside. */
static double locate(const struct drawn *drawn, double px, double py, double share[3])
{
	double inside = 1e30;
	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;
		const double e = drawn->sign * ((drawn->x[b] - drawn->x[a]) * (py - drawn->y[a]) -
										(drawn->y[b] - drawn->y[a]) * (px - drawn->x[a]));
		inside = fmin(inside, e / drawn->length[k]);
		share[k] = drawn->area > 0.0 ? e / drawn->area : 1.0 / 3.0;
	}
	return inside;
}

static double depth_at(const struct compare *compare, const struct drawn *drawn, const double share[3])
{
	double z = 0.0;
	for (int k = 0; k < 3; k++)
		z += share[k] * compare->reference->grid.vertices[drawn->triangle->v[k]].z;
	return z;
}

static double depth_slack(const struct drawn *drawn)
{
	return BOUNDS_DEPTH + drawn->depth_slope * BOUNDS_SUBPIXEL;
}

static long clamp_index(double index, uint32_t count)
{
	return index < 0.0 ? 0 : index > count - 1.0 ? (long)count - 1 : (long)index;
}

/* How much a channel may change when the source position moves by `reach` pixels; its range there. */
static double slope(const struct reference_picture *picture, double x, double y, double reach, int c, double range[2])
{
	const long i0 = clamp_index(floor(x - 0.5 - reach), picture->width);
	const long i1 = clamp_index(floor(x - 0.5 + reach) + 1.0, picture->width);
	const long j0 = clamp_index(floor(y - 0.5 - reach), picture->height);
	const long j1 = clamp_index(floor(y - 0.5 + reach) + 1.0, picture->height);
	const long width = (long)picture->width;
	double across = 0.0, down = 0.0;
	range[0] = 255.0;
	range[1] = 0.0;
	for (long j = j0; j <= j1; j++)
		for (long i = i0; i <= i1; i++) {
			const double here = picture->data[(j * width + i) * 4 + c];
			range[0] = fmin(range[0], here);
			range[1] = fmax(range[1], here);
			if (i < i1)
				across = fmax(across, fabs(picture->data[(j * width + i + 1) * 4 + c] - here));
			if (j < j1)
				down = fmax(down, fabs(picture->data[((j + 1) * width + i) * 4 + c] - here));
		}
	return across + down;
}

/* Least (side 0) or most of a sampled picture near a source position. */
static double sample_side(const struct reference_picture *picture, double x, double y, double reach, int c, int side)
{
	double value[3], range[2];
	reference_sample(picture, x, y, value);
	const double move = reach * slope(picture, x, y, reach, c, range);
	return side ? fmin(range[1], value[c] + move) : fmax(range[0], value[c] - move);
}

static void show(const struct compare *compare, const struct drawn *drawn, const double share[3],
				 struct interval *interval)
{
	const struct reference_grid *grid = &compare->reference->grid;
	const double reach = BOUNDS_WEIGHT + BOUNDS_SUBPIXEL / drawn->sigma[1];
	const double slack = BOUNDS_STRETCH * drawn->sigma[0];
	const bool torn = compare->reference->blur != ENGINE_BLUR_OFF;
	double x = 0.0, y = 0.0, t[2] = {0.0, 0.0};
	for (int k = 0; k < 3; k++) {
		x += share[k] * grid->vertices[drawn->triangle->v[k]].x;
		y += share[k] * grid->vertices[drawn->triangle->v[k]].y;
	}
	for (int side = 0; side < 2 && torn; side++)
		t[side] = reference_tear_of(drawn->sigma[0] + (side ? slack : -slack));
	for (int c = 0; c < 3; c++) {
		interval->least[c] = 0.0;
		interval->most[c] = 255.0;
		if (!(reach < 4.0)) /* a sliver */
			continue;
		const double x0 = sample_side(compare->least, x, y, reach, c, 0);
		const double x1 = sample_side(compare->most, x, y, reach, c, 1);
		interval->least[c] = x0 - BOUNDS_STEP;
		interval->most[c] = x1 + BOUNDS_STEP;
		if (!(t[1] > 0.0))
			continue;
		const double l0 = sample_side(&compare->bounds->low[0], x, y, reach, c, 0);
		const double l1 = sample_side(&compare->bounds->low[1], x, y, reach, c, 1);
		interval->least[c] += fmin(t[0] * (l0 - x0), t[1] * (l0 - x0));
		interval->most[c] += fmax(t[0] * (l1 - x1), t[1] * (l1 - x1));
	}
}

/* Steps by which a displayed pixel misses an interval, the UI laid over it. */
static double miss(const struct compare *compare, size_t pixel, const struct interval *interval)
{
	const struct reference *reference = compare->reference;
	const size_t row = pixel / reference->width, column = pixel % reference->width;
	const uint8_t *got = compare->pixels + row * compare->stride + column * 4;
	double worst = got[3] == 255 ? 0.0 : 255.0;
	for (int c = 0; c < 3; c++) {
		double least = interval->least[c], most = interval->most[c];
		if (reference->has_ui) {
			const uint8_t *ui = &reference->ui.data[pixel * 4];
			least =
				255.0 * reference_over(ui[c] / 255.0, ui[3] / 255.0, fmax(0.0, least / 255.0)) - 0.5 - BOUNDS_ROUNDING;
			most =
				255.0 * reference_over(ui[c] / 255.0, ui[3] / 255.0, fmin(1.0, most / 255.0)) + 0.5 + BOUNDS_ROUNDING;
		}
		worst = fmax(worst, fmax(least - got[c], got[c] - most));
	}
	return fmax(0.0, worst);
}

static double span_of(const struct interval *interval)
{
	double span = 0.0;
	for (int c = 0; c < 3; c++)
		span = fmax(span, fmin(255.0, interval->most[c]) - fmax(0.0, interval->least[c]));
	return span;
}

typedef void (*visit)(struct compare *, const struct drawn *, size_t pixel, double inside, const double share[3]);

/* Calls for each pixel whose centre lies in a triangle or within BOUNDS_EDGE of it. */
static void each_pixel(struct compare *compare, const struct drawn *drawn, visit function)
{
	const double width = compare->reference->width, height = compare->reference->height;
	const double x0 = floor(fmin(drawn->x[0], fmin(drawn->x[1], drawn->x[2])) - 0.5);
	const double x1 = ceil(fmax(drawn->x[0], fmax(drawn->x[1], drawn->x[2])) - 0.5);
	const double y0 = floor(fmin(drawn->y[0], fmin(drawn->y[1], drawn->y[2])) - 0.5);
	const double y1 = ceil(fmax(drawn->y[0], fmax(drawn->y[1], drawn->y[2])) - 0.5);
	for (long j = (long)fmax(0.0, y0); j <= (long)fmin(height - 1.0, y1); j++)
		for (long i = (long)fmax(0.0, x0); i <= (long)fmin(width - 1.0, x1); i++) {
			double share[3];
			const double inside = locate(drawn, (double)i + 0.5, (double)j + 0.5, share);
			if (inside >= -BOUNDS_EDGE)
				function(compare, drawn, (size_t)j * compare->reference->width + (size_t)i, inside, share);
		}
}

static void visit_cut(struct compare *compare, const struct drawn *drawn, size_t pixel, double inside,
					  const double share[3])
{
	const double z = compare->reference->grid.vertices[drawn->triangle->v[0]].z;
	if (!(inside > BOUNDS_EDGE && drawn->triangle->certain && drawn->sign > 0.0))
		return;
	compare->cut[pixel] = fmin(compare->cut[pixel], depth_at(compare, drawn, share) + depth_slack(drawn));
	if (drawn->is_flat && z < compare->flat[pixel]) { /* triangles come in drawing order */
		compare->flat[pixel] = z;
		compare->flat_first[pixel] = (uint32_t)(drawn->triangle - compare->bounds->triangles);
	}
}

/* Behind another one for sure: deeper, or as deep and drawn later. */
static bool is_hidden(const struct compare *compare, const struct drawn *drawn, size_t pixel, const double share[3])
{
	const double z = compare->reference->grid.vertices[drawn->triangle->v[0]].z;
	const size_t index = (size_t)(drawn->triangle - compare->bounds->triangles);
	if (depth_at(compare, drawn, share) - depth_slack(drawn) > compare->cut[pixel])
		return true;
	return drawn->is_flat && z == compare->flat[pixel] && index > compare->flat_first[pixel];
}

static void visit_candidate(struct compare *compare, const struct drawn *drawn, size_t pixel, double inside,
							const double share[3])
{
	struct interval interval;
	if (is_hidden(compare, drawn, pixel, share))
		return;
	show(compare, drawn, share, &interval);
	if (compare->candidates[pixel] < 255)
		compare->candidates[pixel]++;
	compare->excused[pixel] |= drawn->triangle->excused;
	compare->outside[pixel] = fmin(compare->outside[pixel], miss(compare, pixel, &interval));
	compare->span[pixel] = fmax(compare->span[pixel], span_of(&interval));
	compare->plain[pixel] =
		span_of(&interval) <= 2.0 * BOUNDS_STEP + PLAIN_SLOPE * 2.0 * (BOUNDS_SUBPIXEL + BOUNDS_WEIGHT);
}

static void compare_warped(struct compare *compare)
{
	struct drawn drawn;
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t t = 0; t < compare->bounds->triangle_count; t++)
			if (make_drawn(&drawn, compare, &compare->bounds->triangles[t]))
				each_pixel(compare, &drawn, pass ? visit_candidate : visit_cut);
}

static void compare_still(struct compare *compare, size_t count)
{
	for (size_t pixel = 0; pixel < count; pixel++) {
		struct interval interval;
		for (int c = 0; c < 3; c++) {
			interval.least[c] = compare->least->data[pixel * 4 + c];
			interval.most[c] = compare->most->data[pixel * 4 + c];
		}
		compare->candidates[pixel] = 1;
		compare->outside[pixel] = miss(compare, pixel, &interval);
		compare->span[pixel] = span_of(&interval);
		compare->plain[pixel] = compare->span[pixel] == 0.0;
	}
}

static void note_worst(const struct compare *compare, size_t pixel, struct bounds_report *report)
{
	const size_t x = pixel % compare->reference->width, y = pixel / compare->reference->width;
	if (!(compare->outside[pixel] > report->worst))
		return;
	report->worst = compare->outside[pixel];
	report->worst_x = (uint32_t)x;
	report->worst_y = (uint32_t)y;
	for (int c = 0; c < 3; c++) {
		report->worst_got[c] = compare->pixels[y * compare->stride + x * 4 + (size_t)c];
		report->worst_want[c] = compare->want[pixel * 4 + (size_t)c];
	}
}

static void count_pixel(const struct compare *compare, size_t pixel, struct bounds_report *report)
{
	const size_t x = pixel % compare->reference->width, y = pixel / compare->reference->width;
	const uint8_t *got = compare->pixels + y * compare->stride + x * 4, *want = &compare->want[pixel * 4];
	const bool one = compare->candidates[pixel] == 1;
	int difference = 0;
	for (int c = 0; c < 3; c++)
		difference = abs(got[c] - want[c]) > difference ? abs(got[c] - want[c]) : difference;
	report->pixels++;
	report->same += difference == 0;
	report->within_one += difference <= 1;
	report->within_two += difference <= 2;
	report->sharp += one && compare->span[pixel] <= 4.0;
	report->plain += one && compare->plain[pixel];
	report->plain_within_one += one && compare->plain[pixel] && difference <= 1;
	if (compare->outside[pixel] <= 0.0) {
		report->other += !one && difference > compare->span[pixel];
	} else if (compare->excused[pixel]) {
		report->excused++;
	} else {
		report->outside++;
		note_worst(compare, pixel, report);
	}
}

static void choose_planes(struct compare *compare, const struct engine_request *request)
{
	const struct bounds *bounds = compare->bounds;
	const bool original = compare->reference->hold || request->show == ENGINE_SHOW_PLAIN;
	const bool real = request->show == ENGINE_SHOW_REAL;
	compare->least = original ? &compare->reference->original : real ? &bounds->real[0] : &bounds->between[0];
	compare->most = original ? &compare->reference->original : real ? &bounds->real[1] : &bounds->between[1];
}

void bounds_compare(const struct bounds *bounds, const struct engine_request *request, const uint8_t *pixels,
					size_t stride, struct bounds_report *report)
{
	const struct reference *reference = bounds->reference;
	const size_t count = (size_t)reference->width * reference->height;
	struct compare compare = {
		.bounds = bounds,
		.reference = reference,
		.phase = reference_phase(request),
		.pixels = pixels,
		.stride = stride,
		.want = reference_alloc(count, 4),
		.cut = reference_alloc(count, sizeof(double)),
		.outside = reference_alloc(count, sizeof(double)),
		.candidates = reference_alloc(count, 1),
		.span = reference_alloc(count, sizeof(double)),
		.plain = reference_alloc(count, sizeof(bool)),
		.excused = reference_alloc(count, sizeof(bool)),
		.flat = reference_alloc(count, sizeof(double)),
		.flat_first = reference_alloc(count, sizeof(uint32_t)),
	};
	for (size_t i = 0; i < count; i++) {
		compare.cut[i] = compare.outside[i] = 1e9;
		compare.flat[i] = 2.0;
	}
	reference_render(reference, request, compare.want);
	choose_planes(&compare, request);
	if (reference->hold || (request->show != ENGINE_SHOW_IN_BETWEEN && compare.phase == 0.0))
		compare_still(&compare, count);
	else
		compare_warped(&compare);
	for (size_t pixel = 0; pixel < count; pixel++)
		count_pixel(&compare, pixel, report);
	free(compare.want);
	free(compare.cut);
	free(compare.outside);
	free(compare.candidates);
	free(compare.span);
	free(compare.plain);
	free(compare.excused);
	free(compare.flat);
	free(compare.flat_first);
}
