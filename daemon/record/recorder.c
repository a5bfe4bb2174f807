/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/record/recorder.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define DEFAULT_QUEUE_BYTES ((uint64_t)512 << 20)
#define NICENESS 10

struct item {
	struct item *next;
	uint64_t time_ns;
	uint64_t bytes; /* in use */
	uint64_t room;
	bool is_settings;
	uint8_t data[];
};

struct recorder {
	pthread_t thread;
	pthread_mutex_t lock; /* held for a few instructions only, never across a copy or a write */
	pthread_cond_t wake;
	struct item *first, **last; /* the queue */
	struct item *spare;         /* kept for the next frames: fresh pages cost the pushing thread more than the copy */
	uint64_t spare_bytes;       /* with queued_bytes at most queue_bytes */
	bool closing;
	uint64_t queue_bytes;
	struct recorder_stats stats;
	int result; /* of the first failure */
	bool adaptive;
	struct recording_writer *writer; /* of the thread while it runs */
};

/* ---- the thread that writes ---- */

static void set_failed(struct recorder *recorder, int result, const struct error *error)
{
	pthread_mutex_lock(&recorder->lock);
	if (!recorder->stats.failed) {
		recorder->stats.failed = true;
		recorder->result = result;
		snprintf(recorder->stats.text, sizeof(recorder->stats.text), "%s", error->text);
	}
	pthread_mutex_unlock(&recorder->lock);
}

/* The fuller the queue, the less is spent on compression. */
static void choose_level(struct recorder *recorder, uint64_t queued)
{
	const uint64_t full = recorder->queue_bytes;
	recording_writer_set_level(recorder->writer, queued > full / 2 ? -20 : queued > full / 8 ? -5 : 1);
}

static void write_item(struct recorder *recorder, const struct item *item)
{
	struct error error = {""};
	int result;
	if (item->is_settings)
		result = recording_writer_settings(recorder->writer, (const char *)item->data, item->time_ns, &error);
	else
		result = recording_writer_packed(recorder->writer, item->data, item->bytes, item->time_ns, &error);
	if (result < 0)
		set_failed(recorder, result, &error);
}

/* Takes the item out of the books, and keeps its memory for the next one or frees it. */
static void retire(struct recorder *recorder, struct item *item)
{
	recorder->stats.queued_bytes -= item->bytes;
	recorder->stats.queued_frames -= item->is_settings ? 0 : 1;
	recorder->stats.frames_dropped += recorder->stats.failed && !item->is_settings;
	recording_writer_counts(recorder->writer, &recorder->stats.bytes_written, &recorder->stats.frames_written);
	if (!item->is_settings &&
		recorder->spare_bytes + item->room + recorder->stats.queued_bytes <= recorder->queue_bytes) {
		item->next = recorder->spare;
		recorder->spare = item;
		recorder->spare_bytes += item->room;
	} else {
		free(item);
	}
}

static void *write_queue(void *data)
{
	struct recorder *recorder = data;
	pthread_setname_np(pthread_self(), "recorder");
	setpriority(PRIO_PROCESS, (id_t)gettid(), NICENESS);
	pthread_mutex_lock(&recorder->lock);
	for (;;) {
		while (!recorder->first && !recorder->closing)
			pthread_cond_wait(&recorder->wake, &recorder->lock);
		struct item *item = recorder->first;
		if (!item)
			break;
		recorder->first = item->next;
		if (!recorder->first)
			recorder->last = &recorder->first;
		const uint64_t queued = recorder->stats.queued_bytes;
		const bool failed = recorder->stats.failed;
		pthread_mutex_unlock(&recorder->lock);
		if (recorder->adaptive)
			choose_level(recorder, queued);
		if (!failed)
			write_item(recorder, item);
		pthread_mutex_lock(&recorder->lock);
		retire(recorder, item);
	}
	pthread_mutex_unlock(&recorder->lock);
	return NULL;
}

/* ---- the thread that pushes ---- */

/* Memory for `bytes`, from the spare ones if one is large enough. Called with the lock held. */
static struct item *take_spare(struct recorder *recorder, uint64_t bytes)
{
	for (struct item **link = &recorder->spare; *link; link = &(*link)->next) {
		struct item *item = *link;
		if (item->room < bytes)
			continue;
		*link = item->next;
		recorder->spare_bytes -= item->room;
		return item;
	}
	/* Frames have grown: what is kept is of no use. */
	while (recorder->spare) {
		struct item *item = recorder->spare;
		recorder->spare = item->next;
		free(item);
	}
	recorder->spare_bytes = 0;
	return NULL;
}

static bool has_room(const struct recorder *recorder, uint64_t bytes)
{
	const struct recorder_stats *stats = &recorder->stats;
	if (stats->failed || bytes == 0)
		return false;
	if (stats->queued_frames == 0)
		return true;
	return stats->queued_bytes <= recorder->queue_bytes && bytes <= recorder->queue_bytes - stats->queued_bytes;
}

