/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_viewer.h"

#include "report_assets.h"
#include "report_frames.h"
#include "report_html.h"
#include "report_overall.h"

void viewer_seen_id(char id[REPORT_NAME], uint32_t work)
{
	snprintf(id, REPORT_NAME, "seen-%u-", work);
}

bool viewer_is_full(FILE *out)
{
	return ftell(out) > VIEWER_MOST_BYTES;
}

void viewer_write(FILE *out)
{
	fputs(report_viewer_html, out);
}

static void put_pictures(FILE *out, const struct report_gallery *gallery)
{
	fputs(",\n\"pictures\":[", out);
	for (uint32_t i = 0; i < gallery->shown_count; i++) {
		const struct report_shown *shown = &gallery->shown[i];
		char kind[64] = "real frame";
		if (!shown->real)
			snprintf(kind, sizeof(kind), gallery->work->recording ? "prediction" : "in-between at phase %.2f",
					 shown->phase);
		fprintf(out, "%s{\"kind\":\"%s\",\"time\":%.6f}", i ? "," : "", kind, shown->time_s);
	}
	fputs("]", out);
}

/* False, and nothing written, where there is no such file. */
static bool put_strip(const struct report *report, FILE *out, const struct report_gallery *gallery, const char *method,
					  const char *before)
{
	char name[4 * REPORT_NAME], path[4200];
	frames_name(name, report, gallery, method);
	snprintf(path, sizeof(path), "%s/pictures/%s", report->options.out, name);
	return html_data(out, path, "image/png", before);
}

static void put_methods(const struct report *report, FILE *out, const struct report_gallery *gallery)
{
	fputs(",\n\"methods\":[", out);
	for (uint32_t i = 1; i < gallery->strip_count; i++) {
		const struct report_strip *strip = &gallery->strips[i];
		fprintf(out, "%s\n{\"name\":\"%s\",\"late\":%u,\"bases\":[", i > 1 ? "," : "", strip->variant->method,
				strip->variant->lag);
		for (uint32_t shown = 0; shown < gallery->shown_count; shown++) {
			const struct report_base *base = &strip->bases[shown];
			fprintf(out, "%s[%d,%u,%d]", shown ? "," : "", base->strip, base->picture, base->differences);
		}
		fprintf(out, "],\"differing\":%u,\"strip\":\"", strip->differing);
		if (strip->differing)
			put_strip(report, out, gallery, strip->variant->method, "");
		fputs("\"}", out);
	}
	fputs("]", out);
}

static void put_work(const struct report *report, FILE *out, const struct report_gallery *gallery)
{
	const struct report_work *work = gallery->work;
	char name[2 * REPORT_NAME], seen[REPORT_NAME];
	snprintf(name, sizeof(name), "%s, N = %u, %ux%u", work->name, work->n, work->size.width, work->size.height);
	viewer_seen_id(seen, (uint32_t)(work - report->works));
	fputs("{\"name\":", out);
	html_json_text(out, name);
	fprintf(out, ",\"width\":%u,\"height\":%u,\"seen\":\"%s\"", gallery->crop.width, gallery->crop.height, seen);
	put_pictures(out, gallery);
	if (put_strip(report, out, gallery, FRAMES_TRUTH, ",\n\"truth\":\""))
		fputs("\"", out);
	put_methods(report, out, gallery);
	fputs("}", out);
}

void viewer_write_data(const struct report *report, FILE *out)
{
	const char *separator = "\n";
	uint32_t left_out = 0;
	fputs("<script type=\"application/json\" id=\"viewer-data\">[", out);
	for (uint32_t i = 0; i < report->work_count; i++) {
		const struct report_gallery *gallery = &report->galleries[i];
		if (!gallery->work || gallery->shown_count == 0)
			continue;
		if (viewer_is_full(out)) {
			left_out++;
			continue;
		}
		fputs(separator, out);
		put_work(report, out, gallery);
		separator = ",\n";
	}
	fprintf(out, "]</script>\n<script>\n%s</script>\n", report_viewer_js);
	if (left_out)
		fprintf(
			out,
			"<p id=\"left-out\">%u scenes or recordings are not in the viewer: a page of more than %ld MiB takes no "
			"more "
			"pictures. Theirs lie in <code>pictures</code>, beside this page; their figures are in the tables.</p>\n",
			left_out, VIEWER_MOST_BYTES >> 20);
}
