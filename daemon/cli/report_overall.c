/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_overall.h"

#include <math.h>
#include <string.h>

const struct report_row *report_find_row(const struct report *report, const struct report_work *work,
										 const struct report_variant *variant)
{
	for (uint32_t i = 0; i < report->row_count; i++) {
		if (report->rows[i].work == work && report->rows[i].variant == variant)
			return &report->rows[i];
	}
	return NULL;
}

bool report_moves(const struct report *report, const struct report_work *work)
{
	uint64_t moving = 0;
	for (uint32_t i = 0; i < report->row_count; i++) {
		for (uint32_t bin = 1; bin < CAMERA_SPEEDS && report->rows[i].work == work; bin++)
			moving += report->rows[i].score.by_speed[bin].count;
	}
	return moving > 0;
}

/* Works that the overall figures are of. */
static bool counts(const struct report *report, const struct report_work *work)
{
	const struct report_work *first = report->works;
	return !work->recording && work->n == first->n && work->size.width == first->size.width &&
		   work->size.height == first->size.height && report_moves(report, work);
}

double report_mean(const struct report *report, const struct report_variant *variant, enum score_measure measure)
{
	struct running mean = {0};
	for (uint32_t i = 0; i < report->row_count; i++) {
		const struct report_row *row = &report->rows[i];
		const double value = score_value(&row->score, measure);
		if (row->variant == variant && isfinite(value) && counts(report, row->work))
			running_add(&mean, value);
	}
	return mean.count ? mean.mean : (double)NAN;
}

double report_mean_ms(const struct report *report, const struct report_variant *variant, double percentile)
{
	struct running mean = {0};
	for (uint32_t i = 0; i < report->row_count; i++) {
		const struct report_row *row = &report->rows[i];
		const double value = report_row_ms(row, percentile);
		if (row->variant == variant && isfinite(value) && counts(report, row->work))
			running_add(&mean, value);
	}
	return mean.count ? mean.mean : (double)NAN;
}

static bool point_of_row(const struct report_row *row, struct report_point *point)
{
	const double psnr = score_value(&row->score, SCORE_PSNR);
	*point = (struct report_point){row->variant, report_row_ms(row, 50), report_row_ms(row, 25), report_row_ms(row, 75),
								   score_value(&row->score, SCORE_PERCEIVED_ERROR)};
	if (row->work->recording)
		point->error = 255.0 * pow(10.0, -psnr / 20.0);
	return isfinite(point->ms) && isfinite(point->error);
}

uint32_t report_points(const struct report *report, const struct report_work *work, struct report_point *points)
{
	uint32_t count = 0;
	for (uint32_t v = 0; v < report->variant_count; v++) {
		const struct report_variant *variant = &report->variants[v];
		if (work) {
			const struct report_row *row = report_find_row(report, work, variant);
			count += row && point_of_row(row, &points[count]);
			continue;
		}
		points[count] = (struct report_point){variant, report_mean_ms(report, variant, 50),
											  report_mean_ms(report, variant, 25), report_mean_ms(report, variant, 75),
											  report_mean(report, variant, SCORE_PERCEIVED_ERROR)};
		count += isfinite(points[count].ms) && isfinite(points[count].error);
	}
	return count;
}

bool report_speed_bins(const struct report *report, const struct report_variant *variant,
					   struct squared_error bins[CAMERA_SPEEDS])
{
	uint64_t pixels = 0;
	memset(bins, 0, CAMERA_SPEEDS * sizeof(*bins));
	for (uint32_t i = 0; i < report->row_count; i++) {
		const struct report_row *row = &report->rows[i];
		if (row->variant != variant || row->work->n != report->works[0].n)
			continue;
		for (uint32_t bin = 0; bin < CAMERA_SPEEDS; bin++) {
			bins[bin].sum += row->score.by_speed[bin].sum;
			bins[bin].count += row->score.by_speed[bin].count;
			pixels += row->score.by_speed[bin].count;
		}
	}
	return pixels > 0;
}

