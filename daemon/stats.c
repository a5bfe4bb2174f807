/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/stats.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define SPANS_ALWAYS 64u
#define SPANS_ROWS 8u

double stats_percentile_ms(const struct histogram *histogram, double share)
{
	return histogram_percentile(histogram, share) / 1e6;
}

const char *stats_show_name(enum stats_show show)
{
	static const char *const names[] = {"real", "in-between", "repeat", "standby", "kept"};
	return show <= STATS_KEPT ? names[show] : "";
}

static void add_name(struct stats_name *names, uint32_t *count, const char *name, uint64_t times)
{
	for (uint32_t i = 0; i < *count; i++) {
		if (strcmp(names[i].name, name) == 0) {
			names[i].count += times;
			return;
		}
	}
	if (*count < STATS_NAMES)
		names[(*count)++] = (struct stats_name){name, times};
}

void stats_add_report(struct stats *stats, const struct engine_report *report)
{
	if (isfinite(report->total_ms))
		histogram_add(&stats->spans.engine, (int64_t)(fmax(fmin(report->total_ms, 1e9), 0.0) * 1e6));
	stats->engine_bytes = report->memory_bytes + report->plan_bytes;
	for (uint32_t i = 0; i < report->pass_count && i < ENGINE_MAX_PASSES; i++)
		add_name(stats->passes, &stats->pass_count, report->passes[i].name, report->passes[i].runs);
	for (uint32_t i = 0; i < report->left_out_count && i < ENGINE_MAX_LEFT_OUT; i++)
		add_name(stats->left_out, &stats->left_out_count, report->left_out[i].name, 1);
}

void stats_add_row(struct stats *stats, const struct stats_row *row)
{
	stats->timeline[stats->timeline_count++ % STATS_TIMELINE] = *row;
}

void stats_publish(const struct stats *stats, struct stats *copy)
{
	uint64_t first = copy->timeline_count;
	if (stats->timeline_count - first > STATS_TIMELINE)
		first = stats->timeline_count - STATS_TIMELINE;
	for (uint64_t i = first; i < stats->timeline_count; i++)
		copy->timeline[i % STATS_TIMELINE] = stats->timeline[i % STATS_TIMELINE];
	memcpy(copy, stats, offsetof(struct stats, spans));
	if (stats->timeline_count > SPANS_ALWAYS && stats->timeline_count - copy->spans_count < SPANS_ROWS)
		return;
	copy->spans = stats->spans;
	copy->spans_count = stats->timeline_count;
}

/* ---- JSON ---- */

static json_t *count_json(uint64_t count)
{
	return json_integer((json_int_t)count);
}

/* Microseconds are enough, and keep the text short. */
static double rounded(double value)
{
	return round(value * 1000.0) / 1000.0;
}

static json_t *span_json(const struct histogram *histogram)
{
	return json_pack("{s:f, s:f}", "p50", rounded(stats_percentile_ms(histogram, 0.50)), "p99",
					 rounded(stats_percentile_ms(histogram, 0.99)));
}

static json_t *names_json(const struct stats_name *names, uint32_t count)
{
	json_t *object = json_object();
	for (uint32_t i = 0; i < count; i++)
		json_object_set_new(object, names[i].name, count_json(names[i].count));
	return object;
}

/* Only sources that there were. */
static json_t *time_sources_json(const struct stats *stats)
{
	json_t *object = json_object();
	for (unsigned i = 0; i < PRESENTER_TIME_SOURCES; i++)
		if (stats->flips_by_source[i] > 0)
			json_object_set_new(object, presenter_time_source_name((enum presenter_time_source)i),
								count_json(stats->flips_by_source[i]));
	return object;
}

static double displayed_hz(const struct stats *stats)
{
	return stats->active_ns ? (double)stats->displayed_frames * 1e9 / (double)stats->active_ns : 0.0;
}

static json_t *governor_json(const struct governor *governor)
{
	json_t *frames = json_object();
	for (uint32_t i = 0; i < GOVERNOR_LEVELS; i++)
		json_object_set_new(frames, governor_level_name(i), count_json(governor->frames_at[i]));
	return json_pack("{s:i, s:s, s:f, s:I, s:I, s:o}", "level", (int)governor->level, "name",
					 governor_level_name(governor->level), "load", rounded(governor->load), "raised",
					 (json_int_t)governor->raised, "lowered", (json_int_t)governor->lowered, "frames", frames);
}

json_t *stats_json(const struct stats *stats)
{
	const struct {
		const char *name;
		uint64_t count;
	} counts[] = {
		{"real_frames", stats->real_frames},
		{"in_between_frames", stats->in_between_frames},
		{"repeated_frames", stats->repeated_frames},
		{"standby_frames", stats->standby_frames},
		{"displayed_frames", stats->displayed_frames},
		{"late_in_betweens", stats->late_in_betweens},
		{"late_real_frames", stats->late_real_frames},
		{"lost_real_frames", stats->lost_real_frames},
		{"received_frames", stats->received_frames},
		{"refused_frames", stats->refused_frames},
		{"vblanks", stats->vblanks_due},
		{"vblanks_on_time", stats->vblanks_on_time},
		{"late_flips", stats->late_flips},
		{"unbalanced_vblanks", stats->unbalanced_vblanks},
		{"engine_losses", stats->engine_losses},
		{"engine_bytes", stats->engine_bytes},
	};
	json_t *object = json_object();
	if (!object)
		return NULL;
	for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++)
		json_object_set_new(object, counts[i].name, count_json(counts[i].count));
	json_object_set_new(object, "displayed_hz", json_real(rounded(displayed_hz(stats))));
	json_object_set_new(
		object, "on_time",
		json_real(stats->vblanks_due ? (double)stats->vblanks_on_time / (double)stats->vblanks_due : 0.0));
	json_object_set_new(object, "vblank_ms", json_real(round(stats->vblank_ns) / 1e6));
	json_object_set_new(object, "engine_ms", span_json(&stats->spans.engine));
	json_object_set_new(object, "submit_to_flip_ms", span_json(&stats->spans.submit_to_flip));
	json_object_set_new(object, "overhead_ms", span_json(&stats->spans.overhead));
	json_object_set_new(object, "flip_error_ms", span_json(&stats->spans.flip_error));
	json_object_set_new(object, "flip_time_sources", time_sources_json(stats));
	json_object_set_new(object, "governor", governor_json(&stats->governor));
	json_object_set_new(object, "passes", names_json(stats->passes, stats->pass_count));
	json_object_set_new(object, "left_out", names_json(stats->left_out, stats->left_out_count));
	return object;
}

static json_t *row_json(const struct stats_row *row)
{
	return json_pack("[I, I, I, I, I, s, f]", (json_int_t)row->vblank, (json_int_t)row->target_ns,
					 (json_int_t)row->ready_ns, (json_int_t)row->flip_ns, (json_int_t)row->frame_id,
					 stats_show_name((enum stats_show)row->show), rounded((double)row->phase));
}

json_t *stats_timeline_json(const struct stats *stats, uint64_t from, uint64_t count)
{
	const uint64_t oldest = stats->timeline_count > STATS_TIMELINE ? stats->timeline_count - STATS_TIMELINE : 0;
	const uint64_t first = from > oldest ? from : oldest;
	json_t *rows = json_array();
	for (uint64_t i = first; i < stats->timeline_count && i - first < count; i++)
		json_array_append_new(rows, row_json(&stats->timeline[i % STATS_TIMELINE]));
	return json_pack("{s:I, s:I, s:o}", "first", (json_int_t)first, "total", (json_int_t)stats->timeline_count, "rows",
					 rows);
}
