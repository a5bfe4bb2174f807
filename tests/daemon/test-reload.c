/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The configuration file changed by hand, in all the ways that editors and
 * packages do it, while frames come: what is right counts, what is wrong is
 * told with its line and changes nothing, and no frame is lost.
 */

#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"

static struct fixture fixture;
static struct raw_reply reply;
static struct raw_stream stream;
static char config[128], other[128], target[128];
static int fd;

static void write_file(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	CHECK(file && fputs(text, file) >= 0);
	if (file)
		fclose(file);
}

static void play(int frames)
{
	struct pursuit_feedback report;
	for (int i = 0; i < frames; i++) {
		raw_fill(&stream);
		raw_publish(&stream);
		CHECK(raw_feedback(&stream, &report));
		CHECK_INT(report.state, PURSUIT_FEEDBACK_SHOWN);
	}
}

/* Frames go on meanwhile. */
static bool setting_comes(const char *line)
{
	for (int i = 0; i < 1000; i++) {
		if (question_setting(fd, line))
			return true;
		play(1);
	}
	return false;
}

/* So long after a change that it would have been noticed. */
static void pass_time(void)
{
	const uint64_t end_ns = now_ns() + UINT64_C(400000000);
	while (now_ns() < end_ns)
		play(1);
}

static unsigned readings(void)
{
	static char content[1 << 20];
	FILE *file = fopen(fixture.log, "r");
	const size_t length = file ? fread(content, 1, sizeof(content) - 1, file) : 0;
	unsigned count = 0;
	if (file)
		fclose(file);
	content[length] = 0;
	for (const char *at = content; (at = strstr(at, "settings read again")); at++)
		count++;
	return count;
}

static void test_in_place(void)
{
	write_file(config, "cell = 16\n");
	CHECK(setting_comes("\ncell = 16\n"));
}

static void test_replaced(void)
{
	write_file(other, "cell = 20\n");
	CHECK(rename(other, config) == 0);
	CHECK(setting_comes("\ncell = 20\n"));
	write_file(config, "cell = 21\n"); /* and the new one in place */
	CHECK(setting_comes("\ncell = 21\n"));
}

static void test_half_written(void)
{
	char want[256];
	write_file(config, "cell = 40\nblur-le");
	snprintf(want, sizeof(want), "%s:2: \"blur-le\" is not of the form name = value; the settings stay as they are",
			 config);
	CHECK(fixture_logged(&fixture, want));
	CHECK(question_setting(fd, "\ncell = 21\n"));
	write_file(config, "cell = 41\nblur-level = 3\n");
	CHECK(setting_comes("\ncell = 41\n") && question_setting(fd, "\nblur-level = 3\n"));
}

/* What is wrong with a value only when it is used: a name that there is not. */
static void test_unknown_name(void)
{
	char want[256];
	write_file(config, "cell = 40\n\nallow-users = no-such-user-here\n");
	snprintf(want, sizeof(want), "%s:3: allow-users: there is no user \"no-such-user-here\"; what else needs", config);
	CHECK(fixture_logged(&fixture, want));
	CHECK(setting_comes("\ncell = 40\n") && question_setting(fd, "\nallow-users = \n"));
	write_file(config, "cell = 41\nblur-level = 3\n");
	CHECK(setting_comes("\ncell = 41\n"));
}

/* A file that is open for writing is not read, even if it is empty for a while. */
static void test_slow_writer(void)
{
	FILE *file = fopen(config, "w");
	pass_time();
	CHECK(question_setting(fd, "\ncell = 41\n"));
	CHECK(fputs("cell = 42\n", file) >= 0 && fflush(file) == 0);
	pass_time();
	CHECK(question_setting(fd, "\ncell = 41\n"));
	CHECK(fclose(file) == 0);
	CHECK(setting_comes("\ncell = 42\n"));
}

static void test_deleted(void)
{
	CHECK(unlink(config) == 0);
	CHECK(fixture_logged(&fixture, "No such file or directory; the settings stay as they are"));
	CHECK(question_setting(fd, "\ncell = 42\n"));
	write_file(config, "cell = 43\n");
	CHECK(setting_comes("\ncell = 43\n"));
}

static void test_burst(void)
{
	const unsigned before = readings();
	char text[32];
	for (int i = 0; i < 200; i++) {
		snprintf(text, sizeof(text), "cell = %d\n", 10 + i % 40);
		write_file(config, text);
	}
	write_file(config, "cell = 60\n");
	CHECK(setting_comes("\ncell = 60\n"));
	CHECK(readings() - before < 20);
}

/*
 * Changes that do not end are read nevertheless. Where this test was not let run for a while the burst had an end: only
 * what is read later than that counts.
 */
