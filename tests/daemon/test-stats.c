/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Percentiles, costs, and what the flip events of a whole run add up to. */

#include <unistd.h>

#include "daemon/busy.h"
#include "daemon/cost.h"
#include "daemon/showing.h"
#include "daemon/stats.h"
#include "tests/test.h"

#define PERIOD UINT64_C(8333333)

static void test_percentiles(void)
{
	static struct stats wild;
	static const double values[] = {NAN, -5, 0, INFINITY, 1e300, 1e-300, 4, 4, 4};
	for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
		const struct engine_report report = {.total_ms = values[i]};
		stats_add_report(&wild, &report);
	}
	CHECK_INT(wild.spans.engine.count, 7);
	CHECK_NEAR(stats_percentile_ms(&wild.spans.engine, 0.5), 4, 0.02);
	CHECK(isfinite(stats_percentile_ms(&wild.spans.engine, 1.0)));
}

/* A copy is at most seven rows behind with its spans, and never with anything else. */
static void test_publishing(void)
{
	static struct stats stats, copy;
	for (uint64_t i = 1; i <= 400; i++) {
		const struct stats_row row = {.vblank = i};
		histogram_add(&stats.spans.flip_error, 1000);
		stats_add_row(&stats, &row);
		stats.displayed_frames = i;
		stats_publish(&stats, &copy);
		CHECK_INT(copy.displayed_frames, i);
		CHECK_INT(copy.timeline_count, i);
		CHECK_INT(copy.timeline[(i - 1) % STATS_TIMELINE].vblank, i);
		CHECK(copy.spans.flip_error.count + (i <= 64 ? 0 : 7) >= i);
	}
}

static void test_costs(void)
{
	struct cost cost = {0};
	for (int i = 0; i < 1000; i++)
		cost_add(&cost, i % 20 == 0 ? 90000000 : 4000000);
	CHECK_INT(cost.usual_ns, 4000000);
	CHECK_INT(cost.safe_ns, 4900000); /* one of twenty is not planned for */
	for (int i = 0; i < 32; i++)
		cost_add(&cost, i % 2 == 0 ? 40000000 : 4000000);
	CHECK(cost.safe_ns <= 61000000);
}

/* ---- showing ---- */

static struct stats stats;

static void flip(struct showing *showing, uint64_t vblank, enum presenter_shown shown, uint64_t group, uint64_t serial)
{
	const struct presenter_flip event = {.vblank = vblank,
										 .target_ns = vblank * PERIOD,
										 .flip_ns = vblank * PERIOD + 20000,
										 .serial = serial,
										 .group = group,
										 .shown = shown};
	showing_flip(showing, &event);
}

static void draw(struct showing *showing, uint64_t vblank, enum stats_show show, uint64_t group, uint64_t serial)
{
	const struct showing_picture picture = {
		.serial = serial, .group = group, .show = show, .ready_ns = vblank * PERIOD - 1000000};
	showing_add_picture(showing, &picture);
	showing_plan(showing, vblank, show == STATS_REAL ? SHOWING_REAL : SHOWING_IN_BETWEEN);
}

static void test_figures(void)
{
	struct showing showing;
	struct pursuit_shm_control *control = calloc(1, sizeof(*control));
	struct stream stream = {.references = 100, .control = control};
	memset(&stats, 0, sizeof(stats));
	showing_init(&showing, &stats);
	showing.period_ns = (double)PERIOD;
	for (uint64_t i = 1; i <= 30; i++) {
		const uint64_t vblank = 100 + 2 * i;
		const struct frame frame = {.header = {.frame_id = i, .submit_ns = vblank * PERIOD - 5000000},
									.intake_ns = vblank * PERIOD - 4900000};
		showing_add_frame(&showing, i, &stream, &frame);
		if (i == 10) { /* never drawn: replaced by the next */
			showing_plan(&showing, vblank, SHOWING_REAL);
			flip(&showing, vblank, PRESENTER_KEPT, 9, 19);
			showing_plan(&showing, vblank + 1, SHOWING_REPEAT);
			flip(&showing, vblank + 1, PRESENTER_KEPT, 9, 19);
			continue;
		}
		draw(&showing, vblank, STATS_REAL, i, 2 * i);
		flip(&showing, vblank, PRESENTER_PICTURE, i, 2 * i);
		if (i == 20) { /* its in-between is late, and it was boosted */
			showing_find_frame(&showing, i)->boosted = true;
			showing_plan(&showing, vblank + 1, SHOWING_IN_BETWEEN);
			showing_add_picture(&showing, &(struct showing_picture){.serial = 1000, .group = i, .show = STATS_STANDBY});
			flip(&showing, vblank + 1, PRESENTER_STANDBY, i, 1000);
		} else if (i == 25) { /* nobody decided */
			flip(&showing, vblank + 1, PRESENTER_KEPT, i, 2 * i);
		} else {
			draw(&showing, vblank + 1, STATS_IN_BETWEEN, i, 2 * i + 1);
			flip(&showing, vblank + 1, PRESENTER_PICTURE, i, 2 * i + 1);
		}
	}
	showing_plan(&showing, 162, SHOWING_PAUSE);
	flip(&showing, 162, PRESENTER_KEPT, 30, 61);
	showing_close_frames(&showing, 31);
	showing_finish(&showing);
	CHECK_INT(stats.real_frames, 29);
	CHECK_INT(stats.in_between_frames, 27);
	CHECK_INT(stats.standby_frames, 1);
	CHECK_INT(stats.repeated_frames, 1);
	CHECK_INT(stats.displayed_frames, 58);
	CHECK_INT(stats.late_in_betweens, 2);
	CHECK_INT(stats.unbalanced_vblanks, 1);
	CHECK_INT(stats.lost_real_frames, 1);
	CHECK_INT(stats.vblanks_due, 60); /* the pause is none of them */
	CHECK_INT(stats.vblanks_on_time, 57);
	CHECK_NEAR((double)stats.active_ns, 60.0 * (double)PERIOD, 10);
	CHECK_NEAR(stats_percentile_ms(&stats.spans.submit_to_flip, 0.5), 5.02, 0.05);
	CHECK_INT(control->feedback_count, 30);
	CHECK_INT(control->feedback[9].state, PURSUIT_FEEDBACK_REPLACED);
	CHECK_INT(control->feedback[9].frame_id, 10);
	CHECK_INT(control->feedback[19].late_in_betweens, 1);
	CHECK_INT(control->feedback[19].vblanks, 2);
	CHECK_INT(control->feedback[5].in_betweens, 1);
	CHECK_INT(control->feedback[5].vblank, 112);
	CHECK_INT(stream.references, 100); /* every reference was given back */
	free(control);
}

