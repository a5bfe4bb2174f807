/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/inspect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_SAMPLES 12000u
#define MOST_STEP 64u
/* Code values: where nothing differs, nothing can be told. */
#define GRADIENT 0.02f
#define COST_CAP 0.15f
#define OUTLIER 0.10f
#define CHANGE 0.004

struct pair {
	const struct inspect_view *a, *b;
	float scale; /* of m: sign of the kind x interval of the pair / interval that the motion spans */
	uint32_t step;
	float shift[2]; /* that motion leaves over; pixels */
};

static float read_pixel(const struct inspect_view *view, uint32_t x, uint32_t y)
{
	return view->luma[(size_t)y * view->width + x];
}

/* Bilinear at pixel centres' coordinates; false outside the picture. */
static bool sample(const struct inspect_view *view, float x, float y, float *value)
{
	if (!(x >= 0.0f && y >= 0.0f && x <= (float)(view->width - 1) && y <= (float)(view->height - 1)))
		return false;
	uint32_t left = (uint32_t)x, top = (uint32_t)y;
	uint32_t right = left + 1 < view->width ? left + 1 : left, bottom = top + 1 < view->height ? top + 1 : top;
	float u = x - (float)left, v = y - (float)top;
	float upper = read_pixel(view, left, top) * (1.0f - u) + read_pixel(view, right, top) * u;
	float lower = read_pixel(view, left, bottom) * (1.0f - u) + read_pixel(view, right, bottom) * u;
	*value = upper * (1.0f - v) + lower * v;
	return true;
}

static bool has_detail(const struct inspect_view *view, uint32_t x, uint32_t y)
{
	float dx = read_pixel(view, x + 1, y) - read_pixel(view, x - 1, y);
	float dy = read_pixel(view, x, y + 1) - read_pixel(view, x, y - 1);
	return fabsf(dx) > GRADIENT || fabsf(dy) > GRADIENT;
}

static const float *motion_at(const struct inspect_view *view, uint32_t x, uint32_t y)
{
	return view->motion + 2 * ((size_t)y * view->width + x);
}

/* The displacement that a hypothesis takes m for; pixels. */
static void apply(enum inspect_hypothesis hypothesis, const struct pair *pair, const float m[2], float to[2])
{
	const float width = (float)pair->a->width, height = (float)pair->a->height;
	const float factors[INSPECT_HYPOTHESES][2] = {
		[INSPECT_RIGHT] = {1.0f, 1.0f},
		[INSPECT_ZERO] = {0.0f, 0.0f},
		[INSPECT_SIGN] = {-1.0f, -1.0f},
		[INSPECT_X_SIGN] = {-1.0f, 1.0f},
		[INSPECT_Y_SIGN] = {1.0f, -1.0f},
		[INSPECT_SWAPPED] = {1.0f, 1.0f},
		[INSPECT_THIRD] = {1.0f / 3.0f, 1.0f / 3.0f},
		[INSPECT_HALF] = {0.5f, 0.5f},
		[INSPECT_DOUBLE] = {2.0f, 2.0f},
		[INSPECT_TRIPLE] = {3.0f, 3.0f},
		[INSPECT_NDC] = {0.5f * width, -0.5f * height},
		[INSPECT_NDC_DOWN] = {0.5f * width, 0.5f * height},
		[INSPECT_NDC_SIGN] = {-0.5f * width, 0.5f * height},
		[INSPECT_NDC_DOWN_SIGN] = {-0.5f * width, -0.5f * height},
		[INSPECT_UV] = {width, height},
		[INSPECT_UV_UP] = {width, -height},
		[INSPECT_UV_SIGN] = {-width, -height},
		[INSPECT_SHIFTED] = {1.0f, 1.0f},
		[INSPECT_OTHER_KIND] = {1.0f, 1.0f},
	};
	const bool swap = hypothesis == INSPECT_SWAPPED, shifted = hypothesis == INSPECT_SHIFTED;
	to[0] = pair->scale * factors[hypothesis][0] * m[swap] + (shifted ? pair->shift[0] : 0.0f);
	to[1] = pair->scale * factors[hypothesis][1] * m[!swap] + (shifted ? pair->shift[1] : 0.0f);
}

static float capped(float difference)
{
	return fminf(fabsf(difference), COST_CAP);
}

/* A place that a hypothesis puts outside the picture counts as if nothing had moved: it says nothing. */
static float cost_of(const struct pair *pair, enum inspect_hypothesis hypothesis, uint32_t x, uint32_t y)
{
	float shift[2], value;
	const float here = read_pixel(pair->a, x, y);
	apply(hypothesis, pair, motion_at(pair->a, x, y), shift);
	if (!sample(pair->b, (float)x + shift[0], (float)y + shift[1], &value))
		value = read_pixel(pair->b, x, y);
	return capped(here - value);
}

