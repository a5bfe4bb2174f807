/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Lists of lines, and what the lab refuses before it touches any hardware. */

#include "daemon/lab/chip.h"
#include "daemon/lab/lab.h"
#include "daemon/lab/match.h"
#include "daemon/lab/rows.h"
#include "daemon/options.h"
#include "tests/test.h"

static struct error error;

static int count(const char *chip, const char *lines)
{
	error.text[0] = '\0';
	return chip_count_lines(chip, lines, "gpio-line", &error);
}

static void test_lists(void)
{
	CHECK_INT(count("c", "17"), 1);
	CHECK_INT(count("c", "17,GPIO4,5"), 3);
	CHECK_INT(count("", "GPIO17,GPIO4"), 2);
	CHECK_INT(count("c", "0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15"), 16);
	CHECK(count("c", "0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16") < 0);
	CHECK(strstr(error.text, "more than 16"));
	CHECK(count("c", "4,5,4") < 0);
	CHECK(strstr(error.text, "4 is listed twice"));
	CHECK(count("", "17") < 0);
	CHECK(strstr(error.text, "--gpio-chip"));
	CHECK(count("c", "") < 0);
	CHECK(count("c", ",") < 0);
	CHECK(count("c", "1,") < 0);
	CHECK(count("c", "1,,2") < 0);
	CHECK(count("c", "a-name-that-is-longer-than-any-line-of-any-chip") < 0);
	CHECK(strstr(error.text, "is no list of lines"));
}

static void check_refused(const char *const settings[][2], const char *sentence)
{
	struct settings all;
	struct clock clock;
	const struct log log = {.fd = 2, .level = LOG_LEVEL_ERROR};
	struct lab_params params = {.settings = &all.lab, .clock = &clock, .log = &log, .period_ns = 1e9 / 120};
	clock_init_real(&clock);
	settings_defaults(&all);
	CHECK(!lab_is_wanted(&all.lab));
	for (int i = 0; settings[i][0]; i++)
		CHECK_INT(settings_set(&all, settings[i][0], settings[i][1], &error), 0);
	CHECK(lab_is_wanted(&all.lab));
	CHECK(!lab_create(&params, &error));
	if (!strstr(error.text, sentence))
		CHECK_STRING(error.text, sentence);
}

static void test_refusals(void)
{
	check_refused((const char *const[][2]){{"gpio-line", "A,B"}, {NULL}}, "has 2 lines, the pattern wants 1");
	check_refused((const char *const[][2]){{"gpio-line", "A,B"}, {"gpio-pattern", "three-lines"}, {NULL}},
				  "has 2 lines, the pattern wants 3");
	check_refused((const char *const[][2]){{"strobe-line", "A,B"}, {NULL}}, "one line is wanted");
	check_refused((const char *const[][2]){{"strobe-line", "A"}, {"strobe-duty", "0.3"}, {NULL}},
				  "0.3 is above the strobe-limit");
	check_refused((const char *const[][2]){{"photodiode-line", "4"}, {NULL}}, "4 is an offset");
	check_refused(
		(const char *const[][2]){{"latency", "yes"}, {"photon-least-us", "9"}, {"photon-most-us", "9"}, {NULL}},
		"photon-most-us: 9 is not above");
	check_refused((const char *const[][2]){{"latency-log", "x.log"}, {NULL}}, "ends in neither .csv nor .bin");
}

/* No window is longer than a row waits for its light, at any refresh rate up to 500 Hz. */
static void test_windows(void)
{
	static const struct {
		const char *option, *longest, *longer;
	} rows[] = {{"photon-most-us", "900000", "900001"}, {"photon-least-us", "800000", "800001"}};
	const uint64_t hold_ns = 50000000, two_slow_refreshes_ns = 100000000;
	struct settings all;
	settings_defaults(&all);
	for (size_t i = 0; i < 2; i++) {
		CHECK_INT(settings_set(&all, rows[i].option, rows[i].longest, &error), 0);
		CHECK(settings_set(&all, rows[i].option, rows[i].longer, &error) < 0);
	}
	CHECK(all.lab.photon_most_us * UINT64_C(1000) + hold_ns <= ROWS_WAIT_NS);
	CHECK(all.lab.photon_least_us * UINT64_C(1000) + two_slow_refreshes_ns + hold_ns <= ROWS_WAIT_NS);
	CHECK(ROWS > ROWS_WAIT_NS / 2000000);
	CHECK(MATCH_FLIPS > ROWS_WAIT_NS / 2000000);
}

int main(void)
{
	RUN(test_windows);
	RUN(test_lists);
	RUN(test_refusals);
	return test_result();
}
