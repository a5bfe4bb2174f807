/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "args.h"
#include "color.h"
#include "control.h"
#include "daemon/clock.h"
#include "json_out.h"
#include "latency_fetch.h"
#include "top_keys.h"
#include "top_screen.h"
#include "top_view.h"
#include "verbs.h"

#define VERB "top"
#define NO_ROW (UINT64_C(1) << 62)
#define PIPE_COLUMNS 1000u

struct top {
	struct control control;
	struct top_view view;
	uint64_t timeline_from, rows_from; /* numbers of the next rows */
	bool held;
	char message[256]; /* what the last key did */
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

/* What a key has changed is seen at once; the figures go on from round to round. */
static int ask_status(struct top *top, struct error *error)
{
	json_t *status = NULL;
	const int result = control_ask(&top->control, "status", -1, &status, error);
	if (result == 0)
		top_view_replace_status(&top->view, status);
	return result;
}

/* ---- the terminal ---- */

static void draw(struct top *top, struct top_screen *screen)
{
	char *text = NULL, help[256];
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		return;
	top_keys_describe(help, sizeof(help));
	top_view_print(&top->view, screen->columns, color_is_wanted(), out);
	top_view_print_line(screen->columns, top->message, out);
	top_view_print_line(screen->columns, top->held ? "held: space goes on, q quits" : "space hold  q quit", out);
	top_view_print_line(screen->columns, help, out);
	if (fclose(out) == 0)
		top_screen_draw(screen, text);
	free(text);
}

static int press(struct top *top, char key, struct error *error)
{
	if (key == ' ')
		top->held ^= true;
	if (top_keys_press(&top->control, top->view.status, key, top->message, sizeof(top->message)))
		return ask_status(top, error);
	return 0;
}

static uint64_t now_ms(void)
{
	return clock_monotonic_ns() / 1000000;
}

static int run_screen(struct top *top, struct top_screen *screen, uint32_t interval_ms, struct error *error)
{
	uint64_t next_ms = now_ms();
	int result = 0;
	while (result == 0) {
		char key = 0;
		const uint64_t now = now_ms();
		if (now >= next_ms) {
			next_ms = now + interval_ms;
			result = top->held ? 0 : ask_round(top, error);
		}
		if (result < 0)
			break;
		draw(top, screen);
		const enum top_event event = top_screen_wait(screen, (uint32_t)(next_ms - now), &key);
		if (event == TOP_OVER || (event == TOP_KEY && key == 'q'))
			break;
		if (event == TOP_KEY)
			result = press(top, key, error);
	}
	return result;
}

static int watch(struct top *top, uint32_t interval_ms, struct error *error)
{
	struct top_screen screen;
	int result = top_screen_open(&screen, error);
	if (result == 0)
		result = run_screen(top, &screen, interval_ms, error);
	top_screen_close(&screen);
	return result;
}

/* ---- the verb ---- */

static unsigned columns_of_terminal(void)
{
	struct winsize size;
	return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : PIPE_COLUMNS;
}

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
		top_view_print(&top->view, columns_of_terminal(), color_is_wanted(), stdout);
		return 0;
	}
	json_t *json = top_view_json(&top->view);
	const bool whole = json_print(json);
	json_decref(json);
	return whole ? 0 : error_set(error, -ENOMEM, "out of memory");
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
			"Shows live what the running daemon does: rates, phase, latency and its course, the governor, what ran "
			"and\n"
			"what was left out, drops, lines of the lab. Keys change method, blur, boost, motion model, governor and\n"
			"level from the next real frame on, as `pursuit set` does; u takes all of it back. Only lines that "
			"changed\n"
			"are sent, and no faster than the terminal shows them. Latency percentiles of the moment need a daemon\n"
			"with --latency; without, they are those since its start.",
		.examples = "  pursuit top\n"
					"  pursuit top --once\n"
					"  ssh lab-machine -t pursuit top --interval-ms 2000\n"
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
