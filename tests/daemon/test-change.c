/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Settings that need something new (a presenter, an engine, a file, a socket) change while a client plays: each frame
 * is shown and accounted for, once and in order; what cannot be made is refused with a sentence, and all goes on as
 * before.
 */

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/options.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"

#define QUICK 100

static struct fixture fixture;
static struct raw_reply reply;
static struct raw_stream stream;
static int fd;
static uint64_t published, reported;

static const char *answer(void)
{
	return (const char *)reply.raw + sizeof(reply.control);
}

static void must_set(const char *change)
{
	char request[1024];
	snprintf(request, sizeof(request), "set %s", change);
	const int result = raw_control(fd, request, -1, &reply);
	if (result != 0)
		fprintf(stderr, "%s: %s\n", request, answer());
	CHECK_INT(result, 0);
}

static json_int_t figure(const char *name)
{
	CHECK_INT(raw_control(fd, "status", -1, &reply), 0);
	json_t *all = json_loads(answer(), 0, NULL);
	const json_int_t value = json_integer_value(json_object_get(all, name));
	json_decref(all);
	return value;
}

static const char *path_of(const char *name)
{
	static char paths[4][160];
	static unsigned next;
	char *path = paths[next++ % 4];
	snprintf(path, sizeof(paths[0]), "%s/%s", fixture.folder, name);
	return path;
}

static void publish(void)
{
	raw_fill(&stream);
	float *motion = raw_motion(&stream);
	for (uint32_t i = 0; i < RAW_WIDTH * RAW_HEIGHT; i++)
		motion[2 * i] = i % RAW_WIDTH > RAW_WIDTH / 2 ? 6.0f : 0.0f;
	raw_publish(&stream);
	published++;
}

/* Each frame up to there has been shown: one report each, in their order. */
static void check_reports_of(uint64_t frames)
{
	struct pursuit_feedback report;
	while (reported < frames && raw_feedback(&stream, &report)) {
		CHECK_INT(report.frame_id, stream.next_id - (published - reported));
		CHECK_INT(report.state, PURSUIT_FEEDBACK_SHOWN);
		reported++;
	}
	CHECK_INT(reported, frames);
}

static void check_reports(void)
{
	check_reports_of(published);
}

static void check_account(void)
{
	check_reports();
	CHECK_INT(figure("real_frames"), published);
	CHECK_INT(figure("lost_real_frames"), 0);
	CHECK_INT(figure("refused_frames"), 0);
}

/* A frame is on its way while it changes; another one follows once that has been shown, or it might take its place. */
static void change_between_frames(const char *change)
{
	publish();
	must_set(change);
	check_reports();
	publish();
	check_reports();
}

static void test_presenter_quickly(void)
{
	static const char *const rates[] = {"refresh=60", "refresh=240", "refresh=119.88", "refresh=120"};
	for (int i = 0; i < QUICK; i++) {
		publish();
		must_set(rates[i % 4]);
		check_reports_of(published - 1);
	}
	check_account();
	CHECK(fixture_logged(&fixture, "refresh is 240 now, was 60"));
}

static void test_each(void)
{
	static const char *const changes[] = {
		"threads=2",
		"context=cpu threads=1",
		"latency=yes",
		"lab-priority=0",
		"patch=alternate",
		"patch=sequence patch-corner=top-right patch-size=8",
		"gpio-pattern=pulse gpio-pulse-us=200",
		"photon-least-us=100 photon-most-us=9000",
		"strobe-phase=0.2 strobe-duty=0.2",
		"debounce-us=10 vsync-offset-us=-5 vsync-edge=falling",
		"patch=off latency=no",
		"monitor=1 fullscreen=yes window-size=640x480",
		"connector=DP-9 mode=640x480@60 kms-device=/dev/dri/card9",
		"present=headless,headless",
		"on-client-exit=black",
		"on-client-exit=keep refresh=100 threads=2 latency=yes method=pursuit",
	};
	for (size_t i = 0; i < sizeof(changes) / sizeof(changes[0]); i++)
		change_between_frames(changes[i]);
	check_account();
}

