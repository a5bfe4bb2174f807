/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The GLFW presenter and monitors, under Xorg: full screen on the one that was chosen, in its mode that is nearest to
 * the rate wished for, without it when it is unplugged, and the desktop's mode as it was in the end.
 */
#include <dirent.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/picture-game.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"
#include "tests/daemon/xorg.h"

#define WIDTH XORG_WIDTH
#define HEIGHT XORG_HEIGHT

static struct fixture fixture;
static struct xvfb server;
static struct picture_game game = {.width = WIDTH, .height = HEIGHT, .color_at = picture_game_pattern};

/* Plays until a place of the desktop shows this pixel of the picture. */
static bool play_until_seen(uint32_t desktop_x, uint32_t desktop_y, uint32_t color)
{
	return picture_game_play_until(&game, &server, DefaultRootWindow(server.display), desktop_x, desktop_y, color,
								   true);
}

/* Pixels of the monitor at the right that are not the picture's. */
static uint32_t count_wrong(void)
{
	static uint32_t pixels[2 * WIDTH * HEIGHT];
	uint32_t wrong = 0;
	if (!xvfb_capture(&server, DefaultRootWindow(server.display), 2 * WIDTH, HEIGHT, pixels))
		return UINT32_MAX;
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			wrong += pixels[y * 2 * WIDTH + WIDTH + x] != picture_game_pattern(x, y);
	return wrong;
}

/* All of the picture on the monitor at the right, to the bit; the server may be asked while it is being drawn,
 * and the daemon may say something in a corner of it for a while. */
static bool fills_the_right_monitor(void)
{
	if (!play_until_seen(2 * WIDTH - 1, HEIGHT - 1, picture_game_pattern(WIDTH - 1, HEIGHT - 1)))
		return false;
	uint32_t wrong = count_wrong();
	for (int i = 0; i < PICTURE_GAME_PATIENCE && wrong > 0; i++) {
		picture_game_play(&game);
		wrong = count_wrong();
	}
	CHECK_INT(wrong, 0);
	return true;
}

static bool wait_for_rate(const char *monitor, double rate)
{
	for (int i = 0; i < 1200; i++) {
		if (fabs(xorg_rate(monitor) - rate) < 0.02)
			return true;
		sleep_ms(50);
	}
	fprintf(stderr, "%s is at %.2f Hz\n", monitor, xorg_rate(monitor));
	return false;
}

/* Processes that would put a mode back for the daemon. */
static int count_guards(void)
{
	DIR *folder = opendir("/proc");
	int count = 0;
	for (const struct dirent *entry; folder && (entry = readdir(folder));) {
		char path[300], state;
		int parent = 0;
		snprintf(path, sizeof(path), "/proc/%s/stat", entry->d_name);
		FILE *file = fopen(path, "r");
		if (file && fscanf(file, "%*d (%*[^)]) %c %d", &state, &parent) == 2)
			count += parent == fixture.pid;
		if (file)
			fclose(file);
	}
	if (folder)
		closedir(folder);
	return count;
}

static bool wait_for_guards(int wanted)
{
	int count = count_guards();
	for (int i = 0; i < 1200 && count != wanted; i++) {
		sleep_ms(50);
		count = count_guards();
	}
	return count == wanted;
}

/* The daemon, and a game if there is one to be. */
static void start(const char *monitor, const char *refresh, const char *full)
{
	const char *const arguments[] = {"--present", "glfw,headless", "--monitor", monitor,
									 "--refresh", refresh,         full,        NULL};
	unlink(fixture.log);
	fixture_start(&fixture, arguments);
	picture_game_open(&game, fixture.socket);
}

static void stop(void)
{
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	pursuit_close(&game.stream);
}

static void test_chosen_monitor_at_120(void)
{
	start("DUMMY1", "120", "--fullscreen");
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK(wait_for_rate("DUMMY0", XORG_USUAL_HZ));
	CHECK(fixture_logged(&fixture, "glfw: full screen on DUMMY1, 800x600 at 120.00 Hz"));
	CHECK(fills_the_right_monitor());
	stop();
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
}

static void test_nearest_rate(void)
{
	start("DUMMY0", "83", "--fullscreen");
	CHECK(wait_for_rate("DUMMY0", 85.14));
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
	stop();
	CHECK(wait_for_rate("DUMMY0", XORG_USUAL_HZ));
}

/* Also where no process may be started that would put the mode back after a crash. */
static void test_in_and_out_by_key(void)
{
	start("DUMMY1", "120", "--seccomp");
	Window window = xvfb_find(&server, "Pursuit");
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
	xvfb_press(&server, window, "f");
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK(fills_the_right_monitor());
	xvfb_press(&server, window, "f");
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
	xvfb_press(&server, window, "f");
	CHECK(wait_for_rate("DUMMY1", 120.0));
	xvfb_press(&server, window, "q");
	CHECK_INT(fixture_join(&fixture), 0);
	pursuit_close(&game.stream);
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
}

