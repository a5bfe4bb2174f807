/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "real_frame.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/compose.h"

/* Steps of the longest chain: --every goes to 64. */
#define MAX_STEPS 64u

/* Nanoseconds that the motion of a frame spans, 0 unknown. */
static uint64_t step_interval(const struct real_frames *real, const struct pursuit_frame_header *header)
{
	if (header->motion_interval_ns)
		return header->motion_interval_ns;
	return header->real_interval_ns ? header->real_interval_ns : real->frames->interval_ns;
}

/* Recorded frames that the motion of a frame spans. */
static uint32_t step_span(const struct real_frames *real, const struct pursuit_frame_header *header)
{
	uint64_t usual = real->frames->interval_ns;
	if (!header->motion_interval_ns || !usual)
		return 1;
	uint64_t span = (header->motion_interval_ns + usual / 2) / usual;
	return span < 1 ? 1 : span > MAX_STEPS ? MAX_STEPS : (uint32_t)span;
}

/* Index in recorded_frames of a position near `from`, -1 if that frame is missing. */
static int64_t find_position(const struct recorded_frames *frames, uint32_t from, int64_t position)
{
	int64_t at = from, way = position < (int64_t)frames->frames[from].position ? -1 : 1;
	while (at >= 0 && at < frames->count && ((int64_t)frames->frames[at].position - position) * way < 0)
		at += way;
	return at >= 0 && at < frames->count && (int64_t)frames->frames[at].position == position ? at : -1;
}

static int keep_motion(struct motion_step *step, const struct frame *frame, struct error *error)
{
	int index = frame_find_plane(&frame->header, PURSUIT_ROLE_MOTION);
	const struct pursuit_plane *plane = &frame->header.planes[index];
	if (plane->size > step->capacity) {
		free(step->bytes);
		step->bytes = malloc(plane->size);
		step->capacity = step->bytes ? plane->size : 0;
		if (!step->bytes)
			return error_set(error, -ENOMEM, "out of memory for the motion of a frame");
	}
	memcpy(step->bytes, frame->planes[index], plane->size);
	step->frame = (struct frame){.header = frame->header};
	step->frame.planes[index] = step->bytes;
	return 0;
}

/* Does this frame continue a chain that began with the other? */
static bool continues(const struct frame *first, const struct frame *next)
{
	int a = frame_find_plane(&first->header, PURSUIT_ROLE_COLOR),
		b = frame_find_plane(&next->header, PURSUIT_ROLE_COLOR);
	return next->header.motion_kind == first->header.motion_kind &&
		   next->header.planes[b].width == first->header.planes[a].width &&
		   next->header.planes[b].height == first->header.planes[a].height;
}

static int make_room(struct real_frames *real, uint32_t steps, struct error *error)
{
	if (steps <= real->step_capacity)
		return 0;
	struct motion_step *grown = realloc(real->steps, steps * sizeof(*grown));
	if (!grown)
		return error_set(error, -ENOMEM, "out of memory");
	memset(grown + real->step_capacity, 0, (steps - real->step_capacity) * sizeof(*grown));
	real->steps = grown;
	real->step_capacity = steps;
	return 0;
}

/* Loads the frames after the first of the chain into chain[1..]; *count is how many there are. */
static int load_chain(struct real_frames *real, const struct beginning *beginning, uint32_t span, uint32_t wanted,
					  const struct frame **chain, uint32_t *count, struct error *error)
{
	const struct recorded_frames *frames = real->frames;
	int64_t start = (int64_t)frames->frames[beginning->frame].position;
	int64_t way = chain[0]->header.motion_kind == PURSUIT_MOTION_FORWARD ? span : -(int64_t)span;
	int result = make_room(real, wanted, error);
	for (*count = 1; *count < wanted && result == 0; ++*count) {
		struct frame next;
		struct error why;
		int64_t index = find_position(frames, beginning->frame, start + *count * way);
		if (index < 0 || recording_reader_frame(real->reader, frames->frames[index].index, 1, &next, NULL, &why) < 0)
			break;
		if (!continues(chain[0], &next))
			break;
		result = keep_motion(&real->steps[*count], &next, error);
		chain[*count] = &real->steps[*count].frame;
	}
	return result;
}

static int compose(struct real_frames *real, struct frame *frame, const struct frame **chain, uint32_t count,
				   struct error *error)
{
	int index = frame_find_plane(&frame->header, PURSUIT_ROLE_MOTION);
	struct pursuit_plane *plane = &frame->header.planes[index];
	size_t bytes = (size_t)plane->width * plane->height * 2 * sizeof(float);
	if (bytes > real->motion_capacity) {
		free(real->motion);
		real->motion = malloc(bytes);
		real->motion_capacity = real->motion ? bytes : 0;
		if (!real->motion)
			return error_set(error, -ENOMEM, "out of memory for composed motion");
	}
	int result = motion_compose(chain, count, real->motion, error);
	plane->format = PURSUIT_FORMAT_RG32F;
	plane->stride = plane->width * 2 * sizeof(float);
	plane->size = bytes;
	frame->planes[index] = (const uint8_t *)real->motion;
	return result;
}

/* Between this real frame and the one before it there was a cut, even if the cut fell on a frame that is truth. */
static bool cut_before(const struct real_frames *real, const struct beginning *beginning)
{
	const struct recorded_frame *frames = real->frames->frames;
	uint64_t position = frames[beginning->frame].position;
	for (uint32_t i = beginning->frame; position - frames[i].position < beginning->span; i--) {
		if (frames[i].flags & PURSUIT_FRAME_CUT)
			return true;
		if (i == 0)
			break;
	}
	return false;
}

int real_frames_load(struct real_frames *real, const struct beginning *beginning, struct frame *frame,
					 struct error *error)
{
	uint64_t place = real->frames->frames[beginning->frame].index;
	int result = recording_reader_frame(real->reader, place, 0, frame, NULL, error);
	if (result < 0 || beginning->span <= 1)
		return result;
	uint64_t interval = step_interval(real, &frame->header);
	if (cut_before(real, beginning))
		frame->header.flags |= PURSUIT_FRAME_CUT;
	if (frame->header.motion_kind != PURSUIT_MOTION_NONE && !(frame->header.flags & PURSUIT_FRAME_CUT)) {
		const struct frame original = *frame;
		const struct frame *chain[MAX_STEPS] = {&original};
		uint32_t span = step_span(real, &frame->header), count = 1;
		uint32_t wanted = beginning->span % span == 0 ? beginning->span / span : 1;
		result = load_chain(real, beginning, span, wanted < MAX_STEPS ? wanted : MAX_STEPS, chain, &count, error);
		for (uint32_t i = 1; i < count; i++)
			interval += step_interval(real, &chain[i]->header);
		if (result == 0 && count > 1)
			result = compose(real, frame, chain, count, error);
	}
	frame->header.motion_interval_ns = interval;
	frame->header.real_interval_ns = beginning->params.real_interval_ns;
	return result;
}

void real_frames_finish(struct real_frames *real)
{
	for (uint32_t i = 0; i < real->step_capacity; i++)
		free(real->steps[i].bytes);
	free(real->steps);
	free(real->motion);
}
