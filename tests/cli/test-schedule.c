/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What a replay displays when, without rendering anything. */

#include "daemon/cli/schedule.h"
#include "tests/test.h"

#define MAX_FRAMES 256u
#define SECOND UINT64_C(1000000000)

struct fixture {
	struct recorded_frame frames[MAX_FRAMES];
	struct recorded_frames recorded;
	struct schedule schedule;
	struct error error;
};

/* Frames at a steady rate, with motion, all of them real. */
static void make_frames(struct fixture *fixture, uint32_t count, uint64_t fps)
{
	*fixture = (struct fixture){.recorded = {.count = count, .interval_ns = SECOND / fps}};
	fixture->recorded.frames = fixture->frames;
	for (uint32_t i = 0; i < count; i++) {
		fixture->frames[i] = (struct recorded_frame){
			.index = i,
			.position = i,
			.frame_id = i + 1,
			.time_ns = SECOND + i * SECOND / fps,
			.interval_ns = SECOND / fps,
			.width = 64,
			.height = 36,
			.motion = true,
		};
	}
}

static int play(struct fixture *fixture, uint32_t every, uint64_t refresh)
{
	const struct schedule_params params = {.every = every, .refresh = {refresh, 1}};
	return schedule_play(&fixture->schedule, &fixture->recorded, &params, &fixture->error);
}

static void test_double_rate(void)
{
	struct fixture f;
	make_frames(&f, 60, 60);
	CHECK_INT(play(&f, 1, 120), 0);
	CHECK_INT(f.schedule.beginning_count, 60);
	CHECK_INT(f.schedule.showing_count, 120);
	CHECK_INT(f.schedule.lost_real_frames, 0);
	for (uint32_t i = 0; i < f.schedule.showing_count; i++) {
		const struct showing *showing = &f.schedule.showings[i];
		CHECK_INT(showing->show, i % 2 ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL);
		CHECK_NEAR(showing->phase, i % 2 ? 0.5 : 0.0, 1e-6);
		CHECK_INT(showing->number, i);
		CHECK(!showing->repeat);
	}
	CHECK_INT(f.schedule.beginnings[10].params.n, 2);
	CHECK_NEAR(f.schedule.beginnings[10].params.last_phase, 0.5, 1e-6);
	CHECK_NEAR((double)f.schedule.duration_ns, 1e9, 2);
	schedule_finish(&f.schedule);
}

static void test_every_third_has_truth(void)
{
	struct fixture f;
	make_frames(&f, 121, 120);
	CHECK_INT(play(&f, 3, 120), 0);
	CHECK_INT(f.schedule.beginning_count, 41);
	for (uint32_t i = 0; i < f.schedule.beginning_count; i++) {
		const struct beginning *beginning = &f.schedule.beginnings[i];
		CHECK_INT(beginning->frame, 3 * i);
		CHECK_INT(beginning->span, 3);
		CHECK_INT(beginning->params.n, 3);
		CHECK_NEAR((double)beginning->params.real_interval_ns, 25e6, 2);
	}
	for (uint32_t i = 0; i < 121; i++) {
		CHECK_NEAR(f.schedule.showings[i].phase, i % 3 / 3.0, 1e-6);
		CHECK_INT(f.schedule.showings[i].truth, i);
	}
	schedule_finish(&f.schedule);
}

/* 90 Hz from 60: real frames fall on each second and third half vblank; every real frame is shown. */
/* A method that is one real frame late is compared with what it then depicts. */
static void test_delay(void)
{
	struct fixture fixture;
	make_frames(&fixture, 12, 120);
	CHECK_INT(play(&fixture, 3, 120), 0);
	schedule_delay(&fixture.schedule, &fixture.recorded, (struct arg_rate){120, 1});
	for (uint32_t b = 0; b < fixture.schedule.beginning_count; b++) {
		const struct beginning *beginning = &fixture.schedule.beginnings[b];
		for (uint32_t i = 0; i < beginning->showing_count; i++) {
			const struct showing *showing = &fixture.schedule.showings[beginning->first_showing + i];
			CHECK_INT(showing->truth, b ? (int64_t)(beginning->frame - 3 + i) : -1);
			if (b)
				CHECK_NEAR(showing->moment_ns, fixture.frames[beginning->frame - 3 + i].time_ns, 2.0);
		}
	}
	schedule_finish(&fixture.schedule);
}

static void test_uneven_rates(void)
{
	struct fixture f;
	make_frames(&f, 60, 60);
	CHECK_INT(play(&f, 1, 90), 0);
	CHECK_INT(f.schedule.beginning_count, 60);
	CHECK_INT(f.schedule.showing_count, 90);
	for (uint32_t i = 0; i < f.schedule.showing_count; i++)
		CHECK(f.schedule.showings[i].phase >= 0 && f.schedule.showings[i].phase < 1);
	schedule_finish(&f.schedule);
}

