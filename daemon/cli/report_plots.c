/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The plots, drawn by gnuplot: DIR/plots/NAME.gp is script and data in one,
 * and can be run again by hand; NAME.svg is what it draws.
 */

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "report_cost.h"
#include "report_overall.h"

/* Told apart by people with any colour vision (Okabe and Ito 2008), and by shape. */
static const char *const colors[] = {"#000000", "#e69f00", "#56b4e9", "#009e73", "#b8a800",
									 "#0072b2", "#d55e00", "#cc79a7", "#7a4a2b", "#888888"};
#define COLORS (sizeof(colors) / sizeof(*colors))

struct plot {
	FILE *script;
	char path[4096]; /* without .gp */
};

static bool plot_open(struct plot *plot, const struct report *report, const char *name, uint32_t width, uint32_t height)
{
	char path[4128];
	snprintf(plot->path, sizeof(plot->path), "%s/plots/%s", report->options.out, name);
	snprintf(path, sizeof(path), "%s.gp", plot->path);
	plot->script = fopen(path, "we");
	if (!plot->script)
		return false;
	fprintf(plot->script,
			"set terminal svg size %u,%u font 'Helvetica,Arial,sans-serif,14' background '#ffffff'\n"
			"set output '%s.svg'\nset grid linecolor '#dddddd'\nset border 3\nset tics nomirror\n"
			"set key outside right top vertical maxcols 1 samplen 1.5 noenhanced\n",
			width, height, name);
	return true;
}

/* With names of files, which may be anything, and a script can do anything: within '' only ' has a meaning. */
static void put_title(FILE *script, const char *title)
{
	fputs("set title '", script);
	for (; *title; title++)
		fputs(*title == '\'' ? "''" : (const char[]){*title, '\0'}, script);
	fputs("' noenhanced\n", script);
}

/* Runs gnuplot in the folder of the plots. False: it could not, or did not like the script. */
static bool plot_close(struct plot *plot, const struct report *report)
{
	char folder[4096], file[256];
	posix_spawn_file_actions_t actions;
	pid_t child;
	int status = 1;
	fclose(plot->script);
	snprintf(folder, sizeof(folder), "%s/plots", report->options.out);
	snprintf(file, sizeof(file), "%s.gp", strrchr(plot->path, '/') + 1);
	char *arguments[] = {(char[]){"gnuplot"}, file, NULL};
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_addchdir_np(&actions, folder);
	/* Its warnings (of curves that are flat) say nothing to who made no plot. */
	posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "gnuplot.log", O_WRONLY | O_CREAT | O_APPEND, 0666);
	const int failed = posix_spawnp(&child, arguments[0], &actions, NULL, arguments, environ);
	posix_spawn_file_actions_destroy(&actions);
	if (failed)
		return false;
	while (waitpid(child, &status, 0) < 0 && errno == EINTR)
		;
	return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/* ---- methods: the plain variants, in the order of the engine's list ---- */

static uint32_t color_of(const struct report *report, const struct report_variant *variant)
{
	uint32_t color = 0;
	for (const struct report_variant *one = report->variants; one < variant; one++)
		color += one->plain && strcmp(one->method, variant->method) != 0;
	return color % COLORS;
}

static const struct report_variant *plain_variant(const struct report *report, const struct report_variant *variant)
{
	for (uint32_t i = 0; i < report->variant_count; i++) {
		if (report->variants[i].plain && strcmp(report->variants[i].method, variant->method) == 0)
			return &report->variants[i];
	}
	return variant;
}

/* ---- error against run time ---- */

static int compare_points(const void *a, const void *b)
{
	const struct report_point *left = a, *right = b;
	return left->ms < right->ms ? -1 : left->ms > right->ms;
}

static void write_front(FILE *script, struct report_point *points, uint32_t count)
{
	double least = (double)INFINITY;
	qsort(points, count, sizeof(*points), compare_points);
	fprintf(script, "$front << EOD\n");
	for (uint32_t i = 0; i < count; i++) {
		if (points[i].error >= least)
			continue;
		least = points[i].error;
		fprintf(script, "%g %g\n", points[i].ms, points[i].error);
	}
	fprintf(script, "EOD\n");
}

/* Where the others have their places; one that is four times as bad as the next would press all of them together. */
static double highest_shown(const struct report_point *points, uint32_t count)
{
	double most = 0.0, second = 0.0;
	for (uint32_t i = 0; i < count; i++) {
		second = fmax(second, fmin(most, points[i].error));
		most = fmax(most, points[i].error);
	}
	return second > 0.0 && most > 4.0 * second ? 2.0 * second : (double)INFINITY;
}

/* A setting of a method has the method's colour and a mark of its own. */
static uint32_t mark_of(const struct report *report, const struct report_variant *variant)
{
	static const uint32_t marks[] = {1, 2, 3, 14, 15};
	const uint32_t distance = (uint32_t)(variant - plain_variant(report, variant));
	return marks[(distance + 4) % 5];
}

