/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/render.h"

#include <errno.h>
#include <string.h>

/* Vblanks that may be drawn ahead; the presenter holds more. */
#define AHEAD 4u
/* After so long a pause the picture that stays is made the plain one (0.25 s at 120 Hz). */
#define PLAIN_AFTER 30u
/* And then the presenter sleeps, once that picture has been shown, or after so many vblanks more if it never is. */
#define SLEEP_AFTER (PLAIN_AFTER + 4u)
#define SLEEP_ANYWAY 256u
/* A picture that is to stay and misses its vblank, or finds no memory free, is drawn again so often. */
#define STAY_TRIES 120u
/* A presenter that is given some pictures and says nothing for so long and so many vblanks hangs. */
#define STUCK_PICTURES 3u
#define STUCK_NS UINT64_C(2000000000)
#define STUCK_VBLANKS 8.0
/* Nothing was to be shown for so long: whatever it was, it hurts nobody. */
#define FORGIVEN_NS UINT64_C(5000000000)
/* Before anything was measured. */
#define FIRST_COST_NS UINT64_C(5000000)
/* One presenter takes over from another at the boundary of a frame, but not later than this; looked for so often. */
#define GO_OVER_NS UINT64_C(100000000)
/* Nor later than this where that one has a frame to show still, as one that is held up may. */
#define GO_OVER_AWAITED_NS UINT64_C(2000000000)
#define GO_OVER_LOOK_NS UINT64_C(1000000)

int render_start(struct render *render, struct error *error)
{
	const struct settings *settings = render->settings;
	const struct tee_params params = {
		.path = settings->tee,
		.log = render->log,
	};
	render->tees = (struct tees){.close = render->owner.close_tee, .data = render->owner.data, .log = render->log};
	if (*settings->tee) {
		render->tees.now = tee_create(&params, error);
		if (!render->tees.now)
			return -EIO;
	}
	return draw_make_engine(render, error);
}

void render_finish(struct render *render)
{
	tees_finish(&render->tees);
	engine_destroy(&render->other_engine);
	engine_destroy(&render->engine);
	draw_forget_kept(render);
	view_finish(&render->view);
	showing_finish(&render->showing);
	stream_release(&render->waiting.stream);
}

void render_forget_costs(struct render *render)
{
	render->between_cost = render->plain_cost = (struct cost){.count = 0};
}

void render_set_tee(struct render *render, struct tee *tee)
{
	/* Pictures are copied, and come back from GL for that. */
	if ((tee != NULL) != (render->tees.now != NULL))
		render_forget_costs(render);
	tees_follow(&render->tees, tee, render->group, render->serial);
	render->redraw |= tee != NULL; /* a picture that stays is its first one */
	if (render->paused)
		tees_rest(&render->tees, render->awaited);
}

static void close_all_frames(struct render *render)
{
	showing_close_frames(&render->showing, render->group + 1);
}

static void start_pacer(struct render *render)
{
	const struct pacer_params params = {.grid = render->grid};
	pacer_init(&render->pacer, &params);
}

/* Nothing of the stream's is shown: its last frame is due, unless a newer one comes first. */
static void want_held(struct render *render)
{
	render->show_held =
		render->stream && !atomic_load(&render->stream->ended) && stream_get_held(render->stream, &render->frame);
}

void render_wish_presenter(struct render *render, struct presenter *presenter, bool at_once)
{
	render->next.wished = true;
	render->next.presenter = presenter;
	render->next.at_once = at_once;
	render->next.since_ns = clock_now(render->clock);
}

static bool has_new_frame(const struct render *render)
{
	return render->stream && !atomic_load(&render->stream->ended) && stream_has_frame(render->stream);
}

static bool may_go_over(const struct render *render)
{
	const uint64_t waited_ns = clock_now(render->clock) - render->next.since_ns;
	const uint64_t most_ns = showing_awaits(&render->showing) ? GO_OVER_AWAITED_NS : GO_OVER_NS;
	if (!render->presenter || render->next.at_once || waited_ns > most_ns)
		return true;
	return !showing_has_unshown(&render->showing) && (render->paused || has_new_frame(render));
}

