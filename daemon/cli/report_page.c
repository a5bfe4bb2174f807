/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The page: everything in one file that opens without a network. */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/record/image.h"
#include "report_cost.h"
#include "report_curves.h"
#include "report_html.h"
#include "report_overall.h"
#include "report_viewer.h"

static void put_name(FILE *out, const struct report_variant *variant)
{
	html_text(out, variant->method);
	if (!variant->plain) {
		fputs(" <small>", out);
		html_text(out, variant->setting);
		fputs("</small>", out);
	}
}

static void put_plot(const struct report *report, FILE *out, const char *name, const char *description)
{
	char path[4200];
	snprintf(path, sizeof(path), "%s/plots/%s.svg", report->options.out, name);
	html_svg(out, path, description);
}

/* ---- the beginning ---- */

static void put_introduction(const struct report *report, FILE *out)
{
	const struct engine_info *info = &report->variants[0].info;
	fprintf(out, "<p class=\"note\">Made %s in %.0f s; engine on ", report->started, report->seconds);
	html_text(out, info->renderer);
	fputs(" (", out);
	html_text(out, info->context);
	fputs("). ", out);
	if (report->interrupted)
		fputs("<b>The report was interrupted: what was measured until then is here.</b> ", out);
	if (!report->plots)
		fputs("<b>gnuplot is not installed, so there are no plots</b>; the figures are complete. ", out);
	fputs("Engine times are milliseconds for each displayed frame, one frame at a time, upload and read-back included, "
		  "the methods taking turns. The pursuit camera is an eye that follows the true motion of each pixel while the "
		  "display holds its pictures; the truth is the same scene at 960 pictures a second. Less perceived error is "
		  "better.</p>\n",
		  out);
}

static double best_mean(const struct report *report, enum score_measure measure)
{
	const int better = score_table[measure].better;
	double best = (double)NAN;
	for (uint32_t v = 0; v < report->variant_count; v++) {
		const double value = report_mean(report, &report->variants[v], measure);
		if (isfinite(value) && better && (!isfinite(best) || value * better > best * better))
			best = value;
	}
	return best;
}

static void put_overall(const struct report *report, FILE *out)
{
	fprintf(out, "<h2>All methods</h2>\n<p class=\"note\">Means over all scenes that move, N = %u, %ux%u.</p>\n",
			report->works[0].n, report->works[0].size.width, report->works[0].size.height);
	html_table_begin(out, "All methods");
	fputs("<tr><th>method</th><th>ms<br>median</th><th>ms<br>p99</th>", out);
	for (int i = 0; i < SCORE_MEASURES; i++)
		fprintf(out, "<th title=\"%s\">%s%s%s</th>", score_table[i].help, score_table[i].title,
				*score_table[i].unit ? "<br>" : "", score_table[i].unit);
	fputs("</tr>\n", out);
	for (uint32_t v = 0; v < report->variant_count; v++) {
		const struct report_variant *variant = &report->variants[v];
		if (!isfinite(report_mean(report, variant, SCORE_PERCEIVED_ERROR)))
			continue;
		fputs("<tr><td>", out);
		put_name(out, variant);
		fputs("</td>", out);
		html_number(out, report_mean_ms(report, variant, 50), 2, NULL);
		html_number(out, report_mean_ms(report, variant, 99), 2, NULL);
		for (int i = 0; i < SCORE_MEASURES; i++) {
			const enum score_measure measure = (enum score_measure)i;
			const double value = report_mean(report, variant, measure), best = best_mean(report, measure);
			html_number(out, value, score_table[i].digits, value == best ? "best" : NULL);
		}
		fputs("</tr>\n", out);
	}
	html_table_end(out);
	put_plot(report, out, "overall", "error against run time");
	put_plot(report, out, "speed", "error against speed");
}