static void must_set(const char *change)
{
	const int fd = raw_greet(fixture.socket);
	char request[128];
	snprintf(request, sizeof(request), "set %s", change);
	CHECK_INT(question_set_at_last(fd, request), 0);
	close(fd);
}

/* Monitor, rate and full screen change while a game plays. */
static void test_in_and_out_by_settings(void)
{
	start("DUMMY0", "120", "--no-fullscreen");
	CHECK(play_until_seen(300, 200, picture_game_pattern(300, 200)));
	must_set("fullscreen=yes monitor=DUMMY1");
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK(wait_for_rate("DUMMY0", XORG_USUAL_HZ));
	CHECK(fills_the_right_monitor());
	must_set("refresh=83");
	CHECK(wait_for_rate("DUMMY1", 85.14));
	must_set("monitor=DUMMY0");
	CHECK(wait_for_rate("DUMMY0", 85.14));
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
	must_set("fullscreen=no");
	CHECK(wait_for_rate("DUMMY0", XORG_USUAL_HZ));
	stop();
}

/* A window elsewhere while it is away, and full screen in the mode of before when it is back. */
static void test_unplugged(void)
{
	start("DUMMY1", "120", "--fullscreen");
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK(fills_the_right_monitor());
	CHECK(xorg_unplug());
	CHECK(wait_for_rate("DUMMY1", 0.0));
	CHECK(play_until_seen(300, 200, picture_game_pattern(300, 200)));
	CHECK(xorg_plug());
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK(fills_the_right_monitor());
	stop();
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
}

/* It dies while it is in a mode that full screen chose, and another one comes. */
static void test_server_dies(void)
{
	start("DUMMY1", "120", "--fullscreen");
	for (int i = 0; i < 2; i++) {
		CHECK(wait_for_rate("DUMMY1", 120.0));
		CHECK(fills_the_right_monitor());
		xvfb_stop(&server);
		CHECK(fixture_logged(&fixture, "headless presents now"));
		CHECK(wait_for_guards(0));
		CHECK(xorg_start(&server, fixture.folder));
	}
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK(fills_the_right_monitor());
	stop();
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
}

/* The server drops the daemon, and goes on: its mode is put back at once, and changed again with the next window. */
static void test_cut_off(void)
{
	start("DUMMY1", "120", "--fullscreen");
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK(wait_for_guards(1));
	XKillClient(server.display, xvfb_find(&server, "Pursuit"));
	XFlush(server.display);
	CHECK(fixture_logged(&fixture, "glfw presents now"));
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK(fills_the_right_monitor());
	CHECK(wait_for_guards(1));
	xvfb_press(&server, xvfb_find(&server, "Pursuit"), "f");
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
	CHECK(wait_for_guards(0));
	stop();
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
}

/* Nobody can tell a daemon that is killed: a process of its own puts the mode back. */
static void test_killed(void)
{
	start("DUMMY1", "120", "--fullscreen");
	CHECK(wait_for_rate("DUMMY1", 120.0));
	CHECK_INT(fixture_stop(&fixture, SIGKILL), 128 + SIGKILL);
	pursuit_close(&game.stream);
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
}

/* Nor can one that ends ask a server that hangs. */
static void test_ends_while_the_server_hangs(void)
{
	start("DUMMY1", "120", "--fullscreen");
	CHECK(wait_for_rate("DUMMY1", 120.0));
	kill(server.pid, SIGSTOP);
	CHECK(fixture_logged(&fixture, "glfw: the display server does not answer"));
	stop();
	kill(server.pid, SIGCONT);
	CHECK(wait_for_rate("DUMMY1", XORG_USUAL_HZ));
}

int main(int argc, char **argv)
{
	(void)argc;
	fixture_init(&fixture, argv[1]);
	if (!xorg_start(&server, fixture.folder)) {
		fixture_finish(&fixture);
		SKIP("no Xorg with the driver dummy, or no xrandr (Debian: xserver-xorg-core, xserver-xorg-video-dummy, "
			 "x11-xserver-utils)");
	}
	RUN(test_chosen_monitor_at_120);
	RUN(test_nearest_rate);
	RUN(test_in_and_out_by_key);
	RUN(test_in_and_out_by_settings);
	RUN(test_unplugged);
	RUN(test_cut_off);
	RUN(test_killed);
	RUN(test_ends_while_the_server_hangs);
	RUN(test_server_dies);
	xvfb_stop(&server);
	fixture_finish(&fixture);
	return test_result();
}