void render_set_presenter(struct render *render, struct presenter *presenter)
{
	close_all_frames(render);
	showing_finish(&render->showing);
	render->presenter = presenter;
	draw_follow_context(render);
	render->unanswered.pictures = 0;
	if (presenter) {
		render->grid = presenter->impl->get_grid(presenter);
		render->lead_ns = presenter->impl->get_lead(presenter);
	}
	render_forget_costs(render); /* it has other memory */
	showing_init(&render->showing, render->stats);
	render->showing.period_ns = render->stats->vblank_ns = grid_period_ns(&render->grid);
	start_pacer(render);
	render->standby_done = render->front_plain = render->front_black = false;
	render->hold_until_ns = render->take_again_ns = render->awaited = 0;
	render->real_vblank = render->next_vblank = 0;
	render->paused = true;
	/* Nothing was shown there yet: what stays is to be drawn, unless a frame comes first. */
	render->pause_vblanks = render->group > 0 ? PLAIN_AFTER : 0;
	render->redraw |= render->group > 0;
	render->work_ns = 0;
	want_held(render);
}

bool render_go_over(struct render *render)
{
	if (!render->next.wished || !may_go_over(render))
		return false;
	render->next.wished = false;
	render->between_presenters = !render->next.presenter && !render->next.at_once;
	if (!render->next.presenter)
		render_answer_waiting(render);
	render_set_presenter(render, render->next.presenter);
	return true;
}

bool render_follow_grid(struct render *render)
{
	if (!render->presenter)
		return false;
	const struct grid grid = render->presenter->impl->get_grid(render->presenter);
	render->lead_ns = render->presenter->impl->get_lead(render->presenter);
	if (memcmp(&grid, &render->grid, sizeof(grid)) == 0)
		return false;
	render->grid = grid;
	render->showing.period_ns = render->stats->vblank_ns = grid_period_ns(&grid);
	pacer_set_grid(&render->pacer, &grid);
	return true;
}

/* The picture that stays is to be black: there was none, or its client has gone. */
static bool wants_black(const struct render *render)
{
	return render->group == 0 || (render->orphan && render->settings->on_client_exit == ON_CLIENT_EXIT_BLACK);
}

void render_set_streams(struct render *render, struct stream *const *streams, uint32_t count)
{
	struct stream *shown = count ? streams[count - 1] : NULL;
	bool found = false;
	showing_forget_ended(&render->showing);
	for (uint32_t i = 0; i < count; i++)
		found |= streams[i]->number == render->stream_number;
	if (!found && render->group > 0 && !render->orphan) {
		render->orphan = true;
		render->redraw |= wants_black(render);
		/* A window takes its context with it when it is lost. */
		if (render->engine && engine_get_info(render->engine)->brought)
			draw_keep(render);
	}
	if (shown == render->stream)
		return;
	render_answer_waiting(render);
	render->stream = shown;
	start_pacer(render);
	want_held(render);
}

void render_set_view(struct render *render, uint32_t switches)
{
	render->redraw |= switches != render->view.switches;
	render->view.switches = switches;
}

/* What has changed, for the person who looks. */
static void say_changes(struct render *render, const struct settings *settings)
{
	char message[96] = "", value[OPTION_VALUE_BYTES];
	for (const struct option_row *row = option_table(); row->name; row++) {
		const size_t used = strlen(message);
		/* Of files and lines nothing is written over the picture, which may be what is recorded. */
		if (!option_is_of_picture(row) || settings_agree(render->settings, settings, row))
			continue;
		settings_get(settings, row->name, value, sizeof(value));
		snprintf(message + used, sizeof(message) - used, "%s%s: %.32s", used ? "\n" : "", row->name, value);
	}
	if (*message)
		view_say(&render->view, message, clock_now(render->clock));
}

void render_set_settings(struct render *render, const struct settings *settings)
{
	const bool governor =
		settings->governor != render->settings->governor || settings->level != render->settings->level;
	if ((settings->lab.patch == LAB_PATCH_OFF) != (render->settings->lab.patch == LAB_PATCH_OFF))
		render_forget_costs(render); /* the CPU draws on pictures */
	say_changes(render, settings);
	*render->settings = *settings;
	if (governor)
		governor_configure(&render->governor, settings->governor == 0, settings->level, clock_now(render->clock));
	render->settings_changed = render->redraw = true;
}

/* What only this thread knows about a flip. */
static void tell_lab(struct render *render, const struct presenter_flip *flip)
{
	const struct stats_row *row = &render->stats->timeline[(render->stats->timeline_count - 1) % STATS_TIMELINE];
	const struct showing_frame *frame = showing_find_frame(&render->showing, flip->group);
	struct points points = {.vblank = row->vblank,
							.frame_id = row->frame_id,
							.phase = row->phase,
							.show = (uint8_t)row->show,
							.time[POINT_READY] = row->ready_ns};
	if (frame) {
		points.time[POINT_SUBMIT] = frame->report.submit_ns;
		points.time[POINT_INTAKE] = frame->report.intake_ns;
	}
	snprintf(points.method, sizeof(points.method), "%.15s", render->settings->method);
	lab_tell(render->lab, &points);
}

