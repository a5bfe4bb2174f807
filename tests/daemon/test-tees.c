/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Recordings of what is shown that follow each other, quicker than what was drawn for them is shown: none misses any.
 */

#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "daemon/aside.h"
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

/* All rests but the last picture, which is on its way: it is in its file whenever it comes, which is closed then. */
static void test_rest(void)
{
	struct tees tees = {.close = close_now, .log = &quiet};
	closed = 0;
	for (unsigned i = 0; i < 3; i++) {
		tees_follow(&tees, make(i), 1, i);
		draw(&tees, 1, i + 1);
	}
	tees_follow(&tees, make(3), 1, 3);
	show(&tees, 1, 1);
	tees_rest(&tees, 3);
	CHECK_INT(closed, 0);
	show(&tees, 1, 3);
	CHECK_INT(closed, 3);
	CHECK_STRING(serials_of(0), "1 ");
	CHECK_STRING(serials_of(1), "");
	CHECK_STRING(serials_of(2), "3 ");
	/* It goes on before that picture has come: what is drawn since waits for its own. */
	draw(&tees, 1, 4);
	tees_follow(&tees, make(4), 1, 4);
	tees_rest(&tees, 4);
	draw(&tees, 1, 5);
	tees_follow(&tees, NULL, 1, 5);
	CHECK_INT(closed, 3);
	show(&tees, 1, 4);
	CHECK_INT(closed, 4);
	show(&tees, 1, 5);
	tees_rest(&tees, 0);
	CHECK_INT(closed, 5);
	CHECK_STRING(serials_of(3), "4 ");
	CHECK_STRING(serials_of(4), "5 ");
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
	tees_rest(&tees, 0);
	CHECK_INT(closed, 2 * TEES_BEFORE - 1);
	CHECK_STRING(serials_of(2 * TEES_BEFORE - 2), "31 ");
	tees_finish(&tees);
	CHECK_STRING(serials_of(2 * TEES_BEFORE - 1), "32 ");
	for (unsigned i = 0; i < 2 * TEES_BEFORE - 2; i++)
		serials_of(i);
}

/* ---- images ---- */

static struct tee *make_images(void)
{
	char pattern[96];
	struct error error = {""};
	snprintf(pattern, sizeof(pattern), "%s/%%d.png", folder);
	struct tee *tee = tee_create(&(struct tee_params){.path = pattern, .log = &quiet}, &error);
	CHECK(tee != NULL);
	return tee;
}

static bool comes(unsigned number)
{
	char path[96];
	snprintf(path, sizeof(path), "%s/%u.png", folder, number);
	for (unsigned i = 0; i < 6000 && access(path, F_OK) < 0; i++)
		nanosleep(&(struct timespec){0, 10000000}, NULL);
	return access(path, F_OK) == 0;
}

static void record_one(struct tee *tee, uint64_t serial)
{
	const struct presenter_image image = {.data = pixels, .stride = SIDE * 4, .width = SIDE, .height = SIDE};
	const struct presenter_flip flip = {.vblank = serial, .serial = serial, .group = 1};
	tee_add(tee, &image, 1, serial);
	tee_flip(tee, &flip, &grid);
}

/* "1 0, 3 2, ": serial and number of each row; takes it away. */
static const char *rows_of(const char *times)
{
	static char list[128];
	char path[96], line[256];
	snprintf(path, sizeof(path), "%s/%s", folder, times);
	FILE *file = fopen(path, "re");
	list[0] = 0;
	CHECK(file != NULL);
	while (file && fgets(line, sizeof(line), file)) {
		uint64_t serial, number;
		if (sscanf(line, "%*u,%*u,%*u,%*u,%*[^,],%" SCNu64 ",%*[^,],%" SCNu64, &serial, &number) == 2)
			snprintf(list + strlen(list), sizeof(list) - strlen(list), "%" PRIu64 " %" PRIu64 ", ", serial, number);
	}
	if (file)
		fclose(file);
	CHECK_INT(unlink(path), 0);
	return list;
}

