/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/bend.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* Motion that differs by no more than this within four pixels is that of one thing, pixels. */
#define ONE_THING 1.0f
/* A change beyond this share of the motion is another thing's motion or a jerk, not a curve. */
#define MOST_CHANGE 0.5f

static bool is_believed(struct bend_vector u, struct bend_vector a)
{
	return a.x * a.x + a.y * a.y <= MOST_CHANGE * MOST_CHANGE * (u.x * u.x + u.y * u.y);
}

/* Among the 3 x 3 pixels around a place, the motion of the frame before that is most alike. */
static struct bend_vector find_alike(const struct plan_dense *before, uint32_t i, uint32_t j, float scale,
									 struct bend_vector u)
{
	struct bend_vector best = {0.0f, 0.0f};
	float least = INFINITY;
	for (uint32_t y = j ? j - 1 : 0; y <= j + 1 && y < before->height; y++)
		for (uint32_t x = i ? i - 1 : 0; x <= i + 1 && x < before->width; x++) {
			const size_t at = (size_t)y * before->width + x;
			const struct bend_vector v = {scale * before->ux[at], scale * before->uy[at]};
			const float off = (u.x - v.x) * (u.x - v.x) + (u.y - v.y) * (u.y - v.y);
			if (off < least) {
				least = off;
				best = v;
			}
		}
	return best;
}

static struct bend_vector motion_at(const struct plan_dense *field, uint32_t i, uint32_t j)
{
	const size_t at = (size_t)j * field->width + i;
	return (struct bend_vector){field->ux[at], field->uy[at]};
}

static bool is_one_thing(const struct bend_vector v[4])
{
	const float left = fminf(fminf(v[0].x, v[1].x), fminf(v[2].x, v[3].x));
	const float right = fmaxf(fmaxf(v[0].x, v[1].x), fmaxf(v[2].x, v[3].x));
	const float top = fminf(fminf(v[0].y, v[1].y), fminf(v[2].y, v[3].y));
	const float bottom = fmaxf(fmaxf(v[0].y, v[1].y), fmaxf(v[2].y, v[3].y));
	return right - left <= ONE_THING && bottom - top <= ONE_THING;
}

static float mix(float a, float b, float share)
{
	return a + share * (b - a);
}

/* The motion of the frame before at a place within the picture, of the thing that now has motion u. */
static struct bend_vector look_up(const struct plan_dense *before, float x, float y, float scale, struct bend_vector u)
{
	const float fx = fminf(fmaxf(x - 0.5f, 0.0f), (float)(before->width - 1));
	const float fy = fminf(fmaxf(y - 0.5f, 0.0f), (float)(before->height - 1));
	const uint32_t i = (uint32_t)fx, j = (uint32_t)fy;
	const uint32_t right = i + 1 < before->width ? i + 1 : i, below = j + 1 < before->height ? j + 1 : j;
	const struct bend_vector v[4] = {motion_at(before, i, j), motion_at(before, right, j), motion_at(before, i, below),
									 motion_at(before, right, below)};
	if (!is_one_thing(v))
		return find_alike(before, (uint32_t)x, (uint32_t)y, scale, u);
	const float sx = fx - (float)i, sy = fy - (float)j;
	return (struct bend_vector){scale * mix(mix(v[0].x, v[1].x, sx), mix(v[2].x, v[3].x, sx), sy),
								scale * mix(mix(v[0].y, v[1].y, sx), mix(v[2].y, v[3].y, sx), sy)};
}

/*
 * The change a at position (x, y) of a thing with displacement u over the interval `now_s`, from the field before; 0
 * where that is not believed.
 */
static struct bend_vector change_of(const struct plan_dense *before, double now_s, float x, float y,
									struct bend_vector u)
{
	const struct bend_vector none = {0.0f, 0.0f};
	const float px = x - u.x, py = y - u.y;
	if (!(px >= 0.0f && py >= 0.0f && px < (float)before->width && py < (float)before->height))
		return none;
	const double ratio = now_s / before->real_interval_s;
	const struct bend_vector v = look_up(before, px, py, (float)ratio, u);
	const float weight = (float)(2.0 * ratio / (ratio + 1.0));
	const struct bend_vector a = {weight * (u.x - v.x), weight * (u.y - v.y)};
	return is_believed(u, a) ? a : none;
}

static bool reserve(struct bend *bend, uint32_t vertices)
{
	if (vertices <= bend->capacity)
		return true;
	free(bend->straight);
	free(bend->change);
	bend->straight = malloc(vertices * sizeof(*bend->straight));
	bend->change = malloc(vertices * sizeof(*bend->change));
	bend->capacity = bend->straight && bend->change ? vertices : 0;
	return bend->capacity > 0;
}

/* Does the motion of the plan that moves continue that of the field? */
static bool follows(const struct bend *bend, const struct frame *frame, const struct plan *plan)
{
	const struct plan_dense *before = &bend->field;
	const bool comparable =
		before->backward && before->real_interval_s > 0.0 && (before->rest == PLAN_MOVES || before->rest == PLAN_STILL);
	return bend->known && comparable && before->width == plan->width && before->height == plan->height &&
		   frame->header.motion_kind == PURSUIT_MOTION_BACKWARD && plan->real_interval_s > 0.0;
}

/* The field is still that of the frame before. */
static void find_changes(struct bend *bend, const struct frame *frame, const struct plan *plan)
{
	const bool curved = follows(bend, frame, plan);
	for (uint32_t i = 0; i < plan->columns * plan->rows; i++) {
		const struct plan_vertex *vertex = &plan->vertices[i];
		bend->straight[i] = (struct bend_vector){vertex->ux, vertex->uy};
		bend->change[i] = (struct bend_vector){0.0f, 0.0f};
		if (curved && (vertex->ux != 0.0f || vertex->uy != 0.0f))
			bend->change[i] = change_of(&bend->field, plan->real_interval_s, vertex->x, vertex->y, bend->straight[i]);
		bend->bent += bend->change[i].x != 0.0f || bend->change[i].y != 0.0f;
	}
}

int bend_begin(struct bend *bend, const struct frame *frame, const struct plan *plan, const struct plan_params *params,
			   struct error *error)
{
	const uint32_t count = plan->columns * plan->rows;
	int result = 0;
	bend->bent = 0;
	if (reserve(bend, count))
		find_changes(bend, frame, plan);
	else
		result = error_set(error, -ENOMEM, "out of memory for the change of motion of %u vertices", count);
	if (result == 0)
		result = plan_dense_make(&bend->field, frame, params, error);
	bend->known = result == 0;
	if (result < 0)
		bend_forget(bend);
	return result;
}

void bend_apply(const struct bend *bend, struct plan *plan, double phase)
{
	const float share = (float)(0.5 * (phase + 1.0));
	for (uint32_t i = 0; i < plan->columns * plan->rows; i++) {
		plan->vertices[i].ux = bend->straight[i].x + share * bend->change[i].x;
		plan->vertices[i].uy = bend->straight[i].y + share * bend->change[i].y;
	}
}

void bend_forget(struct bend *bend)
{
	bend->known = false;
	bend->bent = 0;
}

uint64_t bend_bytes(const struct bend *bend)
{
	return plan_dense_bytes(&bend->field) + 2 * sizeof(struct bend_vector) * (uint64_t)bend->capacity;
}

void bend_finish(struct bend *bend)
{
	plan_dense_finish(&bend->field);
	free(bend->straight);
	free(bend->change);
	*bend = (struct bend){0};
}
