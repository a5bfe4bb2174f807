/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The latency log: written by its thread, read back, in both forms; damaged files. */

#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/lab/latency_format.h"
#include "daemon/lab/latency_log.h"
#include "daemon/lab/latency_read.h"
#include "daemon/present/presenter.h"
#include "tests/test.h"

#define ROWS 1000u

static const struct log quiet = {.fd = 2, .level = LOG_LEVEL_ERROR};
static char folder[] = "/tmp/pursuit-test-log-XXXXXX";

static const char *path_of(const char *name)
{
	static char path[128];
	snprintf(path, sizeof(path), "%s/%s", folder, name);
	return path;
}

static struct points make_row(uint64_t i)
{
	struct points points = {.vblank = 1000 + i,
							.frame_id = i / 3,
							.set_ns = 1700,
							.code = (uint32_t)i,
							.skipped = i % 50 == 0,
							.phase = 0.25f * (float)(i % 4),
							.show = (uint8_t)(i % POINTS_SHOWS),
							.source = (uint8_t)(i % PRESENTER_TIME_SOURCES),
							.late = i % 7 == 0,
							.level = i & 1,
							.edge_lost = i % 11 == 0,
							.photon_lost = i % 13 == 0,
							.method = "pursuit"};
	for (uint32_t point = 0; point < POINT_COUNT; point++)
		points.time[point] = UINT64_C(13862228216876) + i * 8333333 + point * 1001;
	points.time[POINT_EDGE] = i % 5 == 0 ? POINT_UNKNOWN : points.time[POINT_EDGE];
	points.time[POINT_PHOTON] = i % 6 == 0 ? POINT_NOT_YET : points.time[POINT_PHOTON];
	return points;
}

static void write_log(const char *path, uint32_t count)
{
	struct error error = {""};
	struct latency_log *log = latency_log_create(path, "program: test\nsetting refresh = 120\n", &quiet, &error);
	CHECK_STRING(error.text, "");
	for (uint32_t i = 0; log && i < count; i++) {
		const struct points points = make_row(i);
		latency_log_push(log, &points);
	}
	latency_log_destroy(&log);
}

static void check_whole(const char *path)
{
	struct latency_table table;
	struct error error = {""};
	char value[16] = "";
	uint32_t different = 0;
	CHECK_INT(latency_read(path, &table, &error), 0);
	CHECK_STRING(error.text, "");
	CHECK_INT(table.count, ROWS);
	CHECK_INT(table.dropped, 0);
	CHECK_INT(table.cut_bytes, 0);
	for (uint32_t i = 0; i < table.count; i++) {
		const struct points points = make_row(i);
		uint8_t packed[2][LATENCY_ROW_BYTES];
		latency_pack_row(&points, packed[0]);
		latency_pack_row(&table.rows[i], packed[1]);
		different += memcmp(packed[0], packed[1], LATENCY_ROW_BYTES) != 0;
	}
	CHECK_INT(different, 0);
	CHECK(latency_table_setting(&table, "refresh", value, sizeof(value)));
	CHECK_STRING(value, "120");
	CHECK(!latency_table_setting(&table, "fresh", value, sizeof(value)));
	latency_table_finish(&table);
}

static void test_both_forms(void)
{
	write_log(path_of("a.csv"), ROWS);
	check_whole(path_of("a.csv"));
	write_log(path_of("a.bin"), ROWS);
	check_whole(path_of("a.bin"));
}

/* A writer that was killed: all whole lines and blocks are there. */
static void test_cut(void)
{
	static const char *const names[] = {"a.csv", "a.bin"};
	struct latency_table table;
	struct error error = {""};
	for (int i = 0; i < 2; i++) {
		struct stat status;
		CHECK_INT(stat(path_of(names[i]), &status), 0);
		CHECK_INT(truncate(path_of(names[i]), status.st_size - 37), 0);
		CHECK_INT(latency_read(path_of(names[i]), &table, &error), 0);
		CHECK(table.count < ROWS && table.count >= ROWS - LATENCY_BLOCK_ROWS);
		CHECK(table.cut_bytes > 0);
		CHECK_INT(table.rows[table.count - 1].vblank, 1000 + table.count - 1);
		latency_table_finish(&table);
	}
}

/* Every byte of a file in turn: an error or fewer rows, never a crash. */
static void test_damaged(void)
{
	static const char *const names[] = {"b.csv", "b.bin"};
	for (int form = 0; form < 2; form++) {
		write_log(path_of(names[form]), 4);
		FILE *file = fopen(path_of(names[form]), "r+");
		fseek(file, 0, SEEK_END);
		const long size = ftell(file);
		for (long i = 0; i < size; i += form ? 5 : 11) {
			struct latency_table table;
			struct error error = {""};
			fseek(file, i, SEEK_SET);
			const int byte = fgetc(file);
			fseek(file, i, SEEK_SET);
			fputc(byte ^ 0x15, file);
			fflush(file);
			if (latency_read(path_of(names[form]), &table, &error) == 0) {
				CHECK(table.count <= 4);
				latency_table_finish(&table);
			} else {
				CHECK(error.text[0] != '\0');
			}
			fseek(file, i, SEEK_SET);
			fputc(byte, file);
		}
		fclose(file);
	}
}

static void test_refusals(void)
{
	struct latency_table table;
	struct error error = {""};
	CHECK_INT(latency_log_check("x.txt", &error), -EINVAL);
	CHECK(strstr(error.text, ".csv"));
	CHECK(!latency_log_create("/nonexistent/x.csv", "", &quiet, &error));
	CHECK(strstr(error.text, "/nonexistent/x.csv"));
	CHECK(latency_read("/nonexistent", &table, &error) < 0);
	CHECK(latency_read("/dev/null", &table, &error) < 0);
	CHECK(latency_read("/proc/self/maps", &table, &error) < 0);
}

static void test_times_in_text(void)
{
	char line[LATENCY_LINE];
	struct points points = make_row(30), back;
	CHECK(latency_print_row(&points, line) > 0);
	CHECK(latency_parse_row(line, &back));
	CHECK(back.time[POINT_EDGE] == POINT_UNKNOWN);
	CHECK(back.time[POINT_PHOTON] == POINT_NOT_YET);
	CHECK(!latency_parse_row("", &back));
	CHECK(!latency_parse_row("1,2,real,0.5,pursuit\n", &back));
	CHECK(!latency_parse_row(",,,,,,,,,,,,,,,,,,,,,\n", &back));
	/* As long as a row can get, it fits. */
	memset(&points, 0xff, sizeof(points));
	points.show = 0;
	points.source = 0;
	points.level = points.late = points.edge_lost = points.photon_lost = true;
	points.phase = -1e9f;
	for (uint32_t i = 0; i < POINT_COUNT; i++)
		points.time[i] = INT64_MAX;
	CHECK(latency_print_row(&points, line) < LATENCY_LINE - 1);
	CHECK(strchr(line, '\n') != NULL);
}

int main(void)
{
	if (!mkdtemp(folder))
		return 1;
	RUN(test_both_forms);
	RUN(test_cut);
	RUN(test_damaged);
	RUN(test_refusals);
	RUN(test_times_in_text);
	for (int i = 0; i < 4; i++) {
		static const char *const names[] = {"a.csv", "a.bin", "b.csv", "b.bin"};
		unlink(path_of(names[i]));
	}
	rmdir(folder);
	return test_result();
}
