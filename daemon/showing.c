/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/showing.h"

#include <stdlib.h>
#include <string.h>

void showing_init(struct showing *showing, struct stats *stats)
{
	memset(showing, 0, sizeof(*showing));
	showing->stats = stats;
}

void showing_finish(struct showing *showing)
{
	for (uint32_t i = 0; i < SHOWING_FRAMES; i++)
		stream_release(&showing->frames[i].stream);
}

/* ---- frames and their reports ---- */

static void close_frame(struct showing *showing, struct showing_frame *frame)
{
	if (frame->group == 0)
		return;
	if (frame->report.state == PURSUIT_FEEDBACK_REFUSED) {
		showing->stats->refused_frames++;
	} else if (frame->report.flip_ns != 0) {
		frame->report.state = PURSUIT_FEEDBACK_SHOWN;
		frame->report.next_submit_ns = showing->next_submit_ns;
	} else {
		frame->report.state = PURSUIT_FEEDBACK_REPLACED;
		showing->stats->lost_real_frames++;
		if (frame->stream)
			atomic_fetch_add(&frame->stream->counters.lost_frames, 1);
	}
	if (frame->stream)
		stream_feedback(frame->stream, &frame->report);
	stream_release(&frame->stream);
	frame->group = 0;
}

/* The first group that may have a frame still, of those before `group`. */
static uint64_t first_group(uint64_t group)
{
	return group > SHOWING_FRAMES ? group - SHOWING_FRAMES : 1;
}

void showing_close_frames(struct showing *showing, uint64_t group)
{
	/* In the order of groups, so that the client reads them in order. */
	for (uint64_t g = first_group(group); g < group; g++)
		if (showing->frames[g % SHOWING_FRAMES].group == g)
			close_frame(showing, &showing->frames[g % SHOWING_FRAMES]);
}

static bool is_unshown(const struct showing_frame *frame)
{
	return frame->group != 0 && frame->report.flip_ns == 0 && frame->report.state != PURSUIT_FEEDBACK_REFUSED;
}

void showing_settle_frames(struct showing *showing, uint64_t group)
{
	uint64_t g = first_group(group);
	for (; g < group; g++) {
		const struct showing_frame *frame = &showing->frames[g % SHOWING_FRAMES];
		if (frame->group == g && frame->queued && is_unshown(frame))
			break;
	}
	showing->settling = group;
	showing_close_frames(showing, g);
}

bool showing_awaits(const struct showing *showing)
{
	for (uint32_t i = 0; i < SHOWING_FRAMES; i++)
		if (showing->frames[i].queued && is_unshown(&showing->frames[i]))
			return true;
	return false;
}

bool showing_has_unshown(const struct showing *showing)
{
	for (uint32_t i = 0; i < SHOWING_FRAMES; i++)
		if (is_unshown(&showing->frames[i]))
			return true;
	return false;
}

void showing_forget_ended(struct showing *showing)
{
	for (uint32_t i = 0; i < SHOWING_FRAMES; i++)
		if (showing->frames[i].stream && atomic_load(&showing->frames[i].stream->ended))
			stream_release(&showing->frames[i].stream);
}

void showing_add_frame(struct showing *showing, uint64_t group, struct stream *stream, const struct frame *frame)
{
	struct showing_frame *entry = &showing->frames[group % SHOWING_FRAMES];
	close_frame(showing, entry);
	*entry = (struct showing_frame){
		.group = group,
		.stream = stream_reference(stream),
		.report = {.frame_id = frame->header.frame_id,
				   .submit_ns = frame->header.submit_ns,
				   .intake_ns = frame->intake_ns},
	};
}

struct showing_frame *showing_find_frame(struct showing *showing, uint64_t group)
{
	struct showing_frame *frame = &showing->frames[group % SHOWING_FRAMES];
	return frame->group == group && group != 0 ? frame : NULL;
}

void showing_add_picture(struct showing *showing, const struct showing_picture *picture)
{
	showing->pictures[picture->serial % SHOWING_PICTURES] = *picture;
}

void showing_set_ready(struct showing *showing, uint64_t serial, uint64_t ready_ns)
{
	struct showing_picture *picture = &showing->pictures[serial % SHOWING_PICTURES];
	if (picture->serial == serial)
		picture->ready_ns = ready_ns;
}

void showing_plan(struct showing *showing, uint64_t vblank, enum showing_plan plan)
{
	showing->plans[vblank % SHOWING_VBLANKS].vblank = vblank;
	showing->plans[vblank % SHOWING_VBLANKS].plan = plan;
}

/* ---- flips ---- */

static enum showing_plan plan_of(const struct showing *showing, uint64_t vblank)
{
	const uint32_t index = (uint32_t)(vblank % SHOWING_VBLANKS);
	return showing->plans[index].vblank == vblank ? showing->plans[index].plan : SHOWING_UNDECIDED;
}

