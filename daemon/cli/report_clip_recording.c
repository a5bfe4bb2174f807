/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/compose.h"
#include "pixel.h"
#include "report_clip.h"

struct taker {
	struct recording_reader *reader;
	struct recorded_frames frames;
	struct schedule schedule;
	struct recorded_truth *truth;
	struct real_frames real;
	struct clip *clip;
};

/* Distances of a frame's pixels on a scale of their own; NULL if it has no depth of the clip's size. */
static float *read_distance(const struct clip *clip, const struct frame *frame)
{
	struct error ignored;
	int index = frame_find_plane(&frame->header, PURSUIT_ROLE_DEPTH);
	if (index < 0 || frame->header.depth_kind == PURSUIT_DEPTH_NONE)
		return NULL;
	const struct pursuit_plane *plane = &frame->header.planes[index];
	if (plane->width != clip->width || plane->height != clip->height)
		return NULL;
	float *distance = clip_plane(clip, sizeof(float), &ignored);
	for (uint32_t y = 0; distance && y < plane->height; y++) {
		float *row = distance + (size_t)y * plane->width;
		pixel_read_depth(plane->format, frame->planes[index] + y * plane->stride, plane->width, row);
		for (uint32_t x = 0; x < plane->width; x++) {
			if (frame->header.depth_kind == PURSUIT_DEPTH_DEVICE)
				row[x] = 1.0f / fmaxf(1.0f - row[x], 1e-6f);
			else if (frame->header.depth_kind == PURSUIT_DEPTH_DEVICE_REVERSED)
				row[x] = 1.0f / fmaxf(row[x], 1e-6f);
		}
	}
	return distance;
}

/* Where the pixels of a frame were in the frame before; NULL if it does not say so at the clip's size. */
static float *read_motion(const struct clip *clip, const struct frame *frame)
{
	struct error ignored;
	int index = frame_find_plane(&frame->header, PURSUIT_ROLE_MOTION);
	if (index < 0 || frame->header.motion_kind != PURSUIT_MOTION_BACKWARD)
		return NULL;
	const struct pursuit_plane *plane = &frame->header.planes[index];
	float *motion = plane->width == clip->width && plane->height == clip->height
						? clip_plane(clip, 2 * sizeof(float), &ignored)
						: NULL;
	if (motion && motion_compose(&frame, 1, motion, &ignored) < 0) {
		free(motion);
		return NULL;
	}
	for (size_t i = 0; motion && i < 2 * (size_t)clip->width * clip->height; i++)
		motion[i] = -motion[i];
	return motion;
}

/* What the next frame says about where it came from. Guessed, or left out: nothing depends on it. */
static void guess_regions(struct taker *taker, const struct clip_real *real, const struct showing *showing,
						  struct clip_shown *shown)
{
	struct clip *clip = taker->clip;
	struct error ignored;
	struct frame next;
	uint64_t place = taker->frames.frames[showing->truth].index;
	if (recording_reader_frame(taker->reader, place, 3, &next, NULL, &ignored) < 0)
		return;
	float *motion = read_motion(clip, &next);
	float *here = read_distance(clip, &next), *there = read_distance(clip, &real->frame);
	shown->regions = motion ? clip_plane(clip, 1, &ignored) : NULL;
	if (shown->regions) {
		const struct region_view view_here = {motion, NULL, here}, view_there = {NULL, NULL, there};
		regions_guess(&view_here, &view_there, clip->width, clip->height, shown->regions);
	}
	free(motion);
	free(here);
	free(there);
}

static int take_frame(struct taker *taker, uint32_t index, struct error *error)
{
	const struct beginning *beginning = &taker->schedule.beginnings[index];
	const struct showing *showing = &taker->schedule.showings[beginning->first_showing];
	const struct player_truth truth = recorded_truth_source(taker->truth);
	struct clip_real *real = &taker->clip->reals[index];
	struct clip_shown *shown = &taker->clip->shown[index];
	struct frame frame;
	int result = real_frames_load(&taker->real, beginning, &frame, error);
	if (result == 0)
		result = clip_keep_frame(real, &frame, error);
	if (result < 0)
		return result;
	real->begin = beginning->params;
	real->first_shown = index;
	real->shown_count = 1;
	shown->request = (struct engine_request){showing->show, showing->phase};
	shown->time = (double)(showing->moment_ns - taker->frames.frames[0].time_ns) / 1e9;
	const struct picture *there = truth.get(truth.context, beginning, showing);
	if (!there || there->width != taker->clip->width || there->height != taker->clip->height)
		return 0;
	shown->truth = clip_plane(taker->clip, 4, error);
	if (!shown->truth)
		return -ENOMEM;
	for (uint32_t y = 0; y < there->height; y++)
		memcpy(shown->truth + 4 * (size_t)y * there->width, there->data + y * there->stride, 4 * (size_t)there->width);
	shown->scored = true;
	guess_regions(taker, real, showing, shown);
	return 0;
}

static int open_recording(struct taker *taker, const char *path, const struct engine_params *engine,
						  struct error *error)
{
	const struct recording_reader_params params = {.path = path};
	taker->reader = recording_reader_create(&params, error);
	if (!taker->reader)
		return -EIO;
	int result = recorded_frames_read(&taker->frames, taker->reader, error);
	if (result == 0)
		result = schedule_predict(&taker->schedule, &taker->frames, &(struct schedule_params){.every = 1}, error);
	if (result < 0)
		return result;
	taker->truth = recorded_truth_create(taker->reader, &taker->frames, engine, error);
	taker->real = (struct real_frames){.reader = taker->reader, .frames = &taker->frames};
	return taker->truth ? 0 : -ENOTSUP;
}

static int take_all(struct taker *taker, uint32_t reals, struct error *error)
{
	const struct recorded_frame *first = &taker->frames.frames[taker->schedule.beginnings[0].frame];
	uint32_t count = taker->schedule.beginning_count < reals ? taker->schedule.beginning_count : reals;
	taker->clip = clip_create(first->width, first->height, count, count, 0, error);
	if (!taker->clip)
		return -ENOMEM;
	taker->clip->approximate = true;
	taker->clip->refresh_hz = taker->frames.interval_ns ? 1e9 / (double)taker->frames.interval_ns : 0.0;
	int result = 0;
	for (uint32_t i = 0; i < count && result == 0; i++)
		result = take_frame(taker, i, error);
	return result;
}

struct clip *clip_of_recording(const char *path, uint32_t reals, const struct engine_params *engine,
							   struct error *error)
{
	struct taker taker = {0};
	int result = open_recording(&taker, path, engine, error);
	if (result == 0)
		result = take_all(&taker, reals, error);
	if (result < 0)
		clip_destroy(&taker.clip);
	recorded_truth_destroy(&taker.truth);
	real_frames_finish(&taker.real);
	schedule_finish(&taker.schedule);
	recorded_frames_finish(&taker.frames);
	if (taker.reader)
		recording_reader_destroy(&taker.reader);
	return taker.clip;
}
