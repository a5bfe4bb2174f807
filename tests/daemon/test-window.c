/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The GLFW presenter under Xvfb: what the engine made is what is on the screen, keys work, nothing hangs. */

#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/picture-game.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"
#include "tests/daemon/xvfb.h"

#define WIDTH 160u
#define HEIGHT 120u

static struct fixture fixture;
static struct xvfb xvfb;
static Window window;
static uint32_t corner; /* of the picture: what is the same as before is not drawn again */

/* Four quarters of one colour each, and a white row on top. */
static uint32_t color_at(uint32_t x, uint32_t y)
{
	if (y == 0)
		return x == WIDTH - 1 ? 0xffffff - corner : 0xffffff;
	return x < WIDTH / 2 ? (y < HEIGHT / 2 ? 0xc03020 : 0x20a040) : (y < HEIGHT / 2 ? 0x3050d0 : 0xd0c040);
}

static struct picture_game game = {.width = WIDTH, .height = HEIGHT, .color_at = color_at};

static uint64_t count_shown(void)
{
	struct pursuit_feedback_report report;
	uint64_t shown = 0;
	while (pursuit_poll_feedback(game.stream, &report))
		shown += report.shown == PURSUIT_SHOWN;
	return shown;
}

/* Plays until so many more frames were shown. */
static bool play_until_shown(uint64_t frames)
{
	uint64_t shown = 0;
	count_shown();
	for (int i = 0; i < PICTURE_GAME_PATIENCE && shown < frames; i++) {
		picture_game_play(&game);
		shown += count_shown();
	}
	return shown >= frames;
}

/* Plays until a pixel of the window has this colour, or another one. */
static bool play_until_pixel(uint32_t x, uint32_t y, uint32_t color, bool equal)
{
	return picture_game_play_until(&game, &xvfb, window, x, y, color, equal);
}

/* Flips whose time came from there; NULL: from anywhere but the clock alone, so that their picture was drawn. */
static json_int_t count_dated(const char *wanted)
{
	const int fd = raw_greet(fixture.socket);
	const char *source;
	json_t *count;
	json_int_t drawn = 0;
	json_t *status = question_ask(fd, "status");
	json_object_foreach(json_object_get(status, "flip_time_sources"), source, count)
	{
		if (wanted ? strcmp(source, wanted) == 0 : strcmp(source, "timer") != 0)
			drawn += json_integer_value(count);
	}
	json_decref(status);
	close(fd);
	return drawn;
}

/* Plays until frames are shown and nothing is drawn for them. */
static bool play_until_undrawn(void)
{
	for (int i = 0; i < 40; i++) {
		const json_int_t before = count_dated(NULL);
		if (play_until_shown(10) && count_dated(NULL) == before)
			return true;
	}
	return false;
}

static void start(const char *list)
{
	const char *const arguments[] = {"--present", list, NULL};
	fixture_start(&fixture, arguments);
	picture_game_open(&game, fixture.socket);
	window = xvfb_find(&xvfb, "Pursuit");
	CHECK(window != 0);
	CHECK(play_until_shown(1));
}

static void stop(int number)
{
	CHECK_INT(number ? fixture_stop(&fixture, number) : fixture_join(&fixture), 0);
	pursuit_close(&game.stream);
}

