/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/output.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#include "daemon/display.h"
#include "daemon/render.h"
#include "daemon/slices.h"

#define FLIPS 64u

struct output {
	struct output_params params;
	struct display *display; /* main's */
	pthread_t thread;
	int event_fd;

	_Atomic uint64_t beats;
	pthread_mutex_t lock; /* the mailbox */
	pthread_cond_t wake;
	bool stop, woken, streams_changed, presenter_changed, view_changed, settings_changed;
	bool started; /* the thread has said whether it could start */
	int start_result;
	struct error start_error;
	struct stream *streams[OUTPUT_STREAMS]; /* referenced; in the order of opening */
	uint32_t stream_count;
	struct presenter *presenter; /* to be used from now on */
	uint32_t view;
	struct settings wished; /* by main, for the render thread */
	struct presenter_flip flips[FLIPS];
	uint32_t flip_count;
	struct output_event events[OUTPUT_EVENTS]; /* for main */
	uint32_t event_count;
	struct output_info info;

	pthread_mutex_t stats_lock;
	struct stats published;

	pthread_mutex_t record_lock;
	struct recorder *recorder;

	/* the render thread's own */
	struct settings settings; /* a copy: some change while it runs */
	struct settings due;      /* what it becomes next */
	struct stats stats;
	struct render render;
	struct stream *own[OUTPUT_STREAMS]; /* referenced copy of streams */
	uint32_t own_count;
};

/* ---- called by the render thread's work ---- */

static void record(void *data, const struct frame *frame)
{
	struct output *output = data;
	pthread_mutex_lock(&output->record_lock);
	if (output->recorder)
		recorder_push(output->recorder, frame, frame->intake_ns);
	pthread_mutex_unlock(&output->record_lock);
}

static void push_event(struct output *output, const struct output_event *event)
{
	const uint64_t one = 1;
	pthread_mutex_lock(&output->lock);
	if (output->event_count < OUTPUT_EVENTS)
		output->events[output->event_count++] = *event;
	pthread_mutex_unlock(&output->lock);
	/* A full counter wakes just as well. */
	if (write(output->event_fd, &one, sizeof(one)) < 0 && errno != EAGAIN)
		log_error(output->params.log, "eventfd: %s", strerror(errno));
}

static void report(void *data, enum output_event_kind kind, struct stream *stream, const struct refusal *refusal)
{
	struct output *output = data;
	const struct output_event event = {
		.kind = kind, .client_id = stream->client_id, .stream_id = stream->stream_id, .refusal = *refusal};
	if (kind == OUTPUT_STREAM_BROKEN)
		atomic_store(&stream->ended, true);
	else if (!log_limit_allows(&stream->log_limit, clock_now(output->params.clock)))
		return;
	push_event(output, &event);
}

static void engine_made(void *data, const struct engine_info *info)
{
	struct output *output = data;
	pthread_mutex_lock(&output->lock);
	snprintf(output->info.renderer, sizeof(output->info.renderer), "%s", info->renderer ? info->renderer : "");
	snprintf(output->info.context, sizeof(output->info.context), "%s", info->context ? info->context : "");
	output->info.software = info->software;
	pthread_mutex_unlock(&output->lock);
}

/* ---- called by the display ---- */

/* On main. */
static void on_change(void *data, struct presenter *presenter)
{
	struct output *output = data;
	pthread_mutex_lock(&output->lock);
	output->presenter = presenter;
	output->presenter_changed = true;
	snprintf(output->info.presenter, sizeof(output->info.presenter), "%s", presenter ? presenter->impl->name : "none");
	snprintf(output->info.display, sizeof(output->info.display), "%s",
			 presenter && presenter->impl->get_display ? presenter->impl->get_display(presenter) : "");
	if (presenter)
		output->info.grid = presenter->impl->get_grid(presenter);
	output->woken = true;
	pthread_cond_signal(&output->wake);
	pthread_mutex_unlock(&output->lock);
}

static void on_key(void *data, const struct presenter_key *key)
{
	output_press_key(data, key);
}

/* On the presenter's thread. */
static void on_flip(void *data, const struct presenter_flip *flip)
{
	struct output *output = data;
	lab_flip(output->params.lab, flip);
	pthread_mutex_lock(&output->lock);
	if (output->flip_count < FLIPS)
		output->flips[output->flip_count++] = *flip;
	else
		output->flips[FLIPS - 1].skipped++; /* a render thread that hangs this long has more to worry about */
	output->woken = true;
	pthread_cond_signal(&output->wake);
	pthread_mutex_unlock(&output->lock);
}

/* ---- the render thread ---- */