static bool usable(const struct pair *pair, uint32_t x, uint32_t y)
{
	const float *m = motion_at(pair->a, x, y);
	return isfinite(m[0]) && isfinite(m[1]) && has_detail(pair->a, x, y);
}

static uint32_t step_of(const struct inspect_view *view)
{
	uint32_t step = 1;
	while (step < MOST_STEP && (uint64_t)view->width * view->height / ((uint64_t)step * step) > 4 * MOST_SAMPLES)
		step++;
	return step;
}

static void count_wins(struct inspect *inspect, const double before[INSPECT_HYPOTHESES])
{
	const double right = inspect->cost[INSPECT_RIGHT] - before[INSPECT_RIGHT];
	for (enum inspect_hypothesis h = INSPECT_RIGHT + 1; h < INSPECT_OTHER_KIND; h++)
		inspect->wins[h] += inspect->cost[h] - before[h] < right;
}

static void add_costs(struct inspect *inspect, const struct pair *pair)
{
	double before[INSPECT_HYPOTHESES];
	memcpy(before, inspect->cost, sizeof(before));
	for (uint32_t y = 1; y + 1 < pair->a->height; y += pair->step) {
		for (uint32_t x = 1; x + 1 < pair->a->width; x += pair->step) {
			if (!usable(pair, x, y))
				continue;
			const float *m = motion_at(pair->a, x, y);
			inspect->samples++;
			inspect->speed_sum += (double)fminf(hypotf(m[0], m[1]), 1e6f);
			for (enum inspect_hypothesis h = INSPECT_RIGHT; h < INSPECT_OTHER_KIND; h++)
				inspect->cost[h] += (double)cost_of(pair, h, x, y);
		}
	}
	count_wins(inspect, before);
}

/* What the motion of the other kind would explain: the neighbour on the other side. */
static void add_other_kind(struct inspect *inspect, const struct pair *other)
{
	for (uint32_t y = 1; y + 1 < other->a->height; y += other->step) {
		for (uint32_t x = 1; x + 1 < other->a->width; x += other->step) {
			if (!usable(other, x, y))
				continue;
			inspect->other_samples++;
			inspect->cost[INSPECT_OTHER_KIND] += (double)cost_of(other, INSPECT_OTHER_KIND, x, y);
		}
	}
}

struct normal_equations {
	double xx, xy, yy, xr, yr;
	uint64_t count;
};

static void add_equation(struct normal_equations *sums, const struct pair *pair, uint32_t x, uint32_t y,
						 const float shift[2])
{
	float displaced[2], center, left, right, up, down;
	apply(INSPECT_RIGHT, pair, motion_at(pair->a, x, y), displaced);
	float px = (float)x + displaced[0] + shift[0], py = (float)y + displaced[1] + shift[1];
	if (!sample(pair->b, px, py, &center) || !sample(pair->b, px - 1.0f, py, &left) ||
		!sample(pair->b, px + 1.0f, py, &right) || !sample(pair->b, px, py - 1.0f, &up) ||
		!sample(pair->b, px, py + 1.0f, &down))
		return;
	double r = (double)(read_pixel(pair->a, x, y) - center);
	double gx = 0.5 * (double)(right - left), gy = 0.5 * (double)(down - up);
	if (fabs(r) > (double)OUTLIER)
		return;
	sums->xx += gx * gx;
	sums->xy += gx * gy;
	sums->yy += gy * gy;
	sums->xr += gx * r;
	sums->yr += gy * r;
	sums->count++;
}

/* The one shift that motion leaves over (Lucas, Kanade 1981), two steps of it. */
static bool solve_shift(const struct pair *pair, float shift[2])
{
	shift[0] = shift[1] = 0.0f;
	for (int round = 0; round < 2; round++) {
		struct normal_equations sums = {0};
		for (uint32_t y = 1; y + 1 < pair->a->height; y += pair->step)
			for (uint32_t x = 1; x + 1 < pair->a->width; x += pair->step)
				if (usable(pair, x, y))
					add_equation(&sums, pair, x, y, shift);
		double determinant = sums.xx * sums.yy - sums.xy * sums.xy;
		if (sums.count < 100 || !(determinant > 1e-6 * sums.xx * sums.yy))
			return false;
		shift[0] += (float)((sums.yy * sums.xr - sums.xy * sums.yr) / determinant);
		shift[1] += (float)((sums.xx * sums.yr - sums.xy * sums.xr) / determinant);
	}
	return isfinite(shift[0]) && isfinite(shift[1]) && hypotf(shift[0], shift[1]) < 4.0f;
}

