/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The video of --tee has the rate of the display that showed it, whatever rate was wished for. */
#include <unistd.h>

#include "daemon/tee.h"
#include "tests/test.h"

#define SIDE 16u

static void test_rate(const struct grid *grid, const char *wanted)
{
	char folder[] = "/tmp/pursuit-tee-XXXXXX", path[64], times[80], head[64] = "", line[256] = "";
	static uint8_t pixels[SIDE * SIDE * 4];
	const struct presenter_image image = {.data = pixels, .stride = SIDE * 4, .width = SIDE, .height = SIDE};
	const struct presenter_flip flip = {.vblank = 1, .serial = 1, .group = 1};
	struct log quiet;
	struct error error = {""};
	log_init(&quiet, LOG_LEVEL_ERROR);
	CHECK(mkdtemp(folder) != NULL);
	snprintf(path, sizeof(path), "%s/shown.y4m", folder);
	snprintf(times, sizeof(times), "%s.csv", path);
	struct tee *tee = tee_create(&(struct tee_params){.path = path, .log = &quiet}, &error);
	CHECK(tee != NULL);
	tee_add(tee, &image, 1, 1);
	tee_flip(tee, &flip, grid);
	tee_destroy(&tee);
	FILE *file = fopen(path, "re");
	CHECK(file && fgets(line, sizeof(line), file));
	snprintf(head, sizeof(head), "YUV4MPEG2 W16 H16 %s ", wanted);
	line[strlen(head)] = 0;
	CHECK_STRING(line, head);
	if (file)
		fclose(file);
	unlink(path);
	unlink(times);
	rmdir(folder);
}

static void test_rates(void)
{
	const uint64_t learned = UINT64_C(1000000000000000);
	test_rate(&(struct grid){.numerator = 120, .denominator = 1}, "F120:1");
	test_rate(&(struct grid){.numerator = 120000, .denominator = 1001}, "F120000:1001");
	/* Periods in 1e-6 ns. */
	test_rate(&(struct grid){.numerator = learned, .denominator = UINT64_C(16683350000000)}, "F59940:1000");
	test_rate(&(struct grid){.numerator = learned, .denominator = UINT64_C(16666667100000)}, "F60:1");
}

int main(void)
{
	RUN(test_rates);
	return test_result();
}
