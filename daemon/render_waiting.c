/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Frames that are not shown, or not yet: each is answered. */

#include <errno.h>

#include "daemon/render.h"

/* The newest frame of a stream, and what its client is told unless it is shown. Is there one? */
static bool take(struct render *render, struct stream *stream, struct pursuit_feedback *report)
{
	struct frame frame;
	struct refusal refusal;
	const int result = stream_take(stream, clock_now(render->clock), &frame, &refusal);
	if (result < 0)
		render->owner.report(render->owner.data, result == -EPROTO ? OUTPUT_STREAM_BROKEN : OUTPUT_FRAME_REFUSED,
							 stream, &refusal);
	if (result == 1)
		*report = (struct pursuit_feedback){.frame_id = frame.header.frame_id,
											.submit_ns = frame.header.submit_ns,
											.intake_ns = frame.intake_ns,
											.state = PURSUIT_FEEDBACK_REPLACED};
	return result == 1;
}

void render_skip_frames(struct render *render, struct stream *stream)
{
	struct pursuit_feedback report;
	if (take(render, stream, &report))
		stream_feedback(stream, &report);
}

void render_keep_newest(struct render *render)
{
	struct pursuit_feedback report;
	if (!take(render, render->stream, &report))
		return;
	render_answer_waiting(render);
	render->waiting.stream = stream_reference(render->stream);
	render->waiting.report = report;
}

void render_answer_waiting(struct render *render)
{
	if (render->waiting.stream && !atomic_load(&render->waiting.stream->ended))
		stream_feedback(render->waiting.stream, &render->waiting.report);
	stream_release(&render->waiting.stream);
}

void render_show_waiting(struct render *render)
{
	if (!render->waiting.stream || render->waiting.stream != render->stream ||
		render->waiting.report.frame_id != render->frame.header.frame_id)
		return;
	showing_add_frame(&render->showing, render->group, render->stream, &render->frame);
	stream_release(&render->waiting.stream);
}