/* A presenter that was late for its vblank has dropped it: if it was to stay it is drawn again. */
static void note_awaited(struct render *render, const struct presenter_flip *flip)
{
	const bool shown = flip->serial == render->awaited;
	const bool missed = flip->skipped > 0 || flip->dropped;
	const bool dropped = !shown && missed && flip->vblank >= render->awaited_vblank;
	if (dropped && render->awaited != 0)
		render->front_plain = render->front_black = false;
	if (shown || dropped)
		render->awaited = 0;
}

void render_flip(struct render *render, const struct presenter_flip *flip)
{
	if (!render->presenter)
		return;
	render->unanswered.pictures = 0;
	showing_flip(&render->showing, flip);
	/* One that came on display while all sleeps: the time since is no vblanks that were due. */
	if (render->paused)
		render->showing.last_target_ns = 0;
	note_awaited(render, flip);
	tees_flip(&render->tees, flip, &render->grid);
	if (lab_is_active(render->lab))
		tell_lab(render, flip);
	showing_settle_frames(&render->showing, render->showing.settling);
}

/* From now to a picture that is there as early as the presenter wants it. */
static uint64_t estimate(const struct render *render, const struct cost *cost)
{
	return (cost->count ? cost->safe_ns : FIRST_COST_NS) + render->lead_ns;
}

uint64_t render_first_vblank(const struct render *render)
{
	return grid_at_or_after(&render->grid, clock_now(render->clock) + render->lead_ns + 1);
}

uint64_t render_real_cost(const struct render *render)
{
	return estimate(render, &render->real_cost) + render->margin_ns;
}

static uint64_t before(uint64_t time_ns, uint64_t span_ns)
{
	return time_ns > span_ns ? time_ns - span_ns : 0;
}

void render_plan_pause_until(struct render *render, uint64_t vblank)
{
	for (; render->next_vblank < vblank; render->next_vblank++)
		showing_plan(&render->showing, render->next_vblank, SHOWING_PAUSE);
}

static uint64_t sooner_of(uint64_t a, uint64_t b)
{
	return a < b ? a : b;
}

static uint64_t later_of(uint64_t a, uint64_t b)
{
	return a > b ? a : b;
}

/* Vblanks that went by undecided were missed, unless nothing was due; the flip events count them. */
static void skip_passed(struct render *render, uint64_t now_ns)
{
	const uint64_t first = grid_at_or_after(&render->grid, now_ns + render->lead_ns + 1);
	if (render->pause_vblanks > 0 && !render->paused && first - render->next_vblank < SHOWING_VBLANKS)
		render_plan_pause_until(render, first);
	if (render->next_vblank < first)
		render->next_vblank = first;
}

/* ---- real frames ---- */

/*
 * When the newest frame may be begun: at once, unless that would give it a
 * vblank that another real frame has already. Then it gets the next one and is
 * begun only as early as that needs; what arrives meanwhile replaces it.
 */
static uint64_t real_start(struct render *render, uint64_t now_ns)
{
	const uint64_t cost = render_real_cost(render);
	if (now_ns < render->hold_until_ns)
		return render->hold_until_ns;
	if (!render->begun || grid_at_or_after(&render->grid, now_ns + cost) > render->real_vblank)
		return 0;
	const uint64_t earliest = before(grid_time(&render->grid, render->real_vblank), cost) + 1;
	/* Half a vblank earlier than it must, since a wake-up may be late. */
	const uint64_t slack = (uint64_t)(grid_period_ns(&render->grid) / 2.0);
	const uint64_t needed = before(grid_time(&render->grid, render->real_vblank + 1), cost + slack);
	render->hold_until_ns = later_of(earliest, needed);
	return render->hold_until_ns;
}

/* A vblank before the real frame's lacks its in-between, and drawing that does not cost the real frame its vblank. */
static bool fits_before_real(const struct render *render, uint64_t now_ns)
{
	const uint64_t real = render_real_cost(render), between = estimate(render, &render->between_cost);
	const uint64_t vblank = grid_at_or_after(&render->grid, now_ns + real);
	return render->begun && render->pause_vblanks == 0 && render->next_vblank < vblank &&
		   now_ns + between <= grid_time(&render->grid, render->next_vblank) &&
		   now_ns + between + real <= grid_time(&render->grid, vblank);
}

/* ---- pauses ---- */

/* Is the picture queued last one that may be looked at for long? */
static bool shows_what_stays(const struct render *render)
{
	if (wants_black(render))
		return render->front_black;
	return render->front_plain || (!render->begun && !render->kept.data) || !render->engine;
}

