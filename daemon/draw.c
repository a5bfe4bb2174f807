/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/overlay.h"
#include "daemon/render.h"

#define MS UINT64_C(1000000)
#define MARGIN_STEP UINT64_C(500000)
/* A real frame that is shown for longer than this may stand in a pause. */
#define GOVERNED_VBLANKS 8u
/* Of the picture before the first frame. */
#define EMPTY_WIDTH 960u
#define EMPTY_HEIGHT 540u

/* ---- pictures ---- */

/* Unless the CPU is to draw on it, or to look at it. */
static bool stays_in_gl(const struct render *render)
{
	return engine_get_info(render->engine)->brought && !render->through_memory && !render->tees.now &&
		   !lab_draws(render->lab) && !view_draws(&render->view, clock_now(render->clock));
}

/* In GL, if it can be there. */
static int acquire_somewhere(struct render *render, uint32_t width, uint32_t height, struct presenter_image *image)
{
	const struct presenter_impl *impl = render->presenter->impl;
	if (!stays_in_gl(render))
		return impl->acquire(render->presenter, width, height, image);
	const int result = impl->acquire_texture(render->presenter, width, height, image);
	if (result >= 0 || result == -EBUSY)
		return result;
	log_warning(render->log, "%s takes no pictures in GL: they go through CPU memory", impl->name);
	render->through_memory = true;
	return impl->acquire(render->presenter, width, height, image);
}

static int acquire(struct render *render, struct presenter_image *image)
{
	uint32_t width, height;
	engine_get_size(render->engine, &width, &height);
	const int result = acquire_somewhere(render, width, height, image);
	if (result == -EBUSY)
		render_expect_flips(render);
	/* When it begins and when it ends, since it is tried at each vblank; both may be often. */
	if (result < 0 && !render->lacks_picture && log_limit_allows(&render->lack_limit, clock_now(render->clock))) {
		log_warning(render->log, "no memory for a picture of %ux%u: %s", width, height, strerror(-result));
		render->lacks_picture = true;
	} else if (result == 0 && render->lacks_picture) {
		log_info(render->log, "there is memory for pictures again");
		render->lacks_picture = false;
	}
	return result;
}

/* Nobody has taken a newer one, and its memory is there. */
static bool frame_is_held(const struct render *render)
{
	struct frame held;
	return render->stream && !atomic_load(&render->stream->ended) && render->stream->number == render->stream_number &&
		   stream_get_held(render->stream, &held) && held.header.frame_id == render->frame.header.frame_id;
}

/* The engine is lost: the frame that it was at goes to the one that stands in. Has that got it? */
static bool draw_with_another(struct render *render, int result, const struct error *why)
{
	struct error error;
	const bool held = render->begun && frame_is_held(render);
	draw_lose_engine(render, result, why->text);
	if (!held || !render->engine)
		return false;
	render->begun = render->report_due = engine_begin(render->engine, &render->frame, &render->begun_with, &error) == 0;
	return render->begun;
}

/* A picture from the engine into the presenter's memory. */
static int draw(struct render *render, enum engine_show show, double phase, struct presenter_image *image)
{
	const struct engine_request request = {.show = show, .phase = phase};
	struct presenter *presenter = render->presenter;
	struct error error;

	int result = acquire(render, image);
	if (result < 0)
		return result;
	/* Only a real frame is worth a flip that may wait for the GPU; instead of an in-between a plain one is shown. */
	image->fenced = image->fenced && show == ENGINE_SHOW_REAL;
	struct engine_image target = {.data = image->data,
								  .stride = image->stride,
								  .holds = image->holds,
								  .texture = image->texture,
								  .texture_x = image->texture_x,
								  .texture_y = image->texture_y,
								  .unfinished = image->fenced};
	result = engine_render(render->engine, &request, &target, &error);
	image->holds = result == 0 ? target.holds : 0;
	if (result == 0) {
		view_draw(render, image);
		return 0;
	}
	presenter->impl->release(presenter, image);
	if (!draw_is_lost(render, result)) {
		if (log_limit_allows(&render->draw_limit, clock_now(render->clock)))
			log_warning(render->log, "%s", error.text);
	} else if (draw_with_another(render, result, &error))
		return draw(render, show, phase, image);
	return result;
}

