/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "latency_report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <time.h>

#define BARS 24u

/* ---- counting ---- */

void latency_report_count(struct latency_report *report)
{
	const struct latency_table *table = &report->table;
	uint64_t first_ns = 0, last_ns = 0;
	for (uint64_t i = 0; i < table->count; i++) {
		const struct points *row = &table->rows[i];
		spans_add(&report->spans, row);
		report->sources[row->source < PRESENTER_TIME_SOURCES ? row->source : PRESENTER_TIME_ESTIMATED]++;
		report->shows[row->show < POINTS_SHOWS ? row->show : POINTS_KEPT]++;
		report->late += row->late;
		report->skipped += row->skipped;
		if (!point_known(row->time[POINT_FLIP]))
			continue;
		first_ns = first_ns ? first_ns : row->time[POINT_FLIP];
		last_ns = row->time[POINT_FLIP];
	}
	report->seconds = last_ns > first_ns ? (double)(last_ns - first_ns) / 1e9 : 0.0;
}

void latency_report_finish(struct latency_report *report)
{
	latency_table_finish(&report->table);
}

static double resolution_ns(void)
{
	struct timespec resolution = {0};
	clock_getres(CLOCK_MONOTONIC, &resolution);
	return (double)resolution.tv_sec * 1e9 + (double)resolution.tv_nsec;
}

/* ---- what is certain and what is not ---- */

static const char *source_sentence(enum presenter_time_source source)
{
	switch (source) {
	case PRESENTER_TIME_KERNEL:
		return "stamped by the kernel's display driver: start of scan-out, good to tens of microseconds";
	case PRESENTER_TIME_DISPLAY_SERVER:
		return "told by the display server, as good as its own source";
	case PRESENTER_TIME_EXTERNAL:
		return "a vblank of the external vsync: the line through its edges, so as good as that wire and its offset";
	case PRESENTER_TIME_TIMER:
		return "ESTIMATED: no display, a timer of the daemon's grid fired; nothing was shown";
	case PRESENTER_TIME_ESTIMATED:
	case PRESENTER_TIME_SOURCES:
		break;
	}
	return "ESTIMATED: when the call that shows a picture came back, later than the flip by an unknown time";
}

static double event_jitter_us(const struct latency_report *report)
{
	const struct histogram *event = &report->spans.histograms[SPAN_FLIP_TO_EVENT];
	return (histogram_percentile(event, 0.99) - histogram_percentile(event, 0.50)) / 1e3;
}

static void print_uncertainty(const struct latency_report *report, FILE *out)
{
	const struct histogram *set = &report->spans.histograms[SPAN_GPIO_SET];
	fprintf(out, "\nhow sure these are\n");
	fprintf(out,
			"  clock        CLOCK_MONOTONIC of one machine, resolution here %.0f ns; percentiles are right to 0.4 %%\n",
			resolution_ns());
	for (uint32_t i = 0; i < PRESENTER_TIME_SOURCES; i++)
		if (report->sources[i])
			fprintf(out, "  flip         %" PRIu64 " of %" PRIu64 " (%s): %s\n", report->sources[i],
					report->table.count, presenter_time_source_name((enum presenter_time_source)i),
					source_sentence((enum presenter_time_source)i));
	fprintf(out, "  event jitter %.1f us (99 %% less median): edges wait for the event, not for the flip\n",
			event_jitter_us(report));
	if (set->count)
		fprintf(out,
				"  edge         taken when the call that sets the line came back; the pin changed up to %.1f us before "
				"(99 %%; at most %.1f us)\n",
				histogram_percentile(set, 0.99) / 1e3, (double)set->most / 1e3);
	if (report->spans.histograms[SPAN_FLIP_TO_PHOTON].count)
		fprintf(out, "  photon       stamped by the kernel in the interrupt; its latency and the sensor's are in it\n");
	fprintf(out, "  submit       the client's own word; ready is when the picture was handed on\n");
	if (report->table.dropped)
		fprintf(out, "  incomplete   the writer dropped %" PRIu64 " rows\n", report->table.dropped);
	if (report->table.cut_bytes)
		fprintf(out, "  incomplete   the file ends within a block or line: its writer was stopped\n");
}

/* ---- for a person ---- */

