/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Damping, depth, discontinuities, snapping and diagonals of the reference (docs/method.md, 1 and 2). */
#include "input.h"
#include "reference.h"
#include "tests/test.h"

/* A geometry whose u and z are given by functions of the pixel. */
static void make_geometry(struct reference_geometry *geometry, uint32_t width, uint32_t height,
						  double (*ux)(uint32_t, uint32_t), double (*z)(uint32_t, uint32_t))
{
	*geometry = (struct reference_geometry){.width = width, .height = height};
	geometry->ux = reference_alloc((size_t)width * height, sizeof(double));
	geometry->uy = reference_alloc((size_t)width * height, sizeof(double));
	geometry->z = reference_alloc((size_t)width * height, sizeof(double));
	for (uint32_t j = 0; j < height; j++)
		for (uint32_t i = 0; i < width; i++) {
			geometry->ux[j * width + i] = ux(i, j);
			geometry->z[j * width + i] = z(i, j);
		}
}

static double flat(uint32_t i, uint32_t j)
{
	return 0.5;
}

static double step_right(uint32_t i, uint32_t j)
{
	return i >= 11 ? 4.0 : 0.0;
}

static double near_right(uint32_t i, uint32_t j)
{
	return i >= 11 ? 0.2 : 0.8;
}

static double near_left(uint32_t i, uint32_t j)
{
	return i >= 11 ? 0.8 : 0.2;
}

static double step_below(uint32_t i, uint32_t j)
{
	return j >= 13 ? -3.0 : 2.0;
}

static double small_step(uint32_t i, uint32_t j)
{
	return i >= 11 ? 0.49 : 0.0;
}

static double two_dots(uint32_t i, uint32_t j)
{
	return (i == 9 && j == 9) || (i == 14 && j == 14) ? 5.0 : 0.0;
}

static const struct reference_vertex *vertex(const struct reference_grid *grid, uint32_t column, uint32_t row)
{
	return &grid->vertices[row * grid->columns + column];
}

static void check_vertex(const struct reference_vertex *got, double x, double y, double ux, double z)
{
	CHECK_NEAR(got->x, x, 0.0);
	CHECK_NEAR(got->y, y, 0.0);
	CHECK_NEAR(got->ux, ux, 1e-15);
	CHECK_NEAR(got->z, z, 0.0);
}

static void test_snap_to_vertical_edge(void)
{
	struct reference_geometry geometry;
	struct reference_grid grid = {0};
	make_geometry(&geometry, 24, 24, step_right, near_right);
	reference_grid_init(&grid, &geometry, 8, 2);
	CHECK_INT(grid.columns, 5);
	CHECK_INT(grid.rows, 5);
	CHECK_INT(grid.snapped, 3);
	/* Edge between pixels 10 and 11; among the equals of the column, rows 11 and 12 are nearest: the upper one. */
	check_vertex(vertex(&grid, 2, 2), 11.0, 11.5, 4.0, 0.2);
	check_vertex(vertex(&grid, 2, 1), 11.0, 3.5, 4.0, 0.2);
	check_vertex(vertex(&grid, 1, 2), 4.0, 12.0, 0.0, 0.8);
	check_vertex(vertex(&grid, 3, 3), 20.0, 20.0, 4.0, 0.2);
	reference_geometry_finish(&geometry);
	/* The nearer side on the left stands still. */
	make_geometry(&geometry, 24, 24, step_right, near_left);
	reference_grid_init(&grid, &geometry, 8, 2);
	check_vertex(vertex(&grid, 2, 2), 11.0, 11.5, 0.0, 0.2);
	reference_geometry_finish(&geometry);
	/* Equal depth: the faster side. */
	make_geometry(&geometry, 24, 24, step_right, flat);
	reference_grid_init(&grid, &geometry, 8, 2);
	check_vertex(vertex(&grid, 2, 2), 11.0, 11.5, 4.0, 0.5);
	reference_geometry_finish(&geometry);
	reference_grid_finish(&grid);
}