static int compare_floats(const void *a, const void *b)
{
	float left = *(const float *)a, right = *(const float *)b;
	return left < right ? -1 : left > right;
}

static void median_motion(const struct pair *pair, float median[2])
{
	float values[2][1024];
	uint32_t count = 0;
	const uint64_t pixels = (uint64_t)pair->a->width * pair->a->height;
	for (uint64_t i = 0; i < 1024; i++) {
		const float *m = pair->a->motion + 2 * (i * pixels / 1024);
		if (!isfinite(m[0]) || !isfinite(m[1]))
			continue;
		values[0][count] = pair->scale * m[0];
		values[1][count++] = pair->scale * m[1];
	}
	for (int axis = 0; axis < 2; axis++) {
		qsort(values[axis], count, sizeof(float), compare_floats);
		median[axis] = count ? values[axis][count / 2] : 0.0f;
	}
}

static void add_residual(struct inspect *inspect, struct pair *pair)
{
	struct inspect_residual residual = {.has_jitter = pair->a->has_jitter && pair->b->has_jitter};
	if (inspect->residual_count == INSPECT_PAIRS || !solve_shift(pair, residual.shift))
		return;
	memcpy(pair->shift, residual.shift, sizeof(pair->shift));
	median_motion(pair, residual.motion);
	for (int axis = 0; axis < 2; axis++)
		residual.jitter[axis] = pair->b->jitter[axis] - pair->a->jitter[axis];
	inspect->residuals[inspect->residual_count++] = residual;
}

/* Of the pixels of A that come from one pixel of B: the nearest and the farthest. */
struct claim {
	uint32_t nearest, farthest; /* pixel of A + 1; 0: none */
};

static void make_claims(const struct pair *pair, struct claim *claims)
{
	const struct inspect_view *a = pair->a;
	for (uint32_t y = 0; y < a->height; y++) {
		for (uint32_t x = 0; x < a->width; x++) {
			float shift[2];
			apply(INSPECT_RIGHT, pair, motion_at(a, x, y), shift);
			float fx = roundf((float)x + shift[0]), fy = roundf((float)y + shift[1]);
			if (!(fx >= 0.0f && fy >= 0.0f && fx < (float)a->width && fy < (float)a->height))
				continue;
			uint32_t pixel = y * a->width + x;
			if (!isfinite(a->nearness[pixel]))
				continue;
			struct claim *claim = &claims[(size_t)fy * a->width + (size_t)fx];
			if (!claim->nearest || a->nearness[pixel] > a->nearness[claim->nearest - 1])
				claim->nearest = pixel + 1;
			if (!claim->farthest || a->nearness[pixel] < a->nearness[claim->farthest - 1])
				claim->farthest = pixel + 1;
		}
	}
}

/* Two surfaces of different colour claim a pixel, and it clearly has the colour of one. */
static void count_claim(struct inspect *inspect, const struct pair *pair, uint32_t pixel, const struct claim *claim)
{
	const struct inspect_view *a = pair->a;
	if (!claim->nearest || claim->nearest == claim->farthest)
		return;
	const uint32_t near = claim->nearest - 1, far = claim->farthest - 1;
	const float *m = a->motion + 2 * (size_t)near, *n = a->motion + 2 * (size_t)far;
	const float near_off = fabsf(a->luma[near] - pair->b->luma[pixel]);
	const float far_off = fabsf(a->luma[far] - pair->b->luma[pixel]);
	if (hypotf(m[0] - n[0], m[1] - n[1]) * fabsf(pair->scale) < 1.5f || fabsf(near_off - far_off) < 0.08f)
		return;
	if (near_off < far_off)
		inspect->nearer_wins++;
	else
		inspect->farther_wins++;
}

static void add_claims(struct inspect *inspect, const struct pair *pair)
{
	const uint32_t pixels = pair->a->width * pair->a->height;
	if (!pair->a->nearness)
		return;
	struct claim *claims = calloc(pixels, sizeof(*claims));
	if (!claims)
		return;
	make_claims(pair, claims);
	for (uint32_t pixel = 0; pixel < pixels; pixel++)
		count_claim(inspect, pair, pixel, &claims[pixel]);
	free(claims);
}

static double mean_change(const struct inspect_view *a, const struct inspect_view *b)
{
	const size_t pixels = (size_t)a->width * a->height;
	double sum = 0.0;
	for (size_t i = 0; i < pixels; i++)
		sum += (double)fabsf(a->luma[i] - b->luma[i]);
	return sum / (double)pixels;
}

