/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "args.h"
#include "json_out.h"
#include "latency_fetch.h"
#include "latency_report.h"
#include "loopback.h"
#include "verbs.h"

#define VERB "latency"

struct choices {
	bool json;
	const char *socket, *svg, *loopback, *chip;
	uint32_t count, interval_us;
	const char *logs[2];
	unsigned log_count;
};

/* All that the daemon's ring holds. */
static int fetch(struct latency_report *report, const char *socket, struct error *error)
{
	struct control control;
	uint64_t from = 0;
	int result = control_open(&control, socket, error);
	if (result < 0)
		return result;
	result = latency_fetch(&control, &from, &report->table, error);
	control_close(&control);
	return result;
}

/* ---- logs ---- */

static int load(struct latency_report *report, const struct choices *choices, unsigned index, struct error *error)
{
	int result;
	if (choices->log_count == 0) {
		report->name = "the running daemon";
		result = fetch(report, choices->socket, error);
	} else {
		report->name = choices->logs[index];
		result = latency_read(report->name, &report->table, error);
	}
	if (result == 0 && report->table.count == 0)
		result = error_set(error, -ENODATA, "%s: has no row yet: nothing was displayed", report->name);
	if (result == 0)
		latency_report_count(report);
	return result;
}

static void print_json(json_t *object)
{
	json_print(object);
	json_decref(object);
}

static void tell(const struct latency_report *a, const struct latency_report *b, bool as_json)
{
	if (as_json) {
		json_t *object = latency_report_json(a);
		if (b) {
			json_object_set_new(object, "other", latency_report_json(b));
			json_object_set_new(object, "change", latency_compare_json(a, b));
		}
		print_json(object);
		return;
	}
	latency_report_print(a, stdout);
	if (b) {
		putchar('\n');
		latency_report_print(b, stdout);
		latency_report_compare(a, b, stdout);
	}
}

static int report_logs(const struct choices *choices)
{
	struct latency_report *reports = calloc(2, sizeof(*reports));
	struct error error = {""};
	const bool two = choices->log_count == 2;
	if (!reports)
		return args_failed(VERB, "out of memory");
	int result = load(&reports[0], choices, 0, &error);
	if (result == 0 && two)
		result = load(&reports[1], choices, 1, &error);
	if (result == 0 && choices->svg)
		result = latency_report_svg(&reports[0], two ? &reports[1] : NULL, choices->svg, &error);
	if (result == 0)
		tell(&reports[0], two ? &reports[1] : NULL, choices->json);
	latency_report_finish(&reports[0]);
	latency_report_finish(&reports[1]);
	free(reports);
	return result < 0 ? args_failed(VERB, "%s", error.text) : STATUS_DONE;
}

/* ---- loopback ---- */

static json_t *histogram_json(const struct histogram *histogram)
{
	return json_pack("{s:I, s:f, s:f, s:f, s:f, s:f}", "count", (json_int_t)histogram->count, "min_us",
					 (double)histogram->least / 1e3, "mean_us", histogram_mean(histogram) / 1e3, "p50_us",
					 histogram_percentile(histogram, 0.5) / 1e3, "p99_us", histogram_percentile(histogram, 0.99) / 1e3,
					 "max_us", (double)histogram->most / 1e3);
}

static void print_histogram(const char *name, const struct histogram *histogram)
{
	printf("  %-34s %7" PRIu64 " %9.1f %9.1f %9.1f %9.1f %9.1f\n", name, histogram->count,
		   (double)histogram->least / 1e3, histogram_mean(histogram) / 1e3, histogram_percentile(histogram, 0.5) / 1e3,
		   histogram_percentile(histogram, 0.99) / 1e3, (double)histogram->most / 1e3);
}

static void print_loopback(const struct loopback_result *result, const struct choices *choices)
{
	printf("loopback %s on %s\n\n  %-34s %7s %9s %9s %9s %9s %9s\n", choices->loopback, result->text, "microseconds",
		   "count", "min", "mean", "median", "99 %", "max");
	print_histogram("set called, input rising", &result->rising);
	print_histogram("set called, input falling", &result->falling);
	print_histogram("the call that sets", &result->set);
	printf("  %" PRIu32 " edges lost\n\n"
		   "The input's stamp is taken in its interrupt, so these times hold the setting of the output and the\n"
		   "interrupt of the input; a single one is in neither by itself. Nothing of this is subtracted anywhere.\n",
		   result->lost);
}

static int run_loopback(const struct choices *choices)
{
	const struct loopback_params params = {choices->chip ? choices->chip : "", choices->loopback, choices->count,
										   choices->interval_us};
	struct error error = {""};
	struct loopback_result *result = malloc(sizeof(*result));
	if (!result)
		return args_failed(VERB, "out of memory");
	const int failed = loopback_measure(&params, result, &error);
	if (failed == 0 && choices->json)
		print_json(json_pack("{s:s, s:s, s:o, s:o, s:o, s:i}", "lines", choices->loopback, "chip", result->text,
							 "rising", histogram_json(&result->rising), "falling", histogram_json(&result->falling),
							 "set", histogram_json(&result->set), "lost", (int)result->lost));
	else if (failed == 0)
		print_loopback(result, choices);
	free(result);
	return failed < 0 ? args_failed(VERB, "%s", error.text) : STATUS_DONE;
}

int verb_latency(int argc, char **argv)
{
	struct choices choices = {.count = 500, .interval_us = 2000};
	const struct arg_row rows[] = {
		{"json", ARG_FLAG, &choices.json, 0, 0, NULL, NULL, "all of it as one JSON object"},
		{"svg", ARG_TEXT, &choices.svg, 0, 0, NULL, "FILE", "write histograms and time series"},
		{"loopback", ARG_TEXT, &choices.loopback, 0, 0, NULL, "OUT:IN",
		 "measure the time from setting line OUT to its edge on line IN, with a wire between them"},
		{"gpio-chip", ARG_TEXT, &choices.chip, 0, 0, NULL, "NAME", "chip of --loopback: path, name or label"},
		{"count", ARG_NUMBER, &choices.count, 1, 1000000, NULL, "N",
		 "edges of each direction of --loopback; default 500"},
		{"interval-us", ARG_NUMBER, &choices.interval_us, 0, 1000000, NULL, "US",
		 "between edges of --loopback; default 2000"},
		{"socket", ARG_TEXT, &choices.socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[LOG [LOG]] [--svg FILE] [--json]",
		.summary = "Percentiles of every span between the time points of displayed frames, and how sure they are: of a "
				   "latency log,\nof two compared, or of what a running daemon (started with --latency) remembers.",
		.examples = "  pursuitd --latency-log run.csv --gpio-line GPIO17\n"
					"  pursuit latency run.csv --svg run.svg\n"
					"  pursuit latency before.bin after.bin\n"
					"  pursuit latency --loopback GPIO17:GPIO27\n",
		.rows = rows,
		.positionals = choices.logs,
		.positional_max = 2,
		.positional_count = &choices.log_count,
	};
	int status;
	if (!args_parse(&args, argc, argv, &status))
		return status;
	if (choices.loopback && (choices.log_count || choices.svg))
		return args_wrong(VERB, "--loopback goes with neither logs nor --svg");
	if (choices.loopback && !loopback_are_lines(choices.loopback))
		return args_wrong(VERB, "--loopback is %.64s, must be OUT:IN, two lines by offset or name", choices.loopback);
	return choices.loopback ? run_loopback(&choices) : report_logs(&choices);
}
