/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Limits that rows must keep, and what changed since an earlier report. */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

/* ---- limits ---- */

static int find_measure(const char *name)
{
	for (int i = 0; i < SCORE_MEASURES; i++) {
		if (strcmp(score_table[i].name, name) == 0)
			return i;
	}
	return -1;
}

/* The next "name=value" of a list; false: none is left, or *wrong. */
static bool next_limit(const char **list, int *measure, double *limit, bool *wrong)
{
	char item[REPORT_NAME], *end;
	*wrong = false;
	if (!report_next_item(list, item)) {
		*wrong = **list != '\0';
		return false;
	}
	char *equals = strchr(item, '=');
	*wrong = true;
	if (!equals)
		return false;
	*equals = '\0';
	*measure = find_measure(item);
	*limit = strtod(equals + 1, &end);
	*wrong = *measure < 0 || end == equals + 1 || *end || !isfinite(*limit);
	return !*wrong;
}

bool report_check_limits(const char *limits, struct error *error)
{
	int measure;
	double limit;
	bool wrong;
	while (next_limit(&limits, &measure, &limit, &wrong))
		;
	if (!wrong)
		return true;
	size_t used = (size_t)snprintf(error->text, sizeof(error->text), "a list of MEASURE=VALUE, of");
	for (int i = 0; i < SCORE_MEASURES && used < sizeof(error->text); i++)
		used += (size_t)snprintf(error->text + used, sizeof(error->text) - used, " %s", score_table[i].name);
	return false;
}

static bool is_beyond(int measure, double value, double limit)
{
	if (score_table[measure].better > 0)
		return value < limit;
	return (score_table[measure].better < 0 ? value : fabs(value - score_table[measure].best)) > limit;
}

/* A limit on what no row has is not kept. */
static uint32_t count_unmeasured(const struct report *report, FILE *out)
{
	const char *limits = report->options.fail_under;
	uint32_t unmeasured = 0;
	int measure;
	double limit;
	bool wrong;
	while (limits && next_limit(&limits, &measure, &limit, &wrong)) {
		bool found = false;
		for (uint32_t i = 0; i < report->row_count; i++)
			found |= isfinite(score_value(&report->rows[i].score, (enum score_measure)measure));
		if (found)
			continue;
		fprintf(out, "pursuit report: no row has %s, the limit is %g\n", score_table[measure].name, limit);
		unmeasured++;
	}
	return unmeasured;
}

uint32_t report_below_limits(const struct report *report, FILE *out)
{
	uint32_t beyond = count_unmeasured(report, out);
	for (uint32_t i = 0; i < report->row_count; i++) {
		const char *limits = report->options.fail_under;
		int measure;
		double limit;
		bool wrong;
		while (limits && next_limit(&limits, &measure, &limit, &wrong)) {
			char name[256];
			const double value = score_value(&report->rows[i].score, (enum score_measure)measure);
			if (!isfinite(value) || !is_beyond(measure, value, limit))
				continue;
			report_row_name(&report->rows[i], name, sizeof(name));
			fprintf(out, "pursuit report: %s: %s is %.*f, the limit is %g\n", name, score_table[measure].name,
					score_table[measure].digits, value, limit);
			beyond++;
		}
	}
	return beyond;
}

/* ---- against an earlier report ---- */

struct comparison {
	const struct report_row *row;
	const json_t *old;
	double percent; /* that counts as worse; < 0: nothing does */
	FILE *out;
	bool named; /* the row, on the output */
	bool worse;
};

static bool is_same_case(const json_t *old, const struct report_row *row)
{
	const char *source = json_string_value(json_object_get(old, "source"));
	const char *method = json_string_value(json_object_get(old, "method"));
	const char *setting = json_string_value(json_object_get(old, "setting"));
	return source && method && setting && strcmp(source, row->work->name) == 0 &&
		   strcmp(method, row->variant->method) == 0 && strcmp(setting, row->variant->setting) == 0 &&
		   json_integer_value(json_object_get(old, "n")) == row->work->n &&
		   json_integer_value(json_object_get(old, "width")) == row->work->size.width &&
		   json_integer_value(json_object_get(old, "height")) == row->work->size.height;
}

static const json_t *find_case(const json_t *report, const struct report_row *row)
{
	const json_t *rows = json_object_get(report, "rows");
	for (size_t i = 0; i < json_array_size(rows); i++) {
		if (is_same_case(json_array_get(rows, i), row))
			return json_array_get(rows, i);
	}
	return NULL;
}