/* The same motion everywhere may well stay the same for a while. */
static bool is_uniform(const struct inspect_view *view)
{
	const size_t pixels = (size_t)view->width * view->height;
	for (size_t i = 1; i < pixels; i++) {
		const float *m = view->motion + 2 * i;
		if (fabsf(m[0] - view->motion[0]) > 0.01f || fabsf(m[1] - view->motion[1]) > 0.01f)
			return false;
	}
	return true;
}

static void add_frozen(struct inspect *inspect, const struct inspect_view *previous, const struct inspect_view *current)
{
	const bool same = previous->color_hash == current->color_hash;
	if (same && current->motion && current->usable_motion) {
		const size_t pixels = (size_t)current->width * current->height;
		size_t moving = 0;
		for (size_t i = 0; i < pixels; i++)
			moving += hypotf(current->motion[2 * i], current->motion[2 * i + 1]) > 0.5f;
		inspect->frozen_color += moving > pixels / 100;
	}
	if (same || mean_change(previous, current) < CHANGE)
		return;
	inspect->changing_pairs++;
	inspect->frozen_depth += current->nearness && previous->depth_hash == current->depth_hash;
	inspect->frozen_motion += current->motion && previous->motion_hash == current->motion_hash && !is_uniform(current);
}

static void add_times(struct inspect *inspect, const struct inspect_view *previous, const struct inspect_view *current)
{
	if (!previous->time_ns || !current->time_ns)
		return;
	if (current->time_ns <= previous->time_ns) {
		inspect->times_backwards++;
		return;
	}
	/* Of frames that were left out between them the interval knows nothing. */
	if (!current->real_interval_ns || current->frame_id != previous->frame_id + 1)
		return;
	double ratio = (double)current->real_interval_ns / (double)(current->time_ns - previous->time_ns);
	inspect->intervals_known++;
	inspect->interval_ratio_sum += fmin(ratio, 1e3);
	inspect->intervals_wrong += ratio < 0.8 || ratio > 1.25;
}

/* Sign and scale that turn the motion of A into the displacement from A to B. */
static float scale_of(const struct inspect_view *a, const struct inspect_view *previous,
					  const struct inspect_view *current, float sign)
{
	uint64_t span = a->motion_interval_ns ? a->motion_interval_ns : a->real_interval_ns;
	double between = current->time_ns > previous->time_ns ? (double)(current->time_ns - previous->time_ns) : 0.0;
	return span && between > 0.0 ? sign * (float)fmin(between / (double)span, 16.0) : sign;
}

void inspect_add_frame(struct inspect *inspect, const struct inspect_view *view)
{
	inspect->frames++;
	inspect->pixels += (uint64_t)view->width * view->height;
	inspect->no_motion += !view->motion;
	inspect->no_depth += !view->nearness;
	inspect->invalid_motion += view->invalid_motion;
	inspect->outside_depth += view->outside_depth;
	if (!view->nearness)
		return;
	size_t pixels = (size_t)view->width * view->height, i = 1;
	while (i < pixels && view->nearness[i] == view->nearness[0])
		i++;
	inspect->constant_depth += i == pixels && pixels > 1;
}

void inspect_add_pair(struct inspect *inspect, const struct inspect_view *previous, const struct inspect_view *current)
{
	if (previous->width != current->width || previous->height != current->height) {
		inspect->sizes_changed++;
		return;
	}
	add_times(inspect, previous, current);
	if (!current->usable_motion)
		return;
	add_frozen(inspect, previous, current);
	if (previous->color_hash == current->color_hash)
		return;
	const bool forward = current->forward;
	struct pair pair = {.a = forward ? previous : current, .b = forward ? current : previous};
	struct pair other = {.a = pair.b, .b = pair.a};
	if (!pair.a->motion || (forward && !previous->usable_motion))
		return;
	pair.scale = scale_of(pair.a, previous, current, forward ? 1.0f : -1.0f);
	pair.step = other.step = step_of(pair.a);
	const double cost_before = inspect->cost[INSPECT_RIGHT];
	const uint64_t samples_before = inspect->samples;
	inspect->pairs++;
	add_residual(inspect, &pair);
	add_costs(inspect, &pair);
	add_claims(inspect, &pair);
	if (!other.a->motion || !other.a->usable_motion)
		return;
	other.scale = scale_of(other.a, previous, current, forward ? -1.0f : 1.0f);
	inspect->other_right_cost += inspect->cost[INSPECT_RIGHT] - cost_before;
	inspect->other_right_samples += inspect->samples - samples_before;
	add_other_kind(inspect, &other);
}

double inspect_cost(const struct inspect *inspect, enum inspect_hypothesis hypothesis)
{
	uint64_t samples = hypothesis == INSPECT_OTHER_KIND ? inspect->other_samples : inspect->samples;
	return samples ? inspect->cost[hypothesis] / (double)samples : (double)NAN;
}
