/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/output_state.h"

#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

/* ---- the mailbox ---- */

void output_wake_locked(struct output *output)
{
	output->woken = true;
	pthread_cond_signal(&output->wake);
}

static void wake_main(const struct output *output)
{
	const uint64_t one = 1;
	/* A full counter wakes just as well. */
	if (write(output->event_fd, &one, sizeof(one)) < 0 && errno != EAGAIN)
		log_error(output->params.log, "eventfd: %s", strerror(errno));
}

void output_complain(struct output *output, enum output_event_kind kind, struct stream *stream,
					 const struct refusal *refusal)
{
	const bool ends = kind == OUTPUT_STREAM_BROKEN;
	pthread_mutex_lock(&output->lock);
	if (ends || !stream->complaint.ends)
		stream->complaint = (struct stream_complaint){true, ends, *refusal};
	pthread_mutex_unlock(&output->lock);
	wake_main(output);
}

/* ---- called by the display ---- */

/* On main. */
static void on_change(void *data, struct presenter *presenter, bool lost)
{
	struct output *output = data;
	struct output_presenter *wished = &output->wished_presenter;
	pthread_mutex_lock(&output->lock);
	*wished = (struct output_presenter){.presenter = presenter, .lost = lost, .answer = wished->presenter != NULL};
	snprintf(wished->name, sizeof(wished->name), "%s", presenter ? presenter->impl->name : "none");
	snprintf(wished->display, sizeof(wished->display), "%s",
			 presenter && presenter->impl->get_display ? presenter->impl->get_display(presenter) : "");
	output->presenter_changed = true;
	output_wake_locked(output);
	pthread_mutex_unlock(&output->lock);
}

static void on_key(void *data, const struct presenter_key *key)
{
	output_press_key(data, key);
}

/* With the lock: a vblank at which nothing was to be shown waits for the render thread if that wakes soon by itself. */
static bool can_wait(const struct output *output, const struct presenter_flip *flip)
{
	return output->wakes_soon && flip->shown == PRESENTER_KEPT && !flip->late &&
		   output->flip_count < OUTPUT_FLIPS / 2 && !lab_is_active(output->params.lab);
}

/* On the presenter's thread. */
static void on_flip(void *data, const struct presenter *presenter, const struct presenter_flip *flip)
{
	struct output *output = data;
	atomic_fetch_add(&output->flipping, 1);
	const bool in_use = atomic_load(&output->presenter) == presenter;
	if (in_use)
		lab_flip(output->params.lab, flip);
	atomic_fetch_sub(&output->flipping, 1);
	if (!in_use)
		return;
	pthread_mutex_lock(&output->lock);
	if (output->flip_count < OUTPUT_FLIPS)
		output->flips[output->flip_count++] = (struct output_flip){presenter, *flip};
	else /* a render thread that hangs this long has more to worry about */
		output->flips[OUTPUT_FLIPS - 1].flip.skipped++;
	const bool wakes = !can_wait(output, flip);
	output->woken |= wakes;
	pthread_mutex_unlock(&output->lock);
	/* Who is woken wants the lock first of all. */
	if (wakes)
		pthread_cond_signal(&output->wake);
}

/* ---- main thread ---- */

/* Nothing runs any more. */
static void free_output(struct output *output)
{
	display_destroy(&output->display);
	if (output->event_fd >= 0)
		close(output->event_fd);
	pthread_cond_destroy(&output->wake);
	pthread_mutex_destroy(&output->lock);
	pthread_mutex_destroy(&output->stats_lock);
	pthread_mutex_destroy(&output->record_lock);
	free(output);
}

static struct output *allocate(const struct output_params *params)
{
	struct output *output = calloc(1, sizeof(*output));
	if (!output)
		return NULL;
	output->params = *params;
	output->settings = *params->settings;
	snprintf(output->info.method, sizeof(output->info.method), "%s", params->settings->method);
	output->event_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	clock_cond_init(&output->wake);
	pthread_mutex_init(&output->lock, NULL);
	pthread_mutex_init(&output->stats_lock, NULL);
	pthread_mutex_init(&output->record_lock, NULL);
	if (output->event_fd >= 0)
		return output;
	free_output(output);
	return NULL;
}

static int start_display(struct output *output, struct error *error)
{
	const struct display_params params = {
		.loop = output->params.loop,
		.log = output->params.log,
		.clock = output->params.clock,
		.settings = output->params.settings,
		.flip = on_flip,
		.key = on_key,
		.change = on_change,
		.data = output,
		.vsync = lab_get_vsync(output->params.lab),
	};
	output->display = display_create(&params, error);
	return output->display ? 0 : -ENODEV;
}