static void name_row(struct comparison *comparison)
{
	char name[256];
	if (comparison->named)
		return;
	comparison->named = true;
	report_row_name(comparison->row, name, sizeof(name));
	fprintf(comparison->out, "%s\n", name);
}

/* Engine times count as changed if the medians are further apart than both middle halves are wide. */
static void compare_times(struct comparison *comparison)
{
	const json_t *old = json_object_get(comparison->old, "engine_ms");
	const double before = json_number_value(json_object_get(old, "p50")), after = report_row_ms(comparison->row, 50);
	const double width_before =
		json_number_value(json_object_get(old, "p75")) - json_number_value(json_object_get(old, "p25"));
	const double width_after = report_row_ms(comparison->row, 75) - report_row_ms(comparison->row, 25);
	if (!isfinite(after) || before <= 0.0 || fabs(after - before) <= fmax(width_before, width_after))
		return;
	name_row(comparison);
	fprintf(comparison->out, "  %-22s %.2f -> %.2f ms (%+.0f %%; half of all lie within %.2f, now %.2f ms)\n", "engine",
			before, after, 100.0 * (after / before - 1.0), width_before, width_after);
}

/* Quality is deterministic on one renderer: whatever is more than rounding counts. */
static void compare_measure(struct comparison *comparison, int measure)
{
	const struct score_info *info = &score_table[measure];
	const json_t *old = json_object_get(json_object_get(comparison->old, "measures"), info->name);
	const json_t *value = json_object_get(old, "value");
	const double before = json_number_value(value);
	const double after = score_value(&comparison->row->score, (enum score_measure)measure);
	if (!json_is_number(value) || fabs(after - before) < 0.5 * pow(10.0, -info->digits))
		return;
	name_row(comparison);
	if (!isfinite(after)) {
		comparison->worse |= comparison->percent >= 0.0;
		fprintf(comparison->out, "  %-22s %.*f -> none%s\n", info->name, info->digits, before,
				comparison->percent >= 0.0 ? "  TOO MUCH" : "");
		return;
	}
	const double was = info->better ? before * info->better : -fabs(before - info->best);
	const double is = info->better ? after * info->better : -fabs(after - info->best);
	const double lost = 100.0 * (was - is) / fmax(fabs(before), 1e-9);
	const bool worse = comparison->percent >= 0.0 && lost > comparison->percent;
	comparison->worse |= worse;
	fprintf(comparison->out, "  %-22s %.*f -> %.*f %s (%s; spread %.*f, now %.*f)%s\n", info->name, info->digits,
			before, info->digits, after, info->unit, is > was ? "better" : "worse", info->digits,
			json_number_value(json_object_get(old, "spread")), info->digits,
			score_spread(&comparison->row->score, (enum score_measure)measure), worse ? "  TOO MUCH" : "");
}

json_t *report_load_baseline(const char *path, struct error *error)
{
	json_error_t why;
	json_t *old = json_load_file(path, 0, &why);
	if (old && json_is_array(json_object_get(old, "rows")))
		return old;
	error_set(error, -EINVAL, "%s: %s%s", path, old || why.line > 0 ? "is no report.json: " : "",
			  old ? "it has no rows" : why.text);
	json_decref(old);
	return NULL;
}

uint32_t report_compare(const struct report *report, const json_t *old, double percent, FILE *out)
{
	uint32_t compared = 0, changed = 0, worse = 0;
	fprintf(out, "Since %s:\n", report->options.baseline);
	for (uint32_t i = 0; i < report->row_count; i++) {
		struct comparison comparison = {&report->rows[i], find_case(old, &report->rows[i]), percent, out, false, false};
		if (!comparison.old)
			continue;
		compared++;
		compare_times(&comparison);
		for (int measure = 0; measure < SCORE_MEASURES; measure++)
			compare_measure(&comparison, measure);
		changed += comparison.named;
		worse += comparison.worse;
	}
	fprintf(out, "%u of %u rows are in both, %u of them changed", compared, report->row_count, changed);
	if (percent >= 0.0)
		fprintf(out, ", %u worse by more than %g %%", worse, percent);
	fputc('\n', out);
	if (compared || percent < 0.0)
		return worse;
	fprintf(stderr, "pursuit report: no row is in %s, so that nothing can be said not to be worse\n",
			report->options.baseline);
	return report->row_count;
}
