/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "demo_score.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "contact.h"
#include "player.h"

#define CONTACT_ROWS 4u

/* One in-between that was scored. */
struct scored {
	uint32_t beginning, showing; /* in the whole schedule */
	double psnr, ssim;
};

struct work {
	const struct demo_score_params *params;
	struct demo_score *score;
	struct recording_reader *reader;
	struct recorded_frames frames;
	struct schedule schedule;
	struct engine *engine;
	uint8_t *truth; /* size of a picture */
	struct picture truth_picture;
	struct scored *scored;
	uint32_t scored_count;
	struct contact *contact;
	uint8_t *real; /* the real frame before the in-between of a row */
};

/* ---- the schedule: what the timeline says about the frames that were recorded ---- */

static int64_t find_frame(const struct work *work, uint64_t frame_id)
{
	for (uint32_t i = 0; i < work->frames.count; i++) {
		if (work->frames.frames[i].frame_id == frame_id)
			return i;
	}
	return -1;
}

/* Rows of the same real frame from `first` on. */
static uint32_t rows_of_frame(const struct timeline *timeline, uint32_t first)
{
	uint32_t count = 1;
	while (first + count < timeline->count && timeline->rows[first + count].frame_id == timeline->rows[first].frame_id)
		count++;
	return count;
}

static uint64_t interval_of(const struct work *work, uint32_t frame)
{
	const struct recorded_frame *recorded = &work->frames.frames[frame];
	return recorded->interval_ns ? recorded->interval_ns : work->frames.interval_ns;
}

static int add_frame(struct work *work, uint32_t frame, const struct timeline_row *rows, uint32_t count,
					 struct error *error)
{
	struct beginning beginning = {.frame = frame, .span = 1};
	beginning.params.n = count < 8 ? count : 8;
	beginning.params.real_interval_ns = interval_of(work, frame);
	for (uint32_t i = 0; i < count; i++) {
		if (rows[i].show == TIMELINE_IN_BETWEEN)
			beginning.params.last_phase = rows[i].phase;
	}
	int result = schedule_add_beginning(&work->schedule, &beginning, error);
	for (uint32_t i = 0; i < count && result == 0; i++) {
		if (rows[i].show != TIMELINE_REAL && rows[i].show != TIMELINE_IN_BETWEEN)
			continue;
		double passed = rows[i].phase * (double)beginning.params.real_interval_ns;
		const struct showing showing = {
			.number = rows[i].vblank,
			.show = rows[i].show == TIMELINE_REAL ? ENGINE_SHOW_REAL : ENGINE_SHOW_IN_BETWEEN,
			.phase = rows[i].phase,
			.moment_ns = work->frames.frames[frame].time_ns + (uint64_t)(int64_t)passed,
			.truth = -1,
		};
		result = schedule_add_showing(&work->schedule, &showing, error);
	}
	return result;
}

/* Whole runs only: a frame whose first vblank or whose last one the timeline lacks is left out. */
static int make_schedule(struct work *work, struct error *error)
{
	const struct timeline *timeline = work->params->timeline;
	int result = 0;
	for (uint32_t row = 0, count; row < timeline->count && result == 0; row += count) {
		count = rows_of_frame(timeline, row);
		int64_t frame = find_frame(work, timeline->rows[row].frame_id);
		if (frame < 0 || timeline->rows[row].show != TIMELINE_REAL || row + count == timeline->count)
			continue;
		if (work->score->row_count == 0)
			work->score->first_row = row;
		work->score->row_count = row + count - work->score->first_row;
		result = add_frame(work, (uint32_t)frame, &timeline->rows[row], count, error);
	}
	return result;
}

/* ---- truth: the scene at that moment ---- */

static double scene_time(const struct work *work, const struct showing *showing)
{
	return (double)(int64_t)(showing->moment_ns - work->params->epoch_ns) / 1e9;
}

static const struct picture *get_truth(void *context, const struct beginning *beginning, const struct showing *showing)
{
	struct work *work = context;
	const struct recorded_frame *frame = &work->frames.frames[beginning->frame];
	if (frame->width != work->params->size.width || frame->height != work->params->size.height)
		return NULL;
	bool made = scene_source_truth(work->params->source, scene_time(work, showing), work->truth);
	return made ? &work->truth_picture : NULL;
}

/* ---- first pass: measures ---- */

static int score_picture(void *context, const struct player_picture *picture, struct error *error)
{
	struct work *work = context;
	struct quality one = {0};
	if (!picture->truth)
		return 0;
	quality_add(&one, &picture->shown, picture->truth);
	quality_add(&work->score->quality, &picture->shown, picture->truth);
	work->scored[work->scored_count++] = (struct scored){
		.beginning = (uint32_t)(picture->beginning - work->schedule.beginnings),
		.showing = (uint32_t)(picture->showing - work->schedule.showings),
		.psnr = one.psnr,
		.ssim = one.ssim,
	};
	json_array_append_new(work->score->scored,
						  json_pack("{s:I, s:f, s:f, s:f, s:f}", "vblank", (json_int_t)picture->showing->number,
									"scene_time", scene_time(work, picture->showing), "phase", picture->showing->phase,
									"psnr", one.psnr, "ssim", one.ssim));
	return 0;
}