static void add_cost(struct render *render, struct cost *cost, uint64_t start_ns)
{
	const uint64_t run_ns = clock_now(render->clock) - start_ns;
	cost_add(cost, run_ns);
	render->work_ns += run_ns;
	if (cost != &render->real_cost)
		busy_add(&render->busy, start_ns, start_ns + run_ns);
}

int draw_queue(struct render *render, struct presenter_image *image, uint64_t vblank, enum stats_show show,
			   double phase)
{
	const uint64_t serial = render->serial + 1;
	const struct showing_picture picture = {.serial = serial,
											.group = render->group,
											.show = show,
											.phase = (float)phase,
											.ready_ns = clock_now(render->clock)};
	/* Known before it can be shown. */
	showing_add_picture(&render->showing, &picture);
	lab_mark_picture(render->lab, image, serial, vblank, (enum points_show)show);
	const int result = render->presenter->impl->present(render->presenter, image, vblank, render->group, serial);
	if (result == 0) {
		render->serial = render->awaited = serial;
		render->awaited_vblank = vblank;
	}
	struct showing_frame *frame = showing_find_frame(&render->showing, render->group);
	if (result == 0 && (show == STATS_REAL || show == STATS_REPEAT) && frame)
		frame->queued = true;
	if (result == 0 || result == -EBUSY)
		render_expect_flips(render);
	if (result == 0 && render->tees.now)
		tee_add(render->tees.now, image, render->group, serial);
	return result;
}

/* ---- real frames ---- */

void draw_count_report(struct render *render)
{
	if (!render->report_due || !render->engine)
		return;
	const struct engine_report *report = engine_get_report(render->engine);
	render->report_due = false;
	stats_add_report(render->stats, report);
}

static bool left_out(const struct engine_report *report, const char *name)
{
	for (uint32_t i = 0; i < report->left_out_count; i++)
		if (strcmp(report->left_out[i].name, name) == 0)
			return true;
	return false;
}

static bool ran(const struct engine_report *report, const char *name)
{
	for (uint32_t i = 0; i < report->pass_count; i++)
		if (strcmp(report->passes[i].name, name) == 0)
			return report->passes[i].runs > 0;
	return false;
}

/* Takes the newest frame into render->frame; counts what was lost on the way. */
static int take_counted(struct render *render, uint64_t now_ns, struct refusal *refusal)
{
	_Atomic uint64_t *lost = &render->stream->counters.lost_frames;
	const uint64_t lost_before = atomic_load(lost);
	const int result = stream_take(render->stream, now_ns, &render->frame, refusal);
	render->stats->lost_real_frames += atomic_load(lost) - lost_before;
	render->stats->received_frames += result == 1;
	render->stats->refused_frames += result < 0;
	return result;
}

/* Takes the newest frame and tells pacer, recorder and bookkeeping. Is there one? */
static bool take(struct render *render, uint64_t now_ns)
{
	struct refusal refusal;
	const int result = take_counted(render, now_ns, &refusal);
	if (result <= 0) {
		if (result < 0)
			render->owner.report(render->owner.data, result == -EPROTO ? OUTPUT_STREAM_BROKEN : OUTPUT_FRAME_REFUSED,
								 render->stream, &refusal);
		return false;
	}
	render_answer_waiting(render);
	const struct pursuit_frame_header *header = &render->frame.header;
	const struct pacer_frame frame = {.frame_id = header->frame_id,
									  .time_ns = header->time_ns,
									  .interval_ns = header->real_interval_ns,
									  .intake_ns = render->frame.intake_ns,
									  .ready_ns = now_ns + render_real_cost(render)};
	render->stream_number = render->frame.stream;
	render->orphan = false;
	draw_forget_kept(render);
	render->owner.record(render->owner.data, &render->frame);
	pacer_add_frame(&render->pacer, &frame);
	render->group++;
	showing_add_frame(&render->showing, render->group, render->stream, &render->frame);
	return true;
}

/* A boosted picture must not stay for a second vblank: without boost where the plain one cannot be ready by then. */
static uint32_t boost_over(const struct render *render, const struct pacer_decision *decision)
{
	const uint64_t ready_ns = clock_now(render->clock) + render->real_cost.usual_ns + render->plain_cost.safe_ns;
	return ready_ns < decision->target_ns + (uint64_t)grid_period_ns(&render->grid) ? decision->n : 1;
}

