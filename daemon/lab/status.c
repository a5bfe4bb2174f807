/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the lab tells others: copies under the lock, JSON outside it. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/lab/latency_format.h"
#include "daemon/lab/state.h"

static double microseconds(double ns)
{
	return round(ns) / 1e3;
}

static json_t *span_json(const struct histogram *histogram)
{
	return json_pack("{s:I, s:f, s:f, s:f, s:f, s:f}", "count", (json_int_t)histogram->count, "mean_us",
					 microseconds(histogram_mean(histogram)), "p50_us",
					 microseconds(histogram_percentile(histogram, 0.50)), "p99_us",
					 microseconds(histogram_percentile(histogram, 0.99)), "min_us",
					 microseconds((double)histogram->least), "max_us", microseconds((double)histogram->most));
}

static json_t *spans_json(const struct spans *spans)
{
	json_t *object = json_object();
	for (uint32_t i = 0; i < SPANS; i++)
		if (spans->histograms[i].count > 0)
			json_object_set_new(object, span_info((enum span_kind)i)->name, span_json(&spans->histograms[i]));
	return object;
}

static json_t *line_json(bool wanted, bool there, const char *text)
{
	return wanted ? json_pack("{s:b, s:s}", "there", there, "text", text) : json_null();
}

static json_t *vsync_json(const struct lab *lab, const struct lab_shared *shared)
{
	static const char *const states[] = {"learning", "trusted", "refused"};
	if (!*lab->settings.vsync_line)
		return json_null();
	json_t *object = line_json(true, shared->vsync_there, shared->vsync);
	const struct vsync_counts counts = vsync_get_counts(lab->vsync);
	json_object_set_new(object, "state", json_string(states[counts.state]));
	json_object_set_new(object, "period_us", json_real(microseconds(counts.period_ns)));
	json_object_set_new(object, "jitter_us", json_real(microseconds(counts.jitter_ns)));
	json_object_set_new(object, "edges", json_integer((json_int_t)counts.edges));
	json_object_set_new(object, "bounced", json_integer((json_int_t)counts.bounced));
	json_object_set_new(object, "extra", json_integer((json_int_t)counts.extra));
	json_object_set_new(object, "missed", json_integer((json_int_t)counts.missed));
	return object;
}

static json_t *shared_json(const struct lab *lab, const struct lab_shared *shared)
{
	const struct lab_settings *settings = &lab->settings;
	json_t *object = json_object();
	json_object_set_new(object, "gpio_library", json_string(chip_library()));
	json_object_set_new(object, "marker", line_json(*settings->gpio_line, shared->marker_there, shared->marker));
	json_object_set_new(object, "strobe", line_json(*settings->strobe_line, shared->strobe_there, shared->strobe));
	json_object_set_new(object, "photodiode",
						line_json(*settings->photodiode_line, shared->photodiode_there, shared->photodiode));
	json_object_set_new(object, "trigger", line_json(*settings->trigger_line, shared->trigger_there, shared->trigger));
	json_object_set_new(object, "vsync", vsync_json(lab, shared));
	const struct {
		const char *name;
		uint64_t count;
	} counts[] = {
		{"rows", shared->row_count},
		{"edges", shared->edges},
		{"lost_edges", shared->spans.lost_edges},
		{"late_changes", shared->late_changes},
		{"dropped_changes", shared->schedule_dropped},
		{"lost_photons", shared->spans.lost_photons},
		{"stray_photons", shared->stray_photons},
		{"bounced_photons", shared->bounced},
		{"triggers", shared->triggers},
		{"strobe_pulses", shared->strobe_pulses},
		{"strobe_left_out", shared->strobe_left_out},
		{"strobe_too_long", shared->strobe_too_long},
		{"levels", shared->levels},
		{"dropped_flips", atomic_load(&lab->flips.dropped)},
		{"dropped_rows", atomic_load(&lab->render.dropped)},
		{"log_rows", latency_log_written(lab->latency_log)},
		{"log_dropped", latency_log_dropped(lab->latency_log)},
	};
	for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++)
		json_object_set_new(object, counts[i].name, json_integer((json_int_t)counts[i].count));
	json_object_set_new(object, "realtime", json_boolean(atomic_load(&lab->realtime)));
	json_object_set_new(object, "spans", spans_json(&shared->spans));
	return object;
}

/* Copies under the lock; the ring only where it is asked for. */
static struct lab_shared *copy_shared(struct lab *lab, bool with_ring)
{
	struct lab_shared *copy = malloc(sizeof(*copy));
	if (!copy)
		return NULL;
	pthread_mutex_lock(&lab->shared.lock);
	if (with_ring)
		memcpy(copy->ring, lab->shared.ring, sizeof(copy->ring));
	copy->row_count = lab->shared.row_count;
	copy->spans = lab->shared.spans;
	memcpy(copy->marker, lab->shared.marker, sizeof(*copy) - offsetof(struct lab_shared, marker));
	pthread_mutex_unlock(&lab->shared.lock);
	return copy;
}

json_t *lab_status_json(struct lab *lab)
{
	struct lab_shared *shared = lab_is_active(lab) ? copy_shared(lab, false) : NULL;
	json_t *object = shared ? shared_json(lab, shared) : NULL;
	free(shared);
	return object;
}

static json_t *time_json(uint64_t time_ns)
{
	return point_known(time_ns) ? json_integer((json_int_t)time_ns) : json_null();
}

/* In the columns of the CSV form. */
static json_t *row_json(const struct points *points)
{
	static const enum point order[] = {POINT_SUBMIT, POINT_INTAKE, POINT_TARGET, POINT_READY,  POINT_FLIP,
									   POINT_EVENT,  POINT_EDGE,   POINT_PHOTON, POINT_TRIGGER};
	json_t *row = json_pack("[I, I, s, f, s, I, i]", (json_int_t)points->vblank, (json_int_t)points->frame_id,
							points_show_name(points->show), (double)points->phase, points->method,
							(json_int_t)points->code, (int)points->level);
	for (size_t i = 0; i < sizeof(order) / sizeof(order[0]); i++)
		json_array_append_new(row, time_json(points->time[order[i]]));
	json_array_append_new(row, json_integer(points->set_ns));
	json_array_append_new(row, json_string(presenter_time_source_name((enum presenter_time_source)points->source)));
	json_array_append_new(row, json_integer(points->late));
	json_array_append_new(row, json_integer(points->skipped));
	json_array_append_new(row, json_integer(points->edge_lost));
	json_array_append_new(row, json_integer(points->photon_lost));
	return row;
}

json_t *lab_rows_json(struct lab *lab, uint64_t from, uint64_t count)
{
	struct lab_shared *shared = lab_is_active(lab) ? copy_shared(lab, true) : NULL;
	if (!shared)
		return NULL;
	const uint64_t total = shared->row_count, oldest = total > LAB_RING ? total - LAB_RING : 0;
	const uint64_t first = from > oldest ? from : oldest;
	json_t *rows = json_array();
	for (uint64_t i = first; i < total && i - first < count; i++)
		json_array_append_new(rows, row_json(&shared->ring[i % LAB_RING]));
	free(shared);
	return json_pack("{s:I, s:I, s:s, s:o}", "first", (json_int_t)first, "total", (json_int_t)total, "columns",
					 latency_column_line(), "rows", rows);
}
