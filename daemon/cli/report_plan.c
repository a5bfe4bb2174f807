/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Which works and variants a report has. */

#include <errno.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/printable.h"
#include "daemon/record/recording.h"
#include "report.h"
#include "report_frames.h"

#define VERB "report"

bool report_next_item(const char **list, char item[REPORT_NAME])
{
	while (**list == ',' || **list == ' ')
		++*list;
	const size_t length = strcspn(*list, ", ");
	if (length == 0 || length >= REPORT_NAME)
		return false;
	memcpy(item, *list, length);
	item[length] = '\0';
	*list += length;
	return true;
}

static bool list_has(const char *list, const char *name)
{
	char item[REPORT_NAME];
	while (list && report_next_item(&list, item)) {
		if (strcmp(item, name) == 0)
			return true;
	}
	return false;
}

static bool add_work(struct report *report, const struct report_work *work)
{
	struct report_work *grown = realloc(report->works, (report->work_count + 1) * sizeof(*grown));
	if (!grown)
		return false;
	report->works = grown;
	grown[report->work_count++] = *work;
	return true;
}

/* ---- lists ---- */

static int plan_sizes(struct report *report, struct report_work *work)
{
	char item[REPORT_NAME];
	const char *sizes = report->options.sizes, *ns = report->options.ns;
	while (report_next_item(&sizes, item)) {
		unsigned width, height, read = 0;
		if (sscanf(item, "%5ux%5u%n", &width, &height, (int *)&read) != 2 || item[read] || !width || !height ||
			width > PURSUIT_MAX_SIZE || height > PURSUIT_MAX_SIZE)
			return args_wrong(VERB, "--sizes: %s is not WIDTHxHEIGHT, each 1 to %u", item, PURSUIT_MAX_SIZE);
		work->size = (struct arg_size){width, height};
		for (const char *at = ns; report_next_item(&at, item);) {
			char *end;
			const unsigned long n = strtoul(item, &end, 10);
			if (*end || n < 2 || n > 8)
				return args_wrong(VERB, "--n: %s is not 2 to 8", item);
			work->n = (uint32_t)n;
			if (!add_work(report, work))
				return args_failed(VERB, "out of memory");
		}
	}
	return STATUS_DONE;
}

static int plan_scenes(struct report *report)
{
	const char *list = report->options.scenes;
	struct report_work work = {{0}};
	if (strcmp(list, "none") == 0)
		return STATUS_DONE;
	if (strcmp(list, "all") == 0) {
		for (const struct scene_info *scene = scene_list(); scene->name; scene++) {
			snprintf(work.name, sizeof(work.name), "%s", scene->name);
			const int status = plan_sizes(report, &work);
			if (status != STATUS_DONE)
				return status;
		}
		return STATUS_DONE;
	}
	while (report_next_item(&list, work.name)) {
		struct error error;
		if (!scene_exists(work.name)) {
			scene_source_unknown(work.name, &error);
			return args_wrong(VERB, "%s", error.text);
		}
		const int status = plan_sizes(report, &work);
		if (status != STATUS_DONE)
			return status;
	}
	return *list ? args_wrong(VERB, "--scenes: %.40s... is too long for a name", list) : STATUS_DONE;
}

/* One that is not there is told before an hour of scenes, not after it. */
static bool can_be_read(const char *path)
{
	const struct recording_reader_params params = {.path = path};
	struct error error = {""};
	struct recording_reader *reader = recording_reader_create(&params, &error);
	const bool can = reader != NULL;
	if (!can)
		args_failed(VERB, "%s", error.text);
	recording_reader_destroy(&reader);
	return can;
}

/* Recordings are separated by commas, and may be long. */
static int plan_recordings(struct report *report)
{
	char *list = report->options.recordings ? strdup(report->options.recordings) : NULL, *rest = NULL;
	for (char *path = list ? strtok_r(list, ",", &rest) : NULL; path; path = strtok_r(NULL, ",", &rest)) {
		if (!can_be_read(path)) {
			free(list);
			return STATUS_FAILED;
		}
		struct report_work work = {.recording = strdup(path), .n = 2};
		char *copy = strdup(path);
		if (copy)
			printable_copy(work.name, sizeof(work.name), basename(copy));
		free(copy);
		char *dot = strrchr(work.name, '.');
		if (dot && dot != work.name)
			*dot = '\0';
		if (!work.recording || !add_work(report, &work)) {
			free(list);
			return args_failed(VERB, "out of memory");
		}
	}
	free(list);
	return STATUS_DONE;
}

/* "cell=4+blur=off" */
static int apply(struct report_variant *variant)
{
	char text[REPORT_NAME], *rest = NULL;
	struct error error;
	snprintf(text, sizeof(text), "%s", variant->setting);
	for (char *one = strtok_r(text, "+", &rest); one; one = strtok_r(NULL, "+", &rest)) {
		char *equals = strchr(one, '=');
		if (!equals)
			return args_wrong(VERB, "--settings: %s is not of the form name=value", one);
		*equals = '\0';
		if (settings_set(&variant->settings, one, equals + 1, &error) < 0)
			return args_wrong(VERB, "--settings: %s", error.text);
	}
	return STATUS_DONE;
}

