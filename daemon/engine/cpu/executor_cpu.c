/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/executor_cpu.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/now.h"
#include "daemon/engine/pass.h"

/* Rows that one item of a copy takes. */
#define COPY_ROWS 32u

static struct executor_cpu *self(struct executor *executor)
{
	return (struct executor_cpu *)executor;
}

static int enter(struct executor *executor, struct error *error)
{
	return 0;
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
	scene_finish(&gone->scene);
	free(gone->scratch);
	free(gone->weights.values);
	free(gone->intake.bounds);
	free(gone->intake.hashes);
	free(gone);
	*executor = NULL;
}

static void keep_original(struct executor *executor)
{
	struct executor_cpu *cpu = self(executor);
	layers_show(&cpu->layers, PICTURE_ORIGINAL, &cpu->pictures[PICTURE_ORIGINAL], cpu->base.pool);
	layers_clear(&cpu->layers);
	struct canvas kept = cpu->pictures[PICTURE_ORIGINAL];
	cpu->pictures[PICTURE_ORIGINAL] = cpu->pictures[PICTURE_PREVIOUS];
	cpu->pictures[PICTURE_PREVIOUS] = kept;
}

static void flush(struct executor *executor)
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
	return bytes + layers_bytes(&executor->layers) + scene_bytes(&executor->scene) + executor->weights.capacity +
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
	.destroy = destroy,
	.keep_original = keep_original,
	.release_planes = release_planes,
	.flush = flush,
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

int cpu_shown(struct engine *engine, struct rows *shown, struct error *error)
{
	const struct engine_image *image = engine->job.image;
	if (image && image->data) {
		*shown = (struct rows){image->data, image->stride};
		return 0;
	}
	struct canvas *own = &cpu_of(engine)->pictures[PICTURE_SHOWN];
	int result = canvas_resize(own, engine->width, engine->height, error);
	*shown = (struct rows){own->pixels, own->stride};
	return result;
}

struct copy {
	const struct canvas *from;
	const struct rows *to;
};

static void copy_rows(void *context, uint32_t item, uint32_t thread)
{
	const struct copy *copy = context;
	uint32_t end = (item + 1) * COPY_ROWS;
	for (uint32_t y = item * COPY_ROWS; y < end && y < copy->from->height; y++)
		memcpy(copy->to->data + y * copy->to->stride, canvas_row(copy->from, y), 4 * (size_t)copy->from->width);
}

void cpu_copy(struct executor_cpu *executor, const struct canvas *from, const struct rows *to)
{
	struct copy copy = {from, to};
	pool_run(executor->base.pool, copy_rows, &copy, (from->height + COPY_ROWS - 1) / COPY_ROWS);
}