/* However late flips are, no more pictures are displayed a second than the display has vblanks. */
static void test_displayed_hz(void)
{
	struct showing showing;
	memset(&stats, 0, sizeof(stats));
	showing_init(&showing, &stats);
	showing.period_ns = (double)PERIOD;
	for (uint64_t vblank = 100; vblank < 160; vblank++) {
		const uint64_t late_ns = vblank % 30 < 3 ? (3 - vblank % 30) * PERIOD * 9 / 10 : 0;
		const struct presenter_flip event = {.vblank = vblank,
											 .target_ns = vblank * PERIOD,
											 .flip_ns = vblank * PERIOD + late_ns,
											 .serial = vblank,
											 .group = 1,
											 .late = late_ns >= PERIOD,
											 .shown = PRESENTER_PICTURE};
		const uint64_t frames = stats.displayed_frames, active_ns = stats.active_ns;
		draw(&showing, vblank, STATS_IN_BETWEEN, 1, vblank);
		showing_flip(&showing, &event);
		CHECK_INT(stats.displayed_frames, frames + 1);
		CHECK_INT(stats.active_ns - active_ns, PERIOD);
	}
	showing_finish(&showing);
}

static void test_json(void)
{
	struct engine_report report = {.pass_count = 1, .left_out_count = 1, .total_ms = 2.5};
	report.passes[0].name = "warp";
	report.passes[0].runs = 3;
	report.left_out[0].name = "snap";
	stats_add_report(&stats, &report);
	json_t *object = stats_json(&stats);
	static const char *const names[] = {
		"real_frames",      "in_between_frames", "displayed_frames",  "displayed_hz", "late_in_betweens",
		"lost_real_frames", "engine_ms",         "submit_to_flip_ms", "passes",       "left_out",
		"on_time",          "governor",          "vblank_ms"};
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
		CHECK(json_object_get(object, names[i]) != NULL);
	CHECK_NEAR(json_number_value(json_object_get(object, "displayed_hz")), 116, 0.1);
	CHECK_NEAR(json_number_value(json_object_get(json_object_get(object, "engine_ms"), "p50")), 2.5, 0.02);
	CHECK_INT(json_integer_value(json_object_get(json_object_get(object, "passes"), "warp")), 3);
	CHECK_STRING(json_string_value(json_object_get(json_object_get(object, "governor"), "name")), "full");
	json_decref(object);
	object = stats_timeline_json(&stats, 10, 7);
	CHECK_INT(json_array_size(json_object_get(object, "rows")), 7);
	CHECK_INT(json_integer_value(json_object_get(object, "first")), 10);
	CHECK_INT(json_integer_value(json_object_get(object, "total")), 61);
	json_decref(object);
	for (int i = 0; i < 5000; i++)
		stats_add_row(&stats, &(struct stats_row){.vblank = 1});
	object = stats_timeline_json(&stats, 0, 3);
	CHECK_INT(json_integer_value(json_object_get(object, "first")), 5061 - STATS_TIMELINE);
	json_decref(object);
}

static void test_busy(void)
{
	struct busy busy = {.count = 0};
	CHECK_INT(busy_within(&busy, 0, UINT64_MAX), 0);
	for (uint64_t i = 0; i < 20; i++) /* [0, 30), [100, 130), ...: the first four are forgotten */
		busy_add(&busy, 100 * i, 100 * i + 30);
	CHECK_INT(busy_within(&busy, 0, UINT64_MAX), 16 * 30);
	CHECK_INT(busy_within(&busy, 1000, 1200), 60);
	CHECK_INT(busy_within(&busy, 1010, 1120), 40);
	CHECK_INT(busy_within(&busy, 1030, 1100), 0);
	CHECK_INT(busy_within(&busy, 1200, 1000), 0);
}

int main(void)
{
	RUN(test_percentiles);
	RUN(test_publishing);
	RUN(test_costs);
	RUN(test_figures);
	RUN(test_json);
	RUN(test_displayed_hz);
	RUN(test_busy);
	return test_result();
}
