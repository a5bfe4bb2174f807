/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The engine's plan against the reference: every vertex, every triangle, every
 * count, over fields, formats, sizes and seeds.
 *
 * Tolerances. Positions are multiples of half a pixel and must be equal. u and
 * z are the same arithmetic in float: 1e-5 relative (2^-24 times a few tens of
 * operations); u below a pixel 1e-5 pixels, since a motion that is nearly damped
 * away is a large number times 1 - smoothstep, which cancels; z below 0.02 2e-7,
 * since 1 - near / d cancels. A vertex may lie elsewhere,
 * or a quad be split the other way, only where the reference says that the
 * deciding numbers are within float rounding of each other (`either`); that may
 * happen to at most EITHER_SHARE of all vertices and quads.
 */
#include "daemon/engine/plan.h"
#include "input.h"
#include "reference.h"
#include "tests/test.h"

#define RELATIVE 1e-5
#define EITHER_SHARE 0.002

static struct {
	uint64_t vertices, other_vertices, quads, other_quads;
	double worst_u, worst_z;
} seen;

/* |got - want| as a share of `size`, but never of less than `least`. */
static double relative(double got, double want, double size, double least)
{
	return fabs(got - want) / fmax(size, least);
}

/* false: at another place, or with another side's values, and allowed to be. */
static bool check_vertex(const struct plan_vertex *got, const struct reference_vertex *want)
{
	const double size = hypot(want->ux, want->uy);
	const double u =
		fmax(relative((double)got->ux, want->ux, size, 1.0), relative((double)got->uy, want->uy, size, 1.0));
	const double z = relative((double)got->z, want->z, want->z, 0.02);
	const bool place = (double)got->x == want->x && (double)got->y == want->y;
	const bool snapped = (got->snapped != 0.0f) == want->snapped;
	seen.vertices++;
	if (want->either && !(place && snapped && u <= RELATIVE && z <= RELATIVE)) {
		seen.other_vertices++;
		return false;
	}
	CHECK(place);
	CHECK(snapped);
	CHECK_NEAR(u, 0.0, RELATIVE);
	CHECK_NEAR(z, 0.0, RELATIVE);
	seen.worst_u = fmax(seen.worst_u, u);
	seen.worst_z = fmax(seen.worst_z, z);
	return true;
}

static void check_quad(const uint32_t *got, const struct reference_triangle *want)
{
	bool same = true;
	for (int k = 0; k < 6; k++)
		same = same && got[k] == want[k / 3].v[k % 3];
	seen.quads++;
	seen.other_quads += !same;
	CHECK(same || want->either);
}

/* Triangles that the reference counts, and by how many that may be off. */
static void check_counts(const struct plan *plan, const struct reference *reference)
{
	uint32_t folded = 0, doubtful = 0, folded_either = 0, doubtful_either = 0;
	const double phase = reference->timing.last_phase;
	for (uint32_t t = 0; t < reference->grid.triangle_count; t++) {
		const uint32_t *v = reference->grid.triangles[t].v;
		const double area = reference_area2(&reference->grid, v, phase);
		double sigma[2];
		reference_singular(&reference->grid, v, phase, sigma);
		folded += area <= 0.0;
		doubtful += sigma[0] > 1.25 && area > 0.0;
		/* The edges that an area is made of are up to some 1e3 long: 1e-4 is float's rounding of their products. */
		folded_either += fabs(area) < 1e-4 * (1.0 + sigma[0]) || reference->grid.triangles[t].either;
		doubtful_either += fabs(sigma[0] - 1.25) < 1e-4 || reference->grid.triangles[t].either;
	}
	CHECK_NEAR(plan->folded, folded, folded_either);
	CHECK_NEAR(plan->doubtful, doubtful, doubtful_either);
}

static enum plan_rest expected_rest(const struct reference *reference, const struct pursuit_frame_header *header)
{
	if (header->flags & PURSUIT_FRAME_CUT)
		return PLAN_CUT;
	if (header->flags & PURSUIT_FRAME_MOTION_INVALID)
		return PLAN_MOTION_INVALID;
	if (frame_find_plane(header, PURSUIT_ROLE_MOTION) < 0)
		return PLAN_NO_MOTION;
	if (!(reference->timing.real_s > 0.0))
		return PLAN_NO_INTERVAL;
	return reference->geometry.moves ? PLAN_MOVES : PLAN_STILL;
}

