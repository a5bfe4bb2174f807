/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "schedule.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "daemon/governor.h"
#include "daemon/present/pacer.h"

/* A real frame counts as there, and a recorded frame as the truth of a vblank, this part of a vblank off. */
#define TOLERANCE_PART 20u
/* A stream that pauses longer than this is not displayed meanwhile. */
#define PAUSE_NS UINT64_C(1000000000)

static void *grow(void *array, uint32_t count, uint32_t *capacity, size_t size)
{
	if (count < *capacity)
		return array;
	uint32_t wanted = *capacity ? 2 * *capacity : 256;
	void *grown = realloc(array, wanted * size);
	if (grown)
		*capacity = wanted;
	return grown;
}

int schedule_add_beginning(struct schedule *schedule, const struct beginning *beginning, struct error *error)
{
	struct beginning *grown =
		grow(schedule->beginnings, schedule->beginning_count, &schedule->beginning_capacity, sizeof(*grown));
	if (!grown)
		return error_set(error, -ENOMEM, "out of memory");
	schedule->beginnings = grown;
	grown[schedule->beginning_count] = *beginning;
	grown[schedule->beginning_count].first_showing = schedule->showing_count;
	grown[schedule->beginning_count++].showing_count = 0;
	return 0;
}

int schedule_add_showing(struct schedule *schedule, const struct showing *showing, struct error *error)
{
	struct showing *grown =
		grow(schedule->showings, schedule->showing_count, &schedule->showing_capacity, sizeof(*grown));
	if (!grown)
		return error_set(error, -ENOMEM, "out of memory");
	schedule->showings = grown;
	grown[schedule->showing_count++] = *showing;
	schedule->beginnings[schedule->beginning_count - 1].showing_count++;
	return 0;
}

void schedule_finish(struct schedule *schedule)
{
	free(schedule->beginnings);
	free(schedule->showings);
	*schedule = (struct schedule){0};
}

/* ---- through the pacer ---- */

struct play {
	struct schedule *schedule;
	const struct recorded_frames *frames;
	const struct schedule_params *params;
	struct pacer pacer;
	uint64_t tolerance_ns;
	uint32_t next;  /* the real frame that the pacer is told of next; count: none */
	uint32_t told;  /* told of last */
	uint32_t shown; /* index of the frame shown last */
	uint32_t real_frames;
	bool any;
};

/* The first real frame at or after `from`; the frames of --every are counted from the first that can be real. */
static uint32_t next_real(const struct recorded_frames *frames, uint32_t every, uint32_t from)
{
	uint32_t first = 0;
	while (first < frames->count && (frames->frames[first].flags & PURSUIT_FRAME_TRUTH_ONLY))
		first++;
	for (uint32_t i = from > first ? from : first; i < frames->count; i++) {
		const struct recorded_frame *frame = &frames->frames[i];
		if (!(frame->flags & PURSUIT_FRAME_TRUTH_ONLY) &&
			(frame->position - frames->frames[first].position) % every == 0)
			return i;
	}
	return frames->count;
}

/* The real interval of a frame when only each K-th is real: from the times, else as declared. */
static uint64_t interval_of(const struct play *play, uint32_t index)
{
	const struct recorded_frames *frames = play->frames;
	const struct recorded_frame *frame = &frames->frames[index];
	if (play->params->every == 1)
		return frame->interval_ns;
	if (play->any)
		return frame->time_ns - frames->frames[play->told].time_ns;
	uint32_t after = next_real(frames, play->params->every, index + 1);
	if (after < frames->count)
		return frames->frames[after].time_ns - frame->time_ns;
	return frame->interval_ns * play->params->every;
}

static void tell(struct play *play)
{
	const struct recorded_frame *frame = &play->frames->frames[play->next];
	const struct pacer_frame told = {
		.frame_id = (uint64_t)play->next + 1,
		.time_ns = frame->time_ns,
		.interval_ns = interval_of(play, play->next),
		.intake_ns = frame->time_ns,
	};
	pacer_add_frame(&play->pacer, &told);
	play->told = play->next;
	play->any = true;
	play->real_frames++;
	play->next = next_real(play->frames, play->params->every, play->next + 1);
}

static int show(struct play *play, const struct pacer_decision *decision, uint64_t number, struct error *error)
{
	uint32_t frame = (uint32_t)(decision->frame_id - 1);
	bool first = play->schedule->beginning_count == 0 || frame != play->shown;
	play->shown = frame;
	if (first) {
		const struct beginning beginning = {
			.frame = frame,
			.span = play->params->every,
			.params = {decision->n, decision->last_phase, decision->interval_ns},
		};
		int result = schedule_add_beginning(play->schedule, &beginning, error);
		if (result < 0)
			return result;
	}
	const uint64_t later = play->schedule->beginnings[play->schedule->beginning_count - 1].showing_count;
	const struct showing showing = {
		.number = number,
		.show = decision->show == PACER_IN_BETWEEN ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL,
		.repeat = !first && (decision->show == PACER_REPEAT || !governor_draws(play->params->level, later)),
		.phase = decision->phase,
		.moment_ns = decision->target_ns,
		.truth = recorded_frames_find(play->frames, decision->target_ns, play->tolerance_ns),
	};
	return schedule_add_showing(play->schedule, &showing, error);
}