static void test_engine(void)
{
	publish();
	if (raw_control(fd, "set context=egl", -1, &reply) != 0) {
		printf("no EGL: %s\n", answer());
		check_reports();
		return;
	}
	check_reports();
	publish();
	CHECK(fixture_logged(&fixture, "context is egl now, was cpu"));
	check_reports();
	change_between_frames("context=cpu");
	check_account();
	CHECK_INT(figure("engine_losses"), 0);
}

/* ---- files ---- */

static const char *read_log(void)
{
	static char content[1 << 20];
	FILE *log = fopen(fixture.log, "r");
	const size_t length = fread(content, 1, sizeof(content) - 1, log);
	fclose(log);
	content[length] = 0;
	return content;
}

static uint64_t sum_logged(const char *before)
{
	uint64_t sum = 0;
	for (const char *at = read_log(); (at = strstr(at, before)) != NULL;) {
		at += strlen(before);
		sum += strtoull(at, NULL, 10);
	}
	return sum;
}

static unsigned count_logged(const char *text)
{
	unsigned count = 0;
	for (const char *at = read_log(); (at = strstr(at, text)) != NULL; at++)
		count++;
	return count;
}

static void wait_for_count(const char *text, unsigned count)
{
	for (unsigned waited = 0; waited < PATIENCE_MS && count_logged(text) < count; waited += 10)
		sleep_ms(10);
	CHECK_INT(count_logged(text), count);
}

/* From one file to the next: each frame is in exactly one of them. */
static void test_recordings(void)
{
	char change[256];
	const uint64_t before = published;
	for (int i = 0; i < 10; i++) {
		snprintf(change, sizeof(change), "record=%s.%d", path_of("recording"), i);
		must_set(change);
		publish();
		check_reports();
	}
	must_set("record=");
	publish();
	check_account();
	wait_for_count("recording ended: ", 10);
	CHECK_INT(sum_logged("recording ended: "), published - before - 1);
}

/* One that a client ends: nothing is asked for any more, so the same file may be asked for again. */
static void test_recording_that_is_stopped(void)
{
	const unsigned ended = count_logged("recording ended: ");
	const uint64_t frames = sum_logged("recording ended: ");
	char change[256], line[300];
	snprintf(change, sizeof(change), "record=%s", path_of("again"));
	for (unsigned i = 1; i <= 2; i++) {
		must_set(change);
		publish();
		check_reports();
		CHECK_INT(raw_control(fd, "record-stop", -1, &reply), 0);
		CHECK(strstr(answer(), "\"frames\":1,") != NULL);
		snprintf(line, sizeof(line), "record is empty now, was %s", path_of("again"));
		wait_for_count(line, i);
	}
	CHECK_INT(raw_control(fd, "record-stop", -1, &reply), EINVAL);
	CHECK_INT(count_logged("recording ended: "), ended + 2);
	CHECK_INT(sum_logged("recording ended: "), frames + 2);
	CHECK_INT(access(path_of("again.1"), F_OK), 0);
	CHECK_INT(raw_control(fd, "unset record", -1, &reply), 0);
	check_account();
}

/* How often this flip is in the times of the files. */
static unsigned count_flip(const char *name, int files, uint64_t flip_ns)
{
	unsigned count = 0;
	char needle[64], line[256], path[256];
	snprintf(needle, sizeof(needle), ",%llu,", (unsigned long long)flip_ns);
	for (int i = 0; i < files; i++) {
		snprintf(path, sizeof(path), "%s.%d.y4m.csv", path_of(name), i);
		FILE *file = fopen(path, "r");
		CHECK(file != NULL);
		while (file && fgets(line, sizeof(line), file))
			count += strstr(line, needle) != NULL;
		if (file)
			fclose(file);
	}
	return count;
}

/* The same with what is shown: the first showing of each frame is in exactly one file. */
static void test_tees(void)
{
	enum { FILES = 6, EACH = 3 };
	struct pursuit_feedback reports[FILES * EACH];
	char change[256];
	for (int i = 0; i < FILES; i++) {
		snprintf(change, sizeof(change), "tee=%s.%d.y4m", path_of("tee"), i);
		must_set(change);
		for (int j = 0; j < EACH; j++) {
			publish();
			CHECK(raw_feedback(&stream, &reports[i * EACH + j]));
			reported++;
		}
	}
	must_set("tee=");
	check_account();
	wait_for_count("tee: ", FILES);
	CHECK_INT(count_logged(" 0 dropped, 0 pictures of another size"), FILES);
	for (int i = 0; i < FILES * EACH; i++)
		CHECK_INT(count_flip("tee", FILES, reports[i].flip_ns), 1);
}