static bool begin(struct render *render, const struct pacer_decision *decision)
{
	struct error error;
	render->begun_with = (struct engine_begin_params){.n = boost_over(render, decision),
													  .last_phase = decision->last_phase,
													  .real_interval_ns = decision->interval_ns};
	int result = engine_begin(render->engine, &render->frame, &render->begun_with, &error);
	if (draw_is_lost(render, result)) {
		draw_lose_engine(render, result, error.text);
		if (!render->engine)
			return false;
		result = engine_begin(render->engine, &render->frame, &render->begun_with, &error);
	}
	render->begun = render->report_due = result == 0;
	if (result < 0) {
		struct refusal refusal;
		struct showing_frame *frame = showing_find_frame(&render->showing, render->group);
		if (frame)
			frame->report.state = PURSUIT_FEEDBACK_REFUSED;
		refuse(&refusal, result, PURSUIT_REFUSED_FRAME, "planes", 0, "%.159s", error.text);
		render->owner.report(render->owner.data, OUTPUT_FRAME_REFUSED, render->stream, &refusal);
	}
	return render->begun;
}

/* Settles where one real frame in two hundred is late: a larger margin is delay, a smaller one is judder. */
static void adapt_margin(struct render *render, bool late)
{
	const uint64_t most_ns = (uint64_t)grid_period_ns(&render->grid);
	if (late)
		render->margin_ns = render->margin_ns + MARGIN_STEP < most_ns ? render->margin_ns + MARGIN_STEP : most_ns;
	else
		render->margin_ns -= render->margin_ns < MARGIN_STEP / 200 ? render->margin_ns : MARGIN_STEP / 200;
}

/* Queues the real frame; if its vblank is over, for the next one: it is late, never lost. */
static int queue_real(struct render *render, struct presenter_image *image, struct pacer_decision *decision,
					  uint64_t *vblank)
{
	bool late = false;
	int result;
	while ((result = draw_queue(render, image, *vblank, STATS_REAL, decision->phase)) == -ETIME) {
		late = true;
		render_follow_grid(render); /* it may have changed without a flip that would have told */
		showing_plan(&render->showing, *vblank, SHOWING_REAL);
		pacer_missed(&render->pacer, decision);
		const uint64_t first = render_first_vblank(render);
		*vblank = first > *vblank ? first : *vblank + 1; /* never the same one again, whatever the grid says */
		const double phase = decision->phase;
		*decision = pacer_decide(&render->pacer, *vblank);
		decision->phase = phase;
	}
	render->stats->late_real_frames += late;
	adapt_margin(render, late);
	return result;
}

/* When the next real frame had better be there: in time for the vblank that it is expected at. */
static void give_hint(struct render *render, const struct pacer_decision *decision)
{
	const uint64_t next = pacer_next_real_vblank(&render->pacer);
	const uint64_t lead = render_real_cost(render) + MS, vblank_ns = next ? grid_time(&render->grid, next) : 0;
	render->showing.next_submit_ns = vblank_ns > lead ? vblank_ns - lead : 0;
	stream_hint(render->stream, decision->frame_id, render->showing.next_submit_ns, decision->interval_ns);
}

/* What the way of a frame to its picture took beyond the engine's work; a frame that came too early waits by intent. */
static void count_overhead(struct render *render, const struct engine_report *report)
{
	const uint64_t submit_ns = render->frame.header.submit_ns, hold_ns = render->hold_until_ns;
	const uint64_t ready_ns = render->showing.pictures[render->serial % SHOWING_PICTURES].ready_ns;
	const uint64_t from_ns = submit_ns > hold_ns ? submit_ns : hold_ns;
	const double work_ns = report->total_ms * 1e6 + (double)busy_within(&render->busy, from_ns, ready_ns);
	if (submit_ns != 0 && from_ns < ready_ns)
		histogram_add(&render->stats->spans.overhead, (int64_t)fmax(0.0, (double)(ready_ns - from_ns) - work_ns));
}