/* The last real frame is displayed for as long as one is expected to be. */
static uint64_t end_of(const struct play *play, uint64_t period_ns)
{
	uint64_t last = play->frames->frames[play->told].time_ns;
	uint64_t interval = play->pacer.interval_ns > period_ns ? play->pacer.interval_ns : period_ns;
	return last + (interval < PAUSE_NS ? interval : PAUSE_NS) - period_ns / 2;
}

static uint64_t skip_pause(const struct play *play, uint64_t vblank)
{
	uint64_t now = pacer_vblank_time(&play->pacer, vblank);
	uint64_t told = play->frames->frames[play->told].time_ns;
	if (play->next >= play->frames->count || now < told + PAUSE_NS)
		return vblank;
	uint64_t next = play->frames->frames[play->next].time_ns;
	uint64_t resumed = pacer_vblank_at_or_after(&play->pacer, next - play->tolerance_ns);
	return resumed > vblank ? resumed : vblank;
}

int schedule_play(struct schedule *schedule, const struct recorded_frames *frames, const struct schedule_params *params,
				  struct error *error)
{
	struct play play = {.schedule = schedule, .frames = frames, .params = params};
	uint64_t period_ns = UINT64_C(1000000000) * params->refresh.denominator / params->refresh.numerator;
	*schedule = (struct schedule){0};
	play.tolerance_ns = period_ns / TOLERANCE_PART;
	play.next = next_real(frames, params->every, 0);
	if (play.next >= frames->count)
		return error_set(error, -ENODATA, "no frame of this recording can be a real one: all are truth only");
	pacer_init(&play.pacer, &(struct pacer_params){
								.grid = {.numerator = params->refresh.numerator,
										 .denominator = params->refresh.denominator,
										 .epoch_ns = frames->frames[play.next].time_ns},
								.fixed_delay = true,
							});
	uint64_t number = 0;
	for (uint64_t vblank = 0;; vblank++) {
		if (play.any)
			vblank = skip_pause(&play, vblank);
		uint64_t now = pacer_vblank_time(&play.pacer, vblank);
		while (play.next < frames->count && frames->frames[play.next].time_ns <= now + play.tolerance_ns)
			tell(&play);
		if (play.next >= frames->count && now >= end_of(&play, period_ns))
			break;
		struct pacer_decision decision = pacer_decide(&play.pacer, vblank);
		if (decision.show == PACER_NOTHING)
			continue;
		int result = show(&play, &decision, number++, error);
		if (result < 0)
			return result;
	}
	schedule->lost_real_frames = play.real_frames - schedule->beginning_count;
	schedule->duration_ns = pacer_vblank_time(&play.pacer, number) - play.pacer.params.grid.epoch_ns;
	return 0;
}

static uint64_t time_of(const struct recorded_frames *frames, const struct beginning *beginning)
{
	return frames->frames[beginning->frame].time_ns;
}

static uint64_t between(uint64_t from, uint64_t to, double share)
{
	const double clamped = share > 0.0 ? share < 1.0 ? share : 1.0 : 0.0;
	return from + (uint64_t)(clamped * (double)(to - from) + 0.5);
}

void schedule_delay(struct schedule *schedule, const struct recorded_frames *frames, struct arg_rate refresh)
{
	const uint64_t tolerance_ns = UINT64_C(1000000000) * refresh.denominator / refresh.numerator / TOLERANCE_PART;
	for (uint32_t b = 0; b < schedule->beginning_count; b++) {
		const struct beginning *now = &schedule->beginnings[b];
		const struct beginning *before = b ? now - 1 : now;
		for (uint32_t i = 0; i < now->showing_count; i++) {
			struct showing *showing = &schedule->showings[now->first_showing + i];
			showing->moment_ns = between(time_of(frames, before), time_of(frames, now), showing->phase);
			showing->truth = b ? recorded_frames_find(frames, showing->moment_ns, tolerance_ns) : -1;
		}
	}
}

/* ---- each frame predicts the next ---- */

int schedule_predict(struct schedule *schedule, const struct recorded_frames *frames,
					 const struct schedule_params *params, struct error *error)
{
	*schedule = (struct schedule){0};
	for (uint32_t i = 0; i + 1 < frames->count; i++) {
		const struct recorded_frame *frame = &frames->frames[i], *next = frame + 1;
		if ((frame->flags & PURSUIT_FRAME_TRUTH_ONLY) || !frame->motion || next->position != frame->position + 1)
			continue;
		const struct beginning beginning = {
			.frame = i,
			.span = 1,
			.params = {2, 1.0, next->time_ns - frame->time_ns},
		};
		const struct showing showing = {
			.number = params->numbered ? next->frame_id - 1 + params->number_offset : next->index,
			.show = ENGINE_SHOW_IN_BETWEEN,
			.phase = 1.0,
			.moment_ns = next->time_ns,
			.truth = (int64_t)i + 1,
		};
		int result = schedule_add_beginning(schedule, &beginning, error);
		if (result == 0)
			result = schedule_add_showing(schedule, &showing, error);
		if (result < 0)
			return result;
		schedule->duration_ns += beginning.params.real_interval_ns;
	}
	if (schedule->beginning_count == 0)
		return error_set(error, -ENODATA, "no frame of this recording has motion and a frame after it to predict");
	return 0;
}