static void write_points(const struct report *report, FILE *script, const struct report_point *points, uint32_t count)
{
	const double highest = highest_shown(points, count);
	for (uint32_t i = 0; i < count; i++)
		fprintf(script, "$p%u << EOD\n%g %g %g %g\nEOD\n", i, points[i].ms, points[i].ms_low, points[i].ms_high,
				points[i].error);
	if (isfinite(highest))
		fprintf(script, "set yrange [*:%g]\n", highest);
	fprintf(script, "plot $front using 1:2 with steps linewidth 2 linecolor '#bbbbbb' title 'Pareto front'");
	for (uint32_t i = 0; i < count; i++) {
		const struct report_variant *variant = points[i].variant;
		const uint32_t color = color_of(report, plain_variant(report, variant));
		fprintf(
			script,
			", \\\n $p%u using 1:4:2:3 with xerrorbars linecolor '%s' pointtype %u pointsize %s linewidth %s title '%s",
			i, colors[color], variant->plain ? 4 + color % 10 : mark_of(report, variant),
			variant->plain ? "1.2" : "0.8", variant->plain ? "1.6" : "1",
			variant->plain ? variant->method : variant->setting);
		fprintf(script, points[i].error > highest ? " (%.1f, above)'" : "'", points[i].error);
	}
}

/* What the display itself leaves, as a line. */
static void write_rendered(const struct report *report, const struct report_work *work, FILE *script)
{
	const struct report_variant *last = &report->variants[report->variant_count - 1];
	const struct report_row *row = work ? report_find_row(report, work, last) : NULL;
	const double error = row    ? score_value(&row->score, SCORE_PERCEIVED_ERROR)
						 : work ? (double)NAN
								: report_mean(report, last, SCORE_PERCEIVED_ERROR);
	if (!last->engine && error > 0.0)
		fprintf(script, ", \\\n %g with lines dashtype 2 linecolor '#555555' title 'every frame rendered'", error);
}

static bool plot_pareto(const struct report *report, const struct report_work *work, const char *name,
						const char *title)
{
	struct plot plot;
	struct report_point *points = calloc(report->variant_count + 1u, sizeof(*points));
	uint32_t all = points ? report_points(report, work, points) : 0, count = 0;
	bool drawn = true;
	for (uint32_t i = 0; i < all; i++) { /* the axes are logarithmic: what has no error has no place */
		if (points[i].error > 0.0 && points[i].ms_low > 0.0)
			points[count++] = points[i];
	}
	if (count > 0 && plot_open(&plot, report, name, work ? 560 : 900, work ? 430 : 520)) {
		put_title(plot.script, title);
		fprintf(plot.script,
				"set logscale xy\nset xlabel 'engine, ms a displayed frame "
				"(median, middle half)'\nset ylabel '%s'\nset yrange [*:*]\nset key font ',11'\n",
				work && work->recording ? "root mean square error, code values" : "perceived error, code values");
		write_front(plot.script, points, count);
		write_points(report, plot.script, points, count);
		write_rendered(report, work, plot.script);
		fputc('\n', plot.script);
		drawn = plot_close(&plot, report);
	}
	free(points);
	return drawn;
}

/* ---- error over time, error against speed ---- */

/* A scene is looked at in a few short pieces; the time between them is left out, but for a gap of 20 ms. */
struct pieces {
	uint32_t count;
	double start[8], x[8]; /* s; ms on the axis */
};

static double series_at(const json_t *series, size_t i, size_t column)
{
	return json_number_value(json_array_get(json_array_get(series, i), column));
}

static void find_pieces(struct pieces *pieces, const json_t *series)
{
	double last = -(double)INFINITY, x = -20.0;
	*pieces = (struct pieces){0};
	for (size_t i = 0; i < json_array_size(series) && pieces->count < 8; i++) {
		const double time = series_at(series, i, 0);
		if (time - last > 0.5) {
			pieces->start[pieces->count] = time;
			pieces->x[pieces->count++] = x += 20.0;
		} else {
			x += 1e3 * (time - last);
		}
		last = time;
	}
}

/* A late method's pieces begin a little elsewhere than those of the others. */
static uint32_t piece_of(const struct pieces *pieces, double time)
{
	uint32_t piece = 0;
	while (piece + 1 < pieces->count && time > pieces->start[piece + 1] - 0.25)
		piece++;
	return piece;
}

static void write_series(FILE *script, uint32_t index, const struct pieces *pieces, const json_t *series)
{
	uint32_t before = 0;
	fprintf(script, "$s%u << EOD\n", index);
	for (size_t i = 0; i < json_array_size(series); i++) {
		const double time = series_at(series, i, 0);
		const uint32_t piece = piece_of(pieces, time);
		if (piece != before)
			fputc('\n', script);
		before = piece;
		fprintf(script, "%g %g\n", pieces->x[piece] + 1e3 * (time - pieces->start[piece]), series_at(series, i, 1));
	}
	fprintf(script, "EOD\n");
}

static void write_pieces(FILE *script, const struct pieces *pieces)
{
	fprintf(script, "set xtics (");
	for (uint32_t i = 0; i < pieces->count; i++)
		fprintf(script, "%s'%.2f s' %g", i ? ", " : "", pieces->start[i], pieces->x[i]);
	fprintf(script, ")\n");
}

