/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Recordings of what is shown that follow each other, quicker than what was drawn for them is shown: none misses any.
 */

#include <inttypes.h>
#include <unistd.h>

#include "daemon/tees.h"
#include "tests/test.h"

#define SIDE 16u
#define FILES 5u

static char folder[] = "/tmp/pursuit-tees-XXXXXX";
static const struct grid grid = {.numerator = 120, .denominator = 1};
static uint8_t pixels[SIDE * SIDE * 4];
static struct log quiet;
static unsigned closed;

static void close_now(void *data, struct tee *tee)
{
	(void)data;
	tee_destroy(&tee);
	closed++;
}

static const char *path_of(unsigned number, const char *end)
{
	static char path[96];
	snprintf(path, sizeof(path), "%s/%u.y4m%s", folder, number, end);
	return path;
}

static struct tee *make(unsigned number)
{
	struct error error = {""};
	struct tee *tee = tee_create(&(struct tee_params){.path = path_of(number, ""), .log = &quiet}, &error);
	CHECK(tee != NULL);
	return tee;
}

/* Serials of the pictures that the file has, "1 2 "; takes it away. */
static const char *serials_of(unsigned number)
{
	static char list[256];
	char line[256];
	FILE *times = fopen(path_of(number, ".csv"), "re");
	list[0] = 0;
	CHECK(times != NULL);
	while (times && fgets(line, sizeof(line), times)) {
		uint64_t serial;
		if (sscanf(line, "%*u,%*u,%*u,%*u,%*[^,],%" SCNu64, &serial) == 1)
			snprintf(list + strlen(list), sizeof(list) - strlen(list), "%" PRIu64 " ", serial);
	}
	if (times)
		fclose(times);
	unlink(path_of(number, ".csv"));
	unlink(path_of(number, ""));
	return list;
}

static void draw(struct tees *tees, uint64_t group, uint64_t serial)
{
	const struct presenter_image image = {.data = pixels, .stride = SIDE * 4, .width = SIDE, .height = SIDE};
	if (tees->now)
		tee_add(tees->now, &image, group, serial);
}

static void show(struct tees *tees, uint64_t group, uint64_t serial)
{
	static uint64_t vblank;
	const struct presenter_flip flip = {.vblank = ++vblank, .serial = serial, .group = group};
	tees_flip(tees, &flip, &grid);
}

/* Two pictures for each of them before the first is shown; the plain one of a real frame is shown after the others. */
static void test_in_a_row(void)
{
	struct tees tees = {.close = close_now, .log = &quiet};
	draw(&tees, 1, 1);
	for (unsigned i = 0; i < FILES; i++) {
		tees_follow(&tees, make(i), 1, 1 + 2 * i);
		draw(&tees, 1, 2 + 2 * i);
		draw(&tees, 1, 3 + 2 * i);
	}
	tees_follow(&tees, make(FILES), 1, 1 + 2 * FILES);
	tees_follow(&tees, NULL, 1, 1 + 2 * FILES);
	CHECK_INT(closed, 1);
	for (uint64_t serial = 1; serial <= 1 + 2 * FILES; serial++)
		show(&tees, 1, serial);
	show(&tees, 1, 3);
	CHECK_INT(closed, 1);
	draw(&tees, 2, 100);
	show(&tees, 2, 100);
	CHECK_INT(closed, 1 + FILES);
	CHECK_STRING(serials_of(0), "2 3 3 ");
	CHECK_STRING(serials_of(1), "4 5 ");
	CHECK_STRING(serials_of(2), "6 7 ");
	CHECK_STRING(serials_of(3), "8 9 ");
	CHECK_STRING(serials_of(4), "10 11 ");
	CHECK_STRING(serials_of(FILES), "");
	tees_finish(&tees);
}

/* More than anybody has a use for: none stays open for ever, and the end finds all that are left. */
static void test_without_end(void)
{
	struct tees tees = {.close = close_now, .log = &quiet};
	closed = 0;
	for (unsigned i = 0; i < 2 * TEES_BEFORE; i++) {
		tees_follow(&tees, make(i), 1, i);
		draw(&tees, 1, i + 1);
	}
	CHECK_INT(closed, TEES_BEFORE - 1);
	show(&tees, 1, 2 * TEES_BEFORE);
	show(&tees, 1, 2 * TEES_BEFORE - 1);
	tees_rest(&tees);
	CHECK_INT(closed, 2 * TEES_BEFORE - 1);
	CHECK_STRING(serials_of(2 * TEES_BEFORE - 2), "31 ");
	tees_finish(&tees);
	CHECK_STRING(serials_of(2 * TEES_BEFORE - 1), "32 ");
	for (unsigned i = 0; i < 2 * TEES_BEFORE - 2; i++)
		serials_of(i);
}

int main(void)
{
	CHECK(mkdtemp(folder) != NULL);
	log_init(&quiet, LOG_LEVEL_ERROR);
	RUN(test_in_a_row);
	RUN(test_without_end);
	CHECK_INT(rmdir(folder), 0);
	return test_result();
}
