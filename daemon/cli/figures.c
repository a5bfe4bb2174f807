/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "figures.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

int figures_init(struct figures *figures, struct error *error)
{
	*figures = (struct figures){
		.passes = json_object(),
		.left_out = json_object(),
		.frames = json_array(),
		.displayed = json_array(),
	};
	if (figures->passes && figures->left_out && figures->frames && figures->displayed)
		return 0;
	figures_finish(figures);
	return error_set(error, -ENOMEM, "out of memory");
}

void figures_finish(struct figures *figures)
{
	json_decref(figures->passes);
	json_decref(figures->left_out);
	json_decref(figures->frames);
	json_decref(figures->displayed);
	free(figures->engine_ms);
	*figures = (struct figures){0};
}

uint64_t figures_hash(const struct picture *picture)
{
	size_t row = 4 * (size_t)picture->width;
	if (picture->stride == row)
		return XXH3_64bits(picture->data, row * picture->height);
	XXH3_state_t *state = XXH3_createState();
	if (!state)
		return 0;
	XXH3_64bits_reset(state);
	for (uint32_t y = 0; y < picture->height; y++)
		XXH3_64bits_update(state, picture->data + y * picture->stride, row);
	uint64_t hash = XXH3_64bits_digest(state);
	XXH3_freeState(state);
	return hash;
}

json_t *figures_number(double value)
{
	return isfinite(value) ? json_real(value) : json_null();
}

static const char *show_name(const struct showing *showing)
{
	if (showing->repeat)
		return "repeat";
	switch (showing->show) {
	case ENGINE_SHOW_REAL:
		return "real";
	case ENGINE_SHOW_IN_BETWEEN:
		return "in-between";
	default:
		return "plain";
	}
}

/* Adds the measures of one picture to the means, and gives them back. */
static struct quality score(struct figures *figures, const struct player_picture *picture)
{
	struct quality one = {0};
	quality_add(&one, &picture->shown, picture->truth);
	struct quality *all = &figures->quality;
	double share = 1.0 / (all->frames + 1.0);
	all->psnr_min = all->frames ? fmin(all->psnr_min, one.psnr) : one.psnr;
	all->psnr += (one.psnr - all->psnr) * share;
	all->ssim += (one.ssim - all->ssim) * share;
	all->frames++;
	return one;
}

int figures_add_picture(struct figures *figures, const struct player_picture *picture, uint64_t hash,
						struct error *error)
{
	char text[20];
	snprintf(text, sizeof(text), "%016" PRIx64, hash);
	json_t *row =
		json_pack("{s:I, s:s, s:o, s:s}", "number", (json_int_t)picture->showing->number, "show",
				  show_name(picture->showing), "phase", figures_number(picture->showing->phase), "hash", text);
	if (!row)
		return error_set(error, -ENOMEM, "out of memory");
	if (picture->truth) {
		struct quality one = score(figures, picture);
		json_object_set_new(row, "psnr", figures_number(one.psnr));
		json_object_set_new(row, "ssim", figures_number(one.ssim));
	}
	json_array_append_new(figures->displayed, row);
	figures->displayed_frames++;
	if (picture->showing->repeat)
		figures->repeated_frames++;
	else if (picture->showing->show == ENGINE_SHOW_IN_BETWEEN)
		figures->in_between_frames++;
	figures->size = picture->shown;
	figures->size.data = NULL;
	return 0;
}

static void count(json_t *object, const char *name, json_int_t add)
{
	json_object_set_new(object, name, json_integer(json_integer_value(json_object_get(object, name)) + add));
}

static int add_time(struct figures *figures, double ms, struct error *error)
{
	if (figures->real_frames == figures->engine_ms_capacity) {
		uint32_t capacity = figures->engine_ms_capacity ? 2 * figures->engine_ms_capacity : 256;
		double *grown = realloc(figures->engine_ms, capacity * sizeof(*grown));
		if (!grown)
			return error_set(error, -ENOMEM, "out of memory");
		figures->engine_ms = grown;
		figures->engine_ms_capacity = capacity;
	}
	figures->engine_ms[figures->real_frames++] = ms;
	return 0;
}

int figures_add_frame(struct figures *figures, const struct player_frame *frame, const struct recorded_frames *frames,
					  struct error *error)
{
	const struct engine_report *report = frame->report;
	const struct recorded_frame *real = &frames->frames[frame->beginning->frame];
	json_t *passes = json_object(), *left_out = json_object(), *plan = json_loads(frame->plan, 0, NULL);
	for (uint32_t i = 0; i < report->pass_count; i++) {
		const struct engine_pass_report *pass = &report->passes[i];
		if (pass->runs == 0)
			continue;
		count(figures->passes, pass->name, pass->runs);
		json_object_set_new(passes, pass->name,
							json_pack("{s:i, s:o}", "runs", (int)pass->runs, "ms", figures_number(pass->ms)));
	}
	for (uint32_t i = 0; i < report->left_out_count; i++) {
		count(figures->left_out, report->left_out[i].name, 1);
		json_object_set_new(left_out, report->left_out[i].name, json_string(report->left_out[i].reason));
	}
	json_t *row = json_pack("{s:I, s:I, s:I, s:i, s:o, s:o, s:o, s:s, s:o, s:o, s:o}", "frame", (json_int_t)real->index,
							"frame_id", (json_int_t)real->frame_id, "time_ns", (json_int_t)real->time_ns, "n",
							(int)frame->beginning->params.n, "interval_ms",
							figures_number((double)frame->beginning->params.real_interval_ns / 1e6), "engine_ms",
							figures_number(frame->engine_ms), "passes", passes, "time_source",
							report->time_source ? report->time_source : "", "left_out", left_out, "plan",
							plan ? plan : json_null(), "displayed", figures->displayed);
	figures->displayed = json_array();
	if (!row || !figures->displayed)
		return error_set(error, -ENOMEM, "out of memory");
	json_array_append_new(figures->frames, row);
	return add_time(figures, frame->engine_ms, error);
}