/* The window takes the size of the picture and shows each pixel of it, the right way up. */
static void test_shows_the_picture(void)
{
	unsigned width = 0, height = 0;
	start("glfw");
	for (int i = 0; i < PICTURE_GAME_PATIENCE && (width != WIDTH || height != HEIGHT); i++) {
		picture_game_play(&game);
		xvfb_get_size(&xvfb, window, &width, &height);
	}
	CHECK_INT(width, WIDTH);
	CHECK_INT(height, HEIGHT);
	CHECK(play_until_pixel(0, 0, 0xffffff, true));
	for (uint32_t y = 0; y < HEIGHT; y += 7)
		for (uint32_t x = 3; x < WIDTH; x += 11)
			CHECK_INT(xvfb_pixel(&xvfb, window, x, y), color_at(x, y));
	/* There is no display whose vblanks anybody could know. The first swaps may come back too late to date a flip. */
	for (int i = 0; i < PICTURE_GAME_PATIENCE && count_dated("estimated") == 0; i++) {
		corner = i % 2;
		picture_game_play(&game);
	}
	corner = 0;
	bool estimated = false; /* on a busy machine first by the clock alone */
	for (int i = 0; i < 20 && !estimated; i++)
		estimated = play_until_shown(10) && count_dated("estimated") > 0;
	CHECK(estimated);
	CHECK_INT(count_dated("display server"), 0);
	CHECK_INT(count_dated("kernel"), 0);
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

/* Until a pixel of the window is black, or not. */
static bool wait_for_black(uint32_t x, uint32_t y, bool black)
{
	for (int i = 0; i < PICTURE_GAME_PATIENCE; i++) {
		if ((xvfb_pixel(&xvfb, window, x, y) == 0) == black)
			return true;
		sleep_ms(25);
	}
	return false;
}

/* The help is there before any game is. */
static void test_help_without_a_game(void)
{
	const char *const arguments[] = {"--present", "glfw", "--window-size", "640x360", NULL};
	fixture_start(&fixture, arguments);
	window = xvfb_find(&xvfb, "Pursuit");
	CHECK(wait_for_black(320, 180, true));
	xvfb_press(&xvfb, window, "h");
	CHECK(wait_for_black(320, 180, false));
	CHECK(wait_for_black(10, 10, true));
	xvfb_press(&xvfb, window, "h");
	CHECK(wait_for_black(320, 180, true));
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* Frames go on being shown by the clock, nothing is drawn that nobody sees; pictures are seen again afterwards. */
static void test_hidden_window(void)
{
	start("glfw");
	CHECK(play_until_pixel(20, 20, color_at(20, 20), true));
	XUnmapWindow(xvfb.display, window);
	XFlush(xvfb.display);
	CHECK(play_until_undrawn());
	const json_int_t drawn = count_dated(NULL);
	CHECK(play_until_shown(20));
	CHECK_INT(count_dated(NULL), drawn);
	XMapWindow(xvfb.display, window);
	XFlush(xvfb.display);
	CHECK(play_until_pixel(20, 20, color_at(20, 20), true));
	/* The first swaps may come back too late to date a flip. */
	for (int i = 0; i < PICTURE_GAME_PATIENCE && count_dated(NULL) == drawn; i++) {
		corner = i % 2;
		picture_game_play(&game);
	}
	corner = 0;
	CHECK(count_dated(NULL) > drawn);
	stop(SIGTERM);
}

/* The last picture before a pause came while a swap hung: it is drawn when that is back, though no other one comes. */
static void test_server_that_hangs(void)
{
	start("glfw");
	CHECK(play_until_pixel(WIDTH - 1, 0, 0xffffff, true));
	kill(xvfb.pid, SIGSTOP);
	for (int i = 0; i < 20; i++) {
		corner = i < 15 ? 0x10 : 0x20;
		picture_game_play(&game);
	}
	sleep_ms(500);
	kill(xvfb.pid, SIGCONT);
	bool shown = false;
	for (int i = 0; i < PICTURE_GAME_PATIENCE && !shown; i++) {
		shown = xvfb_pixel(&xvfb, window, WIDTH - 1, 0) == 0xffffff - 0x20;
		sleep_ms(25);
	}
	CHECK(shown);
	corner = 0;
	stop(SIGTERM);
}

/* The window was made anew and goes again at once, maybe before the render thread has seen it. */
static void test_changes_that_are_taken_back(void)
{
	const char *const arguments[] = {"--present", "glfw", NULL};
	static struct raw_reply reply;
	char request[128];
	fixture_start(&fixture, arguments);
	const int fd = raw_greet(fixture.socket);
	CHECK_INT(raw_control(fd, "set seccomp=yes", -1, &reply), 0);
	for (int i = 0; i < 12; i++) {
		snprintf(request, sizeof(request), "set window-size=320x%d seccomp=no", 200 + i);
		CHECK(raw_control(fd, request, -1, &reply) != 0);
		snprintf(request, sizeof(request), "set window-size=400x%d", 200 + i);
		CHECK_INT(question_set_at_last(fd, request), 0);
	}
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* The display server dies: the next presenter of the list takes over, the client stays. */
static void test_lost_server(void)
{
	start("glfw,headless");
	xvfb_stop(&xvfb);
	CHECK(fixture_logged(&fixture, "glfw is lost"));
	CHECK(fixture_logged(&fixture, "headless presents now"));
	CHECK(play_until_shown(20));
}

/* It is looked for up to eight seconds apart, by a machine that may have other things to do. */
static bool logged_at_last(const char *text)
{
	for (int i = 0; i < 6; i++)
		if (fixture_logged(&fixture, text))
			return true;
	return false;
}

/* The picture is in the daemon's window, whichever that is by now. */
static bool play_until_new_window_shows(void)
{
	for (int i = 0; i < 4; i++) {
		window = xvfb_find(&xvfb, "Pursuit");
		if (play_until_pixel(20, 20, color_at(20, 20), true))
			return true;
	}
	return false;
}

/* And comes back: so does the window, and whose pictures went nowhere sees them again. */
static void test_server_that_comes_back(void)
{
	for (int i = 0; i < 3; i++) {
		CHECK(xvfb_start(&xvfb));
		CHECK(logged_at_last("glfw works again and takes over from headless"));
		CHECK(play_until_new_window_shows());
		CHECK(play_until_shown(20));
		xvfb_stop(&xvfb);
		sleep_ms(500);
	}
	CHECK(play_until_shown(20));
	stop(SIGTERM);
}

/* As the only presenter: none for a while. */
static void test_server_that_is_waited_for(void)
{
	CHECK(xvfb_start(&xvfb));
	start("glfw");
	CHECK(play_until_pixel(20, 20, color_at(20, 20), true));
	xvfb_stop(&xvfb);
	CHECK(logged_at_last("no presenter works"));
	CHECK(xvfb_start(&xvfb));
	CHECK(logged_at_last("glfw presents now"));
	CHECK(play_until_new_window_shows());
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
	RUN(test_help_without_a_game);
	RUN(test_hidden_window);
	RUN(test_server_that_hangs);
	RUN(test_changes_that_are_taken_back);
	RUN(test_lost_server);
	RUN(test_server_that_comes_back); /* goes on where that ended */
	RUN(test_server_that_is_waited_for);
	xvfb_stop(&xvfb);
	fixture_finish(&fixture);
	return test_result();
}
