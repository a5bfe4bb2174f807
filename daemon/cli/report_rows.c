/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Rows as CSV, which grows while the report runs, and as JSON. */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "figures.h"
#include "report_cost.h"

#define MS                                                                                                      \
	"milliseconds by CLOCK_MONOTONIC for a real frame with its in-betweens, divided by their number, one at a " \
	"time, upload and read-back included: "

/* Of report.csv, in this order, before the measures of score_table. */
static const char *const columns[][2] = {
	{"source", "the scene, or the file of the recording without its folder and its ending"},
	{"kind", "scene, or recording: each frame predicts the next"},
	{"method", "that made the displayed frames"},
	{"setting", "what differs from the settings of the report; default: nothing"},
	{"n", "displayed frames for each real one"},
	{"width", "of the pictures, pixels"},
	{"height", "of the pictures, pixels"},
	{"context", "where the engine ran"},
	{"engine_ms_p50", MS "the median"},
	{"engine_ms_p99", MS "99 of 100 took less"},
	{"engine_ms_p25", MS "a quarter took less"},
	{"engine_ms_p75", MS "three quarters took less"},
	{"engine_frames", "real frames that were timed"},
	{"bytes_up", "bytes to the engine's textures, mean of the displayed frames"},
	{"bytes_down", "bytes from the engine's textures, mean of the displayed frames"},
	{"in_betweens", "pictures that were scored"},
	{"windows", "real intervals that the pursuit camera looked at"},
};
#define COLUMNS (sizeof(columns) / sizeof(*columns))

struct report_writer {
	FILE *csv;
	char path[4096];
};

double report_row_ms(const struct report_row *row, double percentile)
{
	if (row->engine_ms_count == 0)
		return (double)NAN;
	return figures_percentile(row->engine_ms, row->engine_ms_count, percentile);
}

void report_row_name(const struct report_row *row, char *text, size_t size)
{
	snprintf(text, size, "%s, %s, %s, N = %u, %ux%u", row->work->name, row->variant->method, row->variant->setting,
			 row->work->n, row->work->size.width, row->work->size.height);
}

static double per_displayed(const struct report_row *row, uint64_t bytes)
{
	return row->displayed ? (double)bytes / (double)row->displayed : (double)NAN;
}

/* ---- CSV ---- */

static int make_folder(const char *folder, const char *inside, struct error *error)
{
	char path[4096];
	snprintf(path, sizeof(path), "%s%s", folder, inside);
	if (mkdir(path, 0777) < 0 && errno != EEXIST)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	return 0;
}

struct report_writer *report_writer_create(const char *folder, struct error *error)
{
	struct report_writer *writer = calloc(1, sizeof(*writer));
	if (!writer) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	if (make_folder(folder, "", error) == 0 && make_folder(folder, "/pictures", error) == 0 &&
		make_folder(folder, "/plots", error) == 0) {
		snprintf(writer->path, sizeof(writer->path), "%s/report.csv", folder);
		writer->csv = fopen(writer->path, "we");
		if (!writer->csv)
			error_set(error, -errno, "%s: %s", writer->path, strerror(errno));
	}
	if (!writer->csv) {
		report_writer_destroy(&writer);
		return NULL;
	}
	for (size_t i = 0; i < COLUMNS; i++)
		fprintf(writer->csv, "%s%s", i ? "," : "", columns[i][0]);
	for (int i = 0; i < SCORE_MEASURES; i++)
		fprintf(writer->csv, ",%s", score_table[i].name);
	fputc('\n', writer->csv);
	return writer;
}

void report_writer_destroy(struct report_writer **writer)
{
	if (!writer || !*writer)
		return;
	if ((*writer)->csv)
		fclose((*writer)->csv);
	free(*writer);
	*writer = NULL;
}

/* Names of files may hold anything. */
static void put_text(FILE *file, const char *text)
{
	fputc('"', file);
	for (; *text; text++) {
		if (*text == '"')
			fputc('"', file);
		fputc(*text, file);
	}
	fputc('"', file);
}

static void put_number(FILE *file, double value)
{
	if (isfinite(value))
		fprintf(file, ",%.6g", value);
	else
		fputc(',', file);
}

int report_write_row(struct report_writer *writer, const struct report_row *row, struct error *error)
{
	FILE *file = writer->csv;
	put_text(file, row->work->name);
	fprintf(file, ",%s,%s,%s,%u,%u,%u,%s", row->work->recording ? "recording" : "scene", row->variant->method,
			row->variant->setting, row->work->n, row->work->size.width, row->work->size.height,
			row->variant->engine ? row->variant->info.context : "");
	static const double percentiles[] = {50, 99, 25, 75};
	for (size_t i = 0; i < sizeof(percentiles) / sizeof(*percentiles); i++)
		put_number(file, report_row_ms(row, percentiles[i]));
	fprintf(file, ",%u", row->engine_ms_count);
	put_number(file, per_displayed(row, row->bytes_up));
	put_number(file, per_displayed(row, row->bytes_down));
	fprintf(file, ",%u,%u", row->score.in_betweens, row->score.sites);
	for (int i = 0; i < SCORE_MEASURES; i++)
		put_number(file, score_value(&row->score, (enum score_measure)i));
	fputc('\n', file);
	if (fflush(file) != 0 || ferror(file))
		return error_set(error, -EIO, "%s: not written whole: %s", writer->path, strerror(errno));
	return 0;
}

