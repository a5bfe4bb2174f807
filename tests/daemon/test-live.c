/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Settings that change while frames come: which may, what is refused, what is seen of it, and that no frame is lost. */

#include <errno.h>
#include <jansson.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "daemon/live.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"

static struct fixture fixture;
static struct raw_reply reply;
static int fd;

static const char *answer(void)
{
	return (const char *)reply.raw + sizeof(reply.control);
}

static void play_one(struct raw_stream *stream)
{
	struct pursuit_feedback report;
	float *motion;
	raw_fill(stream);
	motion = raw_motion(stream);
	for (uint32_t i = 0; i < RAW_WIDTH * RAW_HEIGHT; i++)
		motion[2 * i] = i % RAW_WIDTH > RAW_WIDTH / 2 ? 6.0f : 0.0f;
	raw_publish(stream);
	CHECK(raw_feedback(stream, &report));
	CHECK_INT(report.state, PURSUIT_FEEDBACK_SHOWN);
}

/* Each is taken, seen in settings and status, and the frames around it are all shown. */
static void test_each_setting_of_the_picture(struct raw_stream *stream)
{
	static const char *const changes[][2] = {
		{"method", "grid"},
		{"blur", "everywhere"},
		{"compensation", "no"},
		{"cell", "16"},
		{"blur-level", "3"},
		{"snap-threshold", "1.25"},
		{"method", "pursuit"},
		{"display-width-mm", "700"},
		{"motion-model", "quadratic"},
		{"gamma", "2.2"},
		{"viewing-distance-mm", "555.5"},
		{"governor", "off"},
		{"method", "interpolate"},
		{"level", "3"},
		{"level", "0"},
		{"method", "scatter"},
		{"governor", "auto"},
		{"method", "mcif"},
	};
	for (size_t i = 0; i < sizeof(changes) / sizeof(changes[0]); i++) {
		char request[96], line[96];
		play_one(stream);
		snprintf(request, sizeof(request), "set %s=%s", changes[i][0], changes[i][1]);
		snprintf(line, sizeof(line), "%s = %s\n", changes[i][0], changes[i][1]);
		CHECK_INT(raw_control(fd, request, -1, &reply), 0);
		CHECK(question_setting(fd, line));
		json_t *all = question_ask(fd, "status");
		const json_t *seen = json_object_get(json_object_get(all, "settings"), changes[i][0]);
		CHECK(seen && strcmp(json_string_value(seen), changes[i][1]) == 0);
		json_decref(all);
		play_one(stream);
	}
	CHECK_INT(question_figure(fd, "status", "refused_frames"), 0);
	CHECK_INT(question_figure(fd, "status", "engine_losses"), 0);
}

/* The next real frame is made with it: another method has other passes. */
static void test_next_frame_obeys(struct raw_stream *stream)
{
	CHECK_INT(raw_control(fd, "set governor=off level=0 method=hold", -1, &reply), 0);
	play_one(stream);
	play_one(stream); /* the report of a frame is counted when the next begins */
	const json_int_t before = question_figure(fd, "status", "passes.analyse");
	play_one(stream);
	CHECK_INT(question_figure(fd, "status", "passes.analyse"), before);
	CHECK_INT(raw_control(fd, "set method=grid", -1, &reply), 0);
	play_one(stream);
	play_one(stream);
	CHECK(question_figure(fd, "status", "passes.analyse") > before);
}

static void test_level_of_the_governor(struct raw_stream *stream)
{
	CHECK_INT(raw_control(fd, "set governor=off level=4", -1, &reply), 0);
	play_one(stream);
	CHECK_INT(question_figure(fd, "status", "governor.level"), 4);
	CHECK_INT(raw_control(fd, "set level=1", -1, &reply), 0);
	play_one(stream);
	CHECK_INT(question_figure(fd, "status", "governor.level"), 1);
}

static void test_refusals(void)
{
	static const struct {
		const char *request, *sentence;
	} wrong[] = {
		{"set", "NAME=VALUE"},
		{"set blur", "\"blur\" is not of the form NAME=VALUE"},
		{"set cell=3", "cell: 3 is below 4 px; it may be 4 to 64 px"},
		{"set cell=x", "cell: \"x\" is not a whole number; it may be 4 to 64 px"},
		{"set compensation=perhaps", "it may be yes or no"},
		{"set blur=much", "blur: \"much\" is none of doubtful, everywhere, off"},
		{"set method=magic", "method: \"magic\" is none of hold, black"},
		{"set gama=2", "gama: there is no such setting; did you mean gamma?"},
		{"set refresh=0", "refresh: 0 is below 1 Hz; it may be 1 to 1000 Hz"},
		{"set context=magic", "context: \"magic\" is none of auto, egl"},
		{"set allow-users=nobody-of-this-name", "allow-users"},
		{"set cell=32 blur=much", "blur"},
	};
	CHECK_INT(raw_control(fd, "set cell=24", -1, &reply), 0);
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		CHECK_INT(raw_control(fd, wrong[i].request, -1, &reply), EINVAL);
		CHECK(strstr(answer(), wrong[i].sentence) != NULL);
	}
	CHECK(question_setting(fd, "cell = 24\n")); /* all or none */
}

/* Every row of the table is taken with its own default. */
static void test_every_row_has_an_answer(void)
{
	for (const struct option_row *row = option_table(); row->name; row++) {
		char request[128];
		if (strcmp(row->name, "socket") == 0)
			continue; /* the default is somebody else's */
		snprintf(request, sizeof(request), "set %s=%s", row->name, row->default_value);
		CHECK_INT(raw_control(fd, request, -1, &reply), 0);
	}
}

static void test_limits_of_main(void)
{
	const int second = raw_greet(fixture.socket);
	CHECK(second >= 0);
	CHECK_INT(raw_control(fd, "set max-clients=2", -1, &reply), 0);
	CHECK(raw_greet(fixture.socket) < 0);
	CHECK_INT(raw_control(fd, "set max-clients=3", -1, &reply), 0);
	const int third = raw_greet(fixture.socket);
	CHECK(third >= 0);
	close(second);
	close(third);
}

int main(int argc, char **argv)
{
	struct raw_stream stream;
	if (argc < 2)
		return 2;
	fixture_init(&fixture, argv[1]);
	fixture_start(&fixture, NULL);
	fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	test_each_setting_of_the_picture(&stream);
	test_next_frame_obeys(&stream);
	test_level_of_the_governor(&stream);
	RUN(test_refusals);
	RUN(test_every_row_has_an_answer);
	RUN(test_limits_of_main);
	raw_stream_finish(&stream);
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	fixture_finish(&fixture);
	return test_result();
}
