/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "top_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/lab/spans.h"

#define UNKNOWN ((double)NAN)

static const struct {
	const char *name, *label;
	int digits;
} figures[TOP_FIGURES] = {
	[TOP_DISPLAYED_HZ] = {"displayed_hz", "displayed Hz", 1},
	[TOP_REAL_HZ] = {"real_hz", "real Hz", 1},
	[TOP_ON_TIME] = {"on_time_percent", "on time %", 1},
	[TOP_PHASE] = {"phase", "phase, mean", 2},
	[TOP_READY_BEFORE] = {"ready_before_ms", "ready before, ms", 2},
	[TOP_SUBMIT_TO_FLIP] = {"submit_to_flip_ms", "submit to flip, ms", 2},
	[TOP_SUBMIT_TO_FLIP_99] = {"submit_to_flip_p99_ms", "  99 %", 2},
	[TOP_ENGINE] = {"engine_ms", "engine, ms", 2},
	[TOP_ENGINE_99] = {"engine_p99_ms", "  99 %", 2},
	[TOP_FLIP_TO_EDGE] = {"flip_to_edge_us", "flip to edge, us", 1},
	[TOP_FLIP_TO_EDGE_99] = {"flip_to_edge_p99_us", "  99 %", 1},
	[TOP_FLIP_TO_PHOTON] = {"flip_to_photon_ms", "flip to photon, ms", 2},
};

/* ---- figures ---- */

static uint64_t number(const json_t *row, size_t index)
{
	return (uint64_t)json_integer_value(json_array_get(row, index));
}

/* Rows are [vblank, target, ready, flip, frame_id, show, phase]. */
static void add_timeline(const json_t *rows, double now[TOP_FIGURES])
{
	const size_t count = json_array_size(rows);
	uint64_t shown = 0, real = 0, missed = 0, ready = 0;
	double phases = 0, margins = 0;
	for (size_t i = 0; i < count; i++) {
		const json_t *row = json_array_get(rows, i);
		const char *show = json_string_value(json_array_get(row, 5));
		const bool is_real = show && strcmp(show, "real") == 0, between = show && strcmp(show, "in-between") == 0;
		real += is_real;
		shown += is_real || between;
		missed += show && (strcmp(show, "standby") == 0 || strcmp(show, "kept") == 0);
		if (between)
			phases += json_number_value(json_array_get(row, 6));
		if ((is_real || between) && number(row, 2) != 0) {
			margins += (double)(int64_t)(number(row, 1) - number(row, 2)) / 1e6;
			ready++;
		}
	}
	if (count < 2)
		return;
	const double span = (double)(number(json_array_get(rows, count - 1), 1) - number(json_array_get(rows, 0), 1));
	const double refresh = (double)(number(json_array_get(rows, count - 1), 0) - number(json_array_get(rows, 0), 0));
	const double seconds = span / 1e9 * (refresh + 1.0) / (refresh > 0.0 ? refresh : 1.0);
	now[TOP_DISPLAYED_HZ] = seconds > 0.0 ? (double)shown / seconds : UNKNOWN;
	now[TOP_REAL_HZ] = seconds > 0.0 ? (double)real / seconds : UNKNOWN;
	now[TOP_ON_TIME] = 100.0 - 100.0 * (double)missed / (double)count;
	now[TOP_PHASE] = shown > real ? phases / (double)(shown - real) : UNKNOWN;
	now[TOP_READY_BEFORE] = ready ? margins / (double)ready : UNKNOWN;
}

static double percentile(const struct spans *spans, enum span_kind kind, double share, double unit)
{
	const struct histogram *histogram = &spans->histograms[kind];
	return histogram->count ? histogram_percentile(histogram, share) / unit : UNKNOWN;
}

static void add_rows(const struct latency_table *rows, double now[TOP_FIGURES])
{
	struct spans *spans = calloc(1, sizeof(*spans));
	if (!spans)
		return;
	for (uint64_t i = 0; i < rows->count; i++)
		spans_add(spans, &rows->rows[i]);
	now[TOP_SUBMIT_TO_FLIP] = percentile(spans, SPAN_SUBMIT_TO_FLIP, 0.5, 1e6);
	now[TOP_SUBMIT_TO_FLIP_99] = percentile(spans, SPAN_SUBMIT_TO_FLIP, 0.99, 1e6);
	now[TOP_FLIP_TO_EDGE] = percentile(spans, SPAN_FLIP_TO_EDGE, 0.5, 1e3);
	now[TOP_FLIP_TO_EDGE_99] = percentile(spans, SPAN_FLIP_TO_EDGE, 0.99, 1e3);
	now[TOP_FLIP_TO_PHOTON] = percentile(spans, SPAN_FLIP_TO_PHOTON, 0.5, 1e6);
	free(spans);
}

