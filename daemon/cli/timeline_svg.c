/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "timeline.h"

#define LEFT 130
#define WIDTH 1200
#define PER_STRIP 60u
#define CELL (WIDTH / (int)PER_STRIP)
#define STRIP_HEIGHT 150
#define LANE_HEIGHT 26
#define MARGIN_HEIGHT 70
#define OVERVIEW_HEIGHT 96
#define HEAD 92

static const char *const colors[TIMELINE_SHOWS] = {"#1f4e8c", "#8db8e8", "#c9c9c9", "#e69f00", "#c0392b"};
static const char *const legends[TIMELINE_SHOWS] = {"real frame", "in-between", "repeat, as intended",
													"plain: its in-between was late", "late: the old picture stayed"};

static double margin_ms(const struct timeline_row *row)
{
	return ((double)(int64_t)(row->target_ns - row->ready_ns)) / 1e6;
}

static bool is_late(const struct timeline_row *row)
{
	return row->show == TIMELINE_STANDBY || row->show == TIMELINE_KEPT;
}

static void text(FILE *out, double x, double y, const char *style, const char *words)
{
	fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, style);
	for (; *words; words++) {
		if (*words == '<' || *words == '&')
			fputs(*words == '<' ? "&lt;" : "&amp;", out);
		else
			fputc(*words, out);
	}
	fputs("</text>\n", out);
}

static void box(FILE *out, double x, double y, double width, double height, const char *color)
{
	fprintf(out, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\"/>\n", x, y, width, height,
			color);
}

static void draw_head(FILE *out, const struct timeline *timeline, const struct timeline_drawing *drawing)
{
	uint32_t counts[TIMELINE_SHOWS] = {0};
	char words[128];
	for (uint32_t i = 0; i < timeline->count; i++)
		counts[timeline->rows[i].show]++;
	text(out, 20, 30, "font-size=\"18\" font-weight=\"bold\"", drawing->title);
	double x = 20;
	for (unsigned i = 0; i < TIMELINE_SHOWS; i++) {
		snprintf(words, sizeof(words), "%s (%u)", legends[i], counts[i]);
		box(out, x, 48, 14, 14, colors[i]);
		text(out, x + 20, 60, "", words);
		x += 60 + 7.2 * (double)strlen(words);
	}
	snprintf(words, sizeof(words), "counted over the last %u vblanks (%.1f s)", timeline->count,
			 timeline->count / drawing->refresh_hz);
	text(out, 20, 82, "fill=\"#666\"", words);
}

/* Grey lines with their milliseconds; gives the height of a millisecond. */
static double draw_scale(FILE *out, double y, double height, double most_ms)
{
	static const double steps[] = {1, 2, 5, 10, 20, 50, 100, 200, 500};
	double step = steps[0];
	for (unsigned i = 0; i < 9 && most_ms / step > 4; i++)
		step = steps[i];
	for (double ms = 0; ms <= most_ms; ms += step) {
		char words[32];
		double at = y + height - ms / most_ms * height;
		fprintf(out, "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"#ddd\"/>\n", LEFT, at, LEFT + WIDTH,
				at);
		snprintf(words, sizeof(words), "%.0f ms", ms);
		text(out, LEFT - 6, at + 4, "text-anchor=\"end\" fill=\"#666\"", words);
	}
	return height / most_ms;
}

static double largest_margin(const struct timeline *timeline, uint32_t first, uint32_t count)
{
	double most = 4;
	for (uint32_t i = first; i < first + count; i++) {
		const struct timeline_row *row = &timeline->rows[i];
		if (row->ready_ns && margin_ms(row) > most)
			most = margin_ms(row);
	}
	return most < 60 ? most : 60;
}

/* One column for some vblanks: the least margin among them, and whether one was late. */
static void draw_overview(FILE *out, const struct timeline *timeline, double y)
{
	double most = largest_margin(timeline, 0, timeline->count);
	text(out, 20, y + 16, "fill=\"#444\"", "all vblanks");
	double scale = draw_scale(out, y, OVERVIEW_HEIGHT - 30, most);
	uint32_t columns = timeline->count < WIDTH ? timeline->count : WIDTH;
	double width = (double)WIDTH / (columns ? columns : 1);
	for (uint32_t column = 0; column < columns; column++) {
		uint32_t from = (uint32_t)((uint64_t)column * timeline->count / columns);
		uint32_t to = (uint32_t)((uint64_t)(column + 1) * timeline->count / columns);
		double least = most;
		bool late = false, known = false;
		for (uint32_t i = from; i < to; i++) {
			const struct timeline_row *row = &timeline->rows[i];
			late |= is_late(row);
			known |= row->ready_ns != 0;
			if (row->ready_ns && margin_ms(row) < least)
				least = margin_ms(row);
		}
		double height = (least > 0 && known ? least : 0) * scale;
		box(out, LEFT + column * width, y + OVERVIEW_HEIGHT - 30 - height, width, height, "#8db8e8");
		if (late)
			box(out, LEFT + column * width, y + OVERVIEW_HEIGHT - 26, width > 1.5 ? width : 1.5, 10, "#e69f00");
	}
	text(out, LEFT, y + OVERVIEW_HEIGHT + 4, "fill=\"#666\"",
		 "how long before its vblank the latest picture of each moment was ready; marks below: a late one");
}

