/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "schedule.h"

#define NAMED_DAMAGES 8u
#define DEFAULT_INTERVAL_NS UINT64_C(16666666)
#define LONGEST_LEAP_NS UINT64_C(3600000000000)

static void take_header(struct recorded_frame *taken, const struct pursuit_frame_header *header, uint64_t arrival_ns)
{
	int color = frame_find_plane(header, PURSUIT_ROLE_COLOR);
	taken->frame_id = header->frame_id;
	taken->time_ns = header->time_ns ? header->time_ns : arrival_ns;
	taken->interval_ns = header->real_interval_ns;
	taken->motion_interval_ns = header->motion_interval_ns;
	taken->flags = header->flags;
	taken->motion = header->motion_kind != PURSUIT_MOTION_NONE;
	taken->width = header->planes[color].width;
	taken->height = header->planes[color].height;
}

/*
 * A client whose clock stands still or runs backwards gets times that rise all
 * the same, and no leap is longer than an hour, so that sums stay in range.
 */
static void mend_times(struct recorded_frames *frames)
{
	uint64_t declared = frames->frames[0].time_ns;
	if (declared > UINT64_MAX / 4)
		frames->frames[0].time_ns = LONGEST_LEAP_NS;
	for (uint32_t i = 1; i < frames->count; i++) {
		struct recorded_frame *frame = &frames->frames[i];
		uint64_t step = frame->time_ns - declared;
		if (frame->time_ns <= declared)
			step = frame->interval_ns ? frame->interval_ns : DEFAULT_INTERVAL_NS;
		declared = frame->time_ns;
		frame->time_ns = frames->frames[i - 1].time_ns + (step < LONGEST_LEAP_NS ? step : LONGEST_LEAP_NS);
	}
}

/* Ids count the client's frames; where they do not rise sensibly the place in the file counts. */
static void set_positions(struct recorded_frames *frames)
{
	struct recorded_frame *first = &frames->frames[0], *last = &frames->frames[frames->count - 1];
	bool sensible = last->frame_id - first->frame_id < 4 * (uint64_t)frames->count + 16;
	for (uint32_t i = 1; i < frames->count && sensible; i++)
		sensible = frames->frames[i].frame_id > frames->frames[i - 1].frame_id;
	for (uint32_t i = 0; i < frames->count; i++) {
		struct recorded_frame *frame = &frames->frames[i];
		frame->position = sensible ? first->index + (frame->frame_id - first->frame_id) : frame->index;
	}
}

static int compare_intervals(const void *a, const void *b)
{
	uint64_t left = *(const uint64_t *)a, right = *(const uint64_t *)b;
	return left < right ? -1 : left > right;
}

static int set_interval(struct recorded_frames *frames, struct error *error)
{
	uint64_t *intervals = malloc(sizeof(*intervals) * frames->count);
	uint32_t count = 0;
	if (!intervals)
		return error_set(error, -ENOMEM, "out of memory");
	for (uint32_t i = 1; i < frames->count; i++) {
		uint64_t steps = frames->frames[i].position - frames->frames[i - 1].position;
		intervals[count++] = (frames->frames[i].time_ns - frames->frames[i - 1].time_ns) / steps;
	}
	qsort(intervals, count, sizeof(*intervals), compare_intervals);
	frames->interval_ns = count ? intervals[count / 2] : frames->frames[0].interval_ns;
	free(intervals);
	return 0;
}

int recorded_frames_read(struct recorded_frames *frames, struct recording_reader *reader, struct error *error)
{
	uint64_t count = recording_reader_frame_count(reader);
	*frames = (struct recorded_frames){.frames = calloc(count ? count : 1, sizeof(*frames->frames))};
	if (!frames->frames || count > UINT32_MAX)
		return error_set(error, -ENOMEM, "out of memory for %" PRIu64 " frames", count);
	for (uint64_t i = 0; i < count; i++) {
		struct frame frame;
		uint64_t arrival_ns;
		int result = recording_reader_frame(reader, i, 0, &frame, &arrival_ns, error);
		if (result == 0) {
			take_header(&frames->frames[frames->count], &frame.header, arrival_ns);
			frames->frames[frames->count++].index = i;
			continue;
		}
		if (++frames->damaged <= NAMED_DAMAGES)
			fprintf(stderr, "pursuit: %s; left out\n", error->text);
	}
	if (frames->damaged > NAMED_DAMAGES)
		fprintf(stderr, "pursuit: %u more frames are damaged and left out\n", frames->damaged - NAMED_DAMAGES);
	if (frames->count == 0)
		return error_set(error, -ENODATA, "%s: no frame of this recording is whole", recording_reader_path(reader));
	mend_times(frames);
	set_positions(frames);
	return set_interval(frames, error);
}

void recorded_frames_finish(struct recorded_frames *frames)
{
	free(frames->frames);
	*frames = (struct recorded_frames){0};
}

int64_t recorded_frames_find(const struct recorded_frames *frames, uint64_t time_ns, uint64_t tolerance_ns)
{
	uint32_t low = 0, high = frames->count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (frames->frames[middle].time_ns < time_ns)
			low = middle + 1;
		else
			high = middle;
	}
	if (low < frames->count && frames->frames[low].time_ns - time_ns <= tolerance_ns)
		return low;
	if (low > 0 && time_ns - frames->frames[low - 1].time_ns <= tolerance_ns)
		return (int64_t)low - 1;
	return -1;
}

bool recorded_frames_rate(const struct recorded_frames *frames, struct arg_rate *rate)
{
	if (!frames->interval_ns)
		return false;
	double exact = 1e9 / (double)frames->interval_ns, whole = round(exact);
	if (exact < 1 || exact > 1000)
		return false;
	if (fabs(exact - whole) < 2e-4 * whole) {
		*rate = (struct arg_rate){(uint64_t)whole, 1};
	} else {
		bool broadcast = fabs(exact - whole * 1000 / 1001) < 2e-4 * whole;
		*rate = broadcast ? (struct arg_rate){(uint64_t)whole * 1000, 1001}
						  : (struct arg_rate){(uint64_t)llround(exact * 1000), 1000};
	}
	return true;
}