static bool plot_time(const struct report *report, const struct report_work *work, const char *name)
{
	struct plot plot;
	struct pieces pieces = {0};
	char title[2 * REPORT_NAME];
	if (!plot_open(&plot, report, name, 560, 430))
		return false;
	snprintf(title, sizeof(title), "%s, N = %u", work->name, work->n);
	put_title(plot.script, title);
	fprintf(plot.script, "set xlabel 'time of the scene; gaps are left out'\nset ylabel 'PSNR of "
						 "in-betweens, dB'\n"
						 "set key font ',11'\n");
	for (uint32_t i = 0; i < report->row_count; i++) {
		const struct report_row *row = &report->rows[i];
		if (row->work != work || !row->variant->plain || !row->variant->engine)
			continue;
		if (pieces.count == 0) {
			find_pieces(&pieces, row->score.over_time);
			write_pieces(plot.script, &pieces);
		}
		write_series(plot.script, i, &pieces, row->score.over_time);
	}
	const char *separator = "plot ";
	for (uint32_t i = 0; i < report->row_count; i++) {
		const struct report_row *row = &report->rows[i];
		if (row->work != work || !row->variant->plain || !row->variant->engine ||
			json_array_size(row->score.over_time) == 0)
			continue;
		const uint32_t color = color_of(report, row->variant);
		fprintf(plot.script, "%s$s%u using 1:2 with linespoints linecolor '%s' pointtype %u pointsize 0.5 title '%s'",
				separator, i, colors[color], 4 + color % 10, row->variant->method);
		separator = ", \\\n ";
	}
	fputc('\n', plot.script);
	return plot_close(&plot, report);
}

/* Enough moving pixels of a class for a point. */
static bool is_point(const struct squared_error *bin)
{
	return bin->count > 2000 && bin->sum > 0.0;
}

static bool has_speeds(const struct report *report)
{
	for (uint32_t v = 0; v < report->variant_count; v++) {
		struct squared_error bins[CAMERA_SPEEDS];
		const struct report_variant *variant = &report->variants[v];
		if (!variant->plain || !report_speed_bins(report, variant, bins))
			continue;
		for (uint32_t bin = 0; bin < CAMERA_SPEEDS; bin++) {
			if (is_point(&bins[bin]))
				return true;
		}
	}
	return false;
}

static bool plot_speed(const struct report *report)
{
	struct plot plot;
	if (!has_speeds(report))
		return true;
	if (!plot_open(&plot, report, "speed", 900, 520))
		return false;
	fprintf(plot.script,
			"set title 'Perceived error against the speed of motion, all scenes, N = %u'\n"
			"set xlabel 'speed of the true motion, pixels a second (upper end of each class)'\n"
			"set ylabel 'perceived error, code values'\nset logscale x 2\nset logscale y\n",
			report->works[0].n);
	const char *separator = "plot ";
	for (int pass = 0; pass < 2; pass++) {
		for (uint32_t v = 0; v < report->variant_count; v++) {
			const struct report_variant *variant = &report->variants[v];
			struct squared_error bins[CAMERA_SPEEDS];
			if (!variant->plain || !report_speed_bins(report, variant, bins))
				continue;
			if (pass == 0) {
				fprintf(plot.script, "$s%u << EOD\n", v);
				for (uint32_t bin = 0; bin < CAMERA_SPEEDS; bin++) {
					if (is_point(&bins[bin]))
						fprintf(plot.script, "%g %g\n", 7.5 * (1u << bin), squared_error_root(&bins[bin]));
				}
				fprintf(plot.script, "EOD\n");
				continue;
			}
			const uint32_t color = color_of(report, variant);
			fprintf(plot.script, "%s$s%u using 1:2 with linespoints linecolor '%s' pointtype %u title '%s'", separator,
					v, colors[color], 4 + color % 10, variant->method);
			separator = ", \\\n ";
		}
	}
	fputc('\n', plot.script);
	return plot_close(&plot, report);
}

static bool plot_cost(const struct report *report)
{
	struct plot plot;
	if (!report->cost_method)
		return true;
	if (!plot_open(&plot, report, "cost", 900, 380))
		return false;
	report_write_cost_plot(report, plot.script);
	return plot_close(&plot, report);
}

/* ---- all ---- */

bool report_draw_plots(const struct report *report)
{
	char name[REPORT_NAME], title[160];
	bool scenes = false, drawn = true;
	for (uint32_t i = 0; i < report->work_count && drawn; i++) {
		const struct report_work *work = &report->works[i];
		if (!report->galleries[i].work)
			continue;
		scenes |= !work->recording;
		report_plot_name(name, "error", report, i);
		snprintf(title, sizeof(title), "%s, N = %u, %ux%u", work->name, work->n, work->size.width, work->size.height);
		drawn = plot_pareto(report, work, name, title);
		report_plot_name(name, "time", report, i);
		drawn = drawn && plot_time(report, work, name);
	}
	if (scenes && drawn)
		drawn = plot_pareto(report, NULL, "overall", "Error against run time, mean of all scenes that move") &&
				plot_speed(report);
	return drawn && plot_cost(report);
}