static double member(const json_t *status, const char *name, const char *share)
{
	const json_t *value = json_object_get(json_object_get(status, name), share);
	const double number = json_number_value(value);
	return number > 0.0 ? number : UNKNOWN;
}

/* Percentiles since the daemon's start, where the lab does not tell those of the moment. */
static void add_status(const json_t *status, double now[TOP_FIGURES])
{
	now[TOP_ENGINE] = member(status, "engine_ms", "p50");
	now[TOP_ENGINE_99] = member(status, "engine_ms", "p99");
	if (json_is_object(json_object_get(status, "lab")))
		return;
	now[TOP_SUBMIT_TO_FLIP] = member(status, "submit_to_flip_ms", "p50");
	now[TOP_SUBMIT_TO_FLIP_99] = member(status, "submit_to_flip_ms", "p99");
}

void top_view_add(struct top_view *view, json_t *status, const json_t *timeline, const struct latency_table *rows)
{
	double now[TOP_FIGURES];
	for (uint32_t i = 0; i < TOP_FIGURES; i++)
		now[i] = NAN;
	add_timeline(json_object_get(timeline, "rows"), now);
	add_rows(rows, now);
	add_status(status, now);
	for (uint32_t i = 0; i < TOP_FIGURES; i++) {
		if (view->rounds == 0)
			for (uint32_t j = 0; j < TOP_TREND; j++)
				view->trend[i][j] = NAN;
		memmove(&view->trend[i][0], &view->trend[i][1], (TOP_TREND - 1) * sizeof(double));
		view->trend[i][TOP_TREND - 1] = now[i];
	}
	json_decref(view->before);
	view->before = view->status;
	view->status = status;
	view->rounds++;
}

void top_view_replace_status(struct top_view *view, json_t *status)
{
	json_decref(view->status);
	view->status = status;
}

void top_view_finish(struct top_view *view)
{
	json_decref(view->status);
	json_decref(view->before);
	view->status = view->before = NULL;
}

json_t *top_view_json(const struct top_view *view)
{
	json_t *now = json_object();
	for (uint32_t i = 0; i < TOP_FIGURES; i++) {
		const double value = view->trend[i][TOP_TREND - 1];
		json_object_set_new(now, figures[i].name, isnan(value) ? json_null() : json_real(round(value * 1e3) / 1e3));
	}
	return json_pack("{s:o, s:O}", "now", now, "status", view->status);
}

/* ---- text ---- */

struct page {
	FILE *out;
	unsigned columns;
	bool color;
};

/* Names come from clients: nothing that a terminal would obey. Cut to the width. */
static void print_cut(const struct page *page, const char *text)
{
	unsigned column = 0;
	for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
		const bool continues = (*c & 0xc0) == 0x80;
		if (!continues && column++ >= page->columns)
			break;
		fputc(*c < 0x20 || *c == 0x7f ? '?' : *c, page->out);
	}
}

static void print_line(const struct page *page, const char *text)
{
	print_cut(page, text);
	fputc('\n', page->out);
}

static void print_title(const struct page *page, const char *text)
{
	if (page->color)
		fputs("\033[1m", page->out);
	print_cut(page, text);
	fputs(page->color ? "\033[0m\n" : "\n", page->out);
}

/* Each character a round; the height is between least and most of what is shown. */
static void spark(const double *values, uint32_t count, char *text)
{
	static const char *const blocks[] = {"\u2581", "\u2582", "\u2583", "\u2584",
										 "\u2585", "\u2586", "\u2587", "\u2588"};
	double least = INFINITY, most = -INFINITY;
	for (uint32_t i = 0; i < count; i++) {
		least = fmin(least, values[i]);
		most = fmax(most, values[i]);
	}
	for (uint32_t i = 0; i < count; i++) {
		const double share = most > least ? (values[i] - least) / (most - least) : 0.5;
		const char *block = isnan(values[i]) ? " " : blocks[(int)(share * 7.0 + 0.5)];
		memcpy(text, block, strlen(block));
		text += strlen(block);
	}
	*text = '\0';
}

