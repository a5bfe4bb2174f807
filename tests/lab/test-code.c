/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/code.h"
#include "tests/test.h"

static struct code *code;

static void test_every_window_is_unique(void)
{
	uint8_t *seen = calloc(1, 65536);
	uint32_t window = 0, twice = 0, wrong = 0;
	for (uint32_t i = 0; i < CODE_PERIOD + CODE_ORDER - 1; i++) {
		window = (window << 1 | code_bit(code, i)) & 0xffff;
		if (i < CODE_ORDER - 1)
			continue;
		twice += seen[window]++ > 0;
		wrong += code_find(code, window) != (int32_t)(i % CODE_PERIOD);
	}
	CHECK_INT(twice, 0);
	CHECK_INT(wrong, 0);
	CHECK_INT(seen[0], 0);
	CHECK_INT(code_find(code, 0), -1);
	free(seen);
}

static void test_balanced(void)
{
	uint32_t ones = 0;
	for (uint32_t i = 0; i < CODE_PERIOD; i++)
		ones += code_bit(code, i);
	CHECK_INT(ones, 32768);
	CHECK_INT(code_bit(code, 7), code_bit(code, 7 + (uint64_t)CODE_PERIOD * 12345));
}

static void test_reader_locks(void)
{
	struct code_reader reader = {0};
	for (uint32_t i = 0; i < 3 * CODE_PERIOD; i++) {
		const uint32_t number = i + 60000;
		const int32_t index = code_reader_add(&reader, code, code_bit(code, number));
		if (i + 1 < CODE_WINDOW)
			CHECK_INT(index, -1);
		else if (index != (int32_t)(number % CODE_PERIOD))
			CHECK_INT(index, number % CODE_PERIOD);
	}
	CHECK_INT(reader.slips, 0);
}

/* A light sensor that misses frames, or a display that shows them twice: noticed, and by how many. */
static void check_slip(uint32_t at, int32_t slip)
{
	struct code_reader reader = {0};
	uint32_t wrong_for = 0;
	for (uint32_t i = 0; i < 400; i++) {
		const uint32_t number = i < at ? i : (uint32_t)((int32_t)i + slip);
		const int32_t index = code_reader_add(&reader, code, code_bit(code, number));
		wrong_for += i >= at && index >= 0 && index != (int32_t)number;
	}
	CHECK_INT(reader.slips, 1);
	CHECK_INT(reader.slip, slip);
	CHECK(reader.locked);
	CHECK(wrong_for < CODE_WINDOW);
}

static void test_lost_and_doubled(void)
{
	for (uint32_t at = 100; at < 200; at++) {
		check_slip(at, 1);
		check_slip(at, 7);
		check_slip(at, -1);
		check_slip(at, -3);
	}
}

static void test_noise(void)
{
	struct code_reader reader = {0};
	uint32_t random = 1, false_locks = 0;
	for (uint32_t i = 0; i < 200000; i++) {
		random = random * 1664525u + 1013904223u;
		false_locks += code_reader_add(&reader, code, random >> 31) >= 0;
	}
	/* Once in 65536 by chance, and left after two samples. */
	CHECK(false_locks < 40);
}

static void test_gap(void)
{
	struct code_reader reader = {0};
	int32_t index = -1;
	for (uint32_t i = 0; i < 200; i++) {
		if (i % 50 == 10)
			code_reader_gap(&reader);
		else
			index = code_reader_add(&reader, code, code_bit(code, i));
	}
	CHECK_INT(index, 199);
	CHECK_INT(reader.slips, 0);
}

int main(void)
{
	code = code_create();
	RUN(test_every_window_is_unique);
	RUN(test_balanced);
	RUN(test_reader_locks);
	RUN(test_lost_and_doubled);
	RUN(test_noise);
	RUN(test_gap);
	code_destroy(&code);
	return test_result();
}
