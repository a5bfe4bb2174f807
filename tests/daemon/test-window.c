/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The GLFW presenter under Xvfb: what the engine made is what is on the screen, keys work, nothing hangs. */

#include <signal.h>
#include <string.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/xvfb.h"

#define WIDTH 160u
#define HEIGHT 120u
#define PATIENCE_FRAMES 800 /* 20 s */

static struct fixture fixture;
static struct xvfb xvfb;
static struct pursuit_stream *stream;
static Window window;

/* Four quarters of one colour each, and a white row on top. */
static uint32_t color_at(uint32_t x, uint32_t y)
{
	if (y == 0)
		return 0xffffff;
	return x < WIDTH / 2 ? (y < HEIGHT / 2 ? 0xc03020 : 0x20a040) : (y < HEIGHT / 2 ? 0x3050d0 : 0xd0c040);
}

static void submit_one(void)
{
	struct pursuit_frame *frame = pursuit_acquire(stream);
	if (frame) {
		for (uint32_t y = 0; y < HEIGHT; y++) {
			uint32_t *color = (uint32_t *)(void *)(frame->color.data + y * frame->color.stride);
			for (uint32_t x = 0; x < WIDTH; x++)
				color[x] = 0xff000000u | color_at(x, y);
			memset(frame->depth.data + y * frame->depth.stride, 0, (size_t)WIDTH * 4);
			memset(frame->motion.data + y * frame->motion.stride, 0, (size_t)WIDTH * 8);
		}
		pursuit_submit(stream, frame);
	}
	sleep_ms(25);
}

static uint64_t count_shown(void)
{
	struct pursuit_feedback_report report;
	uint64_t shown = 0;
	while (pursuit_poll_feedback(stream, &report))
		shown += report.shown == PURSUIT_SHOWN;
	return shown;
}

/* Plays until so many more frames were shown. */
static bool play_until_shown(uint64_t frames)
{
	uint64_t shown = 0;
	count_shown();
	for (int i = 0; i < PATIENCE_FRAMES && shown < frames; i++) {
		submit_one();
		shown += count_shown();
	}
	return shown >= frames;
}

/* Plays until a pixel of the window has this colour, or another one. */
static bool play_until_pixel(uint32_t x, uint32_t y, uint32_t color, bool equal)
{
	for (int i = 0; i < PATIENCE_FRAMES; i++) {
		if ((xvfb_pixel(&xvfb, window, x, y) == color) == equal)
			return true;
		submit_one();
	}
	return false;
}

static void start(const char *list)
{
	const char *const arguments[] = {"--present", list, NULL};
	const struct pursuit_stream_params params = {.width = WIDTH,
												 .height = HEIGHT,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT32,
												 .socket_path = fixture.socket,
												 .name = "test game"};
	fixture_start(&fixture, arguments);
	stream = pursuit_open(&params);
	window = xvfb_find(&xvfb, "Pursuit");
	CHECK(window != 0);
	CHECK(play_until_shown(1));
}

static void stop(int number)
{
	CHECK_INT(number ? fixture_stop(&fixture, number) : fixture_join(&fixture), 0);
	pursuit_close(&stream);
}

/* The window takes the size of the picture and shows each pixel of it, the right way up. */
static void test_shows_the_picture(void)
{
	unsigned width = 0, height = 0;
	start("glfw");
	for (int i = 0; i < PATIENCE_FRAMES && (width != WIDTH || height != HEIGHT); i++) {
		submit_one();
		xvfb_get_size(&xvfb, window, &width, &height);
	}
	CHECK_INT(width, WIDTH);
	CHECK_INT(height, HEIGHT);
	CHECK(play_until_pixel(0, 0, 0xffffff, true));
	for (uint32_t y = 0; y < HEIGHT; y += 7)
		for (uint32_t x = 3; x < WIDTH; x += 11)
			CHECK_INT(xvfb_pixel(&xvfb, window, x, y), color_at(x, y));
	stop(SIGTERM);
}

static void test_resized_window(void)
{
	start("glfw");
	CHECK(play_until_pixel(WIDTH - 1, 0, 0xffffff, true));
	XResizeWindow(xvfb.display, window, 400, 120); /* too wide: black at both sides */
	XFlush(xvfb.display);
	CHECK(play_until_pixel(120 + WIDTH - 5, 100, color_at(WIDTH - 5, 100), true));
	CHECK(play_until_pixel(110, 100, 0, true));
	CHECK(play_until_pixel(390, 100, 0, true));
	stop(SIGTERM);
}

static void test_keys(void)
{
	start("glfw");
	CHECK(play_until_pixel(20, 20, color_at(20, 20), true));
	xvfb_press(&xvfb, window, "i");
	CHECK(play_until_pixel(6, 6, color_at(6, 6), false));
	xvfb_press(&xvfb, window, "i");
	CHECK(play_until_pixel(6, 6, color_at(6, 6), true));
	xvfb_press(&xvfb, window, "m");
	CHECK(fixture_logged(&fixture, "method is black now, was hold"));
	xvfb_press(&xvfb, window, "q");
	CHECK(fixture_logged(&fixture, "quit by key"));
	stop(0);
}

/* Pictures go on being counted, and are seen again afterwards. */
static void test_hidden_window(void)
{
	start("glfw");
	CHECK(play_until_pixel(20, 20, color_at(20, 20), true));
	XUnmapWindow(xvfb.display, window);
	XFlush(xvfb.display);
	CHECK(play_until_shown(20));
	XMapWindow(xvfb.display, window);
	XFlush(xvfb.display);
	CHECK(play_until_pixel(20, 20, color_at(20, 20), true));
	stop(SIGTERM);
}

/* The display server dies: the next presenter of the list takes over, the client stays. */
static void test_lost_server(void)
{
	start("glfw,headless");
	xvfb_stop(&xvfb);
	CHECK(fixture_logged(&fixture, "glfw is lost"));
	CHECK(fixture_logged(&fixture, "headless presents now"));
	CHECK(play_until_shown(20));
	stop(SIGTERM);
}

int main(int argc, char **argv)
{
	(void)argc;
	if (!xvfb_start(&xvfb))
		SKIP("no Xvfb");
	fixture_init(&fixture, argv[1]);
	RUN(test_shows_the_picture);
	RUN(test_resized_window);
	RUN(test_keys);
	RUN(test_hidden_window);
	RUN(test_lost_server); /* the last one: it has no server afterwards */
	xvfb_stop(&xvfb);
	fixture_finish(&fixture);
	return test_result();
}
