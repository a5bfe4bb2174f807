/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/fuzz/fake-output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "tests/fuzz/fuzz.h"

#define EVENTS 64u

struct output {
	struct clock *clock;
	int event_fd;
	struct stream *streams[OUTPUT_STREAMS];
	uint32_t stream_count;
	struct output_event events[EVENTS];
	uint32_t event_count;
	struct recorder *recorder;
};

struct output *fake_output_create(struct clock *clock)
{
	struct output *output = calloc(1, sizeof(*output));
	FUZZ_EXPECT(output != NULL);
	output->clock = clock;
	output->event_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	return output;
}

void fake_output_destroy(struct output **output)
{
	FUZZ_EXPECT((*output)->stream_count == 0 && !(*output)->recorder);
	close((*output)->event_fd);
	free(*output);
	*output = NULL;
}

uint32_t fake_output_stream_count(const struct output *output)
{
	return output->stream_count;
}

/* ---- the render thread's part ---- */

static void push_event(struct output *output, enum output_event_kind kind, const struct stream *stream,
					   const struct refusal *refusal)
{
	const uint64_t one = 1;
	if (output->event_count < EVENTS)
		output->events[output->event_count++] =
			(struct output_event){kind, stream->client_id, stream->stream_id, stream->number, *refusal};
	FUZZ_EXPECT(write(output->event_fd, &one, sizeof(one)) == (ssize_t)sizeof(one));
}

static void take_one(struct output *output, struct stream *stream)
{
	struct frame frame;
	struct refusal refusal;
	struct pursuit_feedback report = {.state = PURSUIT_FEEDBACK_SHOWN};
	const int result =
		atomic_load(&stream->ended) ? 0 : stream_take(stream, clock_now(output->clock), &frame, &refusal);
	if (result == 1) {
		for (uint32_t i = 0; i < frame.header.plane_count; i++)
			fuzz_touch(frame.planes[i], frame.header.planes[i].size);
		if (output->recorder)
			recorder_push(output->recorder, &frame, frame.intake_ns);
		report.frame_id = frame.header.frame_id;
		stream_feedback(stream, &report);
	} else if (result == -EPROTO) {
		atomic_store(&stream->ended, true);
		push_event(output, OUTPUT_STREAM_BROKEN, stream, &refusal);
	} else if (result < 0) {
		push_event(output, OUTPUT_FRAME_REFUSED, stream, &refusal);
	}
}

void fake_output_take(struct output *output)
{
	for (uint32_t i = 0; i < output->stream_count; i++)
		take_one(output, output->streams[i]);
}

/* ---- daemon/output.h ---- */

bool output_add_stream(struct output *output, struct stream *stream)
{
	if (output->stream_count == OUTPUT_STREAMS)
		return false;
	output->streams[output->stream_count++] = stream_reference(stream);
	return true;
}

void output_remove_stream(struct output *output, struct stream *stream)
{
	atomic_store(&stream->ended, true);
	for (uint32_t i = 0; i < output->stream_count; i++) {
		if (output->streams[i] != stream)
			continue;
		stream_release(&output->streams[i]);
		output->stream_count--;
		memmove(&output->streams[i], &output->streams[i + 1], (output->stream_count - i) * sizeof(output->streams[0]));
	}
}

void output_set_settings(struct output *output, const struct settings *settings)
{
}

bool output_focus(struct output *output, uint64_t client_id)
{
	return output->stream_count > 0;
}

bool output_get_shown(struct output *output, uint64_t *client_id, uint64_t *stream_id)
{
	if (output->stream_count > 0) {
		*client_id = output->streams[0]->client_id;
		*stream_id = output->streams[0]->stream_id;
	}
	return output->stream_count > 0;
}

void output_press_key(struct output *output, const struct presenter_key *key)
{
}

void output_wake(struct output *output)
{
}

uint64_t output_beats(const struct output *output)
{
	return 0;
}

uint64_t output_rounds(const struct output *output)
{
	return 0;
}

int output_event_fd(const struct output *output)
{
	return output->event_fd;
}

bool output_next_event(struct output *output, struct output_event *event)
{
	uint64_t count;
	if (output->event_count == 0)
		return read(output->event_fd, &count, sizeof(count)) < 0 && false;
	*event = output->events[0];
	output->event_count--;
	memmove(&output->events[0], &output->events[1], output->event_count * sizeof(output->events[0]));
	return true;
}

struct recorder *output_set_recorder(struct output *output, struct recorder *recorder)
{
	struct recorder *before = output->recorder;
	output->recorder = recorder;
	return before;
}

void output_get_info(struct output *output, struct output_info *info)
{
	*info = (struct output_info){.presenter = "fake", .renderer = "fake", .context = "fake", .grid = {120, 1, 0}};
}

void output_get_stats(struct output *output, struct stats *stats)
{
	memset(stats, 0, sizeof(*stats));
}
