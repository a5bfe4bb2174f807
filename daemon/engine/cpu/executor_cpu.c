/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/executor_cpu.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/now.h"
#include "daemon/engine/pass.h"

static struct executor_cpu *self(struct executor *executor)
{
	return (struct executor_cpu *)executor;
}

static int enter(struct executor *executor, struct error *error)
{
	self(executor)->sheet_is_open = false;
	return 0;
}

static void leave(struct executor *executor)
{
}

static void destroy(struct executor **executor)
{
	struct executor_cpu *gone = self(*executor);
	pool_destroy(&gone->base.pool);
	for (int i = 0; i < PICTURE_COUNT; i++)
		canvas_finish(&gone->pictures[i]);
	for (int i = 0; i < MAX_LEVELS; i++)
		canvas_finish(&gone->levels[i]);
	layers_finish(&gone->layers);
	contents_finish(&gone->contents);
	scene_finish(&gone->scene);
	free(gone->scratch);
	free(gone->weights.values);
	free(gone->intake.bounds);
	free(gone->intake.hashes);
	free(gone);
	*executor = NULL;
}

static void flush(struct executor *executor)
{
}

static int finish(struct executor *executor, struct error *error)
{
	return 0;
}

/* What was rendered is in the caller's memory. */
static int receive(struct executor *executor, struct arrival *arrival, struct error *error)
{
	return 0;
}

static void forget(struct executor *executor)
{
}

static void release_planes(struct engine *engine)
{
	cpu_finish_intake(engine);
}

static void time_begin(struct executor *executor, struct engine_pass_report *pass, bool on_cpu)
{
	self(executor)->timed = pass;
	self(executor)->began_ns = now_ns();
}

static void time_end(struct executor *executor)
{
	struct executor_cpu *cpu = self(executor);
	cpu->timed->ms += (double)(now_ns() - cpu->began_ns) * 1e-6;
	cpu->timed->runs++;
}

static uint64_t count_bytes(const struct executor_cpu *executor)
{
	uint64_t bytes = sizeof(*executor) + pool_threads(executor->base.pool) * sizeof(*executor->scratch);
	for (int i = 0; i < PICTURE_COUNT; i++)
		bytes += executor->pictures[i].capacity;
	for (int i = 0; i < MAX_LEVELS; i++)
		bytes += executor->levels[i].capacity;
	bytes += layers_bytes(&executor->layers) + contents_bytes(&executor->contents);
	return bytes + scene_bytes(&executor->scene) + executor->weights.capacity +
		   executor->intake.bounds_capacity * sizeof(*executor->intake.bounds) +
		   executor->intake.hashes_capacity * sizeof(*executor->intake.hashes);
}

static void collect_times(struct executor *executor)
{
	executor->bytes = count_bytes(self(executor));
}

static void drop_times(struct executor *executor)
{
}

static const char *time_source(const struct executor *executor)
{
	return "cpu";
}

static const struct executor_ops ops = {
	.passes =
		{
			[PASS_ANALYSE] = &cpu_pass_analyse,
			[PASS_FIELD] = &pass_field,
			[PASS_UPLOAD] = &cpu_pass_upload,
			[PASS_PYRAMID] = &cpu_pass_pyramid,
			[PASS_COMPENSATE] = &cpu_pass_compensate,
			[PASS_PAINT] = &pass_paint,
			[PASS_PUT] = &cpu_pass_put,
			[PASS_WARP] = &cpu_pass_warp,
			[PASS_UI] = &cpu_pass_ui,
			[PASS_READ] = &cpu_pass_read,
		},
	.enter = enter,
	.leave = leave,
	.destroy = destroy,
	.release_planes = release_planes,
	.flush = flush,
	.finish = finish,
	.receive = receive,
	.forget = forget,
	.time_begin = time_begin,
	.time_end = time_end,
	.collect_times = collect_times,
	.drop_times = drop_times,
	.time_source = time_source,
};

static const struct cpu_kernels *choose_kernels(const char *name, struct error *error)
{
	if (!name)
		return cpu_level_best();
	for (int level = 0; level < CPU_LEVEL_COUNT; level++) {
		const struct cpu_kernels *kernels = cpu_level_kernels((enum cpu_level)level);
		if (kernels && strcmp(kernels->name, name) == 0)
			return kernels;
	}
	error_set(error, -EINVAL, "level is \"%.32s\", which this machine or this build does not have", name);
	return NULL;
}