static void test_display_slower_than_stream(void)
{
	struct fixture f;
	make_frames(&f, 120, 120);
	CHECK_INT(play(&f, 1, 60), 0);
	CHECK_INT(f.schedule.beginning_count, 60);
	CHECK_INT(f.schedule.lost_real_frames, 60);
	CHECK_INT(f.schedule.showing_count, 60);
	schedule_finish(&f.schedule);
}

static void test_long_pause_is_skipped(void)
{
	struct fixture f;
	make_frames(&f, 20, 60);
	for (uint32_t i = 10; i < 20; i++)
		f.frames[i].time_ns += 1000 * SECOND;
	CHECK_INT(play(&f, 1, 120), 0);
	CHECK_INT(f.schedule.beginning_count, 20);
	CHECK(f.schedule.showing_count < 400);
	schedule_finish(&f.schedule);
}

static void test_truth_only_is_never_real(void)
{
	struct fixture f;
	make_frames(&f, 30, 60);
	for (uint32_t i = 0; i < 30; i++)
		f.frames[i].flags = i % 2 ? 0 : PURSUIT_FRAME_TRUTH_ONLY;
	CHECK_INT(play(&f, 2, 60), 0);
	CHECK_INT(f.schedule.beginning_count, 15);
	for (uint32_t i = 0; i < f.schedule.beginning_count; i++)
		CHECK_INT(f.schedule.beginnings[i].frame, 2 * i + 1);
	schedule_finish(&f.schedule);
	for (uint32_t i = 0; i < 30; i++)
		f.frames[i].flags = PURSUIT_FRAME_TRUTH_ONLY;
	CHECK(play(&f, 1, 60) < 0);
	CHECK(strstr(f.error.text, "truth only") != NULL);
	schedule_finish(&f.schedule);
}

/* A frame that is missing in the middle moves no other frame of --every. */
static void test_missing_frame_shifts_nothing(void)
{
	struct fixture f;
	make_frames(&f, 12, 120);
	for (uint32_t i = 5; i < 11; i++)
		f.frames[i] = f.frames[i + 1];
	f.recorded.count = 11;
	CHECK_INT(play(&f, 2, 120), 0);
	for (uint32_t i = 0; i < f.schedule.beginning_count; i++)
		CHECK_INT(f.frames[f.schedule.beginnings[i].frame].position % 2, 0);
	schedule_finish(&f.schedule);
}

static void test_predictions(void)
{
	struct fixture f;
	make_frames(&f, 10, 30);
	f.frames[3].motion = false;
	const struct schedule_params params = {.every = 1, .numbered = true, .number_offset = 10};
	CHECK_INT(schedule_predict(&f.schedule, &f.recorded, &params, &f.error), 0);
	CHECK_INT(f.schedule.beginning_count, 8);
	CHECK_INT(f.schedule.showings[0].number, 11);
	CHECK_INT(f.schedule.showings[0].truth, 1);
	CHECK_NEAR(f.schedule.showings[0].phase, 1.0, 0);
	CHECK_INT(f.schedule.beginnings[0].params.n, 2);
	CHECK_INT(f.schedule.beginnings[3].frame, 4);
	CHECK_INT(f.schedule.showings[7].number, 19);
	schedule_finish(&f.schedule);
}

static void test_rates(void)
{
	struct fixture f;
	struct arg_rate rate;
	make_frames(&f, 2, 60);
	CHECK(recorded_frames_rate(&f.recorded, &rate));
	CHECK_INT(rate.numerator, 60);
	CHECK_INT(rate.denominator, 1);
	f.recorded.interval_ns = 16683333;
	CHECK(recorded_frames_rate(&f.recorded, &rate));
	CHECK_INT(rate.numerator, 60000);
	CHECK_INT(rate.denominator, 1001);
	f.recorded.interval_ns = 0;
	CHECK(!recorded_frames_rate(&f.recorded, &rate));
	CHECK(args_read_rate("59.94", &rate));
	CHECK_INT(rate.numerator, 59940);
	CHECK(args_read_rate("60000/1001", &rate));
	CHECK_INT(rate.denominator, 1001);
	CHECK(!args_read_rate("0", &rate));
	CHECK(!args_read_rate("60/0", &rate));
	CHECK(!args_read_rate("60x", &rate));
	CHECK(!args_read_rate("-60", &rate));
	CHECK(!args_read_rate("1e9", &rate));
}

static void test_distance(void)
{
	CHECK_INT(args_distance("replay", "replay"), 0);
	CHECK_INT(args_distance("repaly", "replay"), 2);
	CHECK_INT(args_distance("", "demo"), 4);
	CHECK_INT(args_distance("demo", ""), 4);
}

int main(void)
{
	RUN(test_double_rate);
	RUN(test_every_third_has_truth);
	RUN(test_delay);
	RUN(test_uneven_rates);
	RUN(test_display_slower_than_stream);
	RUN(test_long_pause_is_skipped);
	RUN(test_truth_only_is_never_real);
	RUN(test_missing_frame_shifts_nothing);
	RUN(test_predictions);
	RUN(test_rates);
	RUN(test_distance);
	return test_result();
}
