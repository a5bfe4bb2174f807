/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Plays and scores: work by work, clip by clip, variant by variant. */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "interrupt.h"
#include "report.h"
#include "report_frames.h"
#include "report_gallery.h"
#include "report_progress.h"

/* Moments of a scene at which its clips begin, s. */
static const double clip_starts[] = {1.0, 3.2, 5.4, 7.7, 9.9, 12.3};

struct amount {
	uint32_t clips, reals, samples;
};

static struct amount amount_of(const struct report *report)
{
	return report->options.full ? (struct amount){6, 9, 200} : (struct amount){3, 6, 30};
}

/* One work on its way. */
struct run {
	struct report *report;
	struct report_writer *writer;
	struct report_progress progress;
	struct amount amount;
	struct scorer *scorer;
	const struct report_work *work;
	struct report_gallery *gallery;
	struct scene_source *source;
	uint32_t first_row, rows; /* of the report, those of the work */
	uint8_t **pictures;
	uint32_t picture_count;
};

static bool takes_part(const struct run *run, const struct report_variant *variant)
{
	if (run->work->recording) /* what waits for the next frame cannot predict it */
		return variant->engine && variant->lag == 0;
	return variant->every_n || run->work->n == run->report->works[0].n;
}

static int add_rows(struct run *run, struct error *error)
{
	struct report *report = run->report;
	run->first_row = report->row_count;
	for (uint32_t i = 0; i < report->variant_count; i++) {
		if (!takes_part(run, &report->variants[i]))
			continue;
		struct report_row *row = report_add_row(report);
		if (!row)
			return error_set(error, -ENOMEM, "out of memory");
		row->work = run->work;
		row->variant = &report->variants[i];
		row->score.lag = report->variants[i].lag;
	}
	run->rows = report->row_count - run->first_row;
	return 0;
}

/* Recordings are predicted, as replay --predict does it: no compensation, since a single picture is judged. */
static int set_engines(struct run *run, struct error *error)
{
	int result = 0;
	for (uint32_t i = 0; i < run->rows && result == 0; i++) {
		const struct report_variant *variant = run->report->rows[run->first_row + i].variant;
		struct engine_params params;
		if (!variant->engine)
			continue;
		result = settings_engine_params(&variant->settings, &params, error);
		if (result == 0 && run->work->recording)
			params.no_compensation = true;
		if (result == 0)
			result = engine_set_params(variant->engine, &params, error);
	}
	return result;
}

/* ---- clips ---- */

static double degrees_per_pixel(const struct run *run)
{
	const struct settings *settings = &run->report->options.settings;
	const double pixel_mm = settings->display_width_mm / run->work->size.width;
	return 180.0 / M_PI * atan(pixel_mm / settings->viewing_distance_mm);
}

static struct clip *make_clip(struct run *run, uint32_t index, struct error *error)
{
	const struct report_options *options = &run->report->options;
	if (run->work->recording) {
		struct engine_params params;
		if (settings_engine_params(&options->settings, &params, error) < 0)
			return NULL;
		return clip_of_recording(run->work->recording, options->full ? 60 : 12, &params, error);
	}
	const double refresh = (double)options->refresh.numerator / (double)options->refresh.denominator;
	const struct clip_scene_params params = {
		.first = (uint64_t)llround(clip_starts[index] * refresh / run->work->n),
		.reals = run->amount.reals,
		.n = run->work->n,
		.refresh_hz = refresh,
		.degrees_per_pixel = degrees_per_pixel(run),
		.gamma = options->settings.gamma,
	};
	return clip_of_scene(run->source, &run->work->size, &params, error);
}

static void free_pictures(struct run *run)
{
	for (uint32_t i = 0; run->pictures && i < run->picture_count; i++)
		free(run->pictures[i]);
	free(run->pictures);
	run->pictures = NULL;
	run->picture_count = 0;
}

static int make_pictures(struct run *run, const struct clip *clip, struct error *error)
{
	free_pictures(run);
	run->pictures = calloc(clip->shown_count, sizeof(*run->pictures));
	if (!run->pictures)
		return error_set(error, -ENOMEM, "out of memory");
	run->picture_count = clip->shown_count;
	for (uint32_t i = 0; i < clip->shown_count; i++) {
		run->pictures[i] = clip_plane(clip, 4, error);
		if (!run->pictures[i])
			return -ENOMEM;
	}
	return 0;
}

/* ---- playing ---- */

static int time_rows(struct run *run, const struct clip *clip, struct error *error)
{
	struct report_row **rows = calloc(run->rows + 1u, sizeof(*rows));
	if (!rows)
		return error_set(error, -ENOMEM, "out of memory");
	uint32_t count = 0;
	for (uint32_t i = 0; i < run->rows; i++) {
		struct report_row *row = &run->report->rows[run->first_row + i];
		if (row->variant->engine)
			rows[count++] = row;
	}
	const int result = report_time(rows, count, clip, run->amount.samples, error);
	free(rows);
	return result;
}

