/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Pictures that stay in GL all the way to the window: to the bit what is on the screen when they go through CPU memory,
 * nothing is read back, and what the CPU draws or looks at is right all the same.
 */
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/picture-game.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"
#include "tests/daemon/xvfb.h"

#define WIDTH 203u
#define HEIGHT 151u
#define LARGE_WIDTH 500u
#define LARGE_HEIGHT 400u

static struct fixture fixture;
static struct xvfb xvfb;
static struct picture_game game = {.width = WIDTH, .height = HEIGHT, .color_at = picture_game_pattern};
static Window window;

static bool play_until_pixel(uint32_t x, uint32_t y, uint32_t color, bool equal)
{
	return picture_game_play_until(&game, &xvfb, window, x, y, color, equal);
}

static json_int_t count_runs(const char *pass)
{
	char path[64];
	const int fd = raw_greet(fixture.socket);
	snprintf(path, sizeof(path), "passes.%s", pass);
	const json_int_t count = question_figure(fd, "status", path);
	close(fd);
	return count;
}

static void start(const char *context, const char *more)
{
	const char *const arguments[] = {"--present", "glfw", "--context", context, more, NULL};
	fixture_start(&fixture, arguments);
	picture_game_open(&game, fixture.socket);
	window = xvfb_find(&xvfb, "Pursuit");
	CHECK(window != 0);
	CHECK(play_until_pixel(WIDTH - 1, HEIGHT - 1, picture_game_pattern(WIDTH - 1, HEIGHT - 1), true));
}

static void stop(void)
{
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	pursuit_close(&game.stream);
}

/* What is on the screen: the picture as it is, with the help over it, and enlarged. */
struct screens {
	uint32_t plain[WIDTH * HEIGHT], help[WIDTH * HEIGHT], large[LARGE_WIDTH * LARGE_HEIGHT];
};

static void take_screens(struct screens *screens)
{
	const uint32_t middle = picture_game_pattern(WIDTH / 2, HEIGHT / 2);
	CHECK(xvfb_capture(&xvfb, window, WIDTH, HEIGHT, screens->plain));
	xvfb_press(&xvfb, window, "h");
	CHECK(play_until_pixel(WIDTH / 2, HEIGHT / 2, middle, false));
	CHECK(xvfb_capture(&xvfb, window, WIDTH, HEIGHT, screens->help));
	xvfb_press(&xvfb, window, "h");
	CHECK(play_until_pixel(WIDTH / 2, HEIGHT / 2, middle, true));
	XResizeWindow(xvfb.display, window, LARGE_WIDTH, LARGE_HEIGHT);
	XFlush(xvfb.display);
	CHECK(play_until_pixel(LARGE_WIDTH / 2, LARGE_HEIGHT - 40, 0, false));
	for (int i = 0; i < 8; i++)
		picture_game_play(&game);
	CHECK(xvfb_capture(&xvfb, window, LARGE_WIDTH, LARGE_HEIGHT, screens->large));
}

static void test_same_screen(void)
{
	static struct screens shared, through_memory;
	start("egl", NULL);
	CHECK(fixture_logged(&fixture, "pictures stay in GL"));
	CHECK_INT(count_runs("read"), 0);
	CHECK(count_runs("copy") > 0);
	take_screens(&shared);
	CHECK(count_runs("read") > 0); /* what the help lay over */
	stop();

	start("egl-device:0", NULL);
	take_screens(&through_memory);
	CHECK_INT(count_runs("copy"), 0);
	stop();
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
		CHECK_INT(shared.plain[i], picture_game_pattern(i % WIDTH, i / WIDTH));
	CHECK(memcmp(shared.plain, through_memory.plain, sizeof(shared.plain)) == 0);
	CHECK(memcmp(shared.help, through_memory.help, sizeof(shared.help)) == 0);
	CHECK(memcmp(shared.large, through_memory.large, sizeof(shared.large)) == 0);
}

/* A file of what is shown, and a photodiode's patch, need the pixels. */
static void test_recorded(void)
{
	char option[160];
	snprintf(option, sizeof(option), "--tee=%s/shown.y4m", fixture.folder);
	start("egl", option);
	CHECK_INT(count_runs("copy"), 0);
	CHECK(count_runs("read") > 0);
	stop();
	CHECK(fixture_logged(&fixture, "tee: "));
}

static void test_patch(void)
{
	start("egl", "--patch=alternate");
	CHECK_INT(count_runs("copy"), 0);
	CHECK(play_until_pixel(2, HEIGHT - 2, 0xffffff, true));
	CHECK(play_until_pixel(2, HEIGHT - 2, 0x000000, true));
	stop();
}

/* The engine goes on without the window's context when the server is gone, and in the next one's when it is back. */
static void test_lost_server(void)
{
	struct pursuit_feedback_report report;
	uint64_t shown = 0;
	start("egl", "--present=glfw,headless");
	CHECK(fixture_logged(&fixture, "pictures stay in GL"));
	xvfb_stop(&xvfb);
	CHECK(fixture_logged(&fixture, "headless presents now"));
	while (pursuit_poll_feedback(game.stream, &report))
		continue;
	for (int i = 0; i < PICTURE_GAME_PATIENCE && shown < 20; i++) {
		picture_game_play(&game);
		while (pursuit_poll_feedback(game.stream, &report))
			shown += report.shown == PURSUIT_SHOWN;
	}
	CHECK(shown >= 20);
	const json_int_t copies = count_runs("copy");
	CHECK(xvfb_start(&xvfb));
	window = xvfb_find(&xvfb, "Pursuit");
	CHECK(play_until_pixel(WIDTH - 1, HEIGHT - 1, picture_game_pattern(WIDTH - 1, HEIGHT - 1), true));
	CHECK(count_runs("copy") > copies);
	stop();
}

int main(int argc, char **argv)
{
	(void)argc;
	if (!xvfb_start(&xvfb))
		SKIP("no Xvfb");
	fixture_init(&fixture, argv[1]);
	RUN(test_same_screen);
	RUN(test_recorded);
	RUN(test_patch);
	RUN(test_lost_server);
	xvfb_stop(&xvfb);
	fixture_finish(&fixture);
	return test_result();
}
