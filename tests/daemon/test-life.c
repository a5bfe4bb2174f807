/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Start and stop: command lines, signals, sockets left behind, systemd, recordings, requests. */

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "daemon/record/recording.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"

static const char *program;
static struct fixture fixture;

static bool exists(const char *path)
{
	return access(path, F_OK) == 0;
}

static int run_with(const char *a, const char *b)
{
	const char *const arguments[] = {a, b, NULL};
	fixture_spawn(&fixture, arguments);
	return fixture_join(&fixture);
}

static void test_usage(void)
{
	static const struct {
		const char *a, *b, *sentence;
	} wrong[] = {
		{"--methd", "x", "--methd: there is no such option; did you mean --method?"},
		{"--method", "magic", "method: \"magic\" is none of hold, "},
		{"--present", "hologram", "present: \"hologram\" is none of headless, glfw, kms"},
		{"--refresh", "5000", "refresh: 5000 is above 1000 Hz"},
		{"--cell", NULL, "--cell needs a value"},
		{"stray", NULL, "stray: there is no such option"},
		{"--config", "/nonexistent", "/nonexistent: No such file or directory"},
	};
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		CHECK_INT(run_with(wrong[i].a, wrong[i].b), 2);
		CHECK(fixture_logged(&fixture, wrong[i].sentence));
	}
	CHECK_INT(run_with("--help", NULL), 0);
	CHECK_INT(run_with("--version", NULL), 0);
	CHECK_INT(run_with("--print-config", NULL), 0);
}

static void test_signals(void)
{
	static const int signals[] = {SIGTERM, SIGINT};
	for (size_t i = 0; i < 2; i++) {
		fixture_start(&fixture, NULL);
		CHECK(exists(fixture.socket));
		kill(fixture.pid, SIGHUP);
		CHECK(fixture_logged(&fixture, "SIGHUP"));
		CHECK_INT(fixture_stop(&fixture, signals[i]), 0);
		CHECK(!exists(fixture.socket));
	}
}

/* A client at work when the daemon stops is told so. */
static void test_stop_with_clients(void)
{
	struct raw_reply reply;
	struct raw_stream stream;
	struct pursuit_feedback report;
	fixture_start(&fixture, NULL);
	const int fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	raw_fill(&stream);
	raw_publish(&stream);
	CHECK(raw_feedback(&stream, &report));
	CHECK_INT(report.state, PURSUIT_FEEDBACK_SHOWN);
	CHECK(report.submit_ns <= report.intake_ns && report.intake_ns <= report.ready_ns);
	CHECK(report.ready_ns < report.target_ns && report.target_ns <= report.flip_ns);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	CHECK(raw_receive(fd, &reply));
	CHECK_INT(reply.header.type, PURSUIT_MESSAGE_REFUSED);
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_SHUTDOWN);
	CHECK(raw_is_gone(fd));
	raw_stream_finish(&stream);
	close(fd);
}