/* What was on its way when a tee came is not missed by it, however soon it goes again. */
static void test_tees_that_go_at_once(void)
{
	char change[256];
	for (int i = 0; i < 30; i++) {
		publish();
		snprintf(change, sizeof(change), "tee=%s.%d.y4m", path_of("short"), i);
		must_set(change);
		must_set("tee=");
		check_reports();
	}
	wait_for_count("pictures of another size", 6 + 30);
	CHECK_INT(count_logged("does not keep up"), 0);
	check_account();
}

static void test_latency_logs(void)
{
	char change[256];
	for (int i = 0; i < 4; i++) {
		snprintf(change, sizeof(change), "latency-log=%s.%d.%s", path_of("latency"), i, i % 2 ? "bin" : "csv");
		change_between_frames(change);
	}
	must_set("latency-log=");
	check_account();
	for (int i = 0; i < 4; i++) {
		struct stat status = {.st_size = 0};
		char path[256];
		snprintf(path, sizeof(path), "%s.%d.%s", path_of("latency"), i, i % 2 ? "bin" : "csv");
		for (unsigned waited = 0; waited < PATIENCE_MS && (stat(path, &status) < 0 || status.st_size == 0);
			 waited += 10)
			sleep_ms(10);
		CHECK(status.st_size > 0);
	}
}

static void test_stats(void)
{
	char change[256];
	snprintf(change, sizeof(change), "stats=%s", path_of("stats.json"));
	change_between_frames(change);
	CHECK(access(path_of("stats.json"), F_OK) != 0); /* at the end */
}

/* ---- the socket ---- */

static void test_socket(void)
{
	char change[256];
	for (int i = 0; i < 5; i++) {
		const char *name = i % 2 ? "socket" : "other";
		snprintf(change, sizeof(change), "socket=%s", path_of(name));
		change_between_frames(change);
		const int second = raw_greet(path_of(name));
		CHECK(second >= 0);
		close(second);
		CHECK(raw_greet(path_of(i % 2 ? "other" : "socket")) < 0);
		CHECK(access(path_of(i % 2 ? "other" : "socket"), F_OK) != 0);
	}
	snprintf(change, sizeof(change), "socket=%s", fixture.socket);
	must_set(change);
	check_account();
}

/* Who has connected to the old path before is let in. */
static void test_socket_lets_in(void)
{
	char change[256];
	kill(fixture.pid, SIGSTOP);
	const int early = raw_connect(fixture.socket);
	CHECK(early >= 0);
	const struct pursuit_message_hello hello = raw_hello();
	CHECK_INT(raw_send(early, &hello, sizeof(hello), NULL, 0), 0);
	kill(fixture.pid, SIGCONT);
	snprintf(change, sizeof(change), "socket=%s", path_of("third"));
	must_set(change);
	CHECK(raw_receive(early, &reply));
	CHECK_INT(reply.header.type, PURSUIT_MESSAGE_WELCOME);
	close(early);
	snprintf(change, sizeof(change), "socket=%s", fixture.socket);
	must_set(change);
}

/* ---- refusals ---- */

static void check_refused(const char *change, const char *sentence)
{
	char request[512];
	char *before, *after;
	publish();
	CHECK_INT(raw_control(fd, "settings", -1, &reply), 0);
	before = strdup(answer());
	snprintf(request, sizeof(request), "set %s", change);
	CHECK(raw_control(fd, request, -1, &reply) != 0);
	if (!strstr(answer(), sentence))
		CHECK_STRING(answer(), sentence);
	CHECK_INT(raw_control(fd, "settings", -1, &reply), 0);
	after = strdup(answer());
	CHECK_STRING(after, before);
	free(before);
	free(after);
	check_reports();
	publish();
	check_reports();
}