static void test_snap_to_horizontal_edge(void)
{
	struct reference_geometry geometry;
	struct reference_grid grid = {0};
	make_geometry(&geometry, 24, 24, step_below, flat);
	reference_grid_init(&grid, &geometry, 8, 2);
	CHECK_INT(grid.snapped, 3);
	check_vertex(vertex(&grid, 2, 2), 11.5, 13.0, -3.0, 0.5);
	reference_geometry_finish(&geometry);
	reference_grid_finish(&grid);
}

static double stairs(uint32_t i, uint32_t j)
{
	return i == 0 ? 0.0 : i == 1 ? 0.25 : i == 2 ? 0.74 : i == 3 ? 1.74 : i == 4 ? -14.0 : 400.0;
}

static void test_quantisation(void)
{
	static const uint32_t want[] = {1, 1, 4, 62, 63, 0};
	struct reference_geometry geometry;
	make_geometry(&geometry, 7, 1, stairs, flat);
	for (uint32_t i = 0; i < 6; i++)
		CHECK_INT(reference_discontinuity(&geometry, i, 0, NULL, NULL), want[i]);
	CHECK_INT(reference_discontinuity(&geometry, 6, 0, NULL, NULL), 0);
	geometry.uy[0] = 4.0; /* 3-4-5 in quarters */
	geometry.ux[0] = 0.25 - 3.0;
	CHECK_INT(reference_discontinuity(&geometry, 0, 0, NULL, NULL), 20);
	reference_geometry_finish(&geometry);
}

static void test_threshold(void)
{
	struct reference_geometry geometry;
	struct reference_grid grid = {0};
	make_geometry(&geometry, 24, 24, small_step, flat);
	CHECK_INT(reference_discontinuity(&geometry, 10, 3, NULL, NULL), 1);
	reference_grid_init(&grid, &geometry, 8, 2);
	CHECK_INT(grid.snapped, 0);
	reference_grid_init(&grid, &geometry, 8, 1);
	CHECK_INT(grid.snapped, 3);
	reference_geometry_finish(&geometry);
	reference_grid_finish(&grid);
}

/* Equals: (8, 9), (9, 8), (9, 9) around one dot, (13, 14), (14, 13), (14, 14) around the other; centre (12, 12). */
static void test_nearest_to_centre_wins(void)
{
	struct reference_geometry geometry;
	struct reference_grid grid = {0};
	make_geometry(&geometry, 24, 24, two_dots, flat);
	reference_grid_init(&grid, &geometry, 8, 2);
	/* (14, 13) lies at squared distance 6.25 + 2.25 as does (13, 14); (9, 9) at 12.5. First in rows: (14, 13), below.
	 */
	check_vertex(vertex(&grid, 2, 2), 14.5, 14.0, 5.0, 0.5);
	reference_geometry_finish(&geometry);
	reference_grid_finish(&grid);
}

static void test_unsnapped_means(void)
{
	struct reference_geometry geometry;
	struct reference_grid grid = {0};
	/* Cells of 5: the first is whole and has one middle pixel, the last is 1 wide. */
	make_geometry(&geometry, 11, 5, step_right, near_right);
	geometry.ux[2 * 11 + 2] = 0.25;
	reference_grid_init(&grid, &geometry, 5, 63);
	CHECK_INT(grid.columns, 5);
	CHECK_INT(grid.rows, 3);
	check_vertex(vertex(&grid, 1, 1), 2.5, 2.5, 0.25, 0.8);
	check_vertex(vertex(&grid, 3, 1), 10.5, 2.5, 0.0, 0.8);
	check_vertex(vertex(&grid, 0, 1), 0.0, 2.5, 0.0, 0.8);
	check_vertex(vertex(&grid, 4, 2), 11.0, 5.0, 0.0, 0.8);
	reference_geometry_finish(&geometry);
	make_geometry(&geometry, 16, 8, step_right, near_right);
	geometry.ux[3 * 16 + 3] = 1.0;
	geometry.z[4 * 16 + 4] = 0.1;
	reference_grid_init(&grid, &geometry, 8, 63);
	check_vertex(vertex(&grid, 1, 1), 4.0, 4.0, 0.25, 0.1);
	reference_geometry_finish(&geometry);
	reference_grid_finish(&grid);
}

