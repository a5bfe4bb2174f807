/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "daemon/clock.h"
#include "interrupt.h"
#include "report_cost.h"
#include "verbs.h"

#define VERB "report"

static bool read_options(struct report_options *options, int argc, char **argv, int *status)
{
	const char *scenes[SCENE_SOURCE_NAMES];
	scene_source_names(scenes);
	const struct arg_row rows[] = {
		{"scenes", ARG_TEXT, &options->scenes, 0, 0, scenes, "LIST", "built-in scenes, separated by commas; all, none"},
		{"recordings", ARG_TEXT, &options->recordings, 0, 0, NULL, "LIST",
		 "recordings, separated by commas; each frame predicts the next"},
		{"methods", ARG_TEXT, &options->methods, 0, 0, option_find("method")->choices, "LIST",
		 "methods; by default all that there are"},
		{"sizes", ARG_TEXT, &options->sizes, 0, 0, NULL, "LIST", "of the scenes; by default 640x360"},
		{"n", ARG_TEXT, &options->ns, 0, 0, NULL, "LIST",
		 "displayed frames for each real one, 2 to 8; by default 2,3, with --full 2,3,4"},
		{"vary", ARG_TEXT, &options->vary, 0, 0, NULL, "LIST",
		 "methods that are also tried with the settings of --settings; by default grid; all, none"},
		{"settings", ARG_TEXT, &options->settings_list, 0, 0, NULL, "LIST",
		 "such as cell=4,blur=off,cell=16+blur=off; by default cell=4,cell=16,blur=off,"
		 "blur=everywhere,motion-model=quadratic"},
		{"refresh", ARG_RATE, &options->refresh, 0, 0, NULL, "HZ", "of the display; by default 120"},
		{"antialias", ARG_NUMBER, &options->antialias, 1, 4, NULL, "K",
		 "K x K samples for each pixel of a scene; by default 2, as games are antialiased; 1: the scenes as they are"},
		{"full", ARG_FLAG, &options->full, 0, 0, NULL, NULL, "more moments, longer clips, more samples; takes long"},
		{"out", ARG_TEXT, &options->out, 0, 0, NULL, "DIR",
		 "for report.json, report.csv, report.html, plots and pictures; by default out-report"},
		{"tables", ARG_TEXT, &options->tables, 0, 0, NULL, "LIST",
		 "JSON files with tables for the page: those of the stability tests (their --json), or {title, columns, rows}"},
		{"baseline", ARG_TEXT, &options->baseline, 0, 0, NULL, "OLD.json", "print what changed since that report"},
		{"json", ARG_FLAG, &options->json, 0, 0, NULL, NULL, "print report.json instead of tables"},
		{"fail-worse", ARG_REAL, &options->fail_worse, 0, 1000, NULL, "PERCENT",
		 "with --baseline: exit status 1 if a measure of a row got worse by more than this"},
		{"fail-under", ARG_TEXT, &options->fail_under, 0, 0, NULL, "LIMITS",
		 "exit status 1, and the rows named, if a row is worse: psnr=30,perceived_error=4"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[options]",
		.summary =
			"Error against run time: plays scenes and recordings with every method and some settings, measures\n"
			"engine time, what an eye sees of the display, and the rest, and writes report.json, report.csv (one\n"
			"row for each scene, method and setting; report.json says what its columns mean) and report.html.\n"
			"Ctrl-C ends it early with what it has.",
		.status = "what --fail-under or --fail-worse demands is not there",
		.examples = "  pursuit report\n"
					"      all scenes and methods, about ten minutes on two cores\n"
					"  pursuit report --scenes tower,fan --methods hold,grid --n 2 --out before\n"
					"  pursuit report --scenes tower,fan --methods hold,grid --n 2 --baseline before/report.json\n"
					"      what changed between the two\n"
					"  pursuit report --scenes none --recordings walk.pursuit\n"
					"      a recording of your own\n"
					"  pursuit report --scenes colonnade --methods grid --n 2 --fail-under perceived_error=6\n"
					"      for continuous integration\n",
		.rows = rows,
		.settings = &options->settings,
		.groups = 1u << OPTION_ENGINE,
	};
	return args_parse(&args, argc, argv, status);
}

static void set_defaults(struct report_options *options)
{
	if (!options->scenes)
		options->scenes = "all";
	if (!options->sizes)
		options->sizes = options->full ? "640x360,1280x720" : "640x360";
	if (!options->ns)
		options->ns = options->full ? "2,3,4" : "2,3";
	if (!options->vary)
		options->vary = "grid";
	if (!options->settings_list)
		options->settings_list = "cell=4,cell=16,blur=off,blur=everywhere,motion-model=quadratic";
	if (!options->refresh.numerator)
		options->refresh = (struct arg_rate){120, 1};
	if (!options->antialias)
		options->antialias = 2;
	if (!options->out)
		options->out = "out-report";
}

static int check_options(const struct report_options *options)
{
	struct error error;
	if (options->fail_under && !report_check_limits(options->fail_under, &error))
		return args_wrong(VERB, "--fail-under is %s, must be %s", options->fail_under, error.text);
	if (options->fail_worse >= 0.0 && !options->baseline)
		return args_wrong(VERB, "--fail-worse goes with --baseline");
	if (options->baseline && access(options->baseline, R_OK) < 0)
		return args_failed(VERB, "%s: %s", options->baseline, strerror(errno));
	if (strlen(options->out) > 3000)
		return args_wrong(VERB, "--out is too long");
	return STATUS_DONE;
}

/* ---- the run ---- */

static double now_s(void)
{
	return (double)clock_monotonic_ns() / 1e9;
}

static void note_start(struct report *report)
{
	const time_t now = time(NULL);
	struct tm broken;
	if (gmtime_r(&now, &broken))
		strftime(report->started, sizeof(report->started), "%Y-%m-%d %H:%M UTC", &broken);
}

static int measure(struct report *report, struct error *error)
{
	const double start = now_s();
	struct report_writer *writer = report_writer_create(report->options.out, error);
	int result = writer ? report_load_tables(report, error) : -EIO;
	if (result == 0)
		result = report_start_engines(report, error);
	if (result == 0)
		result = report_run(report, writer, error);
	if (result == 0)
		result = report_measure_cost(report, error);
	report_writer_destroy(&writer);
	report->seconds = now_s() - start;
	return result;
}

/* Also after a failure: what there is, is kept. */
static int write_all(struct report *report, struct error *error)
{
	if (report->row_count == 0)
		return 0;
	int result = report_write_json(report, error);
	report->plots = result == 0 && report_draw_plots(report);
	if (result == 0 && !report->plots)
		fprintf(stderr, "pursuit report: no plots, since gnuplot is not installed or failed (Debian: gnuplot-nox); "
						"report.json and report.csv are complete\n");
	return result == 0 ? report_write_page(report, error) : result;
}

/* The file as it was written. */
static void print_json(const struct report *report)
{
	char path[4096], buffer[65536];
	snprintf(path, sizeof(path), "%s/report.json", report->options.out);
	FILE *file = fopen(path, "re");
	for (size_t got; file && (got = fread(buffer, 1, sizeof(buffer), file)) > 0;)
		fwrite(buffer, 1, got, stdout);
	if (file)
		fclose(file);
}

static int judge(const struct report *report, const json_t *baseline)
{
	const struct report_options *options = &report->options;
	uint32_t worse = 0, beyond = report_below_limits(report, stderr);
	if (baseline)
		worse = report_compare(report, baseline, options->fail_worse, options->json ? stderr : stdout);
	return worse || beyond ? STATUS_FAILED : STATUS_DONE;
}

static int run(struct report *report, const json_t *baseline)
{
	struct error error = {{0}}, later = {{0}};
	interrupt_watch();
	note_start(report);
	const int result = measure(report, &error);
	const int written = write_all(report, &later);
	if (report->row_count && report->options.json) {
		print_json(report);
	} else if (report->row_count) {
		report_print(report, stdout);
		printf("%u rows in %.0f s; see %s/report.html\n", report->row_count, report->seconds, report->options.out);
	}
	if (result < 0)
		return args_failed(VERB, "%s", error.text);
	if (written < 0)
		return args_failed(VERB, "%s", later.text);
	if (report->interrupted)
		return args_failed(VERB, "interrupted; what was measured until then is kept in %s", report->options.out);
	return judge(report, baseline);
}

static int run_since_baseline(struct report *report)
{
	struct error error;
	json_t *baseline = report->options.baseline ? report_load_baseline(report->options.baseline, &error) : NULL;
	if (report->options.baseline && !baseline)
		return args_failed(VERB, "%s", error.text);
	const int status = run(report, baseline);
	json_decref(baseline);
	return status;
}

int verb_report(int argc, char **argv)
{
	struct report report = {.options = {.fail_worse = -1.0}};
	int status;
	settings_defaults(&report.options.settings);
	if (!read_options(&report.options, argc, argv, &status))
		return status;
	set_defaults(&report.options);
	status = check_options(&report.options);
	if (status == STATUS_DONE)
		status = report_plan(&report);
	if (status == STATUS_DONE)
		status = run_since_baseline(&report);
	report_finish(&report);
	return status;
}