static void test_refusals(void)
{
	static const struct {
		const char *change, *sentence;
	} wrong[] = {
		{"tee=/no-such-folder/video.y4m", "/no-such-folder/video.y4m"},
		{"tee=/no-such-folder/%06d.png", "/no-such-folder"},
		{"tee=shown.mp4", "tee: 'shown.mp4': must end in .y4m"},
		{"record=/no-such-folder/recording", "/no-such-folder/recording"},
		{"stats=/no-such-folder/stats", "stats: /no-such-folder/stats: No such file"},
		{"latency-log=/no-such-folder/log.csv", "/no-such-folder/log.csv"},
		{"latency-log=log.txt", "log.txt"},
		{"gpio-line=A,B", "gpio-line"},
		{"gpio-chip=no-such-chip gpio-line=1", "no-such-chip"},
		{"gpio-chip=no-such-chip photodiode-line=1", "no-such-chip"},
		{"gpio-chip=no-such-chip vsync-line=1", "no-such-chip"},
		{"gpio-chip=no-such-chip strobe-line=1", "no-such-chip"},
		{"strobe-duty=0.5", "strobe-duty: 0.5 is above the strobe-limit"},
		{"socket=/no-such-folder/x/socket", "/no-such-folder"},
		{"context=egl-device:200", "200"},
		{"refresh=60 threads=2 latency=yes tee=/no-such-folder/video.y4m", "/no-such-folder"},
		{"latency=yes context=egl-device:200", "200"},
	};
	must_set("refresh=120 threads=1 latency=no strobe-duty=0.1");
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		check_refused(wrong[i].change, wrong[i].sentence);
	char change[256];
	snprintf(change, sizeof(change), "socket=%s record=/no-such-folder/r", path_of("never"));
	check_refused(change, "/no-such-folder/r");
	CHECK(access(path_of("never"), F_OK) != 0);
	check_account();
}

static bool is_there(const char *name)
{
	return access(path_of(name), F_OK) == 0;
}

/* What was there before is as it was, and nothing new is there, whichever of them it was that could not be made. */
static void test_files_of_refusals(void)
{
	static const char *const names[] = {"old.rec", "old.csv", "old.y4m", "old.y4m.csv"};
	static const char *const made[] = {"new.rec", "new.csv", "new.y4m.csv", "old.rec.1", "old.csv.1", "old.y4m.1"};
	static const char *const wrong[] = {"context=egl-device:200", "tee=/no-such-folder/x.y4m"};
	char change[512];
	for (size_t i = 0; i < 4; i++) {
		FILE *file = fopen(path_of(names[i]), "we");
		CHECK(file && fputs(names[i], file) >= 0 && fclose(file) == 0);
	}
	for (int i = 0; i < 4; i++) {
		const char *age = i / 2 ? "old" : "new";
		snprintf(change, sizeof(change), "record=%s/%s.rec latency-log=%s/%s.csv tee=%s/%s.y4m %s", fixture.folder, age,
				 fixture.folder, age, fixture.folder, age, wrong[i % 2]);
		check_refused(change, i % 2 ? "no-such-folder" : "200");
	}
	for (size_t i = 0; i < sizeof(made) / sizeof(made[0]); i++)
		CHECK(!is_there(made[i]));
	for (size_t i = 0; i < 4; i++) {
		char found[64] = "";
		FILE *file = fopen(path_of(names[i]), "re");
		CHECK(file && fgets(found, sizeof(found), file) && fclose(file) == 0);
		CHECK_STRING(found, names[i]);
		unlink(path_of(names[i]));
	}
	check_account();
}

