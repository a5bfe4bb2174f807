/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pyramid, B-spline, blur weight and tears of the reference (docs/method.md, 4 and 5). */
#include "reference.h"
#include "tests/test.h"

static void fill(struct reference_picture *picture, uint32_t width, uint32_t height, uint8_t (*at)(uint32_t, uint32_t))
{
	reference_picture_init(picture, width, height);
	for (uint32_t j = 0; j < height; j++)
		for (uint32_t i = 0; i < width; i++)
			memset(&picture->data[(j * width + i) * 4], at(i, j), 4);
}

static uint8_t value(const struct reference_picture *picture, uint32_t i, uint32_t j)
{
	return picture->data[(j * picture->width + i) * 4];
}

static uint8_t constant_at(uint32_t i, uint32_t j)
{
	return 137;
}

static uint8_t ramp_at(uint32_t i, uint32_t j)
{
	return (uint8_t)(16 + 2 * i + j);
}

static uint8_t dot_at(uint32_t i, uint32_t j)
{
	return i == 20 && j == 12 ? 255 : 0;
}

static void test_constant_stays(void)
{
	static const uint32_t sizes[][2] = {{1, 1}, {2, 1}, {1, 5}, {7, 3}, {16, 16}, {33, 17}};
	struct reference_picture picture = {0}, low = {0};
	for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++)
		for (uint32_t level = 1; level <= 6; level++) {
			fill(&picture, sizes[s][0], sizes[s][1], constant_at);
			reference_low(&low, &picture, level, 0.0);
			for (uint32_t j = 0; j < sizes[s][1]; j++)
				for (uint32_t i = 0; i < sizes[s][0]; i++)
					CHECK_INT(value(&low, i, j), 137);
		}
	reference_picture_finish(&picture);
	reference_picture_finish(&low);
}

/*
 * Level 1 of a 4 x 4, by hand. Rows filtered first: row (a b c d) gives at 0
 * (3a + b)/4 (a is its own left neighbour) and at 2 (b + 2c + d)/4.
 *   0  16  32  48  ->  4  32      64 64 64 64 -> 64 64
 *  16  16  16  16  -> 16  16     255  0  0  0 -> 191.25 0
 * Columns: at 0 (3 r0 + r1)/4, at 2 (r1 + 2 r2 + r3)/4.
 */
static void test_reduce_by_hand(void)
{
	static const uint8_t rows[4][4] = {{0, 16, 32, 48}, {16, 16, 16, 16}, {64, 64, 64, 64}, {255, 0, 0, 0}};
	struct reference_picture picture = {0}, level = {0};
	reference_picture_init(&picture, 4, 4);
	for (int i = 0; i < 16; i++)
		memset(&picture.data[i * 4], rows[i / 4][i % 4], 4);
	reference_reduce(&level, &picture, 0.0);
	CHECK_INT(level.width, 2);
	CHECK_INT(level.height, 2);
	CHECK_INT(value(&level, 0, 0), 7);  /* (3 x 4 + 16)/4 = 7 */
	CHECK_INT(value(&level, 1, 0), 28); /* (3 x 32 + 16)/4 = 28 */
	CHECK_INT(value(&level, 0, 1), 84); /* (16 + 128 + 191.25)/4 = 83.8125 */
	CHECK_INT(value(&level, 1, 1), 36); /* (16 + 128 + 0)/4 = 36 */
	reference_picture_finish(&picture);
	reference_picture_finish(&level);
}

static void test_reduce_rounds_up_halves(void)
{
	struct reference_picture picture = {0}, level = {0};
	reference_picture_init(&picture, 1, 2);
	memset(picture.data, 2, 4);
	memset(picture.data + 4, 4, 4); /* (3 x 2 + 4)/4 = 2.5 */
	reference_reduce(&level, &picture, 0.0);
	CHECK_INT(level.height, 1);
	CHECK_INT(value(&level, 0, 0), 3);
	reference_reduce(&level, &picture, -0.01);
	CHECK_INT(value(&level, 0, 0), 2);
	reference_picture_finish(&picture);
	reference_picture_finish(&level);
}

/* A ramp of whole steps stays itself where no edge is near: binomial and B-spline keep linear functions. */
static void test_ramp_exact_inside(void)
{
	struct reference_picture picture = {0}, low = {0};
	fill(&picture, 64, 48, ramp_at);
	for (uint32_t level = 1; level <= 2; level++) {
		const uint32_t margin = 4u << level;
		reference_low(&low, &picture, level, 0.0);
		for (uint32_t j = margin; j + margin < 48; j++)
			for (uint32_t i = margin; i + margin < 64; i++)
				CHECK_INT(value(&low, i, j), ramp_at(i, j));
	}
	reference_picture_finish(&picture);
	reference_picture_finish(&low);
}