static uint64_t stay_cost(const struct render *render)
{
	return estimate(render, wants_black(render) ? &render->empty_cost : &render->plain_cost);
}

static void draw_what_stays(struct render *render, uint64_t vblank)
{
	if (wants_black(render))
		draw_empty(render, vblank);
	else if (render->begun)
		draw_plain(render, vblank);
	else
		draw_kept(render, vblank);
}

static void fall_asleep(struct render *render)
{
	close_all_frames(render);
	render->presenter->impl->pause(render->presenter);
	render->showing.last_target_ns = 0;
	render->paused = true;
	tees_rest(&render->tees, render->awaited);
}

/* Is the last picture on display, so that all may sleep? */
static bool may_sleep(const struct render *render)
{
	const uint32_t vblanks = render->pause_vblanks;
	return vblanks >= SLEEP_AFTER && (render->awaited == 0 || vblanks >= SLEEP_AFTER + SLEEP_ANYWAY);
}

/* Nothing is due at next_vblank: the picture stays, first as it is, then the plain one, and then all sleeps. */
static void pause_once(struct render *render)
{
	const uint64_t vblank = render->next_vblank++;
	showing_plan(&render->showing, vblank, SHOWING_PAUSE);
	render->showing.pausing = true;
	if (render->pause_vblanks++ == 0)
		render->presenter->impl->clear_standby(render->presenter);
	if (render->pause_vblanks == PLAIN_AFTER) {
		showing_settle_frames(&render->showing, render->group + 1);
		draw_count_report(render);
		render->stay_tries = 0;
	}
	if (render->pause_vblanks >= PLAIN_AFTER && !shows_what_stays(render) && render->stay_tries++ < STAY_TRIES) {
		/* Not for one that it misses for sure, as it has just missed one perhaps. */
		const uint64_t first = grid_at_or_after(&render->grid, clock_now(render->clock) + stay_cost(render));
		render_plan_pause_until(render, first + 1);
		draw_what_stays(render, later_of(vblank, first));
		render->pause_vblanks = PLAIN_AFTER;
	}
	if (may_sleep(render))
		fall_asleep(render);
}

/* The picture that stays is drawn again, as the view is now, or that of another stream; then all sleeps again. */
static void draw_still_anew(struct render *render, uint64_t now_ns)
{
	const uint64_t cost = render->show_held ? render_real_cost(render) : stay_cost(render);
	const uint64_t vblank = grid_at_or_after(&render->grid, now_ns + cost);
	render->redraw = false;
	if ((!wants_black(render) && !render->begun && !render->show_held && !render->kept.data) || !render->engine)
		return;
	if (vblank > render->next_vblank)
		render->next_vblank = vblank;
	render->pause_vblanks = PLAIN_AFTER;
	render->stay_tries = 0;
	render->paused = render->front_plain = render->front_black = false;
	if (render->show_held)
		draw_held(render, render->next_vblank);
	else
		draw_what_stays(render, render->next_vblank);
	render->show_held = false;
	showing_plan(&render->showing, render->next_vblank++, SHOWING_PAUSE);
}

/* The stream is gone: the plain picture soon. */
static uint64_t wind_down(struct render *render, uint64_t now_ns)
{
	if (render->paused)
		return RENDER_NEVER;
	const uint64_t start = before(grid_time(&render->grid, render->next_vblank), render_real_cost(render));
	if (now_ns < start)
		return start;
	if (render->pause_vblanks < PLAIN_AFTER - 1) {
		render->presenter->impl->clear_standby(render->presenter);
		render->pause_vblanks = PLAIN_AFTER - 1;
	}
	pause_once(render);
	return 0;
}

/* ---- between real frames ---- */

/* When the picture of next_vblank is to be begun. */
static uint64_t between_start(const struct render *render)
{
	const uint64_t vblank = render->next_vblank, time_ns = grid_time(&render->grid, vblank);
	const uint64_t costs = later_of(render_real_cost(render), estimate(render, &render->between_cost));
	if (vblank >= render->real_vblank + render->n || render->pause_vblanks > 0)
		return before(time_ns, costs);
	/* Not further ahead than the presenter's queue holds. */
	return vblank > AHEAD ? grid_time(&render->grid, vblank - AHEAD) : 0;
}