static void draw_cell(FILE *out, const struct timeline_row *row, const struct timeline_row *before, double x, double y)
{
	char words[48];
	box(out, x + 0.5, y, CELL - 1, LANE_HEIGHT, colors[row->show]);
	if (row->show == TIMELINE_REAL || row->show == TIMELINE_IN_BETWEEN) {
		snprintf(words, sizeof(words), "%.2f", row->phase);
		text(out, x + CELL / 2.0, y + 17,
			 row->show == TIMELINE_REAL ? "font-size=\"8\" text-anchor=\"middle\" fill=\"white\""
										: "font-size=\"8\" text-anchor=\"middle\" fill=\"#123\"",
			 words);
	}
	if (before && before->frame_id == row->frame_id)
		return;
	snprintf(words, sizeof(words), "%" PRIu64, row->frame_id);
	fprintf(out, "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#444\"/>\n", x, y - 14, x,
			y + LANE_HEIGHT);
	text(out, x + 3, y - 4, "font-size=\"9\" fill=\"#444\"", words);
}

static void draw_margin(FILE *out, const struct timeline_row *row, double x, double zero, double scale)
{
	if (!row->ready_ns || row->show == TIMELINE_REPEAT || row->show == TIMELINE_KEPT)
		return;
	double margin = margin_ms(row), height = (margin > 0 ? margin : -margin) * scale;
	if (height > MARGIN_HEIGHT)
		height = MARGIN_HEIGHT;
	box(out, x + 4, margin > 0 ? zero - height : zero, CELL - 8, height, margin > 0 ? colors[row->show] : "#c0392b");
}

static void draw_strip(FILE *out, const struct timeline *timeline, uint32_t first, uint32_t count, double y,
					   double most)
{
	double zero = y + 30 + LANE_HEIGHT + 12 + MARGIN_HEIGHT;
	char words[64];
	text(out, 20, y + 11, "fill=\"#444\"", "real frame");
	text(out, 20, y + 32, "fill=\"#444\"", "shown, phase");
	text(out, 20, y + 54, "fill=\"#444\"", "ready before");
	double scale = draw_scale(out, zero - MARGIN_HEIGHT, MARGIN_HEIGHT, most);
	for (uint32_t i = 0; i < count; i++) {
		const struct timeline_row *row = &timeline->rows[first + i];
		double x = LEFT + (double)i * CELL;
		draw_cell(out, row, i ? row - 1 : NULL, x, y + 15);
		draw_margin(out, row, x, zero, scale);
		if (i % 6)
			continue;
		snprintf(words, sizeof(words), "%.1f", (double)(row->target_ns - timeline->rows[0].target_ns) / 1e6);
		text(out, x, zero + 13, "font-size=\"9\" fill=\"#666\"", words);
	}
	text(out, LEFT + (double)count * CELL + 6, zero + 13, "font-size=\"9\" fill=\"#666\"", "ms");
}

int timeline_write_svg(const struct timeline *timeline, const struct timeline_drawing *drawing, const char *path,
					   struct error *error)
{
	FILE *out = fopen(path, "w");
	if (!out)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	uint32_t strips = (drawing->detail_count + PER_STRIP - 1) / PER_STRIP;
	double height = HEAD + OVERVIEW_HEIGHT + 40 + strips * (STRIP_HEIGHT + 20.0);
	fprintf(out,
			"<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" font-family=\"sans-serif\" "
			"font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
			LEFT + WIDTH + 40, height);
	draw_head(out, timeline, drawing);
	draw_overview(out, timeline, HEAD + 10);
	double most = largest_margin(timeline, drawing->detail_first, drawing->detail_count);
	for (uint32_t i = 0; i < strips; i++) {
		uint32_t first = drawing->detail_first + i * PER_STRIP;
		uint32_t left = drawing->detail_first + drawing->detail_count - first;
		draw_strip(out, timeline, first, left < PER_STRIP ? left : PER_STRIP,
				   HEAD + OVERVIEW_HEIGHT + 40 + i * (STRIP_HEIGHT + 20.0), most);
	}
	fprintf(out, "</svg>\n");
	bool wrong = ferror(out) != 0;
	if (fclose(out) != 0 || wrong)
		return error_set(error, -EIO, "%s: not written whole: %s", path, strerror(errno));
	return 0;
}