static void check_grid(const struct plan *plan, const struct reference *reference)
{
	const struct reference_grid *grid = &reference->grid;
	uint32_t moved = 0;
	CHECK_INT(plan->columns, grid->columns);
	CHECK_INT(plan->rows, grid->rows);
	CHECK_INT(plan->index_count, 3 * grid->triangle_count);
	if (plan->columns != grid->columns || plan->rows != grid->rows || plan->index_count != 3 * grid->triangle_count)
		return;
	for (uint32_t v = 0; v < grid->columns * grid->rows; v++)
		moved += !check_vertex(&plan->vertices[v], &grid->vertices[v]);
	for (uint32_t t = 0; t < grid->triangle_count && !moved; t += 2)
		check_quad(&plan->indices[3 * t], &grid->triangles[t]);
	CHECK_NEAR(plan->snapped, grid->snapped, moved);
	if (!moved)
		check_counts(plan, reference);
}

struct how {
	uint32_t cell, threshold, n;
	uint64_t real_interval_ns;
};

static void compare(const struct input_spec *spec, const struct how *how)
{
	const int failed = test_failed();
	const struct engine_params params = {.cell = how->cell,
										 .threshold_quarter = how->threshold,
										 .display_width_mm = input_display_mm(spec->width),
										 .viewing_distance_mm = 550};
	const struct engine_begin_params begin = {
		.n = how->n, .last_phase = -1.0, .real_interval_ns = how->real_interval_ns};
	struct reference reference = {0};
	struct plan plan = {0};
	struct input input;
	struct error error;
	input_make(&input, spec);
	reference_begin(&reference, &input.frame, &params, &begin);
	const struct plan_params plan_params = {.cell = how->cell,
											.threshold_quarter = how->threshold,
											.display_width_mm = params.display_width_mm,
											.viewing_distance_mm = params.viewing_distance_mm,
											.last_phase = (float)reference.timing.last_phase,
											.real_interval_ns = how->real_interval_ns};
	CHECK_INT(plan_make(&plan, &input.frame, &plan_params, &error), 0);
	CHECK_INT(plan.rest, expected_rest(&reference, &input.frame.header));
	CHECK_INT(plan.invalid_pixels, reference.geometry.invalid);
	if (plan.rest == PLAN_MOVES)
		check_grid(&plan, &reference);
	else
		CHECK_INT(plan.columns * plan.rows + plan.index_count, 0);
	if (test_failed() != failed)
		fprintf(stderr, "in: %ux%u field %d seed %llu cell %u n %u motion %u kind %u depth %u kind %u\n", spec->width,
				spec->height, spec->field, (unsigned long long)spec->seed, how->cell, how->n, spec->motion_format,
				spec->motion_kind, spec->depth_format, spec->depth_kind);
	plan_finish(&plan);
	reference_finish(&reference);
	input_finish(&input);
}

static const enum input_field fields[] = {INPUT_STILL,  INPUT_TRANSLATE, INPUT_SMOOTH, INPUT_ROTATE, INPUT_ZOOM,
										  INPUT_LAYERS, INPUT_VIOLENT,   INPUT_SHAKE,  INPUT_BROKEN};
#define FIELDS (sizeof(fields) / sizeof(fields[0]))

static void test_fields(void)
{
	for (size_t f = 0; f < FIELDS; f++)
		for (uint64_t seed = 1; seed <= 6; seed++) {
			const struct input_spec spec = {.width = 200, .height = 120, .field = fields[f], .seed = seed};
			const struct how how = {.cell = seed & 1 ? 0 : 16, .n = 2 + seed % 2};
			compare(&spec, &how);
		}
}

static void test_sizes(void)
{
	static const uint32_t sizes[][2] = {{1, 1}, {2, 1},   {1, 3},   {3, 2},   {7, 9},   {8, 8},
										{9, 7}, {16, 17}, {65, 33}, {257, 3}, {3, 140}, {129, 64}};
	static const uint32_t cells[] = {0, 4, 5, 13, 64};
	for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++)
		for (size_t c = 0; c < sizeof(cells) / sizeof(cells[0]); c++)
			for (size_t f = 4; f < FIELDS; f++) {
				const struct input_spec spec = {
					.width = sizes[s][0], .height = sizes[s][1], .field = fields[f], .seed = 1 + s + 3 * c};
				const struct how how = {.cell = cells[c], .threshold = c == 2 ? 9 : 0, .n = 3};
				compare(&spec, &how);
			}
}

