/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The life of the engine: made, lost with its GL context or when the driver has no memory, replaced at once by one on
 * the CPU so that the next vblank has its picture, and tried again.
 */
#include <errno.h>
#include <string.h>

#include "daemon/render.h"

#define MS UINT64_C(1000000)
#define FIRST_DELAY (100 * MS)
#define LAST_DELAY (60000 * MS)
/* One that is lost sooner than this after it was made has not helped. */
#define GOOD_LIFE (10000 * MS)

int draw_get_params(const struct render *render, struct engine_params *params, struct error *error)
{
	const int result = settings_engine_params(render->settings, params, error);
	/* Where real frames are as fast as the display there is nothing between them. */
	governor_apply(render->passes_through ? GOVERNOR_LEVELS - 1 : render->governor.level, params);
	return result;
}

/* What a picture is seen on is not among them: other numbers, the same work. */
static bool cost_the_same(const struct engine_params *a, const struct engine_params *b)
{
	return a->method && b->method && strcmp(a->method, b->method) == 0 && a->context == b->context &&
		   a->device == b->device && a->gles == b->gles && a->threads == b->threads && a->blur == b->blur &&
		   a->motion_model == b->motion_model && a->analysis == b->analysis &&
		   a->no_compensation == b->no_compensation && a->cell == b->cell && a->blur_level == b->blur_level &&
		   a->threshold_quarter == b->threshold_quarter;
}

void draw_note_params(struct render *render, const struct engine_params *params)
{
	if (!cost_the_same(params, &render->params))
		render_forget_costs(render);
	render->params = *params;
	snprintf(render->params_method, sizeof(render->params_method), "%s", params->method);
	render->params.method = render->params_method;
}

static bool runs_on_cpu(const struct render *render)
{
	return strcmp(engine_get_info(render->engine)->context, "cpu") == 0;
}

int draw_make_engine(struct render *render, struct error *error)
{
	struct engine_params params;
	const int result = draw_get_params(render, &params, error);
	if (result < 0)
		return result;
	params.brought = render->context && !render->context_shunned ? &render->brought : NULL;
	struct engine *engine = engine_create(&params, error);
	if (!engine)
		return -EIO;
	engine_destroy(&render->engine);
	render->engine = engine;
	draw_note_params(render, &params);
	render->stand_in = false;
	render->engine_made_ns = clock_now(render->clock);
	const struct engine_info *info = engine_get_info(engine);
	if (info->brought)
		log_info(render->log, "pictures stay in GL, in the context of the %s", info->context);
	render->owner.engine_made(render->owner.data, info);
	return 0;
}

void draw_follow_context(struct render *render)
{
	const struct presenter_impl *impl = render->presenter ? render->presenter->impl : NULL;
	const struct presenter_context *context = impl && impl->get_context ? impl->get_context(render->presenter) : NULL;
	if (context == render->context)
		return;
	/* One in a context that goes, or that could have been in the one that comes. */
	if (render->engine && (context || engine_get_info(render->engine)->brought)) {
		if (!render->kept.data)
			draw_keep(render);
		engine_destroy(&render->engine);
		render->engine_retry_ns = render->engine_delay_ns = 0;
		render->begun = render->report_due = false;
		render->real_cost = (struct cost){.count = 0};
	}
	render->context = context;
	render->context_shunned = render->through_memory = false;
	if (context)
		render->brought = (struct engine_context){.name = context->name,
												  .enter = context->enter,
												  .release = context->release,
												  .find = context->find,
												  .data = context->data};
}

/* ---- losses ---- */

bool draw_is_lost(const struct render *render, int result)
{
	/* On the CPU memory is out for a frame, not for good. */
	return result == -EIO || (result == -ENOMEM && !runs_on_cpu(render));
}

static void try_later(struct render *render, uint64_t now_ns)
{
	render->engine_delay_ns = render->engine_delay_ns ? render->engine_delay_ns * 2 : FIRST_DELAY;
	if (render->engine_delay_ns > LAST_DELAY)
		render->engine_delay_ns = LAST_DELAY;
	render->engine_retry_ns = now_ns + render->engine_delay_ns;
}

static void make_stand_in(struct render *render)
{
	struct engine_params params;
	struct error error;
	int result = draw_get_params(render, &params, &error);
	params.context = ENGINE_CONTEXT_CPU;
	params.gles = false;
	if (result == 0)
		render->engine = engine_create(&params, &error);
	render->stand_in = render->engine != NULL;
	if (render->engine)
		render->owner.engine_made(render->owner.data, engine_get_info(render->engine));
	else
		log_warning(render->log, "no engine on the CPU can stand in: %s", error.text);
}

void draw_lose_engine(struct render *render, int result, const char *why)
{
	const uint64_t now_ns = clock_now(render->clock);
	/* What was lost may be the context itself; it comes back only with its presenter. */
	render->context_shunned |= result == -EIO && engine_get_info(render->engine)->brought;
	if (now_ns - render->engine_made_ns > GOOD_LIFE)
		render->engine_delay_ns = 0;
	engine_destroy(&render->engine);
	render->begun = render->report_due = false;
	render->stats->engine_losses++;
	try_later(render, now_ns);
	log_warning(render->log, "the engine is lost, to be made anew in %u ms: %s",
				(unsigned)(render->engine_delay_ns / MS), why);
	make_stand_in(render);
}

/* Leaves what there is where it is if that fails. */
static bool make_anew(struct render *render, uint64_t now_ns)
{
	struct error error;
	if (draw_make_engine(render, &error) == 0) {
		log_info(render->log, "the engine is back");
		return true;
	}
	try_later(render, now_ns);
	log_warning(render->log, "the engine is lost still, to be tried again in %u ms: %s",
				(unsigned)(render->engine_delay_ns / MS), error.text);
	return false;
}

bool draw_revive_engine(struct render *render, uint64_t now_ns)
{
	return render->engine || (now_ns >= render->engine_retry_ns && make_anew(render, now_ns));
}

void draw_replace_stand_in(struct render *render, uint64_t now_ns)
{
	if (render->stand_in && now_ns >= render->engine_retry_ns && make_anew(render, now_ns))
		render->begun = render->report_due = false;
}

/* ---- another one ---- */

void render_set_engine(struct render *render, struct engine *engine)
{
	engine_destroy(&render->other_engine);
	render->other_engine = engine;
}

void draw_take_engine(struct render *render)
{
	struct error error;
	if (!render->other_engine)
		return;
	draw_count_report(render);
	draw_keep(render);
	engine_destroy(&render->engine);
	render->engine = render->other_engine;
	render->other_engine = NULL;
	render->stand_in = render->begun = render->report_due = render->context_shunned = render->through_memory = false;
	render->engine_made_ns = clock_now(render->clock);
	render->engine_retry_ns = render->engine_delay_ns = 0;
	render_forget_costs(render);
	render->real_cost = (struct cost){.count = 0};
	render->settings_changed = true;
	render->owner.engine_made(render->owner.data, engine_get_info(render->engine));
	/* In the presenter's context only this thread can make one. */
	if (render->context && draw_make_engine(render, &error) < 0)
		log_warning(render->log, "no engine in the context of the presenter: %s", error.text);
}