static uint32_t lag_of(const char *method)
{
	for (const struct engine_method_info *info = engine_methods(); info->name; info++) {
		if (strcmp(info->name, method) == 0)
			return info->lag;
	}
	return 0;
}

static int add_variant(struct report *report, const char *method, const char *setting, bool every_n)
{
	struct report_variant *grown = realloc(report->variants, (report->variant_count + 1) * sizeof(*grown));
	if (!grown)
		return args_failed(VERB, "out of memory");
	report->variants = grown;
	struct report_variant *variant = &grown[report->variant_count++];
	*variant = (struct report_variant){
		.settings = report->options.settings, .lag = lag_of(method), .every_n = every_n, .plain = !setting};
	snprintf(variant->method, sizeof(variant->method), "%s", method);
	snprintf(variant->settings.method, sizeof(variant->settings.method), "%s", method);
	snprintf(variant->setting, sizeof(variant->setting), "%s", setting ? setting : "default");
	return setting ? apply(variant) : STATUS_DONE;
}

static int plan_settings(struct report *report, const char *method)
{
	const char *list = report->options.settings_list;
	char item[REPORT_NAME];
	int status = STATUS_DONE;
	if (!list_has(report->options.vary, method) && !list_has(report->options.vary, "all"))
		return status;
	while (status == STATUS_DONE && report_next_item(&list, item) && strcmp(item, "none") != 0)
		status = add_variant(report, method, item, report->options.full);
	return status;
}

static int plan_methods(struct report *report)
{
	char item[REPORT_NAME];
	int status = STATUS_DONE;
	if (!report->options.methods || strcmp(report->options.methods, "all") == 0) {
		for (const struct engine_method_info *info = engine_methods(); info->name && status == STATUS_DONE; info++) {
			status = add_variant(report, info->name, NULL, true);
			if (status == STATUS_DONE)
				status = plan_settings(report, info->name);
		}
		return status;
	}
	for (const char *list = report->options.methods; status == STATUS_DONE && report_next_item(&list, item);) {
		status = args_check_method(VERB, "--methods", item);
		if (status == STATUS_DONE)
			status = add_variant(report, item, NULL, true);
		if (status == STATUS_DONE)
			status = plan_settings(report, item);
	}
	return status;
}

int report_plan(struct report *report)
{
	int status = plan_scenes(report);
	if (status == STATUS_DONE)
		status = plan_recordings(report);
	if (status == STATUS_DONE)
		status = plan_methods(report);
	if (status == STATUS_DONE && report->variant_count > 0)
		status = add_variant(report, REPORT_RENDERED, NULL, true);
	if (status == STATUS_DONE && (report->work_count == 0 || report->variant_count == 0))
		return args_wrong(VERB, "nothing to report on: --scenes, --recordings or --methods is empty");
	report->galleries = calloc(report->work_count + 1u, sizeof(*report->galleries));
	return status == STATUS_DONE && !report->galleries ? args_failed(VERB, "out of memory") : status;
}

int report_start_engines(struct report *report, struct error *error)
{
	for (uint32_t i = 0; i < report->variant_count; i++) {
		struct report_variant *variant = &report->variants[i];
		struct engine_params params;
		if (strcmp(variant->method, REPORT_RENDERED) == 0)
			continue;
		int result = settings_engine_params(&variant->settings, &params, error);
		if (result < 0)
			return result;
		variant->engine = engine_create(&params, error);
		if (!variant->engine)
			return -ENOTSUP;
		variant->info = *engine_get_info(variant->engine);
	}
	return 0;
}

struct report_row *report_add_row(struct report *report)
{
	if (report->row_count == report->row_capacity) {
		const uint32_t capacity = report->row_capacity ? 2 * report->row_capacity : 64;
		struct report_row *grown = realloc(report->rows, capacity * sizeof(*grown));
		if (!grown)
			return NULL;
		report->rows = grown;
		report->row_capacity = capacity;
	}
	struct report_row *row = &report->rows[report->row_count];
	*row = (struct report_row){0};
	if (!score_init(&row->score)) {
		score_finish(&row->score);
		return NULL;
	}
	report->row_count++;
	return row;
}

void report_finish(struct report *report)
{
	for (uint32_t i = 0; i < report->row_count; i++) {
		score_finish(&report->rows[i].score);
		free(report->rows[i].engine_ms);
		free(report->rows[i].seen);
	}
	for (uint32_t i = 0; i < report->variant_count; i++)
		engine_destroy(&report->variants[i].engine);
	for (uint32_t i = 0; i < report->work_count; i++) {
		free((char *)(uintptr_t)report->works[i].recording);
		if (report->galleries) {
			frames_end(&report->galleries[i]);
			free(report->galleries[i].strips);
			free(report->galleries[i].truth);
		}
	}
	json_decref(report->tables);
	free(report->rows);
	free(report->variants);
	free(report->works);
	free(report->galleries);
	*report = (struct report){0};
}