/* Waits until the engine is there. */
static int start_thread(struct output *output, struct error *error)
{
	const int result = pthread_create(&output->thread, NULL, output_run, output);
	if (result != 0)
		return error_set(error, -result, "output: cannot start a thread: %s", strerror(result));
	pthread_mutex_lock(&output->lock);
	while (!output->started)
		pthread_cond_wait(&output->wake, &output->lock);
	pthread_mutex_unlock(&output->lock);
	if (output->start_result == 0)
		return 0;
	*error = output->start_error;
	pthread_join(output->thread, NULL);
	return output->start_result;
}

struct output *output_create(const struct output_params *params, struct error *error)
{
	struct output *output = allocate(params);
	if (!output) {
		error_set(error, -ENOMEM, "output: out of memory or file descriptors");
		return NULL;
	}
	if (start_display(output, error) == 0 && start_thread(output, error) == 0)
		return output;
	free_output(output);
	return NULL;
}

void output_stop(struct output *output)
{
	pthread_mutex_lock(&output->lock);
	output->stop = true;
	pthread_cond_signal(&output->wake);
	pthread_mutex_unlock(&output->lock);
}

void output_destroy(struct output **output)
{
	struct output *self = *output;
	*output = NULL;
	if (!self)
		return;
	output_stop(self);
	pthread_join(self->thread, NULL);
	for (uint32_t i = 0; i < self->stream_count; i++)
		stream_release(&self->streams[i]);
	engine_destroy(&self->wished_engine);
	output_close_tee(self, self->wished_tee);
	free_output(self);
}

uint64_t output_beats(const struct output *output)
{
	return atomic_load_explicit(&output->beats, memory_order_relaxed);
}

uint64_t output_rounds(const struct output *output)
{
	return atomic_load_explicit(&output->rounds, memory_order_relaxed);
}

void output_wake(struct output *output)
{
	pthread_mutex_lock(&output->lock);
	output->woken = true;
	pthread_mutex_unlock(&output->lock);
	pthread_cond_signal(&output->wake);
}

void output_toggle_view(struct output *output, uint32_t part)
{
	pthread_mutex_lock(&output->lock);
	output->view ^= part;
	output->view_changed = true;
	output_wake_locked(output);
	pthread_mutex_unlock(&output->lock);
}

void output_toggle_fullscreen(struct output *output)
{
	display_toggle_fullscreen(output->display);
}

void output_press_key(struct output *output, const struct presenter_key *key)
{
	pthread_mutex_lock(&output->lock);
	if (output->key_count < OUTPUT_KEYS)
		output->keys[output->key_count++] = *key;
	else
		output->lost_keys++;
	pthread_mutex_unlock(&output->lock);
	wake_main(output);
}

int output_event_fd(const struct output *output)
{
	return output->event_fd;
}

/* With the lock. */
static bool take_key(struct output *output, struct output_event *event)
{
	if (output->key_count == 0)
		return false;
	*event = (struct output_event){.kind = OUTPUT_KEY, .key = output->keys[0]};
	output->key_count--;
	memmove(&output->keys[0], &output->keys[1], output->key_count * sizeof(output->keys[0]));
	return true;
}

/* With the lock. */
static bool take_complaint(struct output *output, struct output_event *event)
{
	for (uint32_t i = 0; i < output->stream_count; i++) {
		struct stream *stream = output->streams[i];
		if (!stream->complaint.due)
			continue;
		stream->complaint.due = false;
		*event = (struct output_event){.kind = stream->complaint.ends ? OUTPUT_STREAM_BROKEN : OUTPUT_FRAME_REFUSED,
									   .client_id = stream->client_id,
									   .stream_id = stream->stream_id,
									   .stream = stream->number,
									   .refusal = stream->complaint.refusal};
		return true;
	}
	return false;
}

bool output_next_event(struct output *output, struct output_event *event)
{
	uint64_t count;
	pthread_mutex_lock(&output->lock);
	const bool any = take_key(output, event) || take_complaint(output, event);
	const uint32_t lost_keys = output->lost_keys;
	output->lost_keys = 0;
	if (!any && read(output->event_fd, &count, sizeof(count)) < 0) {
		/* Nothing to clear. */
	}
	pthread_mutex_unlock(&output->lock);
	if (lost_keys > 0)
		log_warning(output->params.log, "%" PRIu32 " keys were pressed while %u waited, and are lost", lost_keys,
					OUTPUT_KEYS);
	return any;
}

struct recorder *output_set_recorder(struct output *output, struct recorder *recorder)
{
	pthread_mutex_lock(&output->record_lock);
	struct recorder *before = output->recorder;
	output->recorder = recorder;
	pthread_mutex_unlock(&output->record_lock);
	return before;
}

void output_get_info(struct output *output, struct output_info *info)
{
	pthread_mutex_lock(&output->lock);
	*info = output->info;
	pthread_mutex_unlock(&output->lock);
	display_get_trouble(output->display, info->trouble, sizeof(info->trouble));
}

void output_get_stats(struct output *output, struct stats *stats)
{
	pthread_mutex_lock(&output->stats_lock);
	*stats = output->published;
	pthread_mutex_unlock(&output->stats_lock);
}
