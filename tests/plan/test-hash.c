/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The number of a row changes with whatever changes in it: one bit anywhere, and what pictures change alike. */
#include <string.h>

#include "daemon/engine/analysis/levels.h"
#include "tests/test.h"

#define PIXELS 330u

static const struct plan_kernels *kernels;
static uint32_t row[PIXELS];

static void fill(unsigned kind)
{
	uint32_t state = 7;
	for (uint32_t i = 0; i < PIXELS; i++) {
		state = state * 1664525u + 1013904223u;
		row[i] = kind == 0 ? 0 : kind == 1 ? 0xff808080u : state;
	}
}

static uint64_t number(void)
{
	return kernels->hash_row((const uint8_t *)row, sizeof(row));
}

static void test_one_bit(void)
{
	for (uint32_t pixels = 1; pixels <= PIXELS; pixels += pixels < 140 ? 1 : 31) {
		const uint64_t before = kernels->hash_row((const uint8_t *)row, 4 * pixels);
		uint32_t missed = 0;
		for (uint32_t bit = 0; bit < 32 * pixels; bit++) {
			row[bit / 32] ^= 1u << bit % 32;
			missed += kernels->hash_row((const uint8_t *)row, 4 * pixels) == before;
			row[bit / 32] ^= 1u << bit % 32;
		}
		CHECK_INT(missed, 0);
	}
}

/* What lies beyond the row, and where the row lies, does not count; its length does. */
static void test_bounds(void)
{
	static uint8_t bytes[4 * PIXELS + 64];
	for (size_t count = 1; count < 4 * PIXELS; count += 13) {
		memcpy(bytes + 3, row, sizeof(row));
		const uint64_t before = kernels->hash_row((const uint8_t *)row, count);
		bytes[2] ^= 1;
		bytes[3 + count] ^= 1;
		CHECK(kernels->hash_row(bytes + 3, count) == before);
		CHECK(kernels->hash_row((const uint8_t *)row, count - 1) != before);
	}
}

/* The same bits of two pixels, wherever they lie; and of all pixels from one to another. */
static void test_two_and_many(uint32_t bits)
{
	const uint64_t before = number();
	uint32_t missed = 0;
	for (uint32_t first = 0; first < PIXELS; first++) {
		static uint32_t kept[PIXELS];
		memcpy(kept, row, sizeof(row));
		row[first] ^= bits;
		for (uint32_t second = first + 1; second < PIXELS; second++) {
			row[second] ^= bits;
			missed += number() == before;
			row[second] ^= bits;
		}
		for (uint32_t last = first + 1; last < PIXELS; last++) {
			row[last] ^= bits;
			missed += number() == before;
		}
		memcpy(row, kept, sizeof(row));
	}
	CHECK_INT(missed, 0);
}

/* Two pixels exchanged, and two pairs of them. */
static void test_exchanged(void)
{
	const uint64_t before = number();
	uint32_t missed = 0;
	for (uint32_t first = 0; first < PIXELS; first++)
		for (uint32_t second = first + 1; second < PIXELS; second++) {
			const uint32_t kept = row[first];
			row[first] = row[second];
			row[second] = kept;
			missed += number() == before && row[first] != row[second];
			row[second] = row[first];
			row[first] = kept;
		}
	CHECK_INT(missed, 0);
}

static void test_levels(void)
{
	for (int level = 0; level < PLAN_LEVEL_COUNT; level++) {
		kernels = plan_level_kernels((enum plan_level)level);
		for (unsigned kind = 0; kernels && kind < 3; kind++) {
			fill(kind);
			test_one_bit();
			test_bounds();
			test_exchanged();
			test_two_and_many(0x80000000u);
			test_two_and_many(0x80u);
			test_two_and_many(0x00010101u);
			test_two_and_many(0xffffffffu);
		}
	}
}

int main(void)
{
	RUN(test_levels);
	return test_result();
}