static int compare_values(const void *a, const void *b)
{
	double left = *(const double *)a, right = *(const double *)b;
	return left < right ? -1 : left > right;
}

double figures_percentile(double *values, uint32_t values_count, double p)
{
	if (values_count == 0)
		return 0;
	qsort(values, values_count, sizeof(*values), compare_values);
	double rank = p / 100 * (values_count - 1);
	uint32_t below = (uint32_t)rank;
	uint32_t above = below + 1 < values_count ? below + 1 : below;
	return values[below] + (values[above] - values[below]) * (rank - below);
}

json_t *figures_quality_json(const struct quality *quality)
{
	if (quality->frames == 0)
		return json_pack("{s:n, s:n, s:n, s:i}", "psnr", "ssim", "psnr_min", "frames", 0);
	return json_pack("{s:o, s:o, s:o, s:i}", "psnr", figures_number(quality->psnr), "ssim",
					 figures_number(quality->ssim), "psnr_min", figures_number(quality->psnr_min), "frames",
					 (int)quality->frames);
}

static double displayed_hz(const struct figures *figures)
{
	return figures->duration_ns ? figures->displayed_frames * 1e9 / (double)figures->duration_ns : 0;
}

json_t *figures_json(struct figures *figures)
{
	double p50 = figures_percentile(figures->engine_ms, figures->real_frames, 50);
	double p99 = figures_percentile(figures->engine_ms, figures->real_frames, 99);
	return json_pack(
		"{s:i, s:i, s:i, s:i, s:o, s:i, s:i, s:{s:o, s:o}, s:O, s:O, s:o, s:i, s:i}", "real_frames",
		(int)figures->real_frames, "in_between_frames", (int)figures->in_between_frames, "displayed_frames",
		(int)figures->displayed_frames, "repeated_frames", (int)figures->repeated_frames, "displayed_hz",
		figures_number(displayed_hz(figures)), "late_in_betweens", (int)figures->late_in_betweens, "lost_real_frames",
		(int)figures->lost_real_frames, "engine_ms", "p50", figures_number(p50), "p99", figures_number(p99), "passes",
		figures->passes, "left_out", figures->left_out, "quality", figures_quality_json(&figures->quality), "width",
		(int)figures->size.width, "height", (int)figures->size.height);
}

json_t *figures_settings_json(const struct settings *settings)
{
	json_t *object = json_object();
	for (const struct option_row *row = option_table(); object && row->name; row++) {
		char value[OPTION_VALUE_BYTES];
		if (row->group == OPTION_ENGINE && settings_get(settings, row->name, value, sizeof(value)) >= 0)
			json_object_set_new(object, row->name, json_string(value));
	}
	return object;
}

static void print_counts(const json_t *object, const char *label, FILE *out)
{
	const char *name;
	json_t *value, *counts = json_copy((json_t *)(uintptr_t)object);
	const char *separator = "";
	fprintf(out, "  %-18s ", label);
	json_object_foreach(counts, name, value)
	{
		fprintf(out, "%s%s %" JSON_INTEGER_FORMAT, separator, name, json_integer_value(value));
		separator = ", ";
	}
	fprintf(out, "%s\n", *separator ? "" : "nothing");
	json_decref(counts);
}

void figures_print(struct figures *figures, FILE *out)
{
	fprintf(out, "  %-18s %u, %u in-between, %u displayed", "real frames", figures->real_frames,
			figures->in_between_frames, figures->displayed_frames);
	if (figures->repeated_frames)
		fprintf(out, ", %u of them repeated", figures->repeated_frames);
	if (figures->lost_real_frames)
		fprintf(out, ", %u real frames lost", figures->lost_real_frames);
	fprintf(out, "\n  %-18s %.2f Hz for %.2f s\n", "displayed", displayed_hz(figures),
			(double)figures->duration_ns / 1e9);
	fprintf(out, "  %-18s %.1f ms median, %.1f ms at 99%%, for each real frame with its in-betweens\n", "engine",
			figures_percentile(figures->engine_ms, figures->real_frames, 50),
			figures_percentile(figures->engine_ms, figures->real_frames, 99));
	print_counts(figures->passes, "passes", out);
	print_counts(figures->left_out, "left out", out);
	if (figures->quality.frames)
		fprintf(out, "  %-18s PSNR %.2f dB (least %.2f), SSIM %.4f, over %u in-betweens with truth\n", "quality",
				figures->quality.psnr, figures->quality.psnr_min, figures->quality.ssim, figures->quality.frames);
	else
		fprintf(out, "  %-18s not scored: no in-between had a recorded frame of its moment\n", "quality");
}