/* A dot spreads symmetrically around itself and keeps its sum nearly (rounding aside). */
static void test_dot_spreads_around_itself(void)
{
	struct reference_picture picture = {0}, low = {0};
	fill(&picture, 41, 25, dot_at);
	reference_low(&low, &picture, 2, 0.0);
	CHECK(value(&low, 20, 12) >= 6 && value(&low, 20, 12) <= 16);
	for (uint32_t d = 1; d < 12; d++) {
		CHECK_INT(value(&low, 20 - d, 12), value(&low, 20 + d, 12));
		CHECK_INT(value(&low, 20, 12 - d), value(&low, 20, 12 + d));
		CHECK(value(&low, 20 + d, 12) <= value(&low, 20 + d - 1, 12));
	}
	CHECK_INT(value(&low, 2, 2), 0);
	reference_picture_finish(&picture);
	reference_picture_finish(&low);
}

/* One right triangle whose third corner moves. */
static void one_triangle(struct reference_grid *grid, struct reference_vertex vertices[3])
{
	static struct reference_triangle triangle = {{0, 1, 2}, false};
	*grid = (struct reference_grid){.vertices = vertices, .triangle_count = 1, .triangles = &triangle};
}

static void test_singular_values(void)
{
	static const uint32_t v[3] = {0, 1, 2};
	struct reference_vertex vertices[3] = {{.x = 1, .y = 1}, {.x = 5, .y = 1}, {.x = 1, .y = 9}};
	struct reference_grid grid;
	double sigma[2];
	one_triangle(&grid, vertices);
	reference_singular(&grid, v, 1.0, sigma);
	CHECK_NEAR(sigma[0], 1.0, 1e-15);
	CHECK_NEAR(sigma[1], 1.0, 1e-15);
	vertices[1].ux = 4.0; /* x doubles */
	reference_singular(&grid, v, 1.0, sigma);
	CHECK_NEAR(sigma[0], 2.0, 1e-15);
	CHECK_NEAR(sigma[1], 1.0, 1e-15);
	reference_singular(&grid, v, 0.5, sigma);
	CHECK_NEAR(sigma[0], 1.5, 1e-15);
	/* Shear (1 1; 0 1): singular values are the golden ratio and its inverse. */
	vertices[1].ux = 0.0;
	vertices[2].ux = 8.0;
	reference_singular(&grid, v, 1.0, sigma);
	CHECK_NEAR(sigma[0], (1.0 + sqrt(5.0)) / 2.0, 1e-14);
	CHECK_NEAR(sigma[1], (sqrt(5.0) - 1.0) / 2.0, 1e-14);
	/* A quarter turn is no stretch. */
	vertices[1] = (struct reference_vertex){.x = 5, .y = 1, .ux = -4, .uy = 4};
	vertices[2] = (struct reference_vertex){.x = 1, .y = 9, .ux = -8, .uy = -8};
	reference_singular(&grid, v, 1.0, sigma);
	CHECK_NEAR(sigma[0], 1.0, 1e-14);
	CHECK_NEAR(sigma[1], 1.0, 1e-14);
}

static void test_weight_and_tear(void)
{
	static const uint32_t v[3] = {0, 1, 2};
	struct reference_vertex vertices[3] = {{.x = 0, .y = 0}, {.x = 8, .y = 0, .ux = 8}, {.x = 0, .y = 8}};
	struct reference_grid grid;
	one_triangle(&grid, vertices);
	CHECK_NEAR(reference_weight(&grid, v, 1.0, ENGINE_BLUR_DOUBTFUL), 1.0, 0.0);
	CHECK_NEAR(reference_weight(&grid, v, 0.625, ENGINE_BLUR_DOUBTFUL), 0.5, 1e-12);
	CHECK_NEAR(reference_weight(&grid, v, 0.25, ENGINE_BLUR_DOUBTFUL), 0.0, 0.0);
	CHECK_NEAR(reference_weight(&grid, v, 0.25, ENGINE_BLUR_EVERYWHERE), 1.0, 0.0);
	CHECK_NEAR(reference_weight(&grid, v, 1.0, ENGINE_BLUR_OFF), 0.0, 0.0);
	CHECK_NEAR(reference_tear(&grid, v, 1.0, ENGINE_BLUR_DOUBTFUL), 0.0, 0.0);
	CHECK_NEAR(reference_tear(&grid, v, 1.5, ENGINE_BLUR_DOUBTFUL), 0.5, 1e-12);
	CHECK_NEAR(reference_tear(&grid, v, 2.0, ENGINE_BLUR_EVERYWHERE), 1.0, 0.0);
	CHECK_NEAR(reference_tear(&grid, v, 2.0, ENGINE_BLUR_OFF), 0.0, 0.0);
	vertices[1].ux = -20.0; /* turned over and stretched */
	CHECK_NEAR(reference_weight(&grid, v, 1.0, ENGINE_BLUR_DOUBTFUL), 0.0, 0.0);
}

int main(void)
{
	RUN(test_constant_stays);
	RUN(test_reduce_by_hand);
	RUN(test_reduce_rounds_up_halves);
	RUN(test_ramp_exact_inside);
	RUN(test_dot_spreads_around_itself);
	RUN(test_singular_values);
	RUN(test_weight_and_tear);
	return test_result();
}
