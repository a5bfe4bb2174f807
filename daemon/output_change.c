/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Other settings of an output while it runs: what they need is made beside what there is, then taken over. On main. */

#include <errno.h>
#include <string.h>

#include "daemon/engine_maker.h"
#include "daemon/output_state.h"

static void close_tee(void *tee)
{
	struct tee *self = tee;
	tee_destroy(&self);
}

void output_close_tee(void *data, struct tee *tee)
{
	struct output *output = data;
	if (tee)
		closer_add(output->params.closer, close_tee, tee);
}

/* While main makes something it wakes nobody for frames that come. */
static void set_busy(struct output *output, bool busy)
{
	pthread_mutex_lock(&output->lock);
	output->main_is_busy = busy;
	output_wake_locked(output);
	pthread_mutex_unlock(&output->lock);
}

static int prepare_tee(struct output *output, const struct settings *now, const struct settings *fresh,
					   struct error *error)
{
	const struct tee_params params = {
		.path = fresh->tee,
		.log = output->params.log,
	};
	output->prepared.other_tee = strcmp(now->tee, fresh->tee) != 0;
	if (!output->prepared.other_tee || !*fresh->tee)
		return 0;
	output->prepared.tee = tee_create(&params, error);
	return output->prepared.tee ? 0 : -EIO;
}

static int prepare_engine(struct output *output, const struct settings *now, const struct settings *fresh,
						  struct error *error)
{
	if (strcmp(now->context, fresh->context) == 0 && now->gles == fresh->gles && now->threads == fresh->threads)
		return 0;
	output->prepared.engine = engine_maker_make(fresh, output->params.log, error);
	return output->prepared.engine ? 0 : -EIO;
}

int output_prepare(struct output *output, const struct settings *now, const struct settings *fresh, struct error *error)
{
	set_busy(output, true);
	output->prepared = (struct output_prepared){.other_tee = false};
	int result = prepare_tee(output, now, fresh, error);
	if (result == 0)
		result = prepare_engine(output, now, fresh, error);
	if (result == 0)
		result = display_prepare(output->display, fresh, error);
	output->prepared.display = result == 0;
	if (result < 0)
		output_abandon(output);
	return result;
}

void output_commit(struct output *output, const struct settings *fresh)
{
	struct output_prepared *prepared = &output->prepared;
	pthread_mutex_lock(&output->lock);
	output_wish_settings(output, fresh);
	output->tee_changed |= prepared->other_tee;
	struct tee *tee = prepared->other_tee ? output->wished_tee : NULL;
	if (prepared->other_tee)
		output->wished_tee = prepared->tee;
	struct engine *engine = prepared->engine ? output->wished_engine : NULL;
	if (prepared->engine)
		output->wished_engine = prepared->engine;
	output_wake_locked(output);
	pthread_mutex_unlock(&output->lock);
	/* Nobody has looked at what was wished before. */
	engine_destroy(&engine);
	output_close_tee(output, tee);
	display_commit(output->display);
	*prepared = (struct output_prepared){.other_tee = false};
	set_busy(output, false);
}

void output_abandon(struct output *output)
{
	struct output_prepared *prepared = &output->prepared;
	if (prepared->display)
		display_abandon(output->display);
	engine_destroy(&prepared->engine);
	output_close_tee(output, prepared->tee);
	*prepared = (struct output_prepared){.other_tee = false};
	set_busy(output, false);
}