/* Scene by method: the figure that the whole thing is about. */
static void put_matrix(const struct report *report, FILE *out)
{
	fputs("<h2>Perceived error, scene by scene</h2>\n<p class=\"note\">Code values, 0 to 255; less is better.</p>\n",
		  out);
	html_table_begin(out, "Perceived error, scene by scene");
	fputs("<tr><th>scene</th>", out);
	for (uint32_t v = 0; v < report->variant_count; v++) {
		if (!report->variants[v].plain)
			continue;
		fputs("<th>", out);
		html_text(out, report->variants[v].method);
		fputs("</th>", out);
	}
	fputs("</tr>\n", out);
	for (uint32_t w = 0; w < report->work_count; w++) {
		const struct report_work *work = &report->works[w];
		if (work->recording || !report->galleries[w].work)
			continue;
		double least = (double)INFINITY;
		for (uint32_t i = 0; i < report->row_count; i++) {
			if (report->rows[i].work == work && report->rows[i].variant->plain)
				least = fmin(least, score_value(&report->rows[i].score, SCORE_PERCEIVED_ERROR));
		}
		fprintf(out, "<tr><td>%s <small>N = %u, %ux%u</small></td>", work->name, work->n, work->size.width,
				work->size.height);
		for (uint32_t v = 0; v < report->variant_count; v++) {
			const struct report_row *row = report_find_row(report, work, &report->variants[v]);
			const double value = row ? score_value(&row->score, SCORE_PERCEIVED_ERROR) : (double)NAN;
			if (report->variants[v].plain)
				html_number(out, value, 2, value <= least ? "best" : NULL);
		}
		fputs("</tr>\n", out);
	}
	html_table_end(out);
}

/* ---- a scene ---- */

static void put_seen(const struct report *report, FILE *out, const uint8_t *seen, const struct crop *crop,
					 const char *name, const char *id, const char *caption)
{
	char path[4200], attributes[96 + 2 * REPORT_NAME];
	struct error error;
	snprintf(path, sizeof(path), "%s/pictures/%s", report->options.out, name);
	if (image_write_png_small(path, seen, crop->width, crop->height, false, &error) < 0) {
		fprintf(stderr, "pursuit report: %s\n", error.text);
		return;
	}
	snprintf(attributes, sizeof(attributes), "id=\"%s\" class=\"pixels\" decoding=\"async\" width=\"%u\"", id,
			 2 * crop->width);
	fputs("<figure>", out);
	html_image(out, path, "image/png", caption, attributes);
	fputs("<figcaption>", out);
	html_text(out, caption);
	fputs("</figcaption></figure>\n", out);
}

static void put_camera(const struct report *report, FILE *out, uint32_t index)
{
	const struct report_gallery *gallery = &report->galleries[index];
	const struct report_work *work = gallery->work;
	char name[4 * REPORT_NAME], caption[160], seen[REPORT_NAME], id[2 * REPORT_NAME];
	if (!gallery->truth || work->n != report->works[0].n || viewer_is_full(out))
		return;
	fprintf(out,
			"<p>Through the pursuit camera, at %.2f s; motion here is %.0f pixels a second on average.</p>\n<div>\n",
			gallery->time_s, gallery->speed);
	snprintf(name, sizeof(name), "seen-%u-%s-truth.png", index, work->name);
	viewer_seen_id(seen, index);
	snprintf(id, sizeof(id), "%struth", seen);
	put_seen(report, out, gallery->truth, &gallery->crop, name, id, "truth, 960 Hz");
	for (uint32_t i = 0; i < report->row_count; i++) {
		const struct report_row *row = &report->rows[i];
		if (row->work != work || !row->seen || !row->variant->plain)
			continue;
		snprintf(name, sizeof(name), "seen-%u-%s-%s.png", index, work->name, row->variant->method);
		snprintf(caption, sizeof(caption), "%s: perceived error %.2f in all of the scene", row->variant->method,
				 score_value(&row->score, SCORE_PERCEIVED_ERROR));
		snprintf(id, sizeof(id), "%s%s", seen, row->variant->method);
		put_seen(report, out, row->seen, &gallery->crop, name, id, caption);
	}
	fputs("</div>\n", out);
}

static void put_work(const struct report *report, FILE *out, uint32_t index)
{
	const struct report_gallery *gallery = &report->galleries[index];
	const struct report_work *work = &report->works[index];
	char name[REPORT_NAME];
	if (!gallery->work)
		return;
	fputs("<h2>", out);
	html_text(out, work->name);
	fprintf(out, ", N = %u, %ux%u</h2>\n", work->n, work->size.width, work->size.height);
	if (work->recording)
		fputs(
			"<p class=\"note\">A recording: each frame predicts the next one, without compensation. Moving pixels are "
			"those that its own motion says, disoccluded ones are guessed from its depth. Nothing is known of the "
			"moments between, so there is no pursuit camera.</p>\n",
			out);
	report_plot_name(name, "error", report, index);
	put_plot(report, out, name, "error against run time");
	report_plot_name(name, "time", report, index);
	put_plot(report, out, name, "error over time");
	put_camera(report, out, index);
	if (*gallery->contact && (work->recording || work->n == report->works[0].n)) {
		fputs(
			"<p class=\"note\">All methods on one sheet, the last scored in-between of each, enlarged: <code>pictures/",
			out);
		html_text(out, gallery->contact);
		fputs("</code>, beside this page.</p>\n", out);
	}
}