/* ---- JSON ---- */

static json_t *speeds_json(const struct score *score)
{
	json_t *speeds = json_array();
	for (uint32_t i = 0; i < CAMERA_SPEEDS && score->sites; i++) {
		const double limit = i < CAMERA_SPEEDS - 1 ? camera_speed_limits[i] : (double)INFINITY;
		json_array_append_new(speeds, json_pack("{s:o, s:I, s:o}", "up_to_px_per_s", figures_number(limit), "pixels",
												(json_int_t)score->by_speed[i].count, "perceived_error",
												figures_number(squared_error_root(&score->by_speed[i]))));
	}
	return speeds;
}

static json_t *measures_json(const struct score *score)
{
	json_t *measures = json_object();
	for (int i = 0; i < SCORE_MEASURES; i++) {
		const enum score_measure measure = (enum score_measure)i;
		json_object_set_new(measures, score_table[i].name,
							json_pack("{s:o, s:o, s:i}", "value", figures_number(score_value(score, measure)), "spread",
									  figures_number(score_spread(score, measure)), "samples",
									  (int)score->samples[i].count));
	}
	return measures;
}

static json_t *row_json(const struct report_row *row)
{
	const struct report_variant *variant = row->variant;
	json_t *json = json_pack(
		"{s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:s, s:{s:o, s:o, s:o, s:o, s:i}, s:o, s:o, s:i, s:i, s:i}", "source",
		row->work->name, "kind", row->work->recording ? "recording" : "scene", "method", variant->method, "setting",
		variant->setting, "n", (int)row->work->n, "width", (int)row->work->size.width, "height",
		(int)row->work->size.height, "context", variant->engine ? variant->info.context : "", "engine_ms", "p50",
		figures_number(report_row_ms(row, 50)), "p99", figures_number(report_row_ms(row, 99)), "p25",
		figures_number(report_row_ms(row, 25)), "p75", figures_number(report_row_ms(row, 75)), "frames",
		(int)row->engine_ms_count, "bytes_up", figures_number(per_displayed(row, row->bytes_up)), "bytes_down",
		figures_number(per_displayed(row, row->bytes_down)), "clips", (int)row->score.clips, "in_betweens",
		(int)row->score.in_betweens, "windows", (int)row->score.sites);
	json_object_set_new(json, "measures", measures_json(&row->score));
	json_object_set_new(json, "by_speed", speeds_json(&row->score));
	json_object_set(json, "psnr_over_time", row->score.over_time);
	json_object_set(json, "perceived_psnr_over_time", row->score.perceived_over_time);
	json_object_set_new(json, "settings", figures_settings_json(&variant->settings));
	return json;
}

static json_t *machine_json(const struct report *report)
{
	double load[3] = {0};
	const struct engine_info *info = &report->variants[0].info;
	if (getloadavg(load, 3) < 1)
		load[0] = (double)NAN;
	return json_pack("{s:i, s:o, s:s, s:s, s:s}", "processors", (int)sysconf(_SC_NPROCESSORS_ONLN), "load",
					 figures_number(load[0]), "renderer", info->renderer ? info->renderer : "", "version",
					 info->version ? info->version : "", "context", info->context ? info->context : "");
}

json_t *report_json(const struct report *report)
{
	char version[32];
	snprintf(version, sizeof(version), "%d.%d.%d", PURSUIT_VERSION_MAJOR, PURSUIT_VERSION_MINOR, PURSUIT_VERSION_PATCH);
	json_t *rows = json_array(), *help = json_object(), *texts = json_object();
	for (size_t i = 0; i < COLUMNS; i++)
		json_object_set_new(texts, columns[i][0], json_string(columns[i][1]));
	for (uint32_t i = 0; i < report->row_count; i++)
		json_array_append_new(rows, row_json(&report->rows[i]));
	for (int i = 0; i < SCORE_MEASURES; i++)
		json_object_set_new(help, score_table[i].name,
							json_pack("{s:s, s:s, s:s}", "unit", score_table[i].unit, "help", score_table[i].help,
									  "better",
									  score_table[i].better > 0   ? "greater"
									  : score_table[i].better < 0 ? "less"
																  : "near best"));
	json_t *json =
		json_pack("{s:s, s:s, s:s, s:f, s:b, s:b, s:o, s:o, s:o}", "pursuit", "report", "version", version, "started",
				  report->started, "seconds", report->seconds, "complete", !report->interrupted, "full",
				  (int)report->options.full, "machine", machine_json(report), "measures", help, "rows", rows);
	json_object_set_new(json, "columns", texts);
	json_object_set_new(json, "cost", report_cost_json(report));
	if (report->tables)
		json_object_set(json, "tables", report->tables);
	return json;
}

int report_write_json(const struct report *report, struct error *error)
{
	char path[4096], unfinished[4100];
	snprintf(path, sizeof(path), "%s/report.json", report->options.out);
	snprintf(unfinished, sizeof(unfinished), "%s.new", path);
	json_t *json = report_json(report);
	FILE *file = fopen(unfinished, "we");
	int result = 0;
	bool wrong = !file || json_dumpf(json, file, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) != 0;
	wrong |= file && fclose(file) != 0;
	if (wrong || rename(unfinished, path) < 0)
		result = error_set(error, -EIO, "%s: not written: %s", path, strerror(errno));
	json_decref(json);
	return result;
}