static int score_row(struct run *run, struct report_row *row, const struct clip *clip, bool kept, struct error *error)
{
	const struct crop *crop = kept && clip->site_count ? &run->gallery->crop : NULL;
	int result = 0;
	if (row->variant->engine)
		result = clip_play(clip, row->variant->engine, run->pictures, error);
	else
		clip_show_truth(clip, run->pictures);
	if (result == 0 && crop) {
		row->seen = malloc(4 * (size_t)crop->width * crop->height);
		if (!row->seen)
			return error_set(error, -ENOMEM, "out of memory");
	}
	if (result == 0)
		result = scorer_add(run->scorer, &row->score, clip, run->pictures, crop, row->seen, error);
	if (result == 0 && kept && row->variant->plain && row->variant->engine)
		result = gallery_add(run->gallery, row->variant, clip, run->pictures, error);
	if (result == 0 && kept && row->variant->plain && row->variant->engine)
		result = frames_add(run->report, run->gallery, row->variant, clip, run->pictures, error);
	return result;
}

static int run_clip(struct run *run, uint32_t index, struct error *error)
{
	report_progress_step(&run->progress, "%s, N = %u: rendering the truth of clip %u", run->work->name, run->work->n,
						 index + 1);
	struct clip *clip = make_clip(run, index, error);
	if (!clip)
		return -EIO;
	run->report->works[run->work - run->report->works].size = (struct arg_size){clip->width, clip->height};
	int result = make_pictures(run, clip, error);
	if (result == 0 && index == 0) {
		result = gallery_begin(run->gallery, run->work, clip, error);
		if (result == 0 && (run->work->recording || run->work->n == run->report->works[0].n))
			result = frames_begin(run->report, run->gallery, clip, error);
		report_progress_step(&run->progress, "%s, N = %u: engine times", run->work->name, run->work->n);
		if (result == 0)
			result = time_rows(run, clip, error);
	}
	for (uint32_t i = 0; i < run->rows && result == 0 && !interrupt_seen(); i++) {
		struct report_row *row = &run->report->rows[run->first_row + i];
		report_progress_step(&run->progress, "%s, N = %u, clip %u: %s, %s", run->work->name, run->work->n, index + 1,
							 row->variant->method, row->variant->setting);
		result = score_row(run, row, clip, index == 0, error);
	}
	clip_destroy(&clip);
	return result;
}

static int open_source(struct run *run, struct error *error)
{
	const struct report_options *options = &run->report->options;
	const struct scene_source_params params = {
		.scene = run->work->name,
		.size = run->work->size,
		.rate = {options->refresh.numerator, options->refresh.denominator * run->work->n},
		.antialias = options->antialias,
	};
	scene_source_destroy(&run->source);
	if (run->work->recording)
		return 0;
	run->source = scene_source_create(&params, error);
	return run->source ? 0 : -ENOTSUP;
}

/* Rows of which something was scored are whole enough; the others go. */
static int write_rows(struct run *run, struct error *error)
{
	struct report *report = run->report;
	int result = 0;
	uint32_t kept = run->first_row;
	for (uint32_t i = run->first_row; i < run->first_row + run->rows; i++) {
		struct report_row *row = &report->rows[i];
		if (row->score.clips == 0) {
			score_finish(&row->score);
			free(row->engine_ms);
			free(row->seen);
			continue;
		}
		report->rows[kept] = *row;
		if (result == 0)
			result = report_write_row(run->writer, &report->rows[kept], error);
		kept++;
	}
	report->row_count = kept;
	return result;
}

static int run_work(struct run *run, uint32_t index, struct error *error)
{
	struct error later;
	run->work = &run->report->works[index];
	run->gallery = &run->report->galleries[index];
	int result = open_source(run, error);
	if (result == 0)
		result = add_rows(run, error);
	if (result < 0)
		return result;
	result = set_engines(run, error);
	const uint32_t clips = run->work->recording ? 1 : run->amount.clips;
	for (uint32_t i = 0; i < clips && result == 0 && !interrupt_seen(); i++)
		result = run_clip(run, i, error);
	frames_end(run->gallery);
	if (run->gallery->work)
		gallery_end(run->gallery, run->report);
	const int written = write_rows(run, &later);
	if (result == 0 && written < 0)
		return error_set(error, written, "%s", later.text);
	return result;
}

static uint32_t count_steps(struct run *run)
{
	uint32_t steps = 0;
	for (uint32_t w = 0; w < run->report->work_count; w++) {
		run->work = &run->report->works[w];
		const uint32_t clips = run->work->recording ? 1 : run->amount.clips;
		uint32_t variants = 0;
		for (uint32_t v = 0; v < run->report->variant_count; v++)
			variants += takes_part(run, &run->report->variants[v]);
		steps += clips * (variants + 1) + 1;
	}
	return steps;
}

int report_run(struct report *report, struct report_writer *writer, struct error *error)
{
	struct run run = {.report = report, .writer = writer, .amount = amount_of(report)};
	run.scorer = scorer_create(report->options.settings.gamma, error);
	int result = run.scorer ? 0 : -ENOMEM;
	report_progress_begin(&run.progress, count_steps(&run));
	for (uint32_t i = 0; i < report->work_count && result == 0 && !interrupt_seen(); i++)
		result = run_work(&run, i, error);
	report_progress_end(&run.progress);
	report->interrupted = interrupt_seen();
	free_pictures(&run);
	scene_source_destroy(&run.source);
	scorer_destroy(&run.scorer);
	return result;
}
