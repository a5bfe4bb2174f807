/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Streams of an output, and the settings of the picture that go with them. On main. */

#include <stdio.h>
#include <string.h>

#include "daemon/output_state.h"

void output_wish_settings(struct output *output, const struct settings *settings)
{
	output->wished = *settings;
	snprintf(output->info.method, sizeof(output->info.method), "%s", settings->method);
	output->settings_changed = true;
}

/* The settings for this stream (NULL: none), NULL if they are those of now. Only main changes the list, so no lock. */
static const struct settings *settings_for(const struct output *output, const struct stream *stream)
{
	if (!output->params.shown)
		return NULL;
	return output->params.shown(output->params.data, stream ? stream->application : "");
}

/*
 * With the lock: the last one is shown, and all are told. The settings (NULL: as before) reach the render thread
 * together with the stream, so that no frame is made with another's.
 */
static void streams_have_changed(struct output *output, const struct settings *settings)
{
	if (settings)
		output_wish_settings(output, settings);
	for (uint32_t i = 0; i < output->stream_count; i++)
		__atomic_store_n(&output->streams[i]->control->background, i + 1 < output->stream_count, __ATOMIC_RELEASE);
	output->streams_changed = true;
	output_wake_locked(output);
}

bool output_focus(struct output *output, uint64_t client_id)
{
	uint32_t i = output->stream_count;
	while (i > 0 && output->streams[i - 1]->client_id != client_id)
		i--;
	if (i == 0)
		return false;
	struct stream *stream = output->streams[i - 1];
	const struct settings *settings = settings_for(output, stream);
	pthread_mutex_lock(&output->lock);
	memmove(&output->streams[i - 1], &output->streams[i], (output->stream_count - i) * sizeof(output->streams[0]));
	output->streams[output->stream_count - 1] = stream;
	streams_have_changed(output, settings);
	pthread_mutex_unlock(&output->lock);
	return true;
}

bool output_get_shown(struct output *output, uint64_t *client_id, uint64_t *stream_id)
{
	pthread_mutex_lock(&output->lock);
	const bool any = output->stream_count > 0;
	if (any) {
		*client_id = output->streams[output->stream_count - 1]->client_id;
		*stream_id = output->streams[output->stream_count - 1]->stream_id;
	}
	pthread_mutex_unlock(&output->lock);
	return any;
}

bool output_add_stream(struct output *output, struct stream *stream)
{
	if (output->stream_count == OUTPUT_STREAMS)
		return false;
	const struct settings *settings = settings_for(output, stream);
	pthread_mutex_lock(&output->lock);
	output->streams[output->stream_count++] = stream_reference(stream);
	streams_have_changed(output, settings);
	pthread_mutex_unlock(&output->lock);
	return true;
}

void output_remove_stream(struct output *output, struct stream *stream)
{
	const uint32_t count = output->stream_count;
	uint32_t i = 0;
	atomic_store(&stream->ended, true);
	while (i < count && output->streams[i] != stream)
		i++;
	if (i == count)
		return;
	const uint32_t next = i + 1 == count ? count - 1 : count; /* how many stay up to the one that is shown then */
	const struct settings *settings = settings_for(output, next ? output->streams[next - 1] : NULL);
	pthread_mutex_lock(&output->lock);
	output->stream_count--;
	memmove(&output->streams[i], &output->streams[i + 1], (output->stream_count - i) * sizeof(output->streams[0]));
	streams_have_changed(output, settings);
	pthread_mutex_unlock(&output->lock);
	stream_release(&stream);
}

void output_set_settings(struct output *output, const struct settings *settings)
{
	pthread_mutex_lock(&output->lock);
	output_wish_settings(output, settings);
	output_wake_locked(output);
	pthread_mutex_unlock(&output->lock);
}