static void count_due(struct showing *showing, const struct presenter_flip *flip, bool on_time)
{
	struct stats *stats = showing->stats;
	const uint64_t before = showing->last_target_ns;
	stats->vblanks_due += 1 + (before ? flip->skipped : 0);
	stats->vblanks_on_time += on_time && !flip->late;
	stats->late_flips += flip->late;
	/* By the grid: a flip that comes late takes nothing from the time of the next. */
	stats->active_ns += before && flip->target_ns > before ? flip->target_ns - before : (uint64_t)showing->period_ns;
	histogram_add(&stats->spans.flip_error, llabs((int64_t)(flip->flip_ns - flip->target_ns)));
	showing->last_target_ns = flip->target_ns;
}

static void count_first_flip(struct showing *showing, struct showing_frame *frame, const struct presenter_flip *flip,
							 const struct showing_picture *picture)
{
	struct pursuit_feedback *report = &frame->report;
	report->ready_ns = picture->ready_ns;
	report->flip_ns = flip->flip_ns;
	report->target_ns = flip->target_ns;
	report->vblank = flip->vblank;
	showing->stats->real_frames++;
	if (report->submit_ns != 0 && flip->flip_ns > report->submit_ns)
		histogram_add(&showing->stats->spans.submit_to_flip, (int64_t)(flip->flip_ns - report->submit_ns));
}

/* A picture that was queued for this vblank came to be shown. */
static enum stats_show count_picture(struct showing *showing, const struct presenter_flip *flip,
									 const struct showing_picture *picture, struct showing_frame *frame)
{
	switch (picture->show) {
	case STATS_REAL:
		if (frame)
			count_first_flip(showing, frame, flip, picture);
		break;
	case STATS_IN_BETWEEN:
		showing->stats->in_between_frames++;
		if (frame)
			frame->report.in_betweens++;
		break;
	case STATS_REPEAT: /* the plain picture of a pause: it may have come before the real one could be shown */
		if (frame && is_unshown(frame))
			count_first_flip(showing, frame, flip, picture);
		showing->last_target_ns = 0;
		return STATS_REPEAT;
	case STATS_STANDBY:
	case STATS_KEPT:
		showing->last_target_ns = 0;
		return STATS_REPEAT;
	}
	showing->stats->displayed_frames++;
	count_due(showing, flip, true);
	return picture->show;
}

static void count_late(struct showing *showing, enum showing_plan plan, struct showing_frame *frame)
{
	if (plan == SHOWING_REAL)
		return; /* counted where it is shown: late, never lost */
	showing->stats->late_in_betweens++;
	if (!frame)
		return;
	frame->report.late_in_betweens++;
	showing->stats->unbalanced_vblanks += frame->boosted;
}

/* No picture was queued for this vblank. */
static enum stats_show count_kept(struct showing *showing, const struct presenter_flip *flip,
								  struct showing_frame *frame)
{
	const enum showing_plan plan = plan_of(showing, flip->vblank);
	if (plan == SHOWING_PAUSE || (plan == SHOWING_UNDECIDED && showing->pausing)) {
		showing->last_target_ns = 0;
		return STATS_REPEAT;
	}
	if (flip->shown == PRESENTER_KEPT && plan == SHOWING_REPEAT) {
		showing->stats->repeated_frames++;
		showing->stats->displayed_frames++;
		count_due(showing, flip, true);
		return STATS_REPEAT;
	}
	count_late(showing, plan, frame);
	count_due(showing, flip, false);
	if (flip->shown == PRESENTER_KEPT)
		return STATS_KEPT;
	showing->stats->standby_frames++;
	showing->stats->displayed_frames++;
	return STATS_STANDBY;
}

void showing_flip(struct showing *showing, const struct presenter_flip *flip)
{
	const struct showing_picture *picture = &showing->pictures[flip->serial % SHOWING_PICTURES];
	struct showing_frame *frame = showing_find_frame(showing, flip->group);
	const bool known = flip->serial != 0 && picture->serial == flip->serial;
	struct stats_row row = {.vblank = flip->vblank, .target_ns = flip->target_ns, .flip_ns = flip->flip_ns};

	if (flip->group != showing->front_group) {
		showing_close_frames(showing, flip->group);
		showing->front_group = flip->group;
	}
	if (flip->shown == PRESENTER_PICTURE && known)
		row.show = count_picture(showing, flip, picture, frame);
	else
		row.show = count_kept(showing, flip, frame);
	if (known) {
		row.ready_ns = picture->ready_ns;
		row.phase = picture->phase;
	}
	if (frame) {
		frame->report.vblanks++;
		row.frame_id = frame->report.frame_id;
	}
	stats_add_row(showing->stats, &row);
}
