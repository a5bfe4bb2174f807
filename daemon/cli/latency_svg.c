/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Plots of latency logs: for each span a histogram and, beside it, its course over time. */

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "latency_report.h"

#define LEFT 60
#define PLOT 400
#define GAP 80
#define HEIGHT 110
#define ROW 190
#define HEAD 70
#define BINS 100u
#define COLUMNS 200u

static const char *const colors[2] = {"#0072b2", "#d55e00"};

static void print_text(FILE *out, double x, double y, const char *attributes, const char *text)
{
	fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes);
	for (; *text; text++) {
		if (*text == '<' || *text == '&')
			fputs(*text == '<' ? "&lt;" : "&amp;", out);
		else
			fputc(*text, out);
	}
	fputs("</text>\n", out);
}

struct axis {
	double from, to;
};

static double place(const struct axis *axis, double value, double size)
{
	const double share = (value - axis->from) / (axis->to - axis->from);
	return (share < 0.0 ? 0.0 : share > 1.0 ? 1.0 : share) * size;
}

/*
 * From 0.2 to 99.8 % and a little more, so that one outlier does not make a needle of the rest; a class of the
 * histogram (0.8 %) more at least, or one value alone would lie outside.
 */
static struct axis axis_of(const struct latency_report *const reports[2], uint32_t span)
{
	struct axis axis = {0, 0};
	bool any = false;
	for (int i = 0; i < 2; i++) {
		const struct histogram *histogram = reports[i] ? &reports[i]->spans.histograms[span] : NULL;
		if (!histogram || histogram->count == 0)
			continue;
		const double from = histogram_percentile(histogram, 0.002), to = histogram_percentile(histogram, 0.998);
		axis.from = any && axis.from < from ? axis.from : from;
		axis.to = any && axis.to > to ? axis.to : to;
		any = true;
	}
	const double margin = (axis.to - axis.from) * 0.05 + fmax(100.0, 0.01 * fmax(fabs(axis.from), fabs(axis.to)));
	return (struct axis){axis.from - margin, axis.to + margin};
}

static void draw_frame(FILE *out, double x, double y, const struct axis *axis, bool vertical)
{
	fprintf(out, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#bbb\"/>\n", x, y, PLOT,
			HEIGHT);
	for (int i = 0; i <= 4; i++) {
		char label[48];
		const double value = axis->from + (axis->to - axis->from) * i / 4.0;
		snprintf(label, sizeof(label), axis->to - axis->from < 4e5 ? "%.4f" : "%.2f", value / 1e6);
		if (vertical)
			print_text(out, x - 4, y + HEIGHT - HEIGHT * i / 4.0 + 4, "text-anchor=\"end\" fill=\"#555\"", label);
		else
			print_text(out, x + PLOT * i / 4.0, y + HEIGHT + 14, "text-anchor=\"middle\" fill=\"#555\"", label);
	}
}

static void draw_histogram(FILE *out, double x, double y, const struct histogram *histogram, const struct axis *axis,
						   const char *color)
{
	uint64_t counts[BINS], most = 1;
	const double step = (axis->to - axis->from) / BINS;
	for (uint32_t i = 0; i < BINS; i++) {
		counts[i] = histogram_between(histogram, axis->from + step * i, axis->from + step * (i + 1));
		most = counts[i] > most ? counts[i] : most;
	}
	fprintf(out, "<path fill=\"%s\" fill-opacity=\"0.45\" stroke=\"%s\" d=\"M%.1f %.1f", color, color, x, y + HEIGHT);
	for (uint32_t i = 0; i < BINS; i++) {
		const double top = y + HEIGHT - (double)counts[i] / (double)most * (HEIGHT - 6);
		fprintf(out, "L%.1f %.1fL%.1f %.1f", x + PLOT * (double)i / BINS, top, x + PLOT * (i + 1.0) / BINS, top);
	}
	fprintf(out, "L%.1f %.1fZ\"/>\n", x + (double)PLOT, y + HEIGHT);
}

/* What span_of() gives, and the refresh, which takes two rows. */
static bool value_of(const struct points *rows, uint64_t index, uint32_t span, int64_t *value)
{
	const struct points *row = &rows[index], *before = index ? row - 1 : row;
	if (span != SPAN_REFRESH)
		return span_of(row, (enum span_kind)span, value);
	*value = (int64_t)(row->time[POINT_FLIP] - before->time[POINT_FLIP]);
	return row->vblank == before->vblank + 1 && point_known(row->time[POINT_FLIP]) &&
		   point_known(before->time[POINT_FLIP]);
}

