/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The kernels' code, compiled once per level by the level_*.c that include it.
 * Each defines LEVEL_KERNELS (the table's name), LEVEL_NAME and, above this
 * include, decode_half_some(), which decodes a multiple of its own width and
 * says how many, the vector type wide (of floats, aligned to 4 bytes) and
 * wide_larger(): the larger of numbers that are not NaN; and what row_hash.h asks for.
 *
 * Loops are written for the vectoriser: no branches, no reductions of floats
 * (of the bits of numbers that are not negative instead, which sort alike).
 */

#include <math.h>
#include <string.h>

#include "daemon/engine/analysis/row_hash.h"
#include "daemon/engine/analysis/values.h"

static bool any_bits(const uint32_t *words, size_t count, uint32_t mask)
{
	const size_t block = 256;
	for (size_t start = 0; start < count; start += block) {
		size_t end = start + block < count ? start + block : count;
		uint32_t any = 0;
		for (size_t i = start; i < end; i++)
			any |= words[i];
		if (any & mask)
			return true;
	}
	return false;
}

static void decode_half(const uint16_t *restrict halves, size_t count, float *restrict values)
{
	for (size_t i = decode_half_some(halves, count, values); i < count; i++)
		values[i] = plan_half_value(halves[i]);
}

static void encode_half(const float *restrict values, size_t count, uint16_t *restrict halves)
{
	for (size_t i = 0; i < count; i++)
		halves[i] = plan_half_of(values[i]);
}

static uint32_t scale_row(const float *restrict motion, size_t count, const struct plan_scale *scale,
						  float *restrict ux, float *restrict uy)
{
	const float ratio = scale->ratio, limit = scale->plain_squared;
	uint32_t any = 0, odd = 0;
	for (size_t i = 0; i < count; i++) {
		float x = motion[2 * i], y = motion[2 * i + 1];
		odd |= x * x + y * y <= limit ? 0u : PLAN_ROW_ODD;
		x *= ratio;
		y *= ratio;
		any |= plan_bits_of(x) | plan_bits_of(y);
		ux[i] = x;
		uy[i] = y;
	}
	return odd | (any & 0x7fffffffu ? PLAN_ROW_MOVES : 0u);
}

static uint32_t careful_row(const float *restrict motion, size_t count, const struct plan_scale *scale,
							float *restrict ux, float *restrict uy, uint64_t *invalid)
{
	uint32_t any = 0, numbers = 0;
	for (size_t i = 0; i < count; i++) {
		float x, y;
		numbers += plan_displacement(motion[2 * i], motion[2 * i + 1], scale, &x, &y);
		any |= plan_bits_of(x) | plan_bits_of(y);
		ux[i] = x;
		uy[i] = y;
	}
	*invalid += count - numbers;
	return any & 0x7fffffffu ? PLAN_ROW_MOVES : 0u;
}

static inline float square(float x, float y)
{
	return x * x + y * y;
}

static inline float gradient(const float *ux, const float *uy, const float *below_x, const float *below_y, size_t i)
{
	float gx = square(ux[i + 1] - ux[i], uy[i + 1] - uy[i]);
	float gy = square(below_x[i] - ux[i], below_y[i] - uy[i]);
	return gx > gy ? gx : gy;
}

#define LANES (sizeof(wide) / sizeof(float))
#define LOAD(from) (*(const wide *)(const void *)(from))

/* Down the columns, so that each row is loaded once. */
static void band_peaks(const struct plan_field *field, uint32_t rows, size_t count, float *restrict peaks)
{
	size_t i = 0;
	for (; i + LANES <= count; i += LANES) {
		wide ux = LOAD(field->ux[0] + i), uy = LOAD(field->uy[0] + i), peak = ux - ux;
		for (uint32_t j = 0; j < rows; j++) {
			wide below_x = LOAD(field->ux[j + 1] + i), below_y = LOAD(field->uy[j + 1] + i);
			wide dx = LOAD(field->ux[j] + i + 1) - ux, dy = LOAD(field->uy[j] + i + 1) - uy;
			wide down_x = below_x - ux, down_y = below_y - uy;
			peak = wide_larger(peak, wide_larger(dx * dx + dy * dy, down_x * down_x + down_y * down_y));
			ux = below_x;
			uy = below_y;
		}
		memcpy(peaks + i, &peak, sizeof(peak));
	}
	for (; i < count; i++) {
		peaks[i] = 0;
		for (uint32_t j = 0; j < rows; j++) {
			float g = gradient(field->ux[j], field->uy[j], field->ux[j + 1], field->uy[j + 1], i);
			peaks[i] = g > peaks[i] ? g : peaks[i];
		}
	}
}

static inline float largest_of(const float *values, size_t count)
{
	float largest = values[0];
	for (size_t i = 1; i < count; i++)
		largest = values[i] > largest ? values[i] : largest;
	return largest;
}

static void cell_peaks(const float *restrict peaks, size_t count, uint32_t cell, float *restrict largest)
{
	size_t whole = count / cell;
	if (cell == 8)
		for (size_t c = 0; c < whole; c++)
			largest[c] = largest_of(peaks + 8 * c, 8);
	else
		for (size_t c = 0; c < whole; c++)
			largest[c] = largest_of(peaks + cell * c, cell);
	if (whole * cell < count)
		largest[whole] = largest_of(peaks + whole * cell, count - whole * cell);
}

/* Keys sort by distance from the centre (in half pixels, squared), then by row, then by column. */
#define KEY_SCALE 4096
#define KEY_NONE INT32_MAX

static inline int32_t key_part(uint32_t i, uint32_t size)
{
	int32_t d = (int32_t)(2 * i + 1) - (int32_t)size;
	return d * d * KEY_SCALE;
}

static uint32_t locate_any(const struct plan_field *field, const struct plan_cell *cell, float least)
{
	int32_t best[PLAN_MAX_CELL], base[PLAN_MAX_CELL], nearest = KEY_NONE;
	uint32_t x = cell->x, width = cell->width;
	for (uint32_t i = 0; i < width; i++) {
		base[i] = key_part(i, width) + (int32_t)i;
		best[i] = KEY_NONE;
	}
	for (uint32_t j = 0; j < cell->height; j++) {
		const float *ux = field->ux[j] + x, *uy = field->uy[j] + x;
		const float *below_x = field->ux[j + 1] + x, *below_y = field->uy[j + 1] + x;
		int32_t row = key_part(j, cell->height) + (int32_t)(j << 6);
		for (uint32_t i = 0; i < width; i++) {
			int32_t key = gradient(ux, uy, below_x, below_y, i) >= least ? base[i] + row : KEY_NONE;
			best[i] = key < best[i] ? key : best[i];
		}
	}
	for (uint32_t i = 0; i < width; i++)
		nearest = best[i] < nearest ? best[i] : nearest;
	return (uint32_t)nearest % KEY_SCALE;
}

typedef float vector8 __attribute__((vector_size(32), aligned(4), may_alias));
typedef int32_t mask8 __attribute__((vector_size(32)));

#define LOAD8(from) (*(const vector8 *)(const void *)(from))

/* The same for cells eight pixels wide: the row as one vector, where there are such. */
static uint32_t locate_8(const struct plan_field *field, const struct plan_cell *cell, float least)
{
	const mask8 base = {49 * KEY_SCALE,    25 * KEY_SCALE + 1, 9 * KEY_SCALE + 2,  1 * KEY_SCALE + 3,
						1 * KEY_SCALE + 4, 9 * KEY_SCALE + 5,  25 * KEY_SCALE + 6, 49 * KEY_SCALE + 7};
	mask8 best = {KEY_NONE, KEY_NONE, KEY_NONE, KEY_NONE, KEY_NONE, KEY_NONE, KEY_NONE, KEY_NONE};
	uint32_t x = cell->x;
	vector8 ux = LOAD8(field->ux[0] + x), uy = LOAD8(field->uy[0] + x);
	for (uint32_t j = 0; j < cell->height; j++) {
		vector8 below_x = LOAD8(field->ux[j + 1] + x), below_y = LOAD8(field->uy[j + 1] + x);
		vector8 dx = LOAD8(field->ux[j] + x + 1) - ux, dy = LOAD8(field->uy[j] + x + 1) - uy;
		vector8 down_x = below_x - ux, down_y = below_y - uy;
		mask8 strong = (dx * dx + dy * dy >= least) | (down_x * down_x + down_y * down_y >= least);
		mask8 key = base + (key_part(j, cell->height) + (int32_t)(j << 6));
		mask8 better = strong & (key < best);
		best = (key & better) | (best & ~better);
		ux = below_x;
		uy = below_y;
	}
	int32_t nearest = best[0];
	for (int i = 1; i < 8; i++)
		nearest = best[i] < nearest ? best[i] : nearest;
	return (uint32_t)nearest % KEY_SCALE;
}

static uint32_t locate(const struct plan_field *field, const struct plan_cell *cell, float least)
{
	return cell->width == 8 ? locate_8(field, cell, least) : locate_any(field, cell, least);
}

static void depth_decode(const void *raw, size_t count, uint32_t format, float *restrict z)
{
	const uint16_t *shorts = raw;
	const uint32_t *words = raw;
	if (format == PURSUIT_FORMAT_DEPTH16)
		for (size_t i = 0; i < count; i++)
			z[i] = plan_depth_decode16(shorts[i]);
	else if (format == PURSUIT_FORMAT_DEPTH24)
		for (size_t i = 0; i < count; i++)
			z[i] = plan_depth_decode24(words[i]);
	else
		memcpy(z, raw, count * sizeof(*z));
}

static void depth_row(const void *raw, size_t count, const struct plan_depth *depth, float *restrict z)
{
	const float near_distance = depth->near_distance, range = depth->range;
	depth_decode(raw, count, depth->format, z);
	switch (depth->map) {
	case PLAN_DEPTH_REVERSED:
		for (size_t i = 0; i < count; i++)
			z[i] = plan_depth_clamp(1.0f - z[i]);
		break;
	case PLAN_DEPTH_RANGE:
		for (size_t i = 0; i < count; i++)
			z[i] = plan_depth_range(z[i], near_distance, range);
		break;
	case PLAN_DEPTH_INFINITE:
		for (size_t i = 0; i < count; i++)
			z[i] = plan_depth_infinite(z[i], near_distance);
		break;
	case PLAN_DEPTH_OPEN:
		for (size_t i = 0; i < count; i++)
			z[i] = plan_depth_open(z[i]);
		break;
	case PLAN_DEPTH_AS_IS:
	default:
		for (size_t i = 0; i < count; i++)
			z[i] = plan_depth_clamp(z[i]);
	}
}

struct point {
	float x, y, ux, uy;
};

static inline struct point point_at(const struct plan_vertex_row *row, size_t i)
{
	return (struct point){row->x[i], row->y[i], row->ux[i], row->uy[i]};
}

static inline struct point chosen(uint32_t first, struct point a, struct point b)
{
	return (struct point){first ? a.x : b.x, first ? a.y : b.y, first ? a.ux : b.ux, first ? a.uy : b.uy};
}

static inline uint32_t positive(struct point a, struct point b, struct point c)
{
	return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0f;
}

/*
 * Bit 0: folded. Bit 16: doubtful, that is not folded and stretch > 1.25. With
 * A the linear map from source to displaced edges, d = det source edges and
 * B = d A: the larger singular value of A exceeds s when |B|² > 2 s² d² or
 * s⁴ d² - s² |B|² + (d det A)² < 0.
 */
static inline uint32_t judge(struct point a, struct point b, struct point c, float phase)
{
	float x1 = b.x - a.x, y1 = b.y - a.y, x2 = c.x - a.x, y2 = c.y - a.y;
	float px1 = x1 + phase * (b.ux - a.ux), py1 = y1 + phase * (b.uy - a.uy);
	float px2 = x2 + phase * (c.ux - a.ux), py2 = y2 + phase * (c.uy - a.uy);
	float d = x1 * y2 - y1 * x2, moved = px1 * py2 - py1 * px2;
	float b00 = px1 * y2 - px2 * y1, b01 = px2 * x1 - px1 * x2;
	float b10 = py1 * y2 - py2 * y1, b11 = py2 * x1 - py1 * x2;
	float norm = (b00 * b00 + b01 * b01) + (b10 * b10 + b11 * b11);
	const float s2 = 1.25f * 1.25f;
	uint32_t folded = moved <= 0.0f;
	uint32_t far = norm > 2.0f * s2 * (d * d);
	uint32_t stretched = far | ((s2 * s2 * (d * d) - s2 * norm) + moved * moved < 0.0f ? 1u : 0u);
	return folded | (stretched & (folded ^ 1u)) << 16;
}

static struct plan_quad_counts quads(const struct plan_vertex_row *upper, const struct plan_vertex_row *lower,
									 size_t count, float phase, uint32_t *restrict diagonals)
{
	const struct plan_vertex_row up = *upper, low = *lower;
	struct plan_quad_counts counts = {0, 0};
	for (size_t i = 0; i < count; i++) {
		struct point v00 = point_at(&up, i), v10 = point_at(&up, i + 1);
		struct point v01 = point_at(&low, i), v11 = point_at(&low, i + 1);
		uint32_t down = positive(v00, v10, v11) & positive(v00, v11, v01);
		uint32_t rising = positive(v00, v10, v01) & positive(v10, v11, v01);
		uint32_t alike = square(v00.ux - v11.ux, v00.uy - v11.uy) <= square(v10.ux - v01.ux, v10.uy - v01.uy);
		uint32_t main = down & ((rising ^ 1u) | alike);
		uint32_t first = judge(v00, v10, chosen(main, v11, v01), phase);
		uint32_t second = judge(chosen(main, v00, v10), v11, v01, phase);
		counts.folded += (first & 1u) + (second & 1u);
		counts.doubtful += (first >> 16) + (second >> 16);
		diagonals[i] = main;
	}
	return counts;
}

static float largest_square(const float *ux, const float *uy, size_t count)
{
	int32_t largest = 0;
	for (size_t i = 0; i < count; i++) {
		int32_t bits = (int32_t)plan_bits_of(square(ux[i], uy[i]));
		largest = bits > largest ? bits : largest;
	}
	return plan_float_of((uint32_t)largest);
}

extern const struct plan_kernels LEVEL_KERNELS;
const struct plan_kernels LEVEL_KERNELS = {
	.name = LEVEL_NAME,
	.any_bits = any_bits,
	.decode_half = decode_half,
	.encode_half = encode_half,
	.scale_row = scale_row,
	.careful_row = careful_row,
	.band_peaks = band_peaks,
	.cell_peaks = cell_peaks,
	.locate = locate,
	.depth_row = depth_row,
	.quads = quads,
	.largest_square = largest_square,
	.hash_row = hash_row,
};
