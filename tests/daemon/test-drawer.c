/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The start of a window's drawing thread, with a window that is this test's: whatever the display server does
 * meanwhile, main does not wait for ever.
 */

#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>

#include "daemon/present/drawer.h"
#include "tests/test.h"

enum server {
	REFUSES,
	GOES_AWAY, /* as in window.c: the thread that notices ends */
	HANGS,
};

struct window {
	enum server server;
	sem_t again; /* it answers at last */
};

int window_make_current(struct window *window, struct error *error)
{
	if (window->server == GOES_AWAY)
		pthread_exit(NULL);
	if (window->server == HANGS)
		sem_wait(&window->again);
	return error_set(error, -EIO, "no context");
}

void window_let_go(struct window *window)
{
	(void)window;
}

void window_swap(struct window *window)
{
	(void)window;
	CHECK(false);
}

window_function window_find_function(const char *name)
{
	(void)name;
	return NULL;
}

bool window_has_extension(const char *name)
{
	(void)name;
	return false;
}

bool window_get_glx(struct window *window, void **display, unsigned long *drawable)
{
	(void)window;
	(void)display;
	(void)drawable;
	return false;
}

static void test_refused(void)
{
	struct window window = {.server = REFUSES};
	struct error error = {""};
	struct drawer *drawer = drawer_create(&window, &error);
	CHECK(drawer != NULL);
	CHECK_INT(drawer_wait_for_start(drawer, &error), -EIO);
	CHECK_STRING(error.text, "no context");
	CHECK(drawer_destroy(&drawer, NULL, NULL));
}

static void test_server_goes_away(void)
{
	struct window window = {.server = GOES_AWAY};
	struct error error = {""};
	struct drawer *drawer = drawer_create(&window, &error);
	CHECK(drawer != NULL);
	CHECK_INT(drawer_wait_for_start(drawer, &error), -EIO);
	CHECK(strstr(error.text, "went away") != NULL);
	CHECK(drawer_destroy(&drawer, NULL, NULL));
}

static void say_gone(void *data)
{
	sem_post(data);
}

static void test_server_hangs(void)
{
	struct window window = {.server = HANGS};
	struct error error = {""};
	struct timespec until;
	sem_t gone;
	sem_init(&window.again, 0, 0);
	sem_init(&gone, 0, 0);
	struct drawer *drawer = drawer_create(&window, &error);
	CHECK(drawer != NULL);
	CHECK_INT(drawer_wait_for_start(drawer, &error), -ETIMEDOUT);
	CHECK(strstr(error.text, "does not answer") != NULL);
	CHECK(!drawer_destroy(&drawer, say_gone, &gone));
	CHECK(!drawer);
	CHECK(sem_trywait(&gone) < 0);
	/* Its thread ends by itself when it comes back, and says so. */
	sem_post(&window.again);
	clock_gettime(CLOCK_REALTIME, &until);
	until.tv_sec += 60;
	CHECK_INT(sem_timedwait(&gone, &until), 0);
}

int main(void)
{
	RUN(test_refused);
	RUN(test_server_goes_away);
	RUN(test_server_hangs);
	return test_result();
}
