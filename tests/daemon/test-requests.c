/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* CONTROL requests of a daemon with a lab: each has an answer of its form, whatever its arguments are. */

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"

static struct fixture fixture;
static struct raw_reply reply;
static int fd;

static const char *answer(void)
{
	return (const char *)reply.raw + sizeof(reply.control);
}

/* The answer has this member, and is not longer than a packet. */
static void check_json(const char *request, const char *member)
{
	CHECK_INT(raw_control(fd, request, -1, &reply), 0);
	json_t *object = json_loads(answer(), 0, NULL);
	CHECK(json_object_get(object, member) != NULL);
	json_decref(object);
}

static void play(void)
{
	struct raw_stream stream;
	struct pursuit_feedback report;
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	for (int i = 0; i < 4; i++) {
		raw_fill(&stream);
		raw_publish(&stream);
		CHECK(raw_feedback(&stream, &report));
	}
	raw_stream_finish(&stream);
}

static void test_figures(void)
{
	static const char *const arguments[] = {"",       " 0",       " 1 2", " x", " x y", " 0 0", " 99999999999999999999",
											" -1 -1", " 0 100000"};
	char request[64];
	for (size_t i = 0; i < sizeof(arguments) / sizeof(arguments[0]); i++) {
		snprintf(request, sizeof(request), "latency%s", arguments[i]);
		check_json(request, "rows");
		snprintf(request, sizeof(request), "timeline%s", arguments[i]);
		check_json(request, "rows");
	}
	check_json("status", "lab");
}

static void test_recordings(void)
{
	char path[96];
	snprintf(path, sizeof(path), "%s/recorded", fixture.folder);
	const int file = open(path, O_CREAT | O_RDWR | O_CLOEXEC, 0600), null = open("/dev/null", O_WRONLY | O_CLOEXEC);
	const int read_only = open(path, O_RDONLY | O_CLOEXEC);
	CHECK_INT(raw_control(fd, "record-stop", -1, &reply), EINVAL);
	CHECK_INT(raw_control(fd, "record", -1, &reply), EINVAL);
	CHECK_INT(raw_control(fd, "record", null, &reply), EINVAL);
	CHECK_INT(raw_control(fd, "record", read_only, &reply), EINVAL);
	CHECK_INT(raw_control(fd, "record", file, &reply), 0);
	CHECK_INT(raw_control(fd, "record", file, &reply), EBUSY);
	check_json("status", "recording");
	check_json("record-stop", "frames");
	close(file);
	close(null);
	close(read_only);
}

static void test_others(void)
{
	static const char *const wrong[] = {"", "statu", "statuses", "set", "set cell", "key", "key nothing", "reloaded"};
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		CHECK_INT(raw_control(fd, wrong[i], -1, &reply), EINVAL);
	CHECK_INT(raw_control(fd, "ping", -1, &reply), 0);
	CHECK_STRING(answer(), "pong");
	CHECK_INT(raw_control(fd, "settings", -1, &reply), 0);
	CHECK(strstr(answer(), "cell = 8\n") != NULL);
	CHECK_INT(raw_control(fd, "key h", -1, &reply), 0);
}

int main(int argc, char **argv)
{
	const char *const arguments[] = {"--latency", "--lab-priority", "0", NULL};
	if (argc < 2)
		return 2;
	fixture_init(&fixture, argv[1]);
	fixture_start(&fixture, arguments);
	fd = raw_greet(fixture.socket);
	CHECK(fd >= 0);
	play();
	RUN(test_figures);
	RUN(test_recordings);
	RUN(test_others);
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	fixture_finish(&fixture);
	return test_result();
}