/* What is known once the frame has its vblank. */
static void settle_real(struct render *render, const struct pacer_decision *decision, uint64_t vblank)
{
	const struct engine_report *report = engine_get_report(render->engine);
	struct showing_frame *frame = showing_find_frame(&render->showing, render->group);
	showing_plan(&render->showing, vblank, SHOWING_REAL);
	count_overhead(render, report);
	render->n = decision->n;
	render->real_vblank = vblank;
	render->next_vblank = vblank + 1;
	render->pause_vblanks = 0;
	render->paused = false;
	render->showing.pausing = false;
	render->standby_done = false;
	render->still = left_out(report, "extrapolation");
	render->boosted = decision->n > 1 && ran(report, "compensate") && !left_out(report, "boost");
	render->front_plain = !render->boosted && decision->phase == 0.0;
	render->front_black = false;
	if (frame)
		frame->boosted = render->boosted;
	give_hint(render, decision);
}

/* What is begun from now on is made with the settings as they are, at the governor's level. */
static void set_params(struct render *render)
{
	struct engine_params params;
	struct error error;
	int result = draw_get_params(render, &params, &error);
	if (result == 0 && render->engine)
		result = engine_set_params(render->engine, &params, &error);
	if (result < 0)
		log_warning(render->log, "settings of the engine: %s", error.text);
	else
		draw_note_params(render, &params);
	render->settings_changed = false;
}

/* The level of what is begun from now on. */
static void set_level(struct render *render)
{
	set_params(render);
	log_debug(render->log, "governor: %s at a load of %.2f%s", governor_level_name(render->governor.level),
			  render->governor.load, render->passes_through ? ", but frames pass through" : "");
}

/* What the frame before took settles the level of the one that will be shown first at `vblank`. */
static void govern(struct render *render, uint64_t now_ns, uint64_t vblank)
{
	const uint64_t vblanks = vblank - render->real_vblank,
				   late = render->stats->late_in_betweens - render->late_counted;
	const struct governor_sample sample = {
		.now_ns = now_ns,
		.work_ns = render->work_ns + late * render->between_cost.usual_ns,
		.time_ns = (uint64_t)((double)vblanks * grid_period_ns(&render->grid)),
		.late_in_betweens = (uint32_t)late,
	};
	const uint32_t before = render->governor.level;
	const bool passed = render->passes_through;
	render->passes_through = pacer_passes_through(&render->pacer);
	render->work_ns = 0;
	render->late_counted = render->stats->late_in_betweens;
	/* A pause of the stream teaches nothing; one for want of time does. */
	const bool paused = render->pause_vblanks > 0 || vblanks > GOVERNED_VBLANKS;
	const bool busy = sample.work_ns > sample.time_ns / 2;
	if (render->begun && !passed && (busy || !paused))
		governor_add(&render->governor, &sample);
	if (render->governor.level != before || render->passes_through != passed)
		set_level(render);
	render->stats->governor = render->governor;
}

/* A frame that was taken and cannot be shown. In a pause no flip of a later one would ever answer for it. */
static void give_up(struct render *render)
{
	if (render->paused || render->pause_vblanks > 0)
		showing_settle_frames(&render->showing, render->group + 1);
}

/* The presenter has it while the GPU is at it still: what it costs, and when it was ready, is known only now. */
static void finish_real(struct render *render, uint64_t now_ns)
{
	struct error error;
	const int result = engine_finish(render->engine, &error);
	add_cost(render, &render->real_cost, now_ns);
	showing_set_ready(&render->showing, render->serial, clock_now(render->clock));
	if (draw_is_lost(render, result))
		draw_lose_engine(render, result, error.text);
}

