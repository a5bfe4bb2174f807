/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A render thread's work without its thread, for tests of what it does when: the presenter is the headless one's memory
 * and queue, on a virtual clock; it refuses what it is told to, and its flips can be told later.
 */
#ifndef PURSUIT_TESTS_RENDER_WORLD_H
#define PURSUIT_TESTS_RENDER_WORLD_H

#include <errno.h>
#include <string.h>

#include "daemon/present/pictures.h"
#include "daemon/render.h"
#include "tests/engine/picture.h"
#include "tests/test.h"

#define MS UINT64_C(1000000)

static struct {
	struct clock_virtual clock;
	struct log log;
	struct settings settings;
	struct stats stats;
	struct presenter_impl impl;
	struct pictures pictures;
	struct render render;
	struct picture picture;
	unsigned refusals, refused, taken;
	unsigned full, lacks; /* so often there is no picture to draw into; there was none */
	uint64_t drawing_ns;  /* that a picture takes */
	bool silent;          /* flips are told later */
	bool held_up;         /* the presenter shows nothing for the moment */
	bool skips_none;      /* it tells of each vblank, as a display controller does, though it was late for it */
	struct presenter_flip untold[512];
	uint32_t untold_count;
	unsigned closed; /* tees */
} world;

static inline int acquire(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image)
{
	clock_wait_until(&world.clock.clock, clock_now(&world.clock.clock) + world.drawing_ns);
	if (world.full > 0) {
		world.full--;
		world.lacks++;
		return -EBUSY;
	}
	return pictures_acquire(presenter, width, height, image);
}

static inline int present(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank,
						  uint64_t group, uint64_t serial)
{
	if (world.refusals > 0) {
		world.refusals--;
		world.refused++;
		return -ETIME;
	}
	world.taken++;
	return pictures_present(presenter, image, vblank, group, serial);
}

static inline void on_engine(void *data, const struct engine_info *info)
{
	(void)data;
	(void)info;
}

static inline void on_close(void *data, struct tee *tee)
{
	(void)data;
	tee_destroy(&tee);
	world.closed++;
}

static inline void world_init(void)
{
	const struct presenter_params params = {
		.clock = &world.clock.clock, .log = &world.log, .refresh_numerator = 120, .refresh_denominator = 1};
	struct error error = {""};
	memset(&world, 0, sizeof(world));
	log_init(&world.log, LOG_LEVEL_ERROR);
	clock_init_virtual(&world.clock, 1000 * MS);
	settings_defaults(&world.settings);
	CHECK_INT(settings_set(&world.settings, "context", "cpu", &error), 0);
	world.impl = presenter_headless;
	world.impl.present = present;
	world.impl.acquire = acquire;
	pictures_init(&world.pictures, &world.impl, &params);
	struct render *render = &world.render;
	*render = (struct render){.settings = &world.settings,
							  .clock = &world.clock.clock,
							  .log = &world.log,
							  .stats = &world.stats,
							  .owner = {.engine_made = on_engine, .close_tee = on_close}};
	CHECK_INT(render_start(render, &error), 0);
	render_set_presenter(render, &world.pictures.presenter);
}

static inline void world_finish(void)
{
	render_finish(&world.render);
	pictures_finish(&world.pictures);
	if (world.picture.memory)
		picture_finish(&world.picture);
}

static inline void tell(const struct presenter_flip *flip)
{
	if (!world.silent)
		render_flip(&world.render, flip);
	else if (world.untold_count < sizeof(world.untold) / sizeof(world.untold[0]))
		world.untold[world.untold_count++] = *flip;
}

static inline void tell_untold(void)
{
	world.silent = false;
	for (uint32_t i = 0; i < world.untold_count; i++)
		tell(&world.untold[i]);
	world.untold_count = 0;
}

/* What is due within some vblanks is done, and each of them shown. */
static inline void run(uint32_t vblanks)
{
	const struct grid *grid = &world.pictures.grid;
	const uint64_t first = grid_at_or_after(grid, clock_now(&world.clock.clock)) + 1;
	for (uint64_t vblank = first; vblank < first + vblanks; vblank++) {
		const uint64_t vblank_ns = grid_time(grid, vblank);
		for (uint32_t step = 0; step < 1000 && clock_now(&world.clock.clock) < vblank_ns; step++) {
			const uint64_t next_ns = render_step(&world.render);
			clock_wait_until(&world.clock.clock, next_ns < vblank_ns ? next_ns : vblank_ns);
		}
		if (world.pictures.running && world.pictures.next_vblank <= vblank && !world.held_up) {
			struct presenter_flip flip = pictures_show_next(&world.pictures, vblank_ns);
			flip.skipped = world.skips_none ? 0 : flip.skipped;
			tell(&flip);
		}
	}
}

/* A boosted real frame is on display, and nothing comes after it. */
static inline void show_boosted(void)
{
	const struct engine_begin_params params = {.n = 2, .last_phase = 0.5, .real_interval_ns = 16 * MS};
	struct error error = {""};
	picture_init(&world.picture, 64, 64, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
	picture_draw_layers(&world.picture, 1.0);
	struct frame frame = world.picture.frame;
	frame.stream = frame.header.frame_id = 1;
	CHECK_INT(engine_begin(world.render.engine, &frame, &params, &error), 0);
	world.render.begun = true;
	world.render.group = 1;
	world.render.paused = false;
}

#endif