/* The one of before still writes while its pattern is set once more: neither writes over what the other has. */
static void test_images_of_two(void)
{
	char path[96];
	struct error error = {""};
	struct tee *one = make_images();
	/* As for each recording that is set, however little the one of before has written. */
	snprintf(path, sizeof(path), "%s/times.csv", folder);
	CHECK_INT(aside_put("tee", path, &quiet, NULL, &error), 0);
	struct tee *other = make_images();
	for (unsigned i = 0; i < 4; i++) {
		record_one(i % 2 ? other : one, i + 1);
		CHECK(comes(i));
	}
	tee_destroy(&one);
	tee_destroy(&other);
	for (unsigned i = 0; i < 4; i++) {
		snprintf(path, sizeof(path), "%s/%u.png", folder, i);
		CHECK_INT(unlink(path), 0);
	}
	CHECK_STRING(rows_of("times.csv.1"), "1 0, 3 2, ");
	CHECK_STRING(rows_of("times.csv"), "2 1, 4 3, ");
}

/* ---- disks that are slow: a pipe that is read now and then ---- */

#define LARGE 256u
#define FRAMES 12u

static uint8_t large[LARGE * LARGE * 4];

static struct tee *fill_pipe(uint64_t patience_ns, int *reader)
{
	const struct presenter_image image = {.data = large, .stride = LARGE * 4, .width = LARGE, .height = LARGE};
	struct error error = {""};
	CHECK_INT(mkfifo(path_of(0, ""), 0600), 0);
	*reader = open(path_of(0, ""), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	struct tee *tee =
		tee_create(&(struct tee_params){.path = path_of(0, ""), .log = &quiet, .patience_ns = patience_ns}, &error);
	CHECK(tee != NULL);
	for (uint64_t serial = 1; serial <= FRAMES; serial++) {
		const struct presenter_flip flip = {.vblank = serial, .serial = serial, .group = 1};
		tee_add(tee, &image, 1, serial);
		tee_flip(tee, &flip, &grid);
	}
	return tee;
}

/* Reads to the end, a piece at a time, with pauses. Gives the bytes. */
static size_t drain(int reader, long pause_ns)
{
	static uint8_t piece[LARGE * LARGE * 3];
	size_t bytes = 0;
	struct pollfd written = {reader, POLLIN, 0};
	CHECK_INT(poll(&written, 1, 60000), 1); /* before that it would be the end */
	fcntl(reader, F_SETFL, 0);
	for (ssize_t got = 1; got > 0;) {
		size_t filled = 0;
		while (filled < sizeof(piece) && (got = read(reader, piece + filled, sizeof(piece) - filled)) > 0)
			filled += (size_t)got;
		bytes += filled;
		nanosleep(&(struct timespec){0, pause_ns}, NULL);
	}
	close(reader);
	return bytes;
}

static void *destroy(void *data)
{
	struct tee *tee = data;
	tee_destroy(&tee);
	return NULL;
}

/* Of what was logged since. */
static bool is_given_up(void)
{
	static char content[4096];
	const ssize_t got = pread(quiet.fd, content, sizeof(content) - 1, 0);
	content[got > 0 ? got : 0] = 0;
	CHECK(ftruncate(quiet.fd, 0) == 0 && lseek(quiet.fd, 0, SEEK_SET) == 0);
	return strstr(content, "given up after") != NULL;
}

/* It takes longer than the patience, but something all the time: nothing is given up. */
static void test_slow_disk(void)
{
	pthread_t thread;
	int reader;
	struct tee *tee = fill_pipe(UINT64_C(5000000000), &reader);
	CHECK_INT(pthread_create(&thread, NULL, destroy, tee), 0);
	CHECK(drain(reader, 500000000) > FRAMES * LARGE * LARGE * 3);
	pthread_join(thread, NULL);
	CHECK(!is_given_up());
	CHECK_STRING(serials_of(0), "1 2 3 4 5 6 7 8 9 10 11 12 ");
}

/* One that answers after it was given up: all is written and closed, and nothing is kept. */
static void test_disk_that_comes_back(void)
{
	int reader;
	struct tee *tee = fill_pipe(1000000, &reader);
	tee_destroy(&tee);
	CHECK(is_given_up());
	CHECK(drain(reader, 0) > FRAMES * LARGE * LARGE * 3);
	serials_of(0);
}

int main(void)
{
	CHECK(mkdtemp(folder) != NULL);
	quiet = (struct log){.fd = memfd_create("log", MFD_CLOEXEC), .level = LOG_LEVEL_ERROR};
	RUN(test_in_a_row);
	RUN(test_rest);
	RUN(test_without_end);
	RUN(test_images_of_two);
	RUN(test_slow_disk);
	RUN(test_disk_that_comes_back);
	CHECK_INT(rmdir(folder), 0);
	return test_result();
}