static void print_figures(const struct page *page, const struct top_view *view)
{
	for (uint32_t i = 0; i < TOP_FIGURES; i++) {
		const double *trend = view->trend[i];
		char value[24], line[400], course[TOP_TREND * 3 + 1];
		bool any = false;
		for (uint32_t j = 0; j < TOP_TREND; j++)
			any |= !isnan(trend[j]);
		if (!any)
			continue;
		snprintf(value, sizeof(value), "-");
		if (!isnan(trend[TOP_TREND - 1]))
			snprintf(value, sizeof(value), "%.*f", figures[i].digits, trend[TOP_TREND - 1]);
		spark(trend, TOP_TREND, course);
		snprintf(line, sizeof(line), "  %-20s %9s  %s", figures[i].label, value, course);
		print_line(page, line);
	}
}

static const char *text_of(const json_t *object, const char *name)
{
	const char *text = json_string_value(json_object_get(object, name));
	return text ? text : "";
}

static long long count_of(const json_t *object, const char *name)
{
	return (long long)json_integer_value(json_object_get(object, name));
}

static void print_head(const struct page *page, const json_t *status)
{
	char line[512];
	snprintf(line, sizeof(line), "pursuitd %s  up %.0f s  method %s  %.2f Hz  %s (%s)  %s", text_of(status, "version"),
			 json_number_value(json_object_get(status, "uptime")), text_of(status, "method"),
			 json_number_value(json_object_get(status, "refresh")), text_of(status, "presenter"),
			 text_of(status, "flip_time_source"), text_of(status, "renderer"));
	print_title(page, line);
}

/* What a stream is displayed at: only the one that is shown is. */
static void describe_displayed(const struct top_view *view, const json_t *stream, char *text, size_t size)
{
	const double hz = view->trend[TOP_DISPLAYED_HZ][TOP_TREND - 1];
	if (!json_is_true(json_object_get(stream, "shown")))
		snprintf(text, size, "-");
	else if (isnan(hz))
		snprintf(text, size, "?");
	else
		snprintf(text, size, "%.2f", hz);
}

static void print_streams(const struct page *page, const struct top_view *view)
{
	const json_t *streams = json_object_get(view->status, "streams");
	char line[512], displayed[32];
	if (json_array_size(streams) == 0) {
		print_line(page, "  no stream");
		return;
	}
	print_title(page,
				"  stream                     size  real Hz  displayed     frames     lost  refused  application");
	for (size_t i = 0; i < json_array_size(streams); i++) {
		const json_t *stream = json_array_get(streams, i);
		describe_displayed(view, stream, displayed, sizeof(displayed));
		snprintf(line, sizeof(line), "%c %-20.20s %5lldx%-5lld %7.2f %10s %10lld %8lld %8lld  %.64s",
				 json_is_true(json_object_get(stream, "shown")) ? '>' : ' ', text_of(stream, "client"),
				 count_of(stream, "width"), count_of(stream, "height"),
				 json_number_value(json_object_get(stream, "fps")), displayed, count_of(stream, "real_frames"),
				 count_of(stream, "lost_real_frames"), count_of(stream, "refused_frames"),
				 text_of(stream, "application"));
		print_line(page, line);
	}
}

/* "  passes  analyse 60/s, warp 120/s": since the round before; in the first, all. */
static void print_counts(const struct page *page, const char *title, const struct top_view *view,
						 const char *member_name)
{
	const double seconds = json_number_value(json_object_get(view->status, "uptime")) -
						   json_number_value(json_object_get(view->before, "uptime"));
	const json_t *before = json_object_get(view->before, member_name);
	json_t *counts = json_incref(json_object_get(view->status, member_name)), *value;
	char line[1024];
	size_t used = (size_t)snprintf(line, sizeof(line), "  %-10s", title);
	const char *separator = "", *name;
	json_object_foreach(counts, name, value)
	{
		const long long count = (long long)json_integer_value(value) - count_of(before, name);
		if (count == 0 || used >= sizeof(line))
			continue;
		if (view->before && seconds > 0.0)
			used += (size_t)snprintf(line + used, sizeof(line) - used, "%s%.40s %.0f/s", separator, name,
									 (double)count / seconds);
		else
			used += (size_t)snprintf(line + used, sizeof(line) - used, "%s%.40s %lld", separator, name, count);
		separator = ", ";
	}
	json_decref(counts);
	print_line(page, line);
}