/* The shape between least and 99.5 %, as a row of blocks. */
static void print_shape(const struct histogram *histogram, FILE *out)
{
	static const char *const blocks[] = {" ",      "\u2581", "\u2582", "\u2583", "\u2584",
										 "\u2585", "\u2586", "\u2587", "\u2588"};
	const double from = histogram_percentile(histogram, 0.005), to = histogram_percentile(histogram, 0.995);
	const double step = (to - from) / BARS;
	uint64_t counts[BARS], most = 1;
	if (!(step > 0.0))
		return;
	for (uint32_t i = 0; i < BARS; i++) {
		counts[i] = histogram_between(histogram, from + step * i, from + step * (i + 1));
		most = counts[i] > most ? counts[i] : most;
	}
	for (uint32_t i = 0; i < BARS; i++)
		fputs(blocks[counts[i] ? 1 + counts[i] * 7 / most : 0], out);
}

static void print_span(const struct histogram *histogram, const char *name, FILE *out)
{
	fprintf(out, "  %-18s %8" PRIu64 " %9.3f %9.3f %9.3f %9.3f %9.3f  ", name, histogram->count,
			histogram_mean(histogram) / 1e6, histogram_percentile(histogram, 0.50) / 1e6,
			histogram_percentile(histogram, 0.90) / 1e6, histogram_percentile(histogram, 0.99) / 1e6,
			(double)histogram->most / 1e6);
	print_shape(histogram, out);
	fputc('\n', out);
}

void latency_report_print(const struct latency_report *report, FILE *out)
{
	fprintf(out, "%s: %" PRIu64 " refreshes in %.1f s\n ", report->name, report->table.count, report->seconds);
	for (uint32_t i = 0; i < POINTS_SHOWS; i++)
		fprintf(out, " %" PRIu64 " %s%s", report->shows[i], points_show_name(i), i + 1 < POINTS_SHOWS ? "," : "\n");
	fprintf(out,
			"  %" PRIu64 " flips late, %" PRIu64 " refreshes skipped, %" PRIu64 " edges lost, %" PRIu64
			" photons lost\n",
			report->late, report->skipped, report->spans.lost_edges, report->spans.lost_photons);
	fprintf(out, "\n  %-18s %8s %9s %9s %9s %9s %9s  shape, 0.5 to 99.5 %%\n", "milliseconds", "count", "mean",
			"median", "90 %", "99 %", "max");
	for (uint32_t i = 0; i < SPANS; i++)
		if (report->spans.histograms[i].count)
			print_span(&report->spans.histograms[i], span_info((enum span_kind)i)->name, out);
	print_uncertainty(report, out);
}

/* Half of the 95 % interval of the difference of two means (Welch, large samples), in us. */
static double interval_us(const struct histogram *a, const struct histogram *b)
{
	const double da = histogram_deviation(a) / 1e3, db = histogram_deviation(b) / 1e3;
	return 1.96 * sqrt(da * da / (double)a->count + db * db / (double)b->count);
}

static double mean_change_us(const struct histogram *a, const struct histogram *b)
{
	return (histogram_mean(b) - histogram_mean(a)) / 1e3;
}

void latency_report_compare(const struct latency_report *a, const struct latency_report *b, FILE *out)
{
	fprintf(out, "\n%s less %s\n", b->name, a->name);
	fprintf(out, "  %-18s %12s %12s %12s   %s\n", "milliseconds", "median", "99 %", "mean",
			"95 % interval of the mean");
	for (uint32_t i = 0; i < SPANS; i++) {
		const struct histogram *ha = &a->spans.histograms[i], *hb = &b->spans.histograms[i];
		if (ha->count < 2 || hb->count < 2)
			continue;
		const double change = mean_change_us(ha, hb), half = interval_us(ha, hb);
		fprintf(out, "  %-18s %+12.3f %+12.3f %+12.3f   %+.3f to %+.3f%s\n", span_info((enum span_kind)i)->name,
				(histogram_percentile(hb, 0.50) - histogram_percentile(ha, 0.50)) / 1e6,
				(histogram_percentile(hb, 0.99) - histogram_percentile(ha, 0.99)) / 1e6, change / 1e3,
				(change - half) / 1e3, (change + half) / 1e3, fabs(change) > half ? "" : " (may be chance)");
	}
	fprintf(out,
			"  frames that follow each other are not independent: the intervals are too narrow rather than too wide\n");
}

/* ---- JSON ---- */

static json_t *microseconds(double ns)
{
	return json_real(round(ns) / 1e3);
}