/* ---- tables ---- */

static void put_tables(const struct report *report, FILE *out)
{
	size_t t, i, j;
	json_t *table, *row, *cell;
	json_array_foreach(report->tables, t, table)
	{
		fputs("<h2>", out);
		html_text(out, json_string_value(json_object_get(table, "title")));
		fputs("</h2>\n", out);
		curves_write(json_object_get(table, "plot"), json_string_value(json_object_get(table, "title")), out);
		if (json_array_size(json_object_get(table, "columns")) == 0)
			continue;
		html_table_begin(out, json_string_value(json_object_get(table, "title")));
		fputs("<tr>", out);
		json_array_foreach(json_object_get(table, "columns"), i, cell)
		{
			fputs("<th>", out);
			html_text(out, json_is_string(cell) ? json_string_value(cell) : "");
			fputs("</th>", out);
		}
		fputs("</tr>\n", out);
		json_array_foreach(json_object_get(table, "rows"), i, row)
		{
			fputs("<tr>", out);
			json_array_foreach(row, j, cell)
			{
				if (json_is_number(cell)) {
					fprintf(out, "<td>%.6g</td>", json_number_value(cell));
					continue;
				}
				fputs("<td class=\"text\">", out);
				html_text(out, json_is_string(cell) ? json_string_value(cell) : "–");
				fputs("</td>", out);
			}
			fputs("</tr>\n", out);
		}
		html_table_end(out);
	}
}

static void put_all_rows(const struct report *report, FILE *out)
{
	fputs("<h2>All rows</h2>\n<details><summary>Every scene, method and setting</summary>", out);
	html_table_begin(out, "All rows");
	fputs("<tr><th>case</th><th>ms p50</th><th>ms p99</th><th>kB up</th><th>kB down</th>", out);
	for (int i = 0; i < SCORE_MEASURES; i++)
		fprintf(out, "<th>%s</th>", score_table[i].title);
	fputs("</tr>\n", out);
	for (uint32_t r = 0; r < report->row_count; r++) {
		const struct report_row *row = &report->rows[r];
		char name[256];
		report_row_name(row, name, sizeof(name));
		fputs("<tr><td>", out);
		html_text(out, name);
		fputs("</td>", out);
		html_number(out, report_row_ms(row, 50), 2, NULL);
		html_number(out, report_row_ms(row, 99), 2, NULL);
		const double displayed = row->displayed ? 1e3 * (double)row->displayed : (double)NAN;
		html_number(out, (double)row->bytes_up / displayed, 0, NULL);
		html_number(out, (double)row->bytes_down / displayed, 0, NULL);
		for (int i = 0; i < SCORE_MEASURES; i++)
			html_number(out, score_value(&row->score, (enum score_measure)i), score_table[i].digits, NULL);
		fputs("</tr>\n", out);
	}
	html_table_end(out);
	fputs("</details>\n", out);
}

static void put_definitions(FILE *out)
{
	fputs("<h2>What the measures are</h2>\n", out);
	html_table_begin(out, "What the measures are");
	fputs("<tr><th>name</th><th>unit</th><th>what</th></tr>\n", out);
	for (int i = 0; i < SCORE_MEASURES; i++)
		fprintf(out, "<tr><td>%s</td><td class=\"text\">%s</td><td class=\"text\">%s</td></tr>\n", score_table[i].title,
				score_table[i].unit, score_table[i].help);
	html_table_end(out);
}

int report_write_page(struct report *report, struct error *error)
{
	char path[4096];
	snprintf(path, sizeof(path), "%s/report.html", report->options.out);
	FILE *out = fopen(path, "we");
	if (!out)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	html_begin(out, "Pursuit: error against run time");
	put_introduction(report, out);
	if (!report->works[0].recording) {
		put_overall(report, out);
		put_matrix(report, out);
	}
	viewer_write(out);
	for (uint32_t i = 0; i < report->work_count; i++)
		put_work(report, out, i);
	report_put_cost(report, out);
	put_plot(report, out, "cost", "engine time against moving share and pixels");
	put_tables(report, out);
	put_definitions(out);
	put_all_rows(report, out);
	viewer_write_data(report, out);
	html_end(out);
	const bool wrong = ferror(out) != 0;
	if (fclose(out) != 0 || wrong)
		return error_set(error, -EIO, "%s: not written whole: %s", path, strerror(errno));
	return 0;
}