static bool start(struct executor_cpu *executor, const struct engine_params *params, struct error *error)
{
	executor->kernels = choose_kernels(params->level, error);
	if (!executor->kernels)
		return false;
	executor->base.pool = pool_create(params->threads);
	size_t scratch = executor->base.pool ? pool_threads(executor->base.pool) * sizeof(*executor->scratch) : 0;
	executor->scratch = scratch ? aligned_alloc(64, (scratch + 63) / 64 * 64) : NULL;
	if (!executor->scratch) {
		error_set(error, -ENOMEM, "out of memory");
		return false;
	}
	memset(executor->scratch, 0, scratch);
	snprintf(executor->renderer, sizeof(executor->renderer), "cpu (%s, %u threads)", executor->kernels->name,
			 pool_threads(executor->base.pool));
	executor->base.info =
		(struct engine_info){.context = "cpu", .renderer = executor->renderer, .version = "", .software = true};
	return true;
}

struct executor *executor_cpu_create(const struct engine_params *params, struct error *error)
{
	struct executor_cpu *executor = calloc(1, sizeof(*executor));
	if (!executor) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	executor->base.ops = &ops;
	executor->base.max_size = PURSUIT_MAX_SIZE;
	struct executor *made = &executor->base;
	if (!start(executor, params, error))
		destroy(&made);
	return made;
}

const struct canvas *cpu_picture(struct engine *engine, enum picture_id id)
{
	struct executor_cpu *executor = cpu_of(engine);
	cpu_finish_intake(engine);
	if (id != PICTURE_ORIGINAL && id != PICTURE_REAL && id != PICTURE_BETWEEN)
		return &executor->pictures[id];
	layers_show(&executor->layers, id, &executor->pictures[PICTURE_ORIGINAL], executor->base.pool);
	return &executor->pictures[PICTURE_ORIGINAL];
}

int cpu_shown(struct engine *engine, const struct sheet **shown, struct error *error)
{
	struct executor_cpu *executor = cpu_of(engine);
	const struct engine_image *image = engine->job.image;
	const bool given = image && image->data;
	struct canvas *own = &executor->pictures[PICTURE_SHOWN];
	*shown = &executor->sheet;
	if (executor->sheet_is_open)
		return 0;
	if (!given && canvas_resize(own, engine->width, engine->height, error) < 0)
		return -ENOMEM;
	const bool keeps = given && !engine->params.leave_nothing_out;
	contents_open(&executor->contents, keeps ? engine->job.held : 0, &executor->sheet);
	executor->sheet.data = given ? image->data : own->pixels;
	executor->sheet.stride = given ? image->stride : own->stride;
	executor->sheet_is_open = true;
	return 0;
}

struct copy {
	const struct contents *contents;
	enum picture_id id;
	const struct canvas *from;
	const struct sheet *to;
};

/* Tiles `first` to `end` - 1 of a row of them. */
static void copy_tiles(const struct copy *copy, uint32_t row, uint32_t first, uint32_t end)
{
	const uint32_t left = first * TILE_WIDTH, width = copy->from->width - left, most = (end - first) * TILE_WIDTH;
	for (uint32_t y = row * TILE_HEIGHT; y < (row + 1) * TILE_HEIGHT && y < copy->from->height; y++)
		memcpy(copy->to->data + y * copy->to->stride + 4 * (size_t)left, canvas_row(copy->from, y) + 4 * (size_t)left,
			   4 * (size_t)(width < most ? width : most));
}

static void copy_row(void *context, uint32_t row, uint32_t thread)
{
	const struct copy *copy = context;
	const uint32_t columns = copy->contents->columns;
	for (uint32_t column = 0; column < columns; column++) {
		const uint32_t first = column;
		for (uint32_t tile = row * columns + column; column < columns; column++, tile++)
			if (sheet_has(copy->to, tile, contents_of(copy->contents, copy->id, tile)))
				break;
		if (first < column)
			copy_tiles(copy, row, first, column);
	}
}

void cpu_copy(struct executor_cpu *executor, enum picture_id id, const struct canvas *from)
{
	struct copy copy = {&executor->contents, id, from, &executor->sheet};
	pool_run(executor->base.pool, copy_row, &copy, executor->contents.rows);
}