static json_t *span_json(const struct histogram *histogram, const struct span_info *info)
{
	static const struct {
		const char *name;
		double share;
	} shares[] = {{"p1_us", 0.01}, {"p50_us", 0.5}, {"p90_us", 0.9}, {"p99_us", 0.99}, {"p999_us", 0.999}};
	json_t *object = json_object();
	json_object_set_new(object, "meaning", json_string(info->help));
	json_object_set_new(object, "count", json_integer((json_int_t)histogram->count));
	json_object_set_new(object, "mean_us", microseconds(histogram_mean(histogram)));
	json_object_set_new(object, "deviation_us", microseconds(histogram_deviation(histogram)));
	json_object_set_new(object, "min_us", microseconds((double)histogram->least));
	for (size_t i = 0; i < sizeof(shares) / sizeof(shares[0]); i++)
		json_object_set_new(object, shares[i].name, microseconds(histogram_percentile(histogram, shares[i].share)));
	json_object_set_new(object, "max_us", microseconds((double)histogram->most));
	return object;
}

static json_t *uncertainty_json(const struct latency_report *report)
{
	const struct histogram *set = &report->spans.histograms[SPAN_GPIO_SET];
	json_t *object = json_object(), *sources = json_object(), *estimated = json_array();
	for (uint32_t i = 0; i < PRESENTER_TIME_SOURCES; i++)
		if (report->sources[i])
			json_object_set_new(sources, presenter_time_source_name((enum presenter_time_source)i),
								json_integer((json_int_t)report->sources[i]));
	if (report->sources[PRESENTER_TIME_ESTIMATED] || report->sources[PRESENTER_TIME_TIMER])
		json_array_append_new(estimated, json_string("flip"));
	json_object_set_new(object, "clock", json_string("CLOCK_MONOTONIC"));
	json_object_set_new(object, "clock_resolution_ns", json_real(resolution_ns()));
	json_object_set_new(object, "percentile_error", json_real(0.004));
	json_object_set_new(object, "flip_sources", sources);
	json_object_set_new(object, "estimated", estimated);
	json_object_set_new(object, "event_jitter_us", json_real(event_jitter_us(report)));
	json_object_set_new(object, "gpio_set_p99_us", microseconds(histogram_percentile(set, 0.99)));
	json_object_set_new(object, "gpio_set_max_us", microseconds((double)set->most));
	return object;
}

json_t *latency_report_json(const struct latency_report *report)
{
	const struct {
		const char *name;
		uint64_t count;
	} counts[] = {{"rows", report->table.count},
				  {"late_flips", report->late},
				  {"skipped", report->skipped},
				  {"lost_edges", report->spans.lost_edges},
				  {"lost_photons", report->spans.lost_photons},
				  {"dropped_rows", report->table.dropped},
				  {"cut_bytes", report->table.cut_bytes}};
	json_t *object = json_object(), *spans = json_object(), *shows = json_object();
	json_object_set_new(object, "name", json_string(report->name));
	json_object_set_new(object, "seconds", json_real(report->seconds));
	for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++)
		json_object_set_new(object, counts[i].name, json_integer((json_int_t)counts[i].count));
	for (uint32_t i = 0; i < POINTS_SHOWS; i++)
		json_object_set_new(shows, points_show_name(i), json_integer((json_int_t)report->shows[i]));
	for (uint32_t i = 0; i < SPANS; i++)
		if (report->spans.histograms[i].count)
			json_object_set_new(spans, span_info((enum span_kind)i)->name,
								span_json(&report->spans.histograms[i], span_info((enum span_kind)i)));
	json_object_set_new(object, "shows", shows);
	json_object_set_new(object, "spans", spans);
	json_object_set_new(object, "uncertainty", uncertainty_json(report));
	return object;
}

json_t *latency_compare_json(const struct latency_report *a, const struct latency_report *b)
{
	json_t *object = json_object();
	for (uint32_t i = 0; i < SPANS; i++) {
		const struct histogram *ha = &a->spans.histograms[i], *hb = &b->spans.histograms[i];
		if (ha->count < 2 || hb->count < 2)
			continue;
		json_t *change = json_object();
		json_object_set_new(change, "mean_us", json_real(mean_change_us(ha, hb)));
		json_object_set_new(change, "mean_interval_us", json_real(interval_us(ha, hb)));
		json_object_set_new(change, "p50_us",
							microseconds(histogram_percentile(hb, 0.50) - histogram_percentile(ha, 0.50)));
		json_object_set_new(change, "p99_us",
							microseconds(histogram_percentile(hb, 0.99) - histogram_percentile(ha, 0.99)));
		json_object_set_new(object, span_info((enum span_kind)i)->name, change);
	}
	return object;
}