static void test_formats(void)
{
	static const struct {
		uint32_t format, kind;
		float near_distance, far_distance;
	} depths[] = {
		{PURSUIT_FORMAT_DEPTH16, PURSUIT_DEPTH_DEVICE, 0, 0},
		{PURSUIT_FORMAT_DEPTH24, PURSUIT_DEPTH_DEVICE, 0, 0},
		{PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_DEVICE, 0, 0},
		{PURSUIT_FORMAT_DEPTH16, PURSUIT_DEPTH_DEVICE_REVERSED, 0, 0},
		{PURSUIT_FORMAT_DEPTH24, PURSUIT_DEPTH_DEVICE_REVERSED, 0, 0},
		{PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_DEVICE_REVERSED, 0.1f, INFINITY},
		{PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_LINEAR, 0.1f, 50.0f},
		{PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_LINEAR, 0.1f, INFINITY},
		{PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_LINEAR, 0, 0},
	};
	static const enum input_field some[] = {INPUT_LAYERS, INPUT_SHAKE, INPUT_BROKEN};
	for (size_t d = 0; d < sizeof(depths) / sizeof(depths[0]); d++)
		for (uint32_t m = 0; m < 6; m++) {
			const struct input_spec spec = {.width = 90,
											.height = 61,
											.field = some[m % 3],
											.seed = 40 + d,
											.motion_format = m & 1 ? PURSUIT_FORMAT_RG16F : PURSUIT_FORMAT_RG32F,
											.motion_kind = m >= 3 ? PURSUIT_MOTION_FORWARD : PURSUIT_MOTION_BACKWARD,
											.motion_width = m == 2   ? 45
															: m == 4 ? 133
																	 : 0,
											.motion_height = m == 2   ? 31
															 : m == 4 ? 100
																	  : 0,
											.depth_format = depths[d].format,
											.depth_kind = depths[d].kind,
											.depth_width = m == 1   ? 180
														   : m == 4 ? 31
																	: 0,
											.depth_height = m == 1   ? 122
															: m == 4 ? 17
																	 : 0,
											.near_distance = depths[d].near_distance,
											.far_distance = depths[d].far_distance};
			const struct how how = {.n = 2};
			compare(&spec, &how);
		}
}

static void test_intervals(void)
{
	static const uint64_t ms = 1000000;
	static const uint64_t times[][3] = {
		/* real, motion, pacer */
		{0, 0, 0},       {25 * ms, 0, 0}, {25 * ms, 0, 16 * ms}, {25 * ms, 33 * ms, 0},  {1, 33 * ms, 0},
		{1, 0, 20 * ms}, {1, 0, 0},       {ms, 90 * ms, 0},      {900 * ms, 10 * ms, 0}, {16 * ms, 8 * ms, 17 * ms}};
	for (size_t t = 0; t < sizeof(times) / sizeof(times[0]); t++)
		for (int f = 0; f < 2; f++) {
			const struct input_spec spec = {.width = 96,
											.height = 70,
											.field = f ? INPUT_LAYERS : INPUT_ROTATE,
											.seed = t,
											.real_interval_ns = times[t][0],
											.motion_interval_ns = times[t][1]};
			const struct how how = {.n = 3, .real_interval_ns = times[t][2]};
			compare(&spec, &how);
		}
}

static void test_rest(void)
{
	for (int i = 0; i < 5; i++) {
		const struct input_spec spec = {.width = 40,
										.height = 30,
										.field = INPUT_LAYERS,
										.seed = 1,
										.flags = i == 0   ? PURSUIT_FRAME_CUT
												 : i == 1 ? PURSUIT_FRAME_MOTION_INVALID
														  : 0,
										.no_motion = i == 2,
										.no_depth = i == 3,
										.real_interval_ns = i == 4};
		const struct how how = {.n = 2};
		compare(&spec, &how);
	}
}

static void test_share_of_ties(void)
{
	printf(
		"%llu vertices, %llu of them elsewhere; %llu quads, %llu split the other way; worst u %.2g, z %.2g relative\n",
		(unsigned long long)seen.vertices, (unsigned long long)seen.other_vertices, (unsigned long long)seen.quads,
		(unsigned long long)seen.other_quads, seen.worst_u, seen.worst_z);
	CHECK(seen.vertices > 10000);
	CHECK(seen.other_vertices <= EITHER_SHARE * (double)seen.vertices);
	CHECK(seen.other_quads <= EITHER_SHARE * (double)seen.quads);
}

int main(void)
{
	RUN(test_fields);
	RUN(test_sizes);
	RUN(test_formats);
	RUN(test_intervals);
	RUN(test_rest);
	RUN(test_share_of_ties);
	return test_result();
}