/*
 * Never waits for main: a thread of ordinary priority that was interrupted while
 * it copies would hold this one up for many vblanks.
 */
static void publish_stats(struct output *output)
{
	if (pthread_mutex_trylock(&output->stats_lock) != 0)
		return;
	stats_publish(&output->stats, &output->published);
	pthread_mutex_unlock(&output->stats_lock);
}

/* Sleeps until time_ns or until woken. */
static void wait_for_work(struct output *output, uint64_t time_ns)
{
	const struct timespec then = {(time_t)(time_ns / UINT64_C(1000000000)), (long)(time_ns % UINT64_C(1000000000))};
	pthread_mutex_lock(&output->lock);
	while (!output->woken && !output->stop) {
		if (time_ns == RENDER_NEVER)
			pthread_cond_wait(&output->wake, &output->lock);
		else if (pthread_cond_timedwait(&output->wake, &output->lock, &then) == ETIMEDOUT)
			break;
	}
	pthread_mutex_unlock(&output->lock);
}

/* Takes over the new list; references are dropped without the lock. */
static void adopt_streams(struct output *output, struct stream *const *streams, uint32_t count)
{
	struct stream *old[OUTPUT_STREAMS];
	const uint32_t old_count = output->own_count;
	memcpy(old, output->own, sizeof(old));
	for (uint32_t i = 0; i < count; i++)
		output->own[i] = streams[i];
	output->own_count = count;
	render_set_streams(&output->render, streams, count);
	for (uint32_t i = 0; i < old_count; i++)
		stream_release(&old[i]);
}

/* The rate and the phase that clients are told follow the display's. */
static void handle_flips(struct output *output, const struct presenter_flip *flips, uint32_t count)
{
	if (count == 0)
		return;
	for (uint32_t i = 0; i < count; i++) {
		render_flip(&output->render, &flips[i]);
		output->stats.flips_by_source[flips[i].time_source]++;
	}
	const bool changed = render_follow_grid(&output->render);
	pthread_mutex_lock(&output->lock);
	if (changed)
		output->info.grid = output->render.grid;
	output->info.time_source = flips[count - 1].time_source;
	pthread_mutex_unlock(&output->lock);
	publish_stats(output);
}

/* Flips that come before or after a presenter's time are not its. */
static void change_presenter(struct output *output, struct presenter *presenter)
{
	render_set_presenter(&output->render, presenter);
	if (!presenter)
		display_let_go(output->display);
}

/* What main wants to be different; the settings are in output->due. */
struct wishes {
	bool new_view, new_settings;
	uint32_t view;
};

/* With the lock, the one that streams are taken with: theirs and their settings go together. */
static struct wishes take_wishes_over(struct output *output)
{
	const struct wishes wishes = {output->view_changed, output->settings_changed, output->view};
	if (wishes.new_settings)
		output->due = output->wished;
	output->view_changed = output->settings_changed = false;
	return wishes;
}

static void grant(struct output *output, const struct wishes *wishes)
{
	if (wishes->new_view)
		render_set_view(&output->render, wishes->view);
	if (wishes->new_settings)
		render_set_settings(&output->render, &output->due);
}

/* Empties the mailbox. False: stop. */
static bool read_mailbox(struct output *output)
{
	struct presenter_flip flips[FLIPS];
	struct stream *streams[OUTPUT_STREAMS];
	uint32_t stream_count = 0;

	pthread_mutex_lock(&output->lock);
	const bool go_on = !output->stop, changed = output->streams_changed, new_presenter = output->presenter_changed;
	struct presenter *presenter = output->presenter;
	const uint32_t flip_count = output->flip_count;
	memcpy(flips, output->flips, flip_count * sizeof(flips[0]));
	for (; changed && stream_count < output->stream_count; stream_count++)
		streams[stream_count] = stream_reference(output->streams[stream_count]);
	output->flip_count = 0;
	output->streams_changed = output->presenter_changed = false;
	output->woken = false;
	const struct wishes wishes = take_wishes_over(output);
	pthread_mutex_unlock(&output->lock);

	handle_flips(output, flips, flip_count);
	grant(output, &wishes);
	if (new_presenter)
		change_presenter(output, presenter);
	if (changed)
		adopt_streams(output, streams, stream_count);
	for (uint32_t i = 0; i + 1 < output->own_count; i++)
		if (!atomic_load(&output->own[i]->ended))
			render_skip_frames(&output->render, output->own[i]);
	return go_on;
}