void report_plot_name(char name[REPORT_NAME], const char *kind, const struct report *report, uint32_t work)
{
	const struct report_work *of = &report->works[work];
	snprintf(name, REPORT_NAME, "%s-%u-n%u-%ux%u", kind, work, of->n, of->size.width, of->size.height);
}

/* ---- the table for a person ---- */

static const enum score_measure printed[] = {
	SCORE_PERCEIVED_ERROR, SCORE_PERCEIVED_PSNR, SCORE_PERCEIVED_LAG, SCORE_PSNR, SCORE_SSIM,
	SCORE_TPSNR,           SCORE_ENERGY_ERROR,   SCORE_RIPPLE};
#define PRINTED (sizeof(printed) / sizeof(*printed))

static void print_number(FILE *out, int width, int digits, double value)
{
	if (isfinite(value))
		fprintf(out, " %*.*f", width, digits, value);
	else
		fprintf(out, " %*s", width, "-");
}

static void print_means(const struct report *report, FILE *out)
{
	bool any = false;
	for (uint32_t i = 0; i < report->work_count; i++)
		any |= counts(report, &report->works[i]);
	if (!any) {
		fputs("No scene of the first N and size moves, so there is no mean; report.csv has each row.\n", out);
		return;
	}
	fprintf(out, "Mean over the scenes that move, N = %u, %ux%u:\n%-28s %8s %8s", report->works[0].n,
			report->works[0].size.width, report->works[0].size.height, "", "ms p50", "ms p99");
	for (size_t i = 0; i < PRINTED; i++)
		fprintf(out, " %15s", score_table[printed[i]].title);
	fputc('\n', out);
	for (uint32_t v = 0; v < report->variant_count; v++) {
		const struct report_variant *variant = &report->variants[v];
		if (!isfinite(report_mean(report, variant, SCORE_PERCEIVED_ERROR)))
			continue;
		char name[REPORT_NAME + 40];
		snprintf(name, sizeof(name), "%s%s%s", variant->method, variant->plain ? "" : " ",
				 variant->plain ? "" : variant->setting);
		fprintf(out, "%-28s", name);
		print_number(out, 8, 2, report_mean_ms(report, variant, 50));
		print_number(out, 8, 2, report_mean_ms(report, variant, 99));
		for (size_t i = 0; i < PRINTED; i++)
			print_number(out, 15, score_table[printed[i]].digits, report_mean(report, variant, printed[i]));
		fputc('\n', out);
	}
}

static int longest_name(const struct report *report, int least)
{
	for (uint32_t i = 0; i < report->row_count; i++) {
		char name[256];
		report_row_name(&report->rows[i], name, sizeof(name));
		if (report->rows[i].work->recording && (int)strlen(name) > least)
			least = (int)strlen(name);
	}
	return least;
}

static void print_recordings(const struct report *report, FILE *out)
{
	static const char title[] = "Recordings, each frame predicting the next:";
	const int width = longest_name(report, (int)sizeof(title) - 1);
	fprintf(out, "%-*s %8s %15s %15s\n", width, title, "ms p50", "PSNR", "SSIM");
	for (uint32_t i = 0; i < report->row_count; i++) {
		const struct report_row *row = &report->rows[i];
		char name[256];
		if (!row->work->recording)
			continue;
		report_row_name(row, name, sizeof(name));
		fprintf(out, "%-*s", width, name);
		print_number(out, 8, 2, report_row_ms(row, 50));
		print_number(out, 15, 2, score_value(&row->score, SCORE_PSNR));
		print_number(out, 15, 4, score_value(&row->score, SCORE_SSIM));
		fputc('\n', out);
	}
}

void report_print(const struct report *report, FILE *out)
{
	bool recordings = false;
	for (uint32_t i = 0; i < report->work_count; i++)
		recordings |= report->works[i].recording != NULL;
	if (!report->works[0].recording)
		print_means(report, out);
	if (recordings)
		print_recordings(report, out);
}