void draw_real(struct render *render, uint64_t now_ns)
{
	struct presenter_image image;
	draw_count_report(render);
	render->show_held = false;
	if (render->paused)
		render_follow_grid(render);
	if (!take(render, now_ns)) {
		render->take_again_ns = grid_time(&render->grid, grid_at_or_after(&render->grid, now_ns + 1));
		return;
	}
	draw_take_engine(render);
	draw_replace_stand_in(render, now_ns);
	uint64_t vblank = grid_at_or_after(&render->grid, now_ns + render_real_cost(render));
	if (vblank <= render->real_vblank)
		vblank = render->real_vblank + 1;
	struct pacer_decision decision = pacer_decide(&render->pacer, vblank);
	/* Vblanks of a pause that ends now are no misses. */
	if (render->pause_vblanks > 0)
		render_plan_pause_until(render, vblank);
	govern(render, now_ns, vblank);
	if (render->settings_changed)
		set_params(render);
	if (!begin(render, &decision) || draw(render, ENGINE_SHOW_REAL, decision.phase, &image) < 0) {
		give_up(render);
		return;
	}
	const int queued = queue_real(render, &image, &decision, &vblank);
	if (!image.fenced)
		add_cost(render, &render->real_cost, now_ns);
	if (queued < 0) {
		render->presenter->impl->release(render->presenter, &image);
		give_up(render);
		return;
	}
	settle_real(render, &decision, vblank);
	if (image.fenced)
		finish_real(render, now_ns);
}

/* ---- the others ---- */

void draw_empty(struct render *render, uint64_t vblank)
{
	const struct presenter_impl *impl = render->presenter->impl;
	const uint64_t start_ns = clock_now(render->clock);
	struct presenter_image image;
	uint32_t width = EMPTY_WIDTH, height = EMPTY_HEIGHT;
	if (render->begun)
		engine_get_size(render->engine, &width, &height);
	/* A file of what is shown has the size of the first picture. */
	if ((render->tees.now && !render->begun) || impl->acquire(render->presenter, width, height, &image) < 0)
		return;
	image.holds = 0;
	overlay_blacken(&(struct overlay){image.data, image.stride, image.width, image.height});
	view_draw(render, &image);
	render->front_black = draw_queue(render, &image, vblank, STATS_REPEAT, 0.0) == 0;
	add_cost(render, &render->empty_cost, start_ns);
	render->front_plain &= !render->front_black;
	if (!render->front_black)
		impl->release(render->presenter, &image);
}

void draw_held(struct render *render, uint64_t vblank)
{
	const struct pacer_decision decision = {.n = 1, .target_ns = grid_time(&render->grid, vblank)};
	draw_count_report(render);
	if (render->settings_changed)
		set_params(render);
	render->stream_number = render->frame.stream;
	render->orphan = false;
	draw_forget_kept(render);
	render->group++;
	render_show_waiting(render);
	if (begin(render, &decision))
		draw_plain(render, vblank);
}

void draw_in_between(struct render *render, const struct pacer_decision *decision, uint64_t vblank)
{
	const uint64_t start_ns = clock_now(render->clock);
	struct presenter_image image;
	if (draw(render, ENGINE_SHOW_IN_BETWEEN, decision->phase, &image) < 0)
		return;
	const int queued = draw_queue(render, &image, vblank, STATS_IN_BETWEEN, decision->phase);
	add_cost(render, &render->between_cost, start_ns);
	if (queued < 0) {
		render->presenter->impl->release(render->presenter, &image);
		pacer_missed(&render->pacer, decision);
		return;
	}
	render->front_plain = false;
}

void draw_plain(struct render *render, uint64_t vblank)
{
	const uint64_t start_ns = clock_now(render->clock);
	struct presenter_image image;
	render->standby_done = true;
	if (draw(render, ENGINE_SHOW_PLAIN, 0.0, &image) < 0)
		return;
	if (vblank != 0) {
		render->front_plain = draw_queue(render, &image, vblank, STATS_REPEAT, 0.0) == 0;
		add_cost(render, &render->plain_cost, start_ns);
		render->front_black &= !render->front_plain;
		if (!render->front_plain)
			render->presenter->impl->release(render->presenter, &image);
		return;
	}
	const struct showing_picture picture = {.serial = ++render->serial,
											.group = render->group,
											.show = STATS_STANDBY,
											.ready_ns = clock_now(render->clock)};
	showing_add_picture(&render->showing, &picture);
	lab_mark_picture(render->lab, &image, picture.serial, render->real_vblank, POINTS_STANDBY);
	render->presenter->impl->set_standby(render->presenter, &image, render->group, picture.serial);
	add_cost(render, &render->plain_cost, start_ns);
	if (render->tees.now)
		tee_add(render->tees.now, &image, render->group, picture.serial);
}