static void check_positive(uint32_t width, uint32_t height, uint32_t cell, enum input_field field, uint64_t seed)
{
	const struct input_spec spec = {.width = width, .height = height, .field = field, .seed = seed};
	const struct engine_params params = {.cell = cell, .display_width_mm = input_display_mm(width)};
	const struct engine_begin_params begin = {.n = 2, .last_phase = -1.0};
	struct input input;
	struct reference reference = {0};
	double area = 0.0;
	input_make(&input, &spec);
	reference_begin(&reference, &input.frame, &params, &begin);
	for (uint32_t t = 0; t < reference.grid.triangle_count; t++) {
		const double area2 = reference_area2(&reference.grid, reference.grid.triangles[t].v, 0.0);
		CHECK(area2 > 0.0);
		area += area2 / 2.0;
	}
	CHECK_NEAR(area, (double)width * height, 1e-6);
	CHECK_INT(reference.grid.snapped, (reference.grid.columns - 2) * (reference.grid.rows - 2));
	reference_finish(&reference);
	input_finish(&input);
}

/* However the vertices snap, all triangles are positive and tile the picture. */
static void test_triangles_tile_the_picture(void)
{
	for (uint64_t seed = 1; seed <= 12; seed++) {
		check_positive(61, 43, 8, INPUT_VIOLENT, seed);
		check_positive(64, 32, 4, INPUT_SHAKE, seed);
		check_positive(33, 70, 64, INPUT_VIOLENT, seed);
		check_positive(30, 17, 5, INPUT_SHAKE, seed);
	}
}

static double bulge(uint32_t i, uint32_t j)
{
	return i < 8 && j < 8 ? 0.125 : i >= 8 && j >= 8 ? 0.125 : 0.0;
}

static void test_diagonal(void)
{
	struct reference_geometry geometry;
	struct reference_grid grid = {0};
	make_geometry(&geometry, 16, 16, bulge, flat);
	reference_grid_init(&grid, &geometry, 8, 63);
	/* The quad in the middle, between the four cells: v00 and v11 move alike. */
	const struct reference_triangle *middle = &grid.triangles[2 * (1 * 3 + 1)];
	CHECK_INT(middle[0].v[0], 5);
	CHECK_INT(middle[0].v[1], 6);
	CHECK_INT(middle[0].v[2], 10);
	CHECK_INT(middle[1].v[2], 9);
	for (int i = 0; i < 256; i++)
		geometry.ux[i] = (i % 16 < 8) == (i / 16 < 8) ? (i % 16 < 8 ? 0.125 : 0.0) : 0.25;
	reference_grid_init(&grid, &geometry, 8, 63);
	/* v10 and v01 alike, v00 and v11 not. */
	CHECK_INT(grid.triangles[8].v[2], 9);
	CHECK_INT(grid.triangles[9].v[0], 6);
	reference_geometry_finish(&geometry);
	reference_grid_finish(&grid);
}

/* One pixel moves by `pixels` in a picture 531 mm wide seen from 600 mm; its tracking factor by u / m. */
static double factor_at(double degrees_per_second)
{
	const double degree_per_pixel = atan(531.0 / 640.0 / 600.0) * 180.0 / acos(-1.0);
	const float pixels = (float)(degrees_per_second / degree_per_pixel * 0.025);
	const struct input_spec spec = {.width = 640, .height = 2, .real_interval_ns = 25000000};
	const struct engine_params params = {0};
	const struct engine_begin_params begin = {.n = 3, .last_phase = -1.0};
	struct input input;
	struct reference reference = {0};
	input_make(&input, &spec);
	const int index = frame_find_plane(&input.frame.header, PURSUIT_ROLE_MOTION);
	memcpy(input.memory + input.frame.header.planes[index].offset, &pixels, sizeof(pixels));
	reference_begin(&reference, &input.frame, &params, &begin);
	const double factor = reference.geometry.ux[0] / (double)pixels;
	reference_finish(&reference);
	input_finish(&input);
	return factor;
}

