/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A presenter goes with a flip of which the render thread has told and that never came, and another one counts its
 * vblanks anew: the lab knows all about the new one's flips.
 */
#include <jansson.h>
#include <time.h>

#include "daemon/lab/lab.h"
#include "daemon/options.h"
#include "tests/test.h"

#define MS UINT64_C(1000000)
#define OLD 1000000u /* vblanks of the presenters */
#define NEW 5u
#define FLIPS 100u

static struct clock real_clock;

static void flip(struct lab *lab, uint64_t vblank, uint64_t serial, bool seen)
{
	const uint64_t now_ns = clock_now(&real_clock);
	const struct presenter_flip event = {
		.vblank = vblank, .target_ns = now_ns, .flip_ns = now_ns, .serial = serial, .shown = PRESENTER_PICTURE};
	struct points points = {.vblank = vblank, .frame_id = serial, .time[POINT_SUBMIT] = now_ns - 9 * MS};
	struct presenter_image image = {.data = NULL};
	lab_mark_picture(lab, &image, serial, vblank, POINTS_REAL);
	if (seen)
		lab_flip(lab, &event);
	lab_tell(lab, &points);
	nanosleep(&(struct timespec){0, 1000000}, NULL);
}

/* Waits until so many rows are there; how many of them the render thread's part is known of. */
static long count_told(struct lab *lab, json_int_t wanted)
{
	long told = 0;
	json_t *object = lab_rows_json(lab, 0, 10000);
	for (int i = 0; i < 6000 && json_integer_value(json_object_get(object, "total")) < wanted; i++) {
		json_decref(object);
		nanosleep(&(struct timespec){0, 10000000}, NULL);
		object = lab_rows_json(lab, 0, 10000);
	}
	const json_t *rows = json_object_get(object, "rows");
	for (size_t i = 0; i < json_array_size(rows); i++)
		told += json_is_integer(json_array_get(json_array_get(rows, i), 7));
	json_decref(object);
	return told;
}

static void test_restart(void)
{
	struct settings settings;
	struct error error = {""};
	struct log log;
	log_init(&log, LOG_LEVEL_ERROR);
	settings_defaults(&settings);
	CHECK_INT(settings_set(&settings, "latency", "yes", &error), 0);
	CHECK_INT(settings_set(&settings, "lab-priority", "0", &error), 0);
	const struct lab_params params = {.settings = &settings.lab, .clock = &real_clock, .log = &log, .period_ns = 8e6};
	struct lab *lab = lab_create(&params, &error);
	CHECK(lab != NULL);
	uint64_t serial = 0;
	for (uint64_t i = 0; i < FLIPS; i++)
		flip(lab, OLD + i, ++serial, true);
	for (uint64_t i = 0; i < 3; i++)
		flip(lab, OLD + FLIPS + i, ++serial, false);
	for (uint64_t i = 0; i < FLIPS; i++)
		flip(lab, NEW + i, ++serial, true);
	CHECK_INT(count_told(lab, 2 * FLIPS), 2 * FLIPS);
	lab_destroy(&lab);
}

int main(void)
{
	clock_init_real(&real_clock);
	RUN(test_restart);
	return test_result();
}
