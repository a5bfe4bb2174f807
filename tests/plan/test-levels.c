/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* All instruction sets give the same bits, plan by plan and kernel by kernel. */
#include "daemon/engine/analysis/levels.h"
#include "fixture.h"
#include "tests/test.h"

static void check_levels(const struct fixture *fixture, const struct plan_params *params, const char *what)
{
	static struct plan plain, other;
	struct error error;
	CHECK_INT(plan_make_with(&plain, &fixture->frame, params, plan_level_kernels(PLAN_LEVEL_PLAIN), &error), 0);
	for (int level = PLAN_LEVEL_PLAIN + 1; level < PLAN_LEVEL_COUNT; level++) {
		const struct plan_kernels *kernels = plan_level_kernels((enum plan_level)level);
		if (!kernels)
			continue;
		CHECK_INT(plan_make_with(&other, &fixture->frame, params, kernels, &error), 0);
		int same = fixture_same_plan(&plain, &other);
		CHECK(same);
		if (!same)
			fprintf(stderr, "%s: %s is not plain\n", what, kernels->name);
	}
}

static void test_plans(void)
{
	static const uint32_t widths[] = {1, 3, 15, 16, 17, 31, 33, 64, 100, 333}, heights[] = {1, 9, 40, 77};
	for (size_t w = 0; w < sizeof(widths) / sizeof(widths[0]); w++)
		for (size_t h = 0; h < sizeof(heights) / sizeof(heights[0]); h++)
			for (int field = 0; field < FIELD_COUNT; field++)
				for (uint32_t format = PURSUIT_FORMAT_RG16F; format <= PURSUIT_FORMAT_RG32F; format++) {
					struct fixture_spec spec = {widths[w], heights[h], .motion_format = format,
												.depth_format = PURSUIT_FORMAT_DEPTH32F};
					struct plan_params params = {.last_phase = 2.0f / 3, .cell = field % 2 ? 8 : 11};
					struct fixture fixture;
					fixture_make(&fixture, &spec);
					fixture_fill(&fixture, (enum fixture_field)field, 5 + field);
					fixture.frame.header.motion_interval_ns = 24000000;
					fixture.frame.volatile_memory = h % 2;
					check_levels(&fixture, &params, fixture_field_name((enum fixture_field)field));
					fixture_finish(&fixture);
				}
}

static void test_depths(void)
{
	for (uint32_t format = PURSUIT_FORMAT_DEPTH16; format <= PURSUIT_FORMAT_DEPTH32F; format++)
		for (uint32_t kind = PURSUIT_DEPTH_DEVICE; kind <= PURSUIT_DEPTH_LINEAR; kind++)
			for (int range = 0; range < 3; range++)
				for (int field = FIELD_FLOATS; field <= FIELD_BITS; field++) {
					struct fixture_spec spec = {211,
												50,
												.motion_format = PURSUIT_FORMAT_RG32F,
												.depth_format = format,
												.depth_kind = kind,
												.near_distance = range ? 0.1f : 0,
												.far_distance = range == 2 ? INFINITY : 0.9f};
					struct plan_params params = {.last_phase = 0.5f};
					struct fixture fixture;
					fixture_make(&fixture, &spec);
					fixture_fill(&fixture, (enum fixture_field)field, 3);
					check_levels(&fixture, &params, "depth");
					fixture_finish(&fixture);
				}
}

static double half_value(uint32_t bits)
{
	int exponent = bits >> 10 & 31;
	double mantissa = bits & 1023;
	double magnitude = exponent ? ldexp(1024 + mantissa, exponent - 25) : ldexp(mantissa, -24);
	return bits & 0x8000 ? -magnitude : magnitude;
}

static void test_every_half(void)
{
	static uint16_t halves[65536 + 7];
	static float values[65536 + 7];
	for (int level = 0; level < PLAN_LEVEL_COUNT; level++) {
		const struct plan_kernels *kernels = plan_level_kernels((enum plan_level)level);
		if (!kernels)
			continue;
		for (uint32_t i = 0; i < 65536 + 7; i++)
			halves[i] = (uint16_t)i;
		kernels->decode_half(halves, 65536 + 7, values);
		int wrong = 0;
		for (uint32_t i = 0; i < 65536 + 7; i++) {
			float value = values[i];
			if ((i & 0x7c00) == 0x7c00)
				wrong += i & 0x3ff ? !isnan(value) : !isinf(value) || !!signbit(value) != !!(i & 0x8000);
			else
				wrong += (double)value != half_value(i & 0xffff) || !!signbit(value) != !!(i & 0x8000);
		}
		CHECK_INT(wrong, 0);
	}
}

/* Each half and what lies between it and the next: to the nearest, ties to even. */
static void test_to_half(void)
{
	static float values[4];
	static uint16_t halves[4];
	for (int level = 0; level < PLAN_LEVEL_COUNT; level++) {
		const struct plan_kernels *kernels = plan_level_kernels((enum plan_level)level);
		int wrong = 0;
		for (uint32_t i = 0; kernels && i < 0x7bff; i++) {
			const double here = half_value(i), there = half_value(i + 1), tie = (here + there) / 2.0;
			const uint16_t even = (uint16_t)(i & 1 ? i + 1 : i);
			values[0] = (float)here;
			values[1] = nextafterf((float)tie, 0.0f);
			values[2] = (float)-tie;
			values[3] = nextafterf((float)tie, 1e9f);
			kernels->encode_half(values, 4, halves);
			wrong += halves[0] != i || halves[1] != i || halves[2] != (even | 0x8000u) || halves[3] != i + 1;
		}
		CHECK_INT(wrong, 0);
		for (size_t i = 0; kernels && i < 4; i++) {
			static const float odd[] = {65505.0f, -3e38f, INFINITY, NAN};
			kernels->encode_half(&odd[i], 1, halves);
			CHECK_INT(halves[0] & 0x7fff, i < 2 ? 0x7bff : 0x7e00);
		}
	}
}

static void test_any_bits(void)
{
	static uint32_t words[1500];
	for (int level = 0; level < PLAN_LEVEL_COUNT; level++) {
		const struct plan_kernels *kernels = plan_level_kernels((enum plan_level)level);
		for (uint32_t i = 0; kernels && i < 1500; i++) {
			words[i] = 0x80000000u;
			CHECK(!kernels->any_bits(words, 1500, 0x7fffffffu));
			words[i] = 1;
			CHECK(kernels->any_bits(words, 1500, 0x7fffffffu));
			CHECK(kernels->any_bits(words, i + 1, 0x7fffffffu) && !kernels->any_bits(words, i, 0x7fffffffu));
			words[i] = 0;
		}
	}
}

static void test_the_best_is_there(void)
{
	CHECK(plan_level_kernels(plan_level_best()) != NULL);
	CHECK(plan_level_kernels(PLAN_LEVEL_PLAIN) != NULL);
	CHECK(plan_level_kernels(PLAN_LEVEL_COUNT) == NULL);
	CHECK_STRING(plan_level_kernels(PLAN_LEVEL_PLAIN)->name, "plain");
	printf("best: %s\n", plan_level_kernels(plan_level_best())->name);
}

int main(void)
{
	RUN(test_the_best_is_there);
	RUN(test_every_half);
	RUN(test_to_half);
	RUN(test_any_bits);
	RUN(test_plans);
	RUN(test_depths);
	return test_result();
}