/* Reserves room in the queue and memory; NULL, and counted, if there is none. */
static struct item *begin_push(struct recorder *recorder, uint64_t bytes, bool is_settings)
{
	struct item *item = NULL;
	pthread_mutex_lock(&recorder->lock);
	const bool room = has_room(recorder, bytes);
	if (room) {
		recorder->stats.queued_bytes += bytes;
		recorder->stats.queued_frames += is_settings ? 0 : 1;
		item = take_spare(recorder, bytes);
	}
	pthread_mutex_unlock(&recorder->lock);
	if (room && !item) {
		item = malloc(sizeof(*item) + bytes);
		if (item)
			item->room = bytes;
	}
	if (!item) {
		pthread_mutex_lock(&recorder->lock);
		if (room) {
			recorder->stats.queued_bytes -= bytes;
			recorder->stats.queued_frames -= is_settings ? 0 : 1;
		}
		recorder->stats.frames_dropped += is_settings ? 0 : 1;
		pthread_mutex_unlock(&recorder->lock);
		return NULL;
	}
	item->bytes = bytes;
	item->is_settings = is_settings;
	return item;
}

static void end_push(struct recorder *recorder, struct item *item, uint64_t time_ns)
{
	item->next = NULL;
	item->time_ns = time_ns;
	pthread_mutex_lock(&recorder->lock);
	*recorder->last = item;
	recorder->last = &item->next;
	pthread_cond_signal(&recorder->wake);
	pthread_mutex_unlock(&recorder->lock);
}

bool recorder_push(struct recorder *recorder, const struct frame *frame, uint64_t time_ns)
{
	struct item *item = begin_push(recorder, recording_packed_bytes(frame), false);
	if (!item)
		return false;
	recording_pack(frame, item->data);
	end_push(recorder, item, time_ns);
	return true;
}

bool recorder_settings(struct recorder *recorder, const char *text, uint64_t time_ns)
{
	const size_t bytes = strlen(text) + 1;
	struct item *item = begin_push(recorder, bytes, true);
	if (!item)
		return false;
	memcpy(item->data, text, bytes);
	end_push(recorder, item, time_ns);
	return true;
}

void recorder_stats(struct recorder *recorder, struct recorder_stats *stats)
{
	pthread_mutex_lock(&recorder->lock);
	*stats = recorder->stats;
	pthread_mutex_unlock(&recorder->lock);
}

/* ---- life ---- */

/* Signals are for other threads; SIGXFSZ, blocked, makes a file size limit an error instead of a death. */
static int start_thread(struct recorder *recorder)
{
	sigset_t all, before;
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	const int result = pthread_create(&recorder->thread, NULL, write_queue, recorder);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return -result;
}

struct recorder *recorder_create(const struct recorder_params *params, struct error *error)
{
	struct recorder *recorder = calloc(1, sizeof(*recorder));
	if (!recorder) {
		if (params->writer.fd > 0)
			close(params->writer.fd);
		error_set(error, -ENOMEM, "recording: out of memory");
		return NULL;
	}
	recorder->queue_bytes = params->queue_bytes ? params->queue_bytes : DEFAULT_QUEUE_BYTES;
	recorder->adaptive = params->writer.level == 0;
	recorder->last = &recorder->first;
	recorder->writer = recording_writer_create(&params->writer, error);
	if (!recorder->writer) {
		free(recorder);
		return NULL;
	}
	recording_writer_counts(recorder->writer, &recorder->stats.bytes_written, &recorder->stats.frames_written);
	pthread_mutex_init(&recorder->lock, NULL);
	pthread_cond_init(&recorder->wake, NULL);
	const int result = start_thread(recorder);
	if (result < 0) {
		struct error ignored;
		recording_writer_close(&recorder->writer, &ignored);
		pthread_cond_destroy(&recorder->wake);
		pthread_mutex_destroy(&recorder->lock);
		free(recorder);
		error_set(error, result, "recording: no thread to write it: %s", strerror(-result));
		return NULL;
	}
	return recorder;
}

int recorder_destroy(struct recorder **recorder, struct recorder_stats *last, struct error *error)
{
	struct recorder *r = *recorder;
	struct error closing = {""};
	if (!r)
		return 0;
	*recorder = NULL;
	pthread_mutex_lock(&r->lock);
	r->closing = true;
	pthread_cond_signal(&r->wake);
	pthread_mutex_unlock(&r->lock);
	pthread_join(r->thread, NULL);

	recording_writer_counts(r->writer, &r->stats.bytes_written, &r->stats.frames_written);
	int result = recording_writer_close(&r->writer, &closing);
	if (result < 0)
		set_failed(r, result, &closing);
	if (r->stats.failed)
		result = error_set(error, r->result, "%s", r->stats.text);
	if (last)
		*last = r->stats;
	while (r->spare) {
		struct item *item = r->spare;
		r->spare = item->next;
		free(item);
	}
	pthread_cond_destroy(&r->wake);
	pthread_mutex_destroy(&r->lock);
	free(r);
	return result;
}
