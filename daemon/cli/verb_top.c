/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "args.h"
#include "control.h"
#include "interrupt.h"
#include "latency_fetch.h"
#include "top_view.h"
#include "verbs.h"

#define VERB "top"
#define NO_ROW (UINT64_C(1) << 62)
#define DEFAULT_COLUMNS 100u
#define PIPE_COLUMNS 1000u

struct top {
	struct control control;
	struct top_view view;
	uint64_t timeline_from, rows_from; /* numbers of the next rows */
};

/* ---- asking ---- */

/* The timeline's rows since the round before; the first round finds out where they are. */
static int ask_timeline(struct top *top, json_t **timeline, struct error *error)
{
	char request[64];
	snprintf(request, sizeof(request), "timeline %" PRIu64 " 400", top->timeline_from);
	const int result = control_ask(&top->control, request, -1, timeline, error);
	if (result < 0)
		return result;
	const uint64_t total = (uint64_t)json_integer_value(json_object_get(*timeline, "total"));
	top->timeline_from = total;
	return 0;
}

static int ask_rows(struct top *top, const json_t *status, struct latency_table *rows, struct error *error)
{
	const json_t *lab = json_object_get(status, "lab");
	const uint64_t total = (uint64_t)json_integer_value(json_object_get(lab, "rows"));
	if (!json_is_object(lab))
		return 0;
	if (top->rows_from == NO_ROW)
		top->rows_from = total;
	return latency_fetch(&top->control, &top->rows_from, rows, error);
}

static int ask_round(struct top *top, struct error *error)
{
	struct latency_table rows = {0};
	json_t *status = NULL, *timeline = NULL;
	int result = control_ask(&top->control, "status", -1, &status, error);
	if (result == 0)
		result = ask_timeline(top, &timeline, error);
	if (result == 0)
		result = ask_rows(top, status, &rows, error);
	if (result == 0)
		top_view_add(&top->view, status, timeline, &rows);
	else
		json_decref(status);
	json_decref(timeline);
	latency_table_finish(&rows);
	return result;
}

/* ---- the terminal ---- */

static unsigned columns_of_terminal(void)
{
	struct winsize size;
	if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20)
		return size.ws_col;
	return isatty(STDOUT_FILENO) ? DEFAULT_COLUMNS : PIPE_COLUMNS;
}

/* Keys come one by one and unseen. False: standard input is no terminal. */
static bool grab_keys(struct termios *before)
{
	if (!isatty(STDIN_FILENO) || tcgetattr(STDIN_FILENO, before) < 0)
		return false;
	struct termios raw = *before;
	raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
	return tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
}

/* One write a round: no flicker, few packets on a slow line. */
static void draw(const struct top *top, bool held)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		return;
	fputs("\033[H", out);
	top_view_print(&top->view, columns_of_terminal(), true, out);
	fprintf(out, "\033[K\n%s\033[K\n\033[J", held ? "held: space goes on, q quits" : "q quits, space holds");
	fclose(out);
	fwrite(text, 1, size, stdout);
	fflush(stdout);
	free(text);
}

/* The next key within the interval; 0 none. */
static char wait_for_key(bool keys, uint32_t interval_ms)
{
	struct pollfd input = {.fd = keys ? STDIN_FILENO : -1, .events = POLLIN};
	char key = 0;
	if (poll(&input, 1, (int)interval_ms) > 0 && read(STDIN_FILENO, &key, 1) <= 0)
		return 'q';
	return key;
}

static int watch(struct top *top, uint32_t interval_ms, struct error *error)
{
	struct termios before;
	const bool keys = grab_keys(&before);
	bool held = false, over = false;
	int result = 0;
	interrupt_watch();
	fputs("\033[?1049h\033[?25l", stdout);
	while (!over && !interrupt_seen() && result == 0) {
		if (!held)
			result = ask_round(top, error);
		if (result == 0)
			draw(top, held);
		const char key = result == 0 ? wait_for_key(keys, interval_ms) : 0;
		over = key == 'q';
		held ^= key == ' ';
	}
	fputs("\033[?25h\033[?1049l", stdout);
	fflush(stdout);
	if (keys)
		tcsetattr(STDIN_FILENO, TCSANOW, &before);
	return result;
}

/* ---- the verb ---- */

/* Two rounds, so that there is a moment to speak of. */
static int once(struct top *top, uint32_t interval_ms, bool as_json, struct error *error)
{
	int result = ask_round(top, error);
	if (result == 0) {
		poll(NULL, 0, (int)interval_ms);
		result = ask_round(top, error);
	}
	if (result < 0)
		return result;
	if (!as_json) {
		top_view_print(&top->view, columns_of_terminal(), false, stdout);
		return 0;
	}
	json_t *object = top_view_json(&top->view);
	json_dumpf(object, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
	putchar('\n');
	json_decref(object);
	return 0;
}

int verb_top(int argc, char **argv)
{
	bool as_json = false, just_once = false;
	uint32_t interval_ms = 1000;
	const char *socket = NULL;
	const struct arg_row rows[] = {
		{"once", ARG_FLAG, &just_once, 0, 0, NULL, NULL, "look for one interval, print, end"},
		{"json", ARG_FLAG, &as_json, 0, 0, NULL, NULL, "the same as one JSON object"},
		{"interval-ms", ARG_NUMBER, &interval_ms, 100, 60000, NULL, "MS", "between rounds; default 1000"},
		{"socket", ARG_TEXT, &socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[--once] [--json]",
		.summary =
			"Shows live what the running daemon does: rates, phase, latency and its course, what ran and what was\n"
			"left out, lines of the lab. Latency percentiles of the moment need a daemon with --latency.",
		.examples = "  pursuit top\n"
					"  pursuit top --once\n"
					"  pursuit top --json | jq .now.displayed_hz\n",
		.rows = rows,
	};
	struct top top = {.timeline_from = NO_ROW, .rows_from = NO_ROW};
	struct error error = {""};
	int status;
	if (!args_parse(&args, argc, argv, &status))
		return status;
	if (control_open(&top.control, socket, &error) < 0)
		return args_failed(VERB, "%s", error.text);
	const bool live = !as_json && !just_once && isatty(STDOUT_FILENO);
	const int result = live ? watch(&top, interval_ms, &error) : once(&top, interval_ms, as_json, &error);
	top_view_finish(&top.view);
	control_close(&top.control);
	return result < 0 ? args_failed(VERB, "%s", error.text) : STATUS_DONE;
}