static void print_governor(const struct page *page, const json_t *status)
{
	const json_t *governor = json_object_get(status, "governor"), *settings = json_object_get(status, "settings");
	char line[256];
	snprintf(line, sizeof(line), "  governor  %s, level %lld (%s), load %.2f; raised %lld, lowered %lld",
			 text_of(settings, "governor"), count_of(governor, "level"), text_of(governor, "name"),
			 json_number_value(json_object_get(governor, "load")), count_of(governor, "raised"),
			 count_of(governor, "lowered"));
	print_line(page, line);
}

/* Those that keys change, and where they come from. */
static void print_settings(const struct page *page, const json_t *status)
{
	static const char *const names[] = {"blur", "compensation", "motion-model", "cell"};
	const json_t *settings = json_object_get(status, "settings"), *from = json_object_get(status, "configuration");
	char line[1024];
	size_t used = (size_t)snprintf(line, sizeof(line), "  settings ");
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
		used += (size_t)snprintf(line + used, sizeof(line) - used, "%s%s %.32s", i ? ", " : " ", names[i],
								 text_of(settings, names[i]));
	if (*text_of(status, "profile"))
		used += (size_t)snprintf(line + used, sizeof(line) - used, "; profile of %.64s", text_of(status, "profile"));
	for (size_t i = 0; i < json_array_size(json_object_get(from, "asked")) && used < sizeof(line); i++)
		used +=
			(size_t)snprintf(line + used, sizeof(line) - used, "%s%.32s",
							 i ? " " : "; set: ", json_string_value(json_array_get(json_object_get(from, "asked"), i)));
	print_line(page, line);
	if (!*text_of(from, "mistake"))
		return;
	snprintf(line, sizeof(line), "  mistake   %.400s", text_of(from, "mistake"));
	print_line(page, line);
}

static void print_totals(const struct page *page, const struct top_view *view)
{
	const json_t *status = view->status;
	char line[256];
	snprintf(line, sizeof(line), "  shown     real %lld, in-between %lld, repeated %lld, standby %lld",
			 count_of(status, "real_frames"), count_of(status, "in_between_frames"),
			 count_of(status, "repeated_frames"), count_of(status, "standby_frames"));
	print_line(page, line);
	snprintf(line, sizeof(line), "  missed    in-betweens late %lld, real frames late %lld, lost %lld; flips late %lld",
			 count_of(status, "late_in_betweens"), count_of(status, "late_real_frames"),
			 count_of(status, "lost_real_frames"), count_of(status, "late_flips"));
	print_line(page, line);
	print_counts(page, "passes", view, "passes");
	print_counts(page, "left out", view, "left_out");
}

static void print_lab(const struct page *page, const json_t *lab)
{
	static const char *const lines[] = {"marker", "strobe", "photodiode", "trigger", "vsync"};
	char line[400];
	if (!json_is_object(lab)) {
		print_line(page, "  lab       off: no GPIO line, no time points (pursuitd --gpio-line, --latency)");
		return;
	}
	snprintf(line, sizeof(line), "  lab       %s; edges %lld, lost %lld; photons lost %lld, stray %lld; log %lld rows",
			 json_is_true(json_object_get(lab, "realtime")) ? "real-time" : "NOT real-time", count_of(lab, "edges"),
			 count_of(lab, "lost_edges"), count_of(lab, "lost_photons"), count_of(lab, "stray_photons"),
			 count_of(lab, "log_rows"));
	print_line(page, line);
	for (size_t i = 0; i < sizeof(lines) / sizeof(lines[0]); i++) {
		const json_t *state = json_object_get(lab, lines[i]);
		if (!json_is_object(state))
			continue;
		snprintf(line, sizeof(line), "  %-9s %s%.300s", lines[i],
				 json_is_true(json_object_get(state, "there")) ? "" : "MISSING: ", text_of(state, "text"));
		print_line(page, line);
	}
}

void top_view_print(const struct top_view *view, unsigned columns, bool color, FILE *out)
{
	const struct page page = {out, columns, color};
	print_head(&page, view->status);
	print_streams(&page, view);
	print_figures(&page, view);
	print_totals(&page, view);
	print_governor(&page, view->status);
	print_settings(&page, view->status);
	print_lab(&page, json_object_get(view->status, "lab"));
}

void top_view_print_line(unsigned columns, const char *text, FILE *out)
{
	const struct page page = {out, columns, false};
	print_line(&page, text);
}
