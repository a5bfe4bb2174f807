/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <sched.h>
#include <string.h>
#include <sys/prctl.h>

#include "daemon/clock.h"
#include "daemon/output_state.h"
#include "daemon/slices.h"

/* What waits for so long hurts nobody. */
#define SOON_NS UINT64_C(50000000)
#define LOOK_NS UINT64_C(2000000)

/* ---- called by the render thread's work ---- */

static void record(void *data, const struct frame *frame)
{
	struct output *output = data;
	pthread_mutex_lock(&output->record_lock);
	if (output->recorder)
		recorder_push(output->recorder, frame, frame->intake_ns);
	pthread_mutex_unlock(&output->record_lock);
}

static void report(void *data, enum output_event_kind kind, struct stream *stream, const struct refusal *refusal)
{
	struct output *output = data;
	const bool ends = kind == OUTPUT_STREAM_BROKEN;
	if (ends)
		atomic_store(&stream->ended, true);
	if (ends || log_limit_allows(&stream->log_limit, clock_now(output->params.clock)))
		output_complain(output, kind, stream, refusal);
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

/*
 * Sleeps until time_ns or until woken; while main is busy not for long, since it wakes nobody then. What it would not
 * read soon it does not sleep over.
 */
static void wait_for_work(struct output *output, uint64_t time_ns)
{
	const uint64_t now_ns = clock_now(output->params.clock);
	const bool soon = time_ns < now_ns + SOON_NS;
	pthread_mutex_lock(&output->lock);
	const uint64_t end_ns = output->main_is_busy && now_ns + LOOK_NS < time_ns ? now_ns + LOOK_NS : time_ns;
	output->wakes_soon = soon;
	while (!output->woken && !output->stop && (soon || output->flip_count == 0)) {
		if (end_ns == RENDER_NEVER)
			pthread_cond_wait(&output->wake, &output->lock);
		else if (!clock_cond_wait(&output->wake, &output->lock, end_ns))
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

/*
 * The rate and the phase that clients are told follow the display's. Flips that come before or after a presenter's time
 * are not its.
 */
static void handle_flips(struct output *output, const struct output_flip *flips, uint32_t count)
{
	enum presenter_time_source source = PRESENTER_TIME_SOURCES;
	for (uint32_t i = 0; i < count; i++) {
		if (flips[i].presenter != output->render.presenter)
			continue;
		source = flips[i].flip.time_source;
		render_flip(&output->render, &flips[i].flip);
		output->stats.flips_by_source[source]++;
	}
	if (source == PRESENTER_TIME_SOURCES)
		return;
	const bool changed = render_follow_grid(&output->render);
	pthread_mutex_lock(&output->lock);
	if (changed)
		output->info.grid = output->render.grid;
	output->info.time_source = source;
	pthread_mutex_unlock(&output->lock);
	publish_stats(output);
}

/* The one wished for is in use now. */
static void tell_presenter(struct output *output, const struct output_presenter *wished)
{
	pthread_mutex_lock(&output->lock);
	snprintf(output->info.presenter, sizeof(output->info.presenter), "%s", wished->name);
	snprintf(output->info.display, sizeof(output->info.display), "%s", wished->display);
	if (wished->presenter)
		output->info.grid = output->render.grid;
	pthread_mutex_unlock(&output->lock);
}

/* When it is time. */
static void change_presenter(struct output *output)
{
	if (!render_go_over(&output->render))
		return;
	atomic_store(&output->presenter, output->render.presenter);
	/* The lab takes flips from one thread at a time. */
	while (atomic_load(&output->flipping) > 0)
		sched_yield();
	tell_presenter(output, &output->coming);
	if (output->coming.answer)
		display_let_go(output->display);
}

/* What main wants to be different; the settings are in output->due. */
struct wishes {
	bool new_view, new_settings, new_tee;
	uint32_t view;
	struct tee *tee;
	struct engine *engine; /* NULL: that which there is */
};

/* With the lock, the one that streams are taken with: theirs and their settings go together. */
static struct wishes take_wishes_over(struct output *output)
{
	const struct wishes wishes = {output->view_changed, output->settings_changed, output->tee_changed,
								  output->view,         output->wished_tee,       output->wished_engine};
	if (wishes.new_settings)
		output->due = output->wished;
	output->view_changed = output->settings_changed = output->tee_changed = false;
	output->wished_tee = NULL;
	output->wished_engine = NULL;
	return wishes;
}

static void grant(struct output *output, const struct wishes *wishes)
{
	if (wishes->new_view)
		render_set_view(&output->render, wishes->view);
	if (wishes->new_settings)
		render_set_settings(&output->render, &output->due);
	if (wishes->new_tee)
		render_set_tee(&output->render, wishes->tee);
	if (wishes->engine)
		render_set_engine(&output->render, wishes->engine);
}

/* Empties the mailbox. False: stop. */
static bool read_mailbox(struct output *output)
{
	struct output_flip flips[OUTPUT_FLIPS];
	struct stream *streams[OUTPUT_STREAMS];
	uint32_t stream_count = 0;

	pthread_mutex_lock(&output->lock);
	const bool go_on = !output->stop, changed = output->streams_changed, new_presenter = output->presenter_changed;
	if (new_presenter)
		output->coming = output->wished_presenter;
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
		render_wish_presenter(&output->render, output->coming.presenter, output->coming.lost);
	change_presenter(output);
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
		.owner = {output, record, report, engine_made, output_close_tee},
	};
	governor_init(&output->render.governor, output->params.settings->governor == 0, output->params.settings->level);
	output->stats.governor = output->render.governor;
	struct error error = {""};
	/* What it draws in may be the presenter's. */
	pthread_mutex_lock(&output->lock);
	output->coming = output->wished_presenter;
	output->presenter_changed = false;
	pthread_mutex_unlock(&output->lock);
	render_wish_presenter(&output->render, output->coming.presenter, false);
	change_presenter(output);
	const int result = render_start(&output->render, &error);
	pthread_mutex_lock(&output->lock);
	output->started = true;
	output->start_result = result;
	output->start_error = error;
	pthread_cond_broadcast(&output->wake);
	pthread_mutex_unlock(&output->lock);
	return result;
}

void *output_run(void *data)
{
	struct output *output = data;
	pthread_setname_np(pthread_self(), "pursuit-render");
	slices_shorten(output->params.log);
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	if (start(output) == 0) {
		while (read_mailbox(output)) {
			atomic_fetch_add_explicit(&output->rounds, 1, memory_order_relaxed);
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