/* Pipes that nobody reads: whoever opened one would wait. */
static void test_pipes(void)
{
	static const char *const pipes[][2] = {
		{"record", "pipe"}, {"latency-log", "pipe.csv"}, {"stats", "pipe"}, {"tee", "pipe"}, {"tee", "%d.png"}};
	static const char *const names[] = {"pipe", "pipe.csv", "times.csv"};
	char change[256];
	for (size_t i = 0; i < 3; i++)
		CHECK_INT(mkfifo(path_of(names[i]), 0600), 0);
	for (size_t i = 0; i < sizeof(pipes) / sizeof(pipes[0]); i++) {
		snprintf(change, sizeof(change), "%s=%s", pipes[i][0], path_of(pipes[i][1]));
		check_refused(change, "nobody reads the pipe");
	}
	const int reader = open(path_of("pipe"), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	snprintf(change, sizeof(change), "record=%s", path_of("pipe"));
	check_refused(change, "must be a regular file");
	check_refused("record=/dev/null", "must be a regular file");
	close(reader);
	for (size_t i = 0; i < 3; i++)
		unlink(path_of(names[i]));
	check_account();
}

/* There is no window system, and nothing of the one in use is touched. */
static void test_no_such_presenter(void)
{
	for (int i = 0; i < 3; i++)
		check_refused("present=glfw", "glfw");
	CHECK_INT(raw_control(fd, "set present=glfw,headless", -1, &reply), 0);
	must_set("present=headless");
	check_account();
}

/* ---- what stays of a client that has gone ---- */

static bool has_picture(const char *path)
{
	static uint8_t data[1 << 16];
	FILE *file = fopen(path, "r");
	const size_t length = file ? fread(data, 1, sizeof(data), file) : 0;
	if (file)
		fclose(file);
	for (size_t i = 200; i < length; i++) /* after the header */
		if (data[i] != 16 && data[i] != 128 && data[i] != data[199])
			return true;
	return false;
}

static void test_kept_picture(const char *change, const char *name)
{
	char request[256];
	snprintf(request, sizeof(request), "tee=%s %s", path_of(name), change);
	must_set(request);
	question_wait_for_rest(fd);
	must_set("tee=");
	for (unsigned waited = 0; waited < PATIENCE_MS && !has_picture(path_of(name)); waited += 10)
		sleep_ms(10);
	CHECK(has_picture(path_of(name)));
}

static void leave(void)
{
	const struct pursuit_message_close_stream message = {
		.header = {.type = PURSUIT_MESSAGE_CLOSE_STREAM, .size = sizeof(message)}, .stream_id = 1};
	check_reports();
	CHECK_INT(raw_send(fd, &message, sizeof(message), NULL, 0), 0);
	CHECK(raw_receive(fd, &reply));
	raw_stream_finish(&stream);
}

/* ---- the kernel's filter ---- */

static void test_seccomp(void)
{
	must_set("seccomp=yes");
	CHECK(raw_control(fd, "set seccomp=no", -1, &reply) != 0);
	CHECK(strstr(answer(), "never takes such a filter back") != NULL);
	char request[256];
	snprintf(request, sizeof(request), "set socket=%s", path_of("filtered"));
	CHECK(raw_control(fd, request, -1, &reply) != 0);
	CHECK(strstr(answer(), "Operation not permitted") != NULL);
	must_set("refresh=60");
	must_set("latency=yes");
}

int main(int argc, char **argv)
{
	static const char *const arguments[] = {"--method", "grid", "--context", "cpu", "--threads", "1", NULL};
	if (argc < 2)
		return 2;
	unsetenv("DISPLAY");
	unsetenv("WAYLAND_DISPLAY");
	fixture_init(&fixture, argv[1]);
	fixture_start(&fixture, arguments);
	fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	RUN(test_presenter_quickly);
	RUN(test_each);
	RUN(test_engine);
	RUN(test_recordings);
	RUN(test_recording_that_is_stopped);
	RUN(test_tees);
	RUN(test_tees_that_go_at_once);
	RUN(test_latency_logs);
	RUN(test_stats);
	RUN(test_socket);
	RUN(test_socket_lets_in);
	RUN(test_refusals);
	RUN(test_files_of_refusals);
	RUN(test_pipes);
	RUN(test_no_such_presenter);
	leave();
	test_kept_picture("refresh=60", "kept-presenter.y4m");
	test_kept_picture("threads=2", "kept-engine.y4m");
	test_kept_picture("refresh=120 threads=1", "kept-both.y4m");
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	CHECK(access(path_of("stats.json"), F_OK) == 0);
	setenv("ASAN_OPTIONS", "detect_leaks=0", 1); /* which wants a process of its own */
	fixture_start(&fixture, arguments);
	fd = raw_greet(fixture.socket);
	RUN(test_seccomp);
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	fixture_finish(&fixture);
	return test_result();
}