static void test_sockets_left_behind(void)
{
	struct fixture second = fixture;
	fixture_start(&fixture, NULL);
	fixture_spawn(&second, NULL);
	CHECK_INT(fixture_join(&second), 1);
	CHECK(fixture_logged(&fixture, "another pursuitd serves"));
	CHECK_INT(fixture_stop(&fixture, SIGKILL), 128 + SIGKILL);
	CHECK(exists(fixture.socket));
	fixture_start(&fixture, NULL); /* nobody answers there: replaced */
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	const int file = open(fixture.socket, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
	close(file);
	CHECK_INT(run_with(NULL, NULL), 1);
	CHECK(fixture_logged(&fixture, "is there and is no socket"));
	unlink(fixture.socket);
}

static void test_default_path(void)
{
	char path[128], folder[80];
	struct stat status;
	struct fixture other = fixture;
	snprintf(folder, sizeof(folder), "%s/pursuit", fixture.folder);
	snprintf(path, sizeof(path), "%s/socket", folder);
	unsetenv("PURSUIT_SOCKET");
	setenv("XDG_RUNTIME_DIR", fixture.folder, 1);
	snprintf(other.socket, sizeof(other.socket), "%s", ""); /* --socket "" is the default */
	fixture_spawn(&other, NULL);
	snprintf(other.socket, sizeof(other.socket), "%.80s/socket", folder);
	CHECK(fixture_wait(&other));
	CHECK(stat(folder, &status) == 0 && (status.st_mode & 0777) == 0700);
	CHECK_INT(fixture_stop(&other, SIGTERM), 0);
	CHECK(!exists(path));
	setenv("XDG_RUNTIME_DIR", "/nonexistent", 1);
	other.socket[0] = 0;
	fixture_spawn(&other, NULL);
	CHECK_INT(fixture_join(&other), 1);
	CHECK(fixture_logged(&fixture, "cannot make the folder /nonexistent/pursuit"));
	unsetenv("XDG_RUNTIME_DIR");
}

/* As systemd does it: a listening socket as fd 3, and a place to report to. */
static void test_systemd(void)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	char path[96], state[64] = "";
	struct fixture activated = fixture;
	const int listening = socket(AF_UNIX, SOCK_SEQPACKET, 0), notified = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", fixture.socket);
	CHECK_INT(bind(listening, (struct sockaddr *)&address, sizeof(address)), 0);
	CHECK_INT(listen(listening, 5), 0);
	snprintf(path, sizeof(path), "%s/notify", fixture.folder);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", path);
	CHECK_INT(bind(notified, (struct sockaddr *)&address, sizeof(address)), 0);
	activated.pid = fork();
	if (activated.pid == 0) {
		char pid[16];
		snprintf(pid, sizeof(pid), "%d", (int)getpid());
		setenv("LISTEN_PID", pid, 1);
		setenv("LISTEN_FDS", "1", 1);
		setenv("NOTIFY_SOCKET", path, 1);
		if (listening != 3)
			dup2(listening, 3);
		dup2(open(fixture.log, O_WRONLY | O_CREAT | O_APPEND, 0600), STDERR_FILENO);
		execl(program, program, "--method", "hold", (char *)NULL);
		_exit(127);
	}
	close(listening);
	CHECK(recv(notified, state, sizeof(state) - 1, 0) > 0);
	CHECK_STRING(state, "READY=1");
	const int fd = raw_greet(fixture.socket);
	CHECK(fd >= 0);
	close(fd);
	CHECK_INT(fixture_stop(&activated, SIGTERM), 0);
	CHECK(exists(fixture.socket)); /* systemd's, not ours to remove */
	unlink(fixture.socket);
	close(notified);
}

/* ---- requests ---- */

static void play(struct raw_stream *stream, int frames)
{
	for (int i = 0; i < frames; i++) {
		struct pursuit_feedback report;
		raw_fill(stream);
		raw_publish(stream);
		CHECK(raw_feedback(stream, &report));
	}
}

static json_t *ask(int fd, const char *text)
{
	struct raw_reply reply;
	CHECK_INT(raw_control(fd, text, -1, &reply), 0);
	json_t *object = json_loads((const char *)reply.raw + sizeof(reply.control), 0, NULL);
	CHECK(json_is_object(object));
	return object;
}