static int play(struct work *work, const struct schedule *schedule,
				int (*take)(void *context, const struct player_picture *picture, struct error *error),
				struct error *error)
{
	struct player player = {
		.reader = work->reader,
		.frames = &work->frames,
		.schedule = schedule,
		.engine = work->engine,
		.truth = {work, get_truth},
		.observer = {work, take, NULL},
	};
	return player_run(&player, error);
}

/* ---- second pass: the contact sheet ---- */

static int compare_psnr(const void *a, const void *b)
{
	double left = ((const struct scored *)a)->psnr, right = ((const struct scored *)b)->psnr;
	return left < right ? -1 : left > right;
}

static int compare_showing(const void *a, const void *b)
{
	uint32_t left = ((const struct scored *)a)->showing, right = ((const struct scored *)b)->showing;
	return left < right ? -1 : left > right;
}

static int sheet_picture(void *context, const struct player_picture *picture, struct error *error)
{
	struct work *work = context;
	size_t bytes = picture->shown.stride * picture->shown.height;
	char label[160];
	if (!picture->truth) {
		memcpy(work->real, picture->shown.data, bytes);
		return 0;
	}
	double psnr = measure_psnr(&picture->shown, picture->truth);
	snprintf(label, sizeof(label), "at %.3f s, phase %.2f: PSNR %.2f dB, SSIM %.4f", scene_time(work, picture->showing),
			 picture->showing->phase, psnr, measure_ssim(&picture->shown, picture->truth));
	struct picture real = picture->shown;
	real.data = work->real;
	return contact_add(work->contact, label, &real, &picture->shown, picture->truth, error);
}

/* The worst, the best, and some between: in the order of time. */
static uint32_t choose(struct work *work, struct scored chosen[CONTACT_ROWS])
{
	uint32_t count = work->scored_count < CONTACT_ROWS ? work->scored_count : CONTACT_ROWS;
	qsort(work->scored, work->scored_count, sizeof(*work->scored), compare_psnr);
	for (uint32_t i = 0; i < count; i++)
		chosen[i] = work->scored[count > 1 ? i * (work->scored_count - 1) / (count - 1) : 0];
	qsort(chosen, count, sizeof(*chosen), compare_showing);
	return count;
}

static int make_sheet(struct work *work, struct error *error)
{
	struct scored chosen[CONTACT_ROWS];
	struct schedule few = {0};
	uint32_t count = choose(work, chosen);
	int result = 0;
	for (uint32_t i = 0; i < count && result == 0; i++) {
		const struct beginning *beginning = &work->schedule.beginnings[chosen[i].beginning];
		result = schedule_add_beginning(&few, beginning, error);
		if (result == 0)
			result = schedule_add_showing(&few, &work->schedule.showings[beginning->first_showing], error);
		if (result == 0)
			result = schedule_add_showing(&few, &work->schedule.showings[chosen[i].showing], error);
	}
	if (result == 0)
		result = play(work, &few, sheet_picture, error);
	schedule_finish(&few);
	if (result == 0)
		result = contact_write(work->contact, work->params->title, work->params->contact, error);
	return result;
}

/* ---- all of it ---- */

static int open_work(struct work *work, struct error *error)
{
	const struct demo_score_params *params = work->params;
	const struct recording_reader_params file = {.path = params->recording};
	struct engine_params engine;
	size_t bytes = 4 * (size_t)params->size.width * params->size.height;
	work->truth = malloc(bytes);
	work->real = malloc(bytes);
	work->truth_picture =
		(struct picture){work->truth, 4 * (size_t)params->size.width, params->size.width, params->size.height};
	work->contact = contact_create(params->size.width, params->size.height);
	work->score->scored = json_array();
	if (!work->truth || !work->real || !work->contact || !work->score->scored)
		return error_set(error, -ENOMEM, "out of memory");
	work->reader = recording_reader_create(&file, error);
	if (!work->reader)
		return -EIO;
	int result = recorded_frames_read(&work->frames, work->reader, error);
	if (result == 0)
		result = make_schedule(work, error);
	if (result == 0)
		result = settings_engine_params(params->settings, &engine, error);
	if (result < 0)
		return result;
	work->scored = calloc(work->schedule.showing_count + 1u, sizeof(*work->scored));
	work->engine = engine_create(&engine, error);
	return work->engine && work->scored ? 0 : -ENOMEM;
}

int demo_score(const struct demo_score_params *params, struct demo_score *score, struct error *error)
{
	struct work work = {.params = params, .score = score};
	*score = (struct demo_score){.row_count = 0};
	int result = open_work(&work, error);
	if (result == 0)
		result = play(&work, &work.schedule, score_picture, error);
	if (result == 0)
		result = make_sheet(&work, error);
	engine_destroy(&work.engine);
	schedule_finish(&work.schedule);
	recorded_frames_finish(&work.frames);
	if (work.reader)
		recording_reader_destroy(&work.reader);
	contact_destroy(&work.contact);
	free(work.scored);
	free(work.truth);
	free(work.real);
	return result;
}