static void test_endless_burst(void)
{
	const uint64_t end_ns = now_ns() + UINT64_C(40000000000);
	uint64_t last_ns = now_ns(), since_ns = last_ns, now = last_ns;
	unsigned before = readings();
	while (now < end_ns && now - since_ns < UINT64_C(4000000000)) {
		write_file(config, "cell = 59\n");
		sleep_ms(10);
		now = now_ns();
		if (now - last_ns > UINT64_C(80000000))
			since_ns = now;
		last_ns = now;
		if (now - since_ns < UINT64_C(500000000))
			before = readings();
		else if (readings() > before)
			return;
	}
	CHECK(now >= end_ns);
}

/* What cannot be made is told to who asked for the reading; what needs nothing new is taken. */
static void test_asked_for(void)
{
	write_file(config, "cell = 27\nsocket = /no-such-folder/x/socket\n");
	CHECK(raw_control(fd, "reload", -1, &reply) != 0);
	CHECK(strstr((const char *)reply.raw + sizeof(reply.control), "/no-such-folder") != NULL);
	CHECK(setting_comes("\ncell = 27\n"));
	write_file(config, "cell = 28\n");
	CHECK_INT(raw_control(fd, "reload", -1, &reply), 0);
	CHECK(setting_comes("\ncell = 28\n"));
}

/* A link that is switched to another file, and that file changed. */
static void test_link(void)
{
	write_file(target, "cell = 61\n");
	CHECK(symlink("folder/target", other) == 0 && rename(other, config) == 0);
	CHECK(setting_comes("\ncell = 61\n"));
	write_file(target, "cell = 62\n");
	CHECK(setting_comes("\ncell = 62\n"));
	CHECK(unlink(config) == 0);
	write_file(config, "cell = 63\n");
	CHECK(setting_comes("\ncell = 63\n"));
}

static unsigned watches(void)
{
	char command[128], line[256];
	unsigned count = 0;
	snprintf(command, sizeof(command), "cat /proc/%d/fdinfo/*", (int)fixture.pid);
	FILE *out = popen(command, "r");
	while (out && fgets(line, sizeof(line), out))
		count += strncmp(line, "inotify wd:", 11) == 0;
	if (out)
		pclose(out);
	return count;
}

/* The folders that a link led to before are not watched any more. */
static void test_many_links(void)
{
	char folder[160], text[32], path[200];
	for (int i = 0; i < 6; i++) {
		snprintf(folder, sizeof(folder), "%s/folder%d", fixture.folder, i);
		snprintf(path, sizeof(path), "%s/target", folder);
		snprintf(text, sizeof(text), "cell = %d\n", 20 + i);
		CHECK(mkdir(folder, 0700) == 0);
		write_file(path, text);
		CHECK(symlink(path, other) == 0 && rename(other, config) == 0);
		snprintf(text, sizeof(text), "\ncell = %d\n", 20 + i);
		CHECK(setting_comes(text));
	}
	CHECK_INT(watches(), 3); /* with the one that the fixture's folder is in */
	CHECK(unlink(config) == 0);
}

/* What was asked for stays through a reading, and the log says so. */
static void test_asked_stays(void)
{
	CHECK_INT(raw_control(fd, "set cell=50", -1, &reply), 0);
	write_file(config, "cell = 12\nblur = off\n");
	CHECK(setting_comes("\nblur = off\n"));
	CHECK(question_setting(fd, "\ncell = 50\n"));
	CHECK(fixture_logged(&fixture, "cell is 12 now in the configuration; it stays 50, as `pursuit set` asked for"));
	CHECK_INT(raw_control(fd, "unset cell", -1, &reply), 0);
	CHECK(question_setting(fd, "\ncell = 12\n"));
}

static void test_signal(void)
{
	const unsigned before = readings();
	kill(fixture.pid, SIGHUP);
	CHECK(fixture_logged(&fixture, "SIGHUP: settings read again"));
	CHECK(readings() > before);
}

static bool cell_becomes(int cell)
{
	char line[32];
	snprintf(line, sizeof(line), "\ncell = %d\n", cell);
	for (unsigned waited = 0; waited < PATIENCE_MS && !question_setting(fd, line); waited += 20)
		sleep_ms(20);
	return question_setting(fd, line);
}

