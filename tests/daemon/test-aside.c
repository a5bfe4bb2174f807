/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What an earlier run has written is still there when a later one is told to write to the same place. */
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/aside.h"
#include "tests/daemon/fixture.h"

static struct fixture fixture;
static struct log quiet;

static void write_text(const char *path, const char *text)
{
	FILE *file = fopen(path, "we");
	CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static bool holds(const char *path, const char *text)
{
	char found[64] = "";
	FILE *file = fopen(path, "re");
	if (!file)
		return false;
	const size_t length = fread(found, 1, sizeof(found) - 1, file);
	fclose(file);
	return strncmp(found, text, strlen(text)) == 0 && length >= strlen(text);
}

static void test_numbers(void)
{
	char path[96], first[128], second[128];
	struct error error = {""};
	snprintf(path, sizeof(path), "%s/run.csv", fixture.folder);
	snprintf(first, sizeof(first), "%s.1", path);
	snprintf(second, sizeof(second), "%s.2", path);
	CHECK_INT(aside_put("log", path, &quiet, NULL, &error), 0);
	write_text(path, "");
	CHECK_INT(aside_put("log", path, &quiet, NULL, &error), 0);
	CHECK(access(path, F_OK) == 0 && access(first, F_OK) != 0);
	write_text(path, "one");
	CHECK_INT(aside_put("log", path, &quiet, NULL, &error), 0);
	CHECK(access(path, F_OK) != 0 && holds(first, "one"));
	write_text(path, "two");
	CHECK_INT(aside_put("log", path, &quiet, NULL, &error), 0);
	CHECK(access(path, F_OK) != 0 && holds(first, "one") && holds(second, "two"));
	CHECK_INT(aside_put("log", "/dev/null", &quiet, NULL, &error), 0);
	CHECK_INT(aside_put("log", "", &quiet, NULL, &error), 0);
	CHECK(access("/dev/null", F_OK) == 0);
	unlink(first);
	unlink(second);
}

/* Files of a run that was killed. */
static void test_killed_daemon(void)
{
	static const char *const names[] = {"run.csv", "all.pursuit", "shown.y4m", "shown.y4m.csv"};
	static const char *const begin[] = {"# Pursuit latency log", "PUIT", "mine", "mine"};
	char paths[4][128], kept[4][136];
	for (int i = 0; i < 4; i++) {
		snprintf(paths[i], sizeof(paths[i]), "%s/%s", fixture.folder, names[i]);
		snprintf(kept[i], sizeof(kept[i]), "%.127s.1", paths[i]);
	}
	/* Without a picture there is no video. */
	write_text(paths[2], "mine");
	write_text(paths[3], "mine");
	const char *const arguments[] = {"--present", "headless", "--latency-log", paths[0], "--record",
									 paths[1],    "--tee",    paths[2],        NULL};
	fixture_start(&fixture, arguments);
	CHECK_INT(fixture_stop(&fixture, SIGKILL), 128 + SIGKILL);
	const char *const again[] = {"--present", "headless", "--latency-log", paths[0], "--record", paths[1], NULL};
	fixture_start(&fixture, again);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	for (int i = 0; i < 4; i++) {
		CHECK(holds(kept[i], begin[i]));
		if (i < 2)
			CHECK(holds(paths[i], begin[i]));
		unlink(paths[i]);
		unlink(kept[i]);
	}
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	log_init(&quiet, LOG_LEVEL_ERROR);
	fixture_init(&fixture, argv[1]);
	RUN(test_numbers);
	RUN(test_killed_daemon);
	fixture_finish(&fixture);
	return test_result();
}
