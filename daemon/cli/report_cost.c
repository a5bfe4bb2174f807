/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What the engine's time grows with: the share of the picture that moves, and the pixels that do. One scene in which
 * everything moves, its motion set to nothing right of the share; a straight line through the medians.
 */
#include "report_cost.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/clock.h"
#include "interrupt.h"
#include "scene_source.h"

#define SCENE "colonnade"
#define SAMPLES 31
#define STEPS 10u
/* The frame that is shown: all of the scene is in motion. */
#define FRAME 45u

/* Sizes, in quarters of the report's own. */
static const uint32_t quarters[] = {1, 2, 3, 4, 6, 8};
#define SIZES (sizeof(quarters) / sizeof(quarters[0]))

static uint32_t scaled(uint32_t size, uint32_t quarter)
{
	const uint32_t result = size * quarter / 4;
	return result < 16 ? 16 : result < PURSUIT_MAX_SIZE ? result : PURSUIT_MAX_SIZE;
}

/* A frame whose motion can be taken away. */
struct still {
	struct frame frame; /* its planes are the source's */
	uint8_t *motion;    /* a copy of the plane */
	int index;
};

static double now_ms(void)
{
	return (double)clock_monotonic_ns() / 1e6;
}

static void still_finish(struct still *still)
{
	free(still->motion);
}

static int still_init(struct still *still, struct scene_source *source, struct arg_size size, struct error *error)
{
	*still = (struct still){.motion = NULL};
	if (!scene_source_resize(source, &size, error))
		return -EIO;
	if (!scene_source_frame(source, FRAME, &still->frame))
		return error_set(error, -EIO, "GL failed while scene %s was rendered", SCENE);
	still->index = frame_find_plane(&still->frame.header, PURSUIT_ROLE_MOTION);
	const size_t bytes = still->frame.header.planes[still->index].size;
	still->motion = malloc(bytes);
	if (!still->motion)
		return error_set(error, -ENOMEM, "out of memory");
	memcpy(still->motion, still->frame.planes[still->index], bytes);
	still->frame.planes[still->index] = still->motion;
	return 0;
}

/* Nothing moves any more right of the share; shares fall from call to call. */
static void rest(const struct still *still, double share)
{
	const struct pursuit_plane *plane = &still->frame.header.planes[still->index];
	const size_t pixel = pursuit_format_bytes(plane->format), from = (size_t)(share * plane->width);
	for (uint32_t y = 0; y < plane->height; y++)
		memset(still->motion + y * plane->stride + from * pixel, 0, (plane->width - from) * pixel);
}

static int show(struct engine *engine, const struct frame *frame, uint32_t n, uint8_t *out, struct error *error)
{
	const struct pursuit_plane *color = &frame->header.planes[frame_find_plane(&frame->header, PURSUIT_ROLE_COLOR)];
	const struct engine_begin_params begin = {.n = n, .last_phase = -1.0};
	int result = engine_begin(engine, frame, &begin, error);
	for (uint32_t i = 0; i < n && result == 0; i++) {
		const struct engine_request request = {i ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, (double)i / n};
		struct engine_image image = {.data = out, .stride = 4 * (size_t)color->width};
		result = engine_render(engine, &request, &image, error);
	}
	return result;
}

static int compare(const void *a, const void *b)
{
	const double left = *(const double *)a, right = *(const double *)b;
	return (left > right) - (left < right);
}

/* Median milliseconds of the real frame with its in-betweens. */
static int time_still(struct engine *engine, const struct still *still, uint32_t n, double *ms, struct error *error)
{
	const struct pursuit_plane *plane = &still->frame.header.planes[still->index];
	double samples[SAMPLES] = {0};
	uint8_t *out = malloc(4 * (size_t)plane->width * plane->height);
	int result = out ? 0 : error_set(error, -ENOMEM, "out of memory");
	for (int i = -2; i < SAMPLES && result == 0 && !interrupt_seen(); i++) {
		const double start = now_ms();
		result = show(engine, &still->frame, n, out, error);
		if (i >= 0)
			samples[i] = now_ms() - start;
	}
	free(out);
	qsort(samples, SAMPLES, sizeof(*samples), compare);
	*ms = samples[SAMPLES / 2];
	return result;
}

static void add(struct report_cost *cost, double x, double ms)
{
	cost->x[cost->count] = x;
	cost->ms[cost->count++] = ms;
}

/* Least squares; r2: the share of the variance that the line explains. */
static void fit(struct report_cost *cost)
{
	const double n = cost->count;
	double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
	for (uint32_t i = 0; i < cost->count; i++) {
		x += cost->x[i] / n;
		y += cost->ms[i] / n;
	}
	for (uint32_t i = 0; i < cost->count; i++) {
		xx += (cost->x[i] - x) * (cost->x[i] - x);
		xy += (cost->x[i] - x) * (cost->ms[i] - y);
		yy += (cost->ms[i] - y) * (cost->ms[i] - y);
	}
	cost->slope = xx > 0.0 ? xy / xx : 0.0;
	cost->intercept = y - cost->slope * x;
	cost->r2 = xx > 0.0 && yy > 0.0 ? xy * xy / (xx * yy) : 0.0;
}

static int measure_share(struct engine *engine, struct scene_source *source, uint32_t n, struct report_cost *cost,
						 struct error *error)
{
	struct still still;
	int result = still_init(&still, source, cost->size, error);
	for (uint32_t step = STEPS + 1; step-- > 0 && result == 0;) {
		double ms = 0.0;
		rest(&still, (double)step / STEPS);
		result = time_still(engine, &still, n, &ms, error);
		add(cost, (double)step / STEPS, ms);
	}
	still_finish(&still);
	return result;
}

