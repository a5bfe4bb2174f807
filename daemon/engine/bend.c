/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/bend.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "daemon/engine/analysis/facts.h"
#include "daemon/engine/analysis/field.h"

/* Motion that differs by no more than this within four pixels is that of one thing, pixels. */
#define ONE_THING 1.0f
/* A change beyond this share of the motion is another thing's motion or a jerk, not a curve. */
#define MOST_CHANGE 0.5f
/* T / S and T / S' beyond which displacements are clamped. */
#define MOST_RATIO 8.0
#define SECONDS 1e-9

/* How two frames lie in time, with what is made of their motion. */
struct timing {
	double gap;              /* D / T: from the one before to this one */
	double span;             /* S / T */
	double weight;           /* of a change of u: T over the time between the middles of what the two motions span */
	struct plan_scale scale; /* of the motion of the one before: what it was is over T */
};

static bool is_believed(struct bend_vector u, struct bend_vector a)
{
	return a.x * a.x + a.y * a.y <= MOST_CHANGE * MOST_CHANGE * (u.x * u.x + u.y * u.y);
}

static struct bend_vector motion_at(const struct bend_before *before, const struct timing *timing, uint32_t i,
									uint32_t j)
{
	struct bend_vector u = {0.0f, 0.0f};
	if (before->rest == PLAN_MOVES)
		plan_motion_plane_get(&before->motion, i, j, &timing->scale, &u.x, &u.y);
	return u;
}

