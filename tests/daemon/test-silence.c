/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * An X server that hangs: the daemon serves its clients, shows by the clock, records what it shows, says what is the
 * matter, is back when the server is, and ends when it is told to, whatever the server does.
 */
#include <jansson.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"
#include "tests/daemon/xvfb.h"

#define WIDTH 64u
#define HEIGHT 48u
#define PATIENCE_FRAMES 2400 /* 60 s */
/* No call of a game lasts longer, however busy the machine is; one that waited for the server would last for ever. */
#define BOUND_NS UINT64_C(30000000000)
/* The daemon's end: its threads are waited for 3.5 s. */
#define END_NS UINT64_C(40000000000)

static struct fixture fixture;
static struct xvfb xvfb;
static struct pursuit_stream *stream;
static uint64_t longest_ns; /* of the game's calls */

static void note_call(uint64_t since_ns)
{
	const uint64_t lasted_ns = now_ns() - since_ns;
	longest_ns = lasted_ns > longest_ns ? lasted_ns : longest_ns;
}

static void submit_one(uint32_t color)
{
	uint64_t since_ns = now_ns();
	struct pursuit_frame *frame = pursuit_acquire(stream);
	note_call(since_ns);
	if (frame) {
		for (uint32_t y = 0; y < HEIGHT; y++) {
			uint32_t *row = (uint32_t *)(void *)(frame->color.data + y * frame->color.stride);
			for (uint32_t x = 0; x < WIDTH; x++)
				row[x] = 0xff000000u | color;
			memset(frame->depth.data + y * frame->depth.stride, 0, (size_t)WIDTH * 4);
			memset(frame->motion.data + y * frame->motion.stride, 0, (size_t)WIDTH * 8);
		}
		since_ns = now_ns();
		pursuit_submit(stream, frame);
		note_call(since_ns);
	}
	since_ns = now_ns();
	pursuit_wait_next(stream, 50000000);
	note_call(since_ns);
	sleep_ms(15);
}

static bool play_until_shown(uint32_t color, unsigned frames)
{
	struct pursuit_feedback_report report;
	unsigned shown = 0;
	while (pursuit_poll_feedback(stream, &report))
		continue;
	for (int i = 0; i < PATIENCE_FRAMES && shown < frames; i++) {
		submit_one(color);
		while (pursuit_poll_feedback(stream, &report))
			shown += report.shown == PURSUIT_SHOWN;
	}
	return shown >= frames;
}

static bool play_until_seen(uint32_t color)
{
	const Window window = xvfb_find(&xvfb, "Pursuit");
	for (int i = 0; i < PATIENCE_FRAMES; i++) {
		if (xvfb_pixel(&xvfb, window, 20, 20) == color)
			return true;
		submit_one(color);
	}
	return false;
}

/* As `pursuit status` says it; -1: no answer. */
static int status_says_trouble(void)
{
	static struct raw_reply reply;
	const int fd = raw_greet(fixture.socket);
	if (fd < 0 || raw_control(fd, "status", -1, &reply) != 0)
		return -1;
	json_t *status = json_loads((const char *)reply.raw + sizeof(reply.control), 0, NULL);
	const char *text = json_string_value(json_object_get(status, "display_trouble"));
	const int trouble = text ? strstr(text, "display server has not answered") != NULL : -1;
	json_decref(status);
	close(fd);
	return trouble;
}

static bool play_until_trouble(int trouble)
{
	for (int i = 0; i < PATIENCE_FRAMES; i++) {
		if (status_says_trouble() == trouble)
			return true;
		submit_one(0x102030);
	}
	return false;
}

static void open_stream(void)
{
	const struct pursuit_stream_params params = {.width = WIDTH,
												 .height = HEIGHT,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT32,
												 .socket_path = fixture.socket};
	stream = pursuit_open(&params);
	longest_ns = 0;
}

static void start(const char *list, const char *context, const char *more, const char *value)
{
	const char *const arguments[] = {"--present", list, "--context", context, more, value, NULL};
	unlink(fixture.log);
	fixture_start(&fixture, arguments);
	open_stream();
}

static off_t file_size(const char *path)
{
	struct stat found = {.st_size = 0};
	return stat(path, &found) == 0 ? found.st_size : 0;
}

