/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/motion_order.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "daemon/engine/bend.h"
#include "daemon/engine/plan.h"

#define SIDE 160u
#define RADIUS 60.0
#define EPOCH_NS UINT64_C(1000000000)

struct point {
	double x, y;
};

/* A picture that nobody looks at, and the motion of one frame. */
struct world {
	uint8_t color[SIDE][SIDE][4];
	float motion[SIDE][SIDE][2];
	struct frame frame;
};

const char *motion_path_name(enum motion_path path)
{
	static const char *const names[MOTION_PATH_COUNT] = {"fan", "parabola", "cubic"};
	return path < MOTION_PATH_COUNT ? names[path] : "";
}

/* Where what is at a place at one time is at another, seconds. */
static struct point follow(enum motion_path path, struct point from, double time, double later)
{
	if (path == MOTION_PATH_FAN) {
		const double angle = 2.0 * (later - time), x = from.x - SIDE / 2.0, y = from.y - SIDE / 2.0;
		return (struct point){SIDE / 2.0 + x * cos(angle) - y * sin(angle),
							  SIDE / 2.0 + x * sin(angle) + y * cos(angle)};
	}
	const double jerk = path == MOTION_PATH_CUBIC ? 1.0 : 0.0, once = later - time;
	const double twice = later * later - time * time, thrice = later * later * later - time * time * time;
	return (struct point){from.x + 60.0 * once + 150.0 * twice + jerk * 4000.0 / 6.0 * thrice,
						  from.y - 20.0 * once + 450.0 * twice - jerk * 2000.0 / 6.0 * thrice};
}

static void describe(struct world *world, double interval_s)
{
	struct pursuit_frame_header *header = &world->frame.header;
	static const uint32_t kinds[2][3] = {{PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8, 4},
										 {PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG32F, 8}};
	header->motion_kind = PURSUIT_MOTION_BACKWARD;
	header->real_interval_ns = header->motion_interval_ns = (uint64_t)llround(interval_s * 1e9);
	header->plane_count = 2;
	for (int i = 0; i < 2; i++)
		header->planes[i] = (struct pursuit_plane){.role = kinds[i][0],
												   .format = kinds[i][1],
												   .storage = PURSUIT_STORAGE_MEMORY,
												   .width = SIDE,
												   .height = SIDE,
												   .stride = kinds[i][2] * SIDE,
												   .size = kinds[i][2] * SIDE * SIDE};
	world->frame.planes[0] = &world->color[0][0][0];
	world->frame.planes[1] = (const uint8_t *)world->motion;
}

static void move(struct world *world, enum motion_path path, double time, double interval_s)
{
	for (uint32_t j = 0; j < SIDE; j++)
		for (uint32_t i = 0; i < SIDE; i++) {
			const struct point here = {i + 0.5, j + 0.5}, before = follow(path, here, time, time - interval_s);
			world->motion[j][i][0] = (float)(here.x - before.x);
			world->motion[j][i][1] = (float)(here.y - before.y);
		}
}

/* Both frames, `gap` intervals from one another, through the analysis, as the engine does it. */
static int extrapolate(struct world *world, enum motion_path path, double interval_s, uint32_t gap, struct plan *plan,
					   struct bend *bend, struct error *error)
{
	/* So far away that everything can be tracked. */
	const struct plan_params params = {.viewing_distance_mm = 1e6f, .last_phase = 1.0f};
	int result = 0;
	for (uint32_t frame = 0; frame <= gap && result == 0; frame += gap) {
		world->frame.header.frame_id = 1 + frame;
		world->frame.header.time_ns = EPOCH_NS + frame * world->frame.header.real_interval_ns;
		move(world, path, ((double)frame - gap) * interval_s, interval_s);
		result = plan_make(plan, &world->frame, &params, error);
		if (result == 0)
			result = bend_begin(bend, &world->frame, plan, &params, error);
	}
	return result;
}

static double worst_error(const struct plan *plan, enum motion_path path, double interval_s, double phase)
{
	double worst = 0.0;
	for (uint32_t i = 0; i < plan->columns * plan->rows; i++) {
		const struct plan_vertex *vertex = &plan->vertices[i];
		const struct point here = {(double)vertex->x, (double)vertex->y};
		if (hypot(here.x - SIDE / 2.0, here.y - SIDE / 2.0) > RADIUS)
			continue;
		const struct point there = follow(path, here, 0.0, phase * interval_s);
		const double x = here.x + phase * (double)vertex->ux, y = here.y + phase * (double)vertex->uy;
		worst = fmax(worst, hypot(x - there.x, y - there.y));
	}
	return worst;
}

double motion_order_error(enum motion_path path, enum engine_motion_model model, double interval_s, uint32_t gap,
						  double phase, struct error *error)
{
	struct world *world = calloc(1, sizeof(*world));
	struct plan plan = {0};
	struct bend bend = {0};
	double worst = -1.0;
	if (!world) {
		error_set(error, -ENOMEM, "out of memory");
		return worst;
	}
	describe(world, interval_s);
	if (extrapolate(world, path, interval_s, gap, &plan, &bend, error) == 0) {
		if (model == ENGINE_MOTION_QUADRATIC)
			bend_apply(&bend, &plan, phase);
		worst = worst_error(&plan, path, interval_s, phase);
	}
	bend_finish(&bend);
	plan_finish(&plan);
	free(world);
	return worst;
}