static void check_requests(int fd)
{
	struct raw_reply reply;
	const char *text = (const char *)reply.raw + sizeof(reply.control);
	json_t *status = ask(fd, "status");
	CHECK(json_integer_value(json_object_get(status, "real_frames")) >= 4);
	CHECK_INT(json_array_size(json_object_get(status, "streams")), 1);
	CHECK_STRING(json_string_value(json_object_get(json_array_get(json_object_get(status, "streams"), 0), "client")),
				 "raw");
	CHECK_STRING(json_string_value(json_object_get(status, "presenter")), "headless");
	json_decref(status);
	json_t *timeline = ask(fd, "timeline 0 100");
	CHECK(json_array_size(json_object_get(timeline, "rows")) > 3);
	CHECK_INT(json_array_size(json_array_get(json_object_get(timeline, "rows"), 0)), 7);
	json_decref(timeline);
	CHECK_INT(raw_control(fd, "settings", -1, &reply), 0);
	CHECK(strstr(text, "method = hold\n") != NULL);
	CHECK_INT(raw_control(fd, "explode", -1, &reply), EINVAL);
	CHECK(strstr(text, "\"explode\" is no request") != NULL);
	CHECK_INT(raw_control(fd, "", -1, &reply), EINVAL);
	CHECK_INT(raw_control(fd, "record", -1, &reply), EINVAL);
	CHECK_INT(raw_control(fd, "record-stop", -1, &reply), EINVAL);
	int ends[2];
	CHECK_INT(pipe2(ends, O_CLOEXEC), 0);
	CHECK_INT(raw_control(fd, "record", ends[1], &reply), EINVAL);
	CHECK(strstr(text, "no regular file") != NULL);
	close(ends[0]);
	close(ends[1]);
}

static uint64_t frames_in(const char *path)
{
	const struct recording_reader_params params = {.path = path};
	struct error error = {""};
	struct recording_reader *reader = recording_reader_create(&params, &error);
	if (!reader) {
		fprintf(stderr, "%s\n", error.text);
		return 0;
	}
	const uint64_t count = recording_reader_frame_count(reader);
	CHECK(recording_reader_summary(reader)->closed);
	recording_reader_destroy(&reader);
	return count;
}

static void check_recording(int fd, struct raw_stream *stream)
{
	struct raw_reply reply;
	char path[96];
	snprintf(path, sizeof(path), "%s/asked.pursuit", fixture.folder);
	const int file = open(path, O_CREAT | O_RDWR | O_CLOEXEC, 0600);
	CHECK_INT(raw_control(fd, "record", file, &reply), 0);
	CHECK_INT(raw_control(fd, "record", file, &reply), EBUSY);
	close(file);
	play(stream, 5);
	json_t *result = ask(fd, "record-stop");
	CHECK_INT(json_integer_value(json_object_get(result, "frames")), 5);
	CHECK_STRING(json_string_value(json_object_get(result, "error")), "");
	json_decref(result);
	CHECK_INT(frames_in(path), 5);
}

static void test_requests(void)
{
	struct raw_reply reply;
	struct raw_stream stream;
	char stats[96], record[96];
	snprintf(stats, sizeof(stats), "%s/stats.json", fixture.folder);
	snprintf(record, sizeof(record), "%s/all.pursuit", fixture.folder);
	const char *const first[] = {"--stats", stats, NULL}, *const second[] = {"--record", record, NULL};
	fixture_start(&fixture, first);
	const int fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	play(&stream, 5);
	check_requests(fd);
	check_recording(fd, &stream);
	raw_stream_finish(&stream);
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGINT), 0);
	json_t *object = json_load_file(stats, 0, NULL);
	CHECK(json_integer_value(json_object_get(object, "real_frames")) >= 9);
	json_decref(object);

	fixture_start(&fixture, second);
	const int again = raw_greet(fixture.socket);
	raw_stream_init(&stream, again, 1);
	CHECK(raw_stream_open(&stream, &reply));
	play(&stream, 7);
	raw_stream_finish(&stream);
	close(again);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	CHECK_INT(frames_in(record), 7);
	CHECK_INT(run_with("--record", "/nonexistent/x.pursuit"), 1);
	CHECK(fixture_logged(&fixture, "/nonexistent/x.pursuit"));
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	program = argv[1];
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, program);
	RUN(test_usage);
	RUN(test_signals);
	RUN(test_stop_with_clients);
	RUN(test_sockets_left_behind);
	RUN(test_default_path);
	RUN(test_systemd);
	RUN(test_requests);
	fixture_finish(&fixture);
	return test_result();
}