static void test_damping(void)
{
	CHECK_NEAR(reference_speed(1.0, 1.0, 1.0, 600.0, 600.0), 45.0, 1e-12);
	CHECK_NEAR(factor_at(30.0), 1.0, 0.0);
	CHECK_NEAR(factor_at(69.99), 1.0, 0.0);
	CHECK_NEAR(factor_at(70.0), 1.0, 1e-9);
	CHECK_NEAR(factor_at(75.0), 0.84375, 1e-5);
	CHECK_NEAR(factor_at(80.0), 0.5, 1e-5);
	CHECK_NEAR(factor_at(90.0), 0.0, 1e-9);
	CHECK_NEAR(factor_at(90.01), 0.0, 0.0);
	CHECK_NEAR(factor_at(5000.0), 0.0, 0.0);
}

static void check_timing(uint64_t real, uint64_t motion, uint64_t pacer, double real_s, double motion_s)
{
	const struct pursuit_frame_header header = {.real_interval_ns = real, .motion_interval_ns = motion};
	const struct engine_begin_params begin = {.n = 0, .real_interval_ns = pacer, .last_phase = -1.0};
	struct reference_timing timing;
	reference_timing(&timing, &header, &begin);
	CHECK_NEAR(timing.real_s, real_s, 1e-12);
	CHECK_NEAR(timing.motion_s, motion_s, 1e-12);
	CHECK_INT(timing.n, 1);
}

static void test_timing(void)
{
	check_timing(20000000, 10000000, 0, 0.02, 0.01);
	check_timing(20000000, 0, 0, 0.02, 0.02);
	check_timing(20000000, 0, 30000000, 0.03, 0.02);
	check_timing(0, 10000000, 0, 0.01, 0.01);
	check_timing(0, 0, 30000000, 0.03, 0.03);
	check_timing(0, 0, 0, 0.0, 0.0);
}

static void test_depth_kinds(void)
{
	const double inf = (double)INFINITY, nan = (double)NAN;
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_NONE, 0, 0, 0.1), 0.5, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_DEVICE, 0, 0, 0.25), 0.25, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_DEVICE, 0, 0, 1.5), 1.0, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_DEVICE, 0, 0, -1.5), 0.0, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_DEVICE, 0, 0, nan), 1.0, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_DEVICE_REVERSED, 0, 0, 0.25), 0.75, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_DEVICE_REVERSED, 0, 0, nan), 1.0, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_LINEAR, 2.0, 10.0, 4.0), 0.25, 1e-15);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_LINEAR, 2.0, inf, 8.0), 0.75, 1e-15);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_LINEAR, 2.0, inf, 1.0), 0.0, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_LINEAR, 2.0, inf, inf), 1.0, 0.0);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_LINEAR, 0.0, 0.0, 3.0), 0.75, 1e-15);
	CHECK_NEAR(reference_depth(PURSUIT_DEPTH_LINEAR, 0.0, 0.0, inf), 1.0, 0.0);
}

static void test_rest(void)
{
	static const uint32_t flags[] = {PURSUIT_FRAME_CUT, PURSUIT_FRAME_MOTION_INVALID};
	struct reference reference = {0};
	struct input input;
	for (int i = 0; i < 5; i++) {
		const struct input_spec spec = {.width = 20,
										.height = 9,
										.field = INPUT_TRANSLATE,
										.flags = i < 2 ? flags[i] : 0,
										.no_motion = i == 2,
										.real_interval_ns = i == 3};
		const struct engine_params params = {.display_width_mm = input_display_mm(20)};
		const struct engine_begin_params begin = {.n = 2, .last_phase = -1.0};
		input_make(&input, &spec);
		reference_begin(&reference, &input.frame, &params, &begin);
		CHECK_INT(reference.geometry.moves, i == 4);
		reference_finish(&reference);
		input_finish(&input);
	}
}

int main(void)
{
	RUN(test_snap_to_vertical_edge);
	RUN(test_snap_to_horizontal_edge);
	RUN(test_quantisation);
	RUN(test_threshold);
	RUN(test_nearest_to_centre_wins);
	RUN(test_unsnapped_means);
	RUN(test_triangles_tile_the_picture);
	RUN(test_diagonal);
	RUN(test_damping);
	RUN(test_timing);
	RUN(test_depth_kinds);
	RUN(test_rest);
	return test_result();
}
