/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The terminal of `pursuit top`: a screen of its own, of which only lines that
 * changed are sent, in one write a picture. After each picture the terminal is
 * asked whether it is there (ECMA-48, DSR 5); until it has answered nothing more
 * is sent, so that a slow line never lags behind. A terminal that answers
 * nothing is not waited for. What was there before comes back at the end, after
 * a signal, and while the program is stopped (Ctrl-Z).
 */
#ifndef PURSUIT_CLI_TOP_SCREEN_H
#define PURSUIT_CLI_TOP_SCREEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <termios.h>

#include "daemon/error.h"

enum top_event {
	TOP_NOTHING, /* the time is over */
	TOP_KEY,
	TOP_CHANGED, /* the screen has another size, or is back: draw */
	TOP_OVER,    /* a signal, or the terminal is gone */
};

struct top_screen {
	struct termios before;
	bool keys; /* standard input is a terminal too */
	int signal_fd;
	unsigned columns, rows;
	char **lines; /* that the terminal shows */
	size_t count;
	bool answers, waiting;
	uint64_t sent_ms;
	unsigned escape; /* how far an answer has been read */
};

/* 0 or a negative errno with a sentence. */
int top_screen_open(struct top_screen *screen, struct error *error);
void top_screen_close(struct top_screen *screen);

/* Shows these lines; cut at the end of the screen. False: the terminal has not shown those before yet. */
bool top_screen_draw(struct top_screen *screen, const char *text);

/* At most so long; *key after TOP_KEY. */
enum top_event top_screen_wait(struct top_screen *screen, uint32_t ms, char *key);

#endif