/* Among the 3 x 3 pixels around a place, the motion of the frame before that is most alike. */
static struct bend_vector find_alike(const struct bend_before *before, const struct timing *timing, uint32_t i,
									 uint32_t j, struct bend_vector u)
{
	struct bend_vector best = {0.0f, 0.0f};
	float least = INFINITY;
	for (uint32_t y = j ? j - 1 : 0; y <= j + 1 && y < before->height; y++)
		for (uint32_t x = i ? i - 1 : 0; x <= i + 1 && x < before->width; x++) {
			const struct bend_vector v = motion_at(before, timing, x, y);
			const float off = (u.x - v.x) * (u.x - v.x) + (u.y - v.y) * (u.y - v.y);
			if (off < least) {
				least = off;
				best = v;
			}
		}
	return best;
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
static struct bend_vector look_up(const struct bend_before *before, const struct timing *timing, float x, float y,
								  struct bend_vector u)
{
	const float fx = fminf(fmaxf(x - 0.5f, 0.0f), (float)(before->width - 1));
	const float fy = fminf(fmaxf(y - 0.5f, 0.0f), (float)(before->height - 1));
	const uint32_t i = (uint32_t)fx, j = (uint32_t)fy;
	const uint32_t right = i + 1 < before->width ? i + 1 : i, below = j + 1 < before->height ? j + 1 : j;
	const struct bend_vector v[4] = {motion_at(before, timing, i, j), motion_at(before, timing, right, j),
									 motion_at(before, timing, i, below), motion_at(before, timing, right, below)};
	if (!is_one_thing(v))
		return find_alike(before, timing, (uint32_t)x, (uint32_t)y, u);
	const float sx = fx - (float)i, sy = fy - (float)j;
	return (struct bend_vector){mix(mix(v[0].x, v[1].x, sx), mix(v[2].x, v[3].x, sx), sy),
								mix(mix(v[0].y, v[1].y, sx), mix(v[2].y, v[3].y, sx), sy)};
}

/*
 * The change a at position (x, y) of a thing with displacement u; 0 where that is not believed. Where it then was its
 * motion tells if that spans just the gap; else a straight line does at first, and then the curve that comes of it.
 */
static struct bend_vector change_of(const struct bend_before *before, const struct timing *timing, float x, float y,
									struct bend_vector u)
{
	const struct bend_vector none = {0.0f, 0.0f};
	const float gap = (float)timing->gap, off = (float)(0.5 * timing->gap * (timing->gap - timing->span));
	const float weight = (float)timing->weight;
	struct bend_vector change = none, a = none;
	for (int looks = off != 0.0f ? 2 : 1; looks > 0; looks--) {
		const float px = x - gap * u.x + off * a.x, py = y - gap * u.y + off * a.y;
		if (!(px >= 0.0f && py >= 0.0f && px < (float)before->width && py < (float)before->height))
			return none;
		const struct bend_vector v = look_up(before, timing, px, py, u);
		change = (struct bend_vector){u.x - v.x, u.y - v.y};
		a = (struct bend_vector){weight * change.x, weight * change.y};
	}
	return is_believed(u, change) && is_believed(u, a) ? a : none;
}

/* Seconds from the frame before to this one, which came later; 0: nobody knows. */
static double gap_between(const struct bend_before *before, const struct pursuit_frame_header *header, double real_s)
{
	const bool next = header->frame_id - before->frame_id == 1;
	if (next && header->real_interval_ns)
		return (double)header->real_interval_ns * SECONDS;
	if (before->time_ns && header->time_ns > before->time_ns)
		return (double)(header->time_ns - before->time_ns) * SECONDS;
	return next ? real_s : 0.0;
}

static bool is_near_one(double ratio)
{
	return ratio >= 1.0 / MOST_RATIO && ratio <= MOST_RATIO;
}

/* Why the motion of a frame says nothing about that of the plan; NULL if it does. */
static const char *compare(const struct bend_before *before, const struct frame *frame, const struct plan *plan)
{
	if (!before->known)
		return "first";
	if (before->rest != PLAN_MOVES && before->rest != PLAN_STILL && before->rest != PLAN_UNCHANGED)
		return plan_rest_name(before->rest);
	if (!before->backward || frame->header.motion_kind != PURSUIT_MOTION_BACKWARD)
		return "forward";
	if (before->width != plan->width || before->height != plan->height)
		return "size";
	return frame->header.frame_id > before->frame_id ? NULL : "not-later";
}

/* The same of the times: NULL, and how the two lie in time. */
static const char *measure(const struct bend_before *before, const struct frame *frame, const struct plan *plan,
						   const struct plan_params *params, struct timing *timing)
{
	const double real_s = plan->real_interval_s;
	const struct plan_intervals intervals = plan_intervals_of(&frame->header, params->real_interval_ns);
	const double gap = gap_between(before, &frame->header, real_s) / real_s;
	const double span = (double)intervals.motion * SECONDS / real_s, span_before = before->motion_s / real_s;
	const double between = gap + (span_before - span) / 2.0;
	if (gap <= 0.0 || gap > MOST_RATIO)
		return "frames-lost";
	if (!is_near_one(gap) || !is_near_one(span) || !is_near_one(span_before) || !is_near_one(between))
		return "intervals";
	timing->gap = gap;
	timing->span = span;
	timing->weight = 1.0 / between;
	timing->scale = plan_scale_make(real_s, before->motion_s, before->width, params);
	return NULL;
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

struct search {
	struct bend *bend;
	const struct plan *plan;
	struct timing timing;
	bool comparable;
};

static void find_in_row(void *context, uint32_t row, uint32_t thread)
{
	const struct search *search = context;
	struct bend *bend = search->bend;
	uint32_t bent = 0;
	for (uint32_t i = row * search->plan->columns; i < (row + 1) * search->plan->columns; i++) {
		const struct plan_vertex *vertex = &search->plan->vertices[i];
		bend->straight[i] = (struct bend_vector){vertex->ux, vertex->uy};
		bend->change[i] = (struct bend_vector){0.0f, 0.0f};
		if (search->comparable && (vertex->ux != 0.0f || vertex->uy != 0.0f))
			bend->change[i] = change_of(&bend->before, &search->timing, vertex->x, vertex->y, bend->straight[i]);
		bent += bend->change[i].x != 0.0f || bend->change[i].y != 0.0f;
	}
	__atomic_fetch_add(&bend->bent, bent, __ATOMIC_RELAXED);
}

/* What is known of a frame before is still that of the frame before. */
static void find_changes(struct bend *bend, const struct frame *frame, const struct plan *plan,
						 const struct plan_params *params)
{
	struct search search = {.bend = bend, .plan = plan, .timing = {.span = 1.0}};
	const char *reason = compare(&bend->before, frame, plan);
	if (!reason && plan->rest == PLAN_MOVES)
		reason = measure(&bend->before, frame, plan, params, &search.timing);
	search.comparable = !reason;
	bend->span = (float)search.timing.span;
	bend->bent = 0;
	pool_run(params->pool, find_in_row, &search, plan->rows);
	bend->reason = reason ? reason : bend->bent ? NULL : "no-change";
}

static bool remember(struct bend *bend, const struct frame *frame, const struct plan *plan,
					 const struct plan_params *params)
{
	struct bend_before *before = &bend->before;
	const struct plan_intervals intervals = plan_intervals_of(&frame->header, params->real_interval_ns);
	before->frame_id = frame->header.frame_id;
	before->time_ns = frame->header.time_ns;
	before->motion_s = (double)intervals.motion * SECONDS;
	before->rest = plan->rest;
	before->backward = frame->header.motion_kind == PURSUIT_MOTION_BACKWARD;
	before->width = plan->width;
	before->height = plan->height;
	if (!bend->kernels)
		bend->kernels = plan_level_kernels(plan_level_best());
	before->known =
		plan->rest != PLAN_MOVES || plan_motion_plane_take(&before->motion, frame, bend->kernels, params->pool);
	return before->known;
}

int bend_begin(struct bend *bend, const struct frame *frame, const struct plan *plan, const struct plan_params *params,
			   struct error *error)
{
	const uint32_t count = plan->columns * plan->rows;
	int result = 0;
	bend->bent = 0;
	if (reserve(bend, count))
		find_changes(bend, frame, plan, params);
	else
		result = error_set(error, -ENOMEM, "out of memory for the change of motion of %u vertices", count);
	if (result == 0 && !remember(bend, frame, plan, params))
		result = error_set(error, -ENOMEM, "no memory for the motion of a %u x %u picture", plan->width, plan->height);
	if (result < 0)
		bend_forget(bend);
	return result;
}

void bend_apply(const struct bend *bend, struct plan *plan, double phase)
{
	const float share = (float)(0.5 * (phase + (double)bend->span));
	for (uint32_t i = 0; i < plan->columns * plan->rows; i++) {
		plan->vertices[i].ux = bend->straight[i].x + share * bend->change[i].x;
		plan->vertices[i].uy = bend->straight[i].y + share * bend->change[i].y;
	}
}

void bend_forget(struct bend *bend)
{
	bend->before.known = false;
	bend->bent = 0;
}

uint64_t bend_bytes(const struct bend *bend)
{
	return plan_motion_plane_bytes(&bend->before.motion) + 2 * sizeof(struct bend_vector) * (uint64_t)bend->capacity;
}

void bend_finish(struct bend *bend)
{
	plan_motion_plane_finish(&bend->before.motion);
	free(bend->straight);
	free(bend->change);
	*bend = (struct bend){0};
}