/* Least and most of each column of time. */
static void draw_course(FILE *out, double x, double y, const struct latency_report *report, uint32_t span,
						const struct axis *axis, const char *color)
{
	const uint64_t rows = report->table.count, columns = rows < COLUMNS ? rows : COLUMNS;
	fprintf(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" d=\"", color);
	for (uint64_t column = 0; column < columns; column++) {
		double least = 0, most = 0;
		bool any = false;
		for (uint64_t i = column * rows / columns; i < (column + 1) * rows / columns; i++) {
			int64_t value;
			if (!value_of(report->table.rows, i, span, &value))
				continue;
			least = any && least < (double)value ? least : (double)value;
			most = any && most > (double)value ? most : (double)value;
			any = true;
		}
		const double at = x + PLOT * ((double)column + 0.5) / (double)columns;
		if (any)
			fprintf(out, "M%.1f %.1fV%.1f", at, y + HEIGHT - place(axis, least, HEIGHT) + 0.5,
					y + HEIGHT - place(axis, most, HEIGHT) - 0.5);
	}
	fputs("\"/>\n", out);
}

static void draw_span(FILE *out, double y, const struct latency_report *const reports[2], uint32_t span)
{
	const struct span_info *info = span_info((enum span_kind)span);
	const struct axis axis = axis_of(reports, span);
	char words[160];
	print_text(out, LEFT, y - 22, "font-weight=\"bold\"", info->name);
	print_text(out, LEFT + 150.0, y - 22, "fill=\"#555\"", info->help);
	draw_frame(out, LEFT, y, &axis, false);
	draw_frame(out, LEFT + PLOT + GAP, y, &axis, true);
	print_text(out, LEFT + PLOT + GAP, y + HEIGHT + 14, "fill=\"#555\"",
			   "over the time of the log; least to most of each moment");
	print_text(out, LEFT + PLOT + 26, y + HEIGHT + 14, "fill=\"#555\"", "ms");
	for (int i = 0; i < 2; i++) {
		const struct histogram *histogram = reports[i] ? &reports[i]->spans.histograms[span] : NULL;
		if (!histogram || histogram->count == 0)
			continue;
		draw_histogram(out, LEFT, y, histogram, &axis, colors[i]);
		draw_course(out, LEFT + PLOT + GAP, y, reports[i], span, &axis, colors[i]);
		snprintf(words, sizeof(words), "median %.4f, 99 %% %.4f, max %.4f ms (%" PRIu64 ")",
				 histogram_percentile(histogram, 0.5) / 1e6, histogram_percentile(histogram, 0.99) / 1e6,
				 (double)histogram->most / 1e6, histogram->count);
		print_text(out, LEFT + i * (PLOT + GAP), y - 6, i ? "fill=\"#d55e00\"" : "fill=\"#0072b2\"", words);
	}
}

static void draw_head(FILE *out, const struct latency_report *const reports[2])
{
	for (int i = 0; i < 2 && reports[i]; i++) {
		char words[400];
		snprintf(words, sizeof(words), "%.200s: %" PRIu64 " refreshes in %.1f s", reports[i]->name,
				 reports[i]->table.count, reports[i]->seconds);
		print_text(out, LEFT, 24 + 18.0 * i,
				   i ? "font-size=\"14\" fill=\"#d55e00\"" : "font-size=\"14\" fill=\"#0072b2\"", words);
	}
}

int latency_report_svg(const struct latency_report *a, const struct latency_report *b, const char *path,
					   struct error *error)
{
	const struct latency_report *const reports[2] = {a, b};
	uint32_t spans[SPANS], count = 0;
	FILE *out = fopen(path, "we");
	if (!out)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	for (uint32_t i = 0; i < SPANS; i++)
		if (a->spans.histograms[i].count || (b && b->spans.histograms[i].count))
			spans[count++] = i;
	fprintf(out,
			"<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%u\" font-family=\"sans-serif\" "
			"font-size=\"11\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
			LEFT + 2 * PLOT + GAP + 30, HEAD + count * ROW + 20);
	draw_head(out, reports);
	for (uint32_t i = 0; i < count; i++)
		draw_span(out, HEAD + 30.0 + (double)i * ROW, reports, spans[i]);
	fprintf(out, "</svg>\n");
	const bool wrong = ferror(out) != 0;
	if (fclose(out) != 0 || wrong)
		return error_set(error, -EIO, "%s: not written whole: %s", path, strerror(errno));
	return 0;
}