static int start(struct output *output)
{
	output->render = (struct render){
		.settings = &output->settings,
		.clock = output->params.clock,
		.log = output->params.log,
		.stats = &output->stats,
		.lab = output->params.lab,
		.owner = {output, record, report, engine_made},
	};
	governor_init(&output->render.governor, output->params.settings->governor == 0, output->params.settings->level);
	output->stats.governor = output->render.governor;
	struct error error = {""};
	/* What it draws in may be the presenter's. */
	pthread_mutex_lock(&output->lock);
	struct presenter *presenter = output->presenter;
	output->presenter_changed = false;
	pthread_mutex_unlock(&output->lock);
	change_presenter(output, presenter);
	const int result = render_start(&output->render, &error);
	pthread_mutex_lock(&output->lock);
	output->started = true;
	output->start_result = result;
	output->start_error = error;
	pthread_cond_broadcast(&output->wake);
	pthread_mutex_unlock(&output->lock);
	return result;
}

static void *run(void *data)
{
	struct output *output = data;
	pthread_setname_np(pthread_self(), "pursuit-render");
	slices_shorten(output->params.log);
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	if (start(output) == 0) {
		while (read_mailbox(output)) {
			if (!render_is_stuck(&output->render))
				atomic_fetch_add_explicit(&output->beats, 1, memory_order_relaxed);
			const uint64_t next_ns = render_step(&output->render);
			if (next_ns > clock_now(output->params.clock)) {
				publish_stats(output);
				wait_for_work(output, next_ns);
			}
		}
	}
	adopt_streams(output, NULL, 0);
	render_finish(&output->render);
	return NULL;
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
	pthread_condattr_t attributes;
	if (!output)
		return NULL;
	output->params = *params;
	output->settings = *params->settings;
	snprintf(output->info.method, sizeof(output->info.method), "%s", params->settings->method);
	output->event_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_cond_init(&output->wake, &attributes);
	pthread_condattr_destroy(&attributes);
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
	const int result = pthread_create(&output->thread, NULL, run, output);
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

void output_destroy(struct output **output)
{
	struct output *self = *output;
	*output = NULL;
	if (!self)
		return;
	pthread_mutex_lock(&self->lock);
	self->stop = true;
	pthread_cond_signal(&self->wake);
	pthread_mutex_unlock(&self->lock);
	pthread_join(self->thread, NULL);
	for (uint32_t i = 0; i < self->stream_count; i++)
		stream_release(&self->streams[i]);
	free_output(self);
}

/* With the lock. */
static void wake_locked(struct output *output)
{
	output->woken = true;
	pthread_cond_signal(&output->wake);
}

/* With the lock. */
static void take_wishes(struct output *output, const struct settings *settings)
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
		take_wishes(output, settings);
	for (uint32_t i = 0; i < output->stream_count; i++)
		__atomic_store_n(&output->streams[i]->control->background, i + 1 < output->stream_count, __ATOMIC_RELEASE);
	output->streams_changed = true;
	wake_locked(output);
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

uint64_t output_beats(const struct output *output)
{
	return atomic_load_explicit(&output->beats, memory_order_relaxed);
}

void output_wake(struct output *output)
{
	pthread_mutex_lock(&output->lock);
	wake_locked(output);
	pthread_mutex_unlock(&output->lock);
}

void output_set_settings(struct output *output, const struct settings *settings)
{
	pthread_mutex_lock(&output->lock);
	take_wishes(output, settings);
	wake_locked(output);
	pthread_mutex_unlock(&output->lock);
}

void output_toggle_view(struct output *output, uint32_t part)
{
	pthread_mutex_lock(&output->lock);
	output->view ^= part;
	output->view_changed = true;
	wake_locked(output);
	pthread_mutex_unlock(&output->lock);
}

void output_toggle_fullscreen(struct output *output)
{
	display_toggle_fullscreen(output->display);
}

void output_press_key(struct output *output, const struct presenter_key *key)
{
	push_event(output, &(struct output_event){.kind = OUTPUT_KEY, .key = *key});
}

int output_event_fd(const struct output *output)
{
	return output->event_fd;
}

bool output_next_event(struct output *output, struct output_event *event)
{
	uint64_t count;
	pthread_mutex_lock(&output->lock);
	const bool any = output->event_count > 0;
	if (any) {
		*event = output->events[0];
		output->event_count--;
		memmove(&output->events[0], &output->events[1], output->event_count * sizeof(output->events[0]));
	} else if (read(output->event_fd, &count, sizeof(count)) < 0) {
		/* Nothing to clear. */
	}
	pthread_mutex_unlock(&output->lock);
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
}

void output_get_stats(struct output *output, struct stats *stats)
{
	pthread_mutex_lock(&output->stats_lock);
	*stats = output->published;
	pthread_mutex_unlock(&output->stats_lock);
}