/* A file that need not be there, and comes later. */
static void test_missing(void)
{
	char minus[160];
	const char *const wrong[] = {"--config", other, NULL}, *const right[] = {"--config", minus, NULL};
	snprintf(minus, sizeof(minus), "-%s", other);
	fixture_spawn(&fixture, wrong);
	CHECK_INT(fixture_join(&fixture), 2);
	fixture_start(&fixture, right);
	fd = raw_greet(fixture.socket);
	CHECK(question_setting(fd, "\ncell = 8\n"));
	write_file(other, "cell = 33\n");
	CHECK(cell_becomes(33));
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* Its folders taken away and made again, one by one; moved away and back; another put in their place. */
static void test_folders(void)
{
	char outer[128], inner[160], file[192], aside[160], aside_file[192], minus[200], away[160];
	const char *const arguments[] = {"--config", minus, NULL};
	snprintf(outer, sizeof(outer), "%s/outer", fixture.folder);
	snprintf(inner, sizeof(inner), "%s/inner", outer);
	snprintf(file, sizeof(file), "%s/file", inner);
	snprintf(aside, sizeof(aside), "%s/aside", fixture.folder);
	snprintf(aside_file, sizeof(aside_file), "%s/file", aside);
	snprintf(minus, sizeof(minus), "-%s", file);
	snprintf(away, sizeof(away), "%s/away", fixture.folder);
	CHECK(mkdir(outer, 0700) == 0 && mkdir(inner, 0700) == 0);
	write_file(file, "cell = 20\n");
	fixture_start(&fixture, arguments);
	fd = raw_greet(fixture.socket);
	CHECK(cell_becomes(20));

	CHECK(unlink(file) == 0 && rmdir(inner) == 0 && rmdir(outer) == 0);
	CHECK(cell_becomes(8));
	sleep_ms(400);
	CHECK(mkdir(outer, 0700) == 0);
	sleep_ms(400);
	CHECK(mkdir(inner, 0700) == 0);
	sleep_ms(400);
	write_file(file, "cell = 30\n");
	CHECK(cell_becomes(30));

	CHECK(rename(inner, aside) == 0);
	CHECK(cell_becomes(8));
	CHECK(rename(aside, inner) == 0);
	CHECK(cell_becomes(30));

	CHECK(mkdir(aside, 0700) == 0);
	write_file(aside_file, "cell = 31\n");
	CHECK(renameat2(AT_FDCWD, aside, AT_FDCWD, inner, RENAME_EXCHANGE) == 0);
	CHECK(cell_becomes(31));
	write_file(file, "cell = 32\n");
	CHECK(cell_becomes(32));

	CHECK(rename(outer, away) == 0); /* a folder above that of the file */
	CHECK(cell_becomes(8));
	CHECK(rename(away, outer) == 0);
	CHECK(cell_becomes(32));
	CHECK(mkdir(away, 0700) == 0);
	CHECK(renameat2(AT_FDCWD, away, AT_FDCWD, outer, RENAME_EXCHANGE) == 0);
	CHECK(cell_becomes(8));
	CHECK(mkdir(inner, 0700) == 0);
	write_file(file, "cell = 34\n");
	CHECK(cell_becomes(34));
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* Many files in one folder that lies deep leave room for another one's folders. */
static void test_many_files(void)
{
	char deep[160], names[7][192], outer[144], file[160], away[144];
	const char *arguments[17] = {NULL};
	int used = snprintf(deep, sizeof(deep), "%s", fixture.folder);
	for (unsigned i = 0; i < 9; i++) {
		used += snprintf(deep + used, sizeof(deep) - (size_t)used, "/%u", i);
		CHECK_INT(mkdir(deep, 0700), 0);
	}
	for (unsigned i = 0; i < 7; i++) {
		snprintf(names[i], sizeof(names[i]), "-%s/%u", deep, i);
		arguments[2 * i] = "--config";
		arguments[2 * i + 1] = names[i];
	}
	snprintf(outer, sizeof(outer), "%s/many", fixture.folder);
	snprintf(away, sizeof(away), "%s/elsewhere", fixture.folder);
	snprintf(file, sizeof(file), "-%s/many/inner/file", fixture.folder);
	arguments[14] = "--config";
	arguments[15] = file;
	CHECK_INT(mkdir(outer, 0700), 0);
	snprintf(deep, sizeof(deep), "%s/inner", outer);
	CHECK_INT(mkdir(deep, 0700), 0);
	write_file(file + 1, "cell = 35\n");
	fixture_start(&fixture, arguments);
	fd = raw_greet(fixture.socket);
	CHECK(cell_becomes(35));
	CHECK_INT(rename(outer, away), 0);
	CHECK(cell_becomes(8));
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

int main(int argc, char **argv)
{
	const char *const arguments[] = {"--config", config, NULL};
	char folder[128];
	if (argc < 2)
		return 2;
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, argv[1]);
	snprintf(config, sizeof(config), "%s/config", fixture.folder);
	snprintf(other, sizeof(other), "%s/other", fixture.folder);
	snprintf(folder, sizeof(folder), "%s/folder", fixture.folder);
	snprintf(target, sizeof(target), "%s/folder/target", fixture.folder);
	CHECK(mkdir(folder, 0700) == 0);
	write_file(config, "cell = 9\n");
	fixture_start(&fixture, arguments);
	fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	RUN(test_in_place);
	RUN(test_replaced);
	RUN(test_half_written);
	RUN(test_unknown_name);
	RUN(test_slow_writer);
	RUN(test_deleted);
	RUN(test_burst);
	RUN(test_endless_burst);
	RUN(test_asked_for);
	RUN(test_link);
	RUN(test_many_links);
	RUN(test_asked_stays);
	RUN(test_signal);
	CHECK_INT(question_figure(fd, "status", "lost_real_frames"), 0);
	CHECK_INT(question_figure(fd, "status", "refused_frames"), 0);
	raw_stream_finish(&stream);
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	RUN(test_missing);
	RUN(test_folders);
	RUN(test_many_files);
	fixture_finish(&fixture);
	return test_result();
}
