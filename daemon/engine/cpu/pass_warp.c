/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The displaced grid, tile by tile (docs/method.md, 3), straight into the caller's image. */
#include "daemon/engine/cpu/executor_cpu.h"

static void draw(void *context, uint32_t tile, uint32_t thread)
{
	struct executor_cpu *executor = context;
	executor->kernels->draw_tile(&executor->scene, tile, &executor->scratch[thread]);
}

static int run(struct engine *engine, struct error *error)
{
	struct executor_cpu *executor = cpu_of(engine);
	struct scene *scene = &executor->scene;
	int result = cpu_shown(engine, &scene->sheet, error);
	scene->mesh = &engine->mesh;
	scene->phase = (float)engine->job.phase;
	scene->tolerance = engine->params.leave_nothing_out ? -1.0f : engine->mesh.tolerance;
	scene->width = engine->width;
	scene->height = engine->height;
	if (result == 0)
		result = scene_prepare(scene, error);
	if (result < 0)
		return result;
	scene->picture = cpu_picture(engine, engine->job.picture);
	scene->low = cpu_picture(engine, PICTURE_LOW);
	scene->contents = &executor->contents;
	scene->id = engine->job.picture;
	pool_run(executor->base.pool, draw, executor, scene_tiles(scene));
	return 0;
}

const struct pass cpu_pass_warp = {.run = run};