/* The plain picture that stands by comes first if there is time, or if the in-between is late anyway. */
static bool standby_first(const struct render *render, uint64_t now_ns)
{
	if (!render->boosted || render->standby_done || render->n < 2 || render->pause_vblanks > 0)
		return false;
	const uint64_t time_ns = grid_time(&render->grid, render->next_vblank);
	const uint64_t plain = estimate(render, &render->plain_cost), between = estimate(render, &render->between_cost);
	return now_ns + plain + between <= time_ns || now_ns + render->between_cost.usual_ns + render->lead_ns > time_ns ||
		   render->next_vblank > render->real_vblank + 1;
}

/* With `urgent` at once: a real frame waits for it. */
static uint64_t show_between(struct render *render, uint64_t now_ns, bool urgent)
{
	const uint64_t start = urgent ? 0 : between_start(render);
	if (now_ns < start)
		return start;
	if (standby_first(render, now_ns)) {
		draw_plain(render, 0);
		return 0;
	}
	const uint64_t vblank = render->next_vblank;
	const struct pacer_decision decision = pacer_decide(&render->pacer, vblank);
	if (decision.show == PACER_REPEAT && pacer_passes_through(&render->pacer) &&
		vblank - render->real_vblank < PLAIN_AFTER) {
		showing_plan(&render->showing, vblank, SHOWING_REPEAT);
		render->next_vblank++;
	} else if (decision.show != PACER_IN_BETWEEN) {
		pause_once(render);
	} else if (render->still || !governor_draws(render->governor.level, vblank - render->real_vblank)) {
		showing_plan(&render->showing, vblank, SHOWING_REPEAT);
		render->next_vblank++;
	} else {
		showing_plan(&render->showing, vblank, SHOWING_IN_BETWEEN);
		render->next_vblank++;
		/* Late beyond doubt: not worth the time that the next one needs. */
		if (now_ns + render->between_cost.usual_ns + render->lead_ns <= decision.target_ns)
			draw_in_between(render, &decision, vblank);
		else
			cost_add(&render->between_cost,
					 render->between_cost.usual_ns / 8 * 7); /* or it would never be tried again */
	}
	return 0;
}

void render_expect_flips(struct render *render)
{
	const uint64_t now_ns = clock_now(render->clock);
	if (render->unanswered.pictures++ == 0)
		render->unanswered.first_ns = now_ns;
	render->unanswered.last_ns = now_ns;
}

bool render_is_stuck(const struct render *render)
{
	const uint64_t now_ns = clock_now(render->clock);
	const uint64_t patience_ns = STUCK_NS + (uint64_t)(STUCK_VBLANKS * grid_period_ns(&render->grid));
	return render->presenter && render->unanswered.pictures >= STUCK_PICTURES &&
		   now_ns - render->unanswered.first_ns > patience_ns && now_ns - render->unanswered.last_ns < FORGIVEN_NS;
}

static uint64_t step(struct render *render)
{
	const uint64_t now_ns = clock_now(render->clock);
	uint64_t wake_ns = RENDER_NEVER;
	bool urgent = false;

	if (!render->presenter) {
		if (has_new_frame(render) && render->between_presenters)
			render_keep_newest(render);
		else if (has_new_frame(render))
			render_skip_frames(render, render->stream);
		return RENDER_NEVER;
	}
	/* A stream that moves takes it with its next frame. */
	if (render->other_engine && render->paused) {
		draw_take_engine(render);
		want_held(render);
		render->redraw = true;
	}
	const bool lost = !render->engine;
	if (!draw_revive_engine(render, now_ns))
		return render->engine_retry_ns;
	if (lost)
		want_held(render);
	skip_passed(render, now_ns);
	if (has_new_frame(render) && !render->next.wished) {
		wake_ns = later_of(real_start(render, now_ns), render->take_again_ns);
		urgent = now_ns >= wake_ns;
		if (urgent && !fits_before_real(render, now_ns)) {
			draw_real(render, now_ns);
			return 0;
		}
	}
	if (view_message_is_over(&render->view, now_ns))
		render->redraw = true;
	const bool other = render->show_held && wake_ns == RENDER_NEVER;
	if (other || (render->redraw && (render->pause_vblanks >= PLAIN_AFTER || render->group == 0)))
		draw_still_anew(render, now_ns);
	if (render->paused)
		return sooner_of(wake_ns, view_message_end(&render->view));
	const bool moves = render->stream && render->begun && render->pacer.has_frame;
	const uint64_t next_ns = moves ? show_between(render, now_ns, urgent) : wind_down(render, now_ns);
	return sooner_of(next_ns, wake_ns);
}

uint64_t render_step(struct render *render)
{
	const uint64_t next_ns = step(render);
	return render->next.wished ? sooner_of(next_ns, clock_now(render->clock) + GO_OVER_LOOK_NS) : next_ns;
}