/* All that goes on, and that it is back afterwards. */
static void hang_and_come_back(const char *context)
{
	char tee[128];
	snprintf(tee, sizeof(tee), "%s/tee-%s.y4m", fixture.folder, context);
	start("glfw", context, "--tee", tee);
	CHECK(play_until_seen(0x4080c0));
	CHECK_INT(status_says_trouble(), 0);

	kill(xvfb.pid, SIGSTOP);
	CHECK(play_until_trouble(1));
	CHECK(fixture_logged(&fixture, "glfw: the display server does not answer"));
	const off_t recorded = file_size(tee);
	CHECK(play_until_shown(0xc08040, 40));
	CHECK(file_size(tee) > recorded);
	/* A new client, while the server hangs. */
	pursuit_close(&stream);
	open_stream();
	CHECK(play_until_shown(0x208020, 20));
	CHECK(longest_ns < BOUND_NS);

	kill(xvfb.pid, SIGCONT);
	CHECK(play_until_seen(0xd0c040));
	CHECK(play_until_trouble(0));
	CHECK(fixture_logged(&fixture, "glfw: the display server answers again"));
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	pursuit_close(&stream);
}

static void test_hangs(void)
{
	hang_and_come_back("cpu");
}

static void test_hangs_with_pictures_in_gl(void)
{
	hang_and_come_back("egl");
}

/* The drawing thread hangs too where pictures come; else the window's alone. */
static void end_while_hanging(const char *context, bool with_pictures)
{
	start("glfw", context, NULL, NULL);
	CHECK(play_until_seen(0x4080c0));
	kill(xvfb.pid, SIGSTOP);
	if (with_pictures)
		CHECK(play_until_shown(0xc08040, 20));
	CHECK(fixture_logged(&fixture, "glfw: the display server does not answer"));
	const uint64_t since_ns = now_ns();
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	CHECK(now_ns() - since_ns < END_NS);
	kill(xvfb.pid, SIGCONT);
	pursuit_close(&stream);
}

static void test_ends_while_hanging(void)
{
	end_while_hanging("cpu", true);
	end_while_hanging("cpu", false);
}

static void test_ends_while_hanging_with_pictures_in_gl(void)
{
	end_while_hanging("egl", true);
	end_while_hanging("egl", false);
}

/* The next of the list, until it answers. */
static void test_hangs_at_the_start(void)
{
	kill(xvfb.pid, SIGSTOP);
	start("glfw,headless", "cpu", NULL, NULL);
	CHECK(fixture_logged(&fixture, "glfw: the display server does not answer"));
	CHECK(play_until_shown(0x4080c0, 20));
	sleep_ms(1500); /* it is looked for */
	CHECK(play_until_shown(0x4080c0, 20));
	CHECK(longest_ns < BOUND_NS);
	kill(xvfb.pid, SIGCONT);
	CHECK(play_until_seen(0xc08040));
	CHECK(fixture_logged(&fixture, "glfw works again and takes over from headless"));
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	pursuit_close(&stream);
}

/* It hangs, is killed, and another one comes under its name. */
static void test_dies_while_hanging(void)
{
	start("glfw,headless", "cpu", NULL, NULL);
	CHECK(play_until_seen(0x4080c0));
	XCloseDisplay(xvfb.display);
	xvfb.display = NULL;
	kill(xvfb.pid, SIGSTOP);
	CHECK(play_until_trouble(1));
	xvfb_stop(&xvfb);
	CHECK(fixture_logged(&fixture, "headless presents now"));
	CHECK(play_until_shown(0xc08040, 20));
	CHECK(xvfb_start(&xvfb));
	CHECK(play_until_seen(0x208020));
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	pursuit_close(&stream);
}

int main(int argc, char **argv)
{
	(void)argc;
	if (!xvfb_start(&xvfb))
		SKIP("no Xvfb");
	fixture_init(&fixture, argv[1]);
	RUN(test_hangs);
	RUN(test_hangs_with_pictures_in_gl);
	RUN(test_ends_while_hanging);
	RUN(test_ends_while_hanging_with_pictures_in_gl);
	RUN(test_hangs_at_the_start);
	RUN(test_dies_while_hanging);
	xvfb_stop(&xvfb);
	fixture_finish(&fixture);
	return test_result();
}