static int measure_pixels(struct engine *engine, struct scene_source *source, const struct report_work *work,
						  struct report_cost *cost, struct error *error)
{
	int result = 0;
	for (uint32_t i = 0; i < SIZES && result == 0; i++) {
		const struct arg_size size = {scaled(work->size.width, quarters[i]), scaled(work->size.height, quarters[i])};
		struct still still;
		double ms = 0.0;
		result = still_init(&still, source, size, error);
		if (result == 0)
			result = time_still(engine, &still, work->n, &ms, error);
		add(cost, 1e-6 * size.width * size.height, ms);
		still_finish(&still);
	}
	return result;
}

static const struct report_variant *choose(const struct report *report)
{
	const struct report_variant *chosen = NULL;
	for (uint32_t i = 0; i < report->variant_count; i++) {
		const struct report_variant *variant = &report->variants[i];
		if (variant->engine && variant->plain && (!chosen || strcmp(chosen->method, "pursuit") != 0))
			chosen = variant;
	}
	return chosen;
}

int report_measure_cost(struct report *report, struct error *error)
{
	const struct report_work *work = report->works;
	const struct report_variant *variant = choose(report);
	if (!variant || work->recording || interrupt_seen())
		return 0;
	const uint32_t rate = (uint32_t)(report->options.refresh.numerator / report->options.refresh.denominator) / work->n;
	const struct scene_source_params params = {.scene = SCENE, .size = work->size, .rate = {rate ? rate : 1, 1}};
	struct report_cost share = {.size = work->size}, pixels = {.size = {0, 0}};
	struct scene_source *source = scene_source_create(&params, error);
	int result = source ? measure_share(variant->engine, source, work->n, &share, error) : -EIO;
	if (result == 0)
		result = measure_pixels(variant->engine, source, work, &pixels, error);
	scene_source_destroy(&source);
	if (result < 0 || interrupt_seen())
		return result;
	fit(&share);
	fit(&pixels);
	report->cost_method = variant->method;
	report->cost_share = share;
	report->cost_pixels = pixels;
	return 0;
}

static json_t *line_json(const struct report_cost *cost, const char *unit)
{
	json_t *points = json_array();
	for (uint32_t i = 0; i < cost->count; i++)
		json_array_append_new(points, json_pack("[f, f]", cost->x[i], cost->ms[i]));
	return json_pack("{s:s, s:f, s:f, s:f, s:o}", "against", unit, "slope_ms", cost->slope, "intercept_ms",
					 cost->intercept, "r2", cost->r2, "points", points);
}

json_t *report_cost_json(const struct report *report)
{
	if (!report->cost_method)
		return json_null();
	return json_pack("{s:s, s:s, s:i, s:i, s:i, s:o, s:o}", "scene", SCENE, "method", report->cost_method, "n",
					 (int)report->works[0].n, "width", (int)report->cost_share.size.width, "height",
					 (int)report->cost_share.size.height, "share", line_json(&report->cost_share, "moving share"),
					 "pixels", line_json(&report->cost_pixels, "million pixels"));
}

static void put_line(FILE *out, const struct report_cost *cost, const char *unit)
{
	fprintf(out, "<p>%.2f ms + %.2f ms &times; %s; R&sup2; = %.3f.</p>\n", cost->intercept, cost->slope, unit,
			cost->r2);
}

void report_put_cost(const struct report *report, FILE *out)
{
	if (!report->cost_method)
		return;
	fprintf(out,
			"<h2>What the time grows with</h2>\n<p class=\"note\">Method %s, %s, a real frame with its in-betweens, "
			"N = %u: median of %d. First at %ux%u with part of the picture moving, then with all of it at six "
			"sizes. Least squares.</p>\n",
			report->cost_method, SCENE, report->works[0].n, SAMPLES, report->cost_share.size.width,
			report->cost_share.size.height);
	put_line(out, &report->cost_share, "share of the picture that moves");
	put_line(out, &report->cost_pixels, "million pixels");
}

void report_write_cost_plot(const struct report *report, FILE *script)
{
	const struct report_cost *const costs[2] = {&report->cost_share, &report->cost_pixels};
	static const char *const labels[2] = {"share of the picture that moves", "million pixels, all moving"};
	for (int i = 0; i < 2; i++) {
		fprintf(script, "$c%d << EOD\n", i);
		for (uint32_t k = 0; k < costs[i]->count; k++)
			fprintf(script, "%g %g\n", costs[i]->x[k], costs[i]->ms[k]);
		fprintf(script, "EOD\n");
	}
	fprintf(script, "set multiplot layout 1,2\nset key above left\nset yrange [0:*]\n");
	for (int i = 0; i < 2; i++)
		fprintf(script,
				"set xlabel '%s'\nset ylabel 'engine, ms a real frame'\n"
				"plot $c%d using 1:2 with points pointtype 7 linecolor '#0072b2' title 'median', \\\n"
				" %g + %g * x with lines linecolor '#d55e00' title '%.2f + %.2f x, R2 = %.3f'\n",
				labels[i], i, costs[i]->intercept, costs[i]->slope, costs[i]->intercept, costs[i]->slope, costs[i]->r2);
	fprintf(script, "unset multiplot\n");
}
