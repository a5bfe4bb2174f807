/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The lab on lines that are only here: what its rows say of edges is what was on the wires, however late its thread
 * comes to them.
 */
#include <jansson.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "daemon/lab/chip.h"
#include "daemon/lab/lab.h"
#include "daemon/options.h"
#include "tests/test.h"

#define MS UINT64_C(1000000)
#define PAIRS 20u
#define EDGES 16u

/* Columns of a row. */
enum { FLIP = 11, EDGE = 13, TRIGGER = 15, EDGE_LOST = 20 };

/* ---- lines, in place of libgpiod's ---- */

struct chip {
	bool input;
	int fd; /* readable while there are edges */
	pthread_mutex_t lock;
	struct chip_edge edges[EDGES];
	uint32_t edge_count;
	uint32_t level, rises;
	bool held; /* the call that sets it does not come back until let_go is posted */
	sem_t entered, let_go;
};

static struct chip marker, trigger;
static struct clock real_clock;

static void begin_chip(struct chip *chip, bool input)
{
	*chip = (struct chip){.input = input, .fd = eventfd(0, EFD_NONBLOCK | EFD_SEMAPHORE)};
	pthread_mutex_init(&chip->lock, NULL);
	sem_init(&chip->entered, 0, 0);
	sem_init(&chip->let_go, 0, 0);
}

static void end_chip(struct chip *chip)
{
	close(chip->fd);
	sem_destroy(&chip->entered);
	sem_destroy(&chip->let_go);
	pthread_mutex_destroy(&chip->lock);
}

const char *chip_library(void)
{
	return "none";
}

struct chip *chip_open(const struct chip_params *params, struct error *error)
{
	(void)error;
	return params->input ? &trigger : &marker;
}

void chip_close(struct chip **chip)
{
	*chip = NULL;
}

uint32_t chip_line_count(const struct chip *chip)
{
	(void)chip;
	return 1;
}

const char *chip_text(const struct chip *chip)
{
	(void)chip;
	return "wires";
}

int chip_set(struct chip *chip, uint32_t levels)
{
	pthread_mutex_lock(&chip->lock);
	chip->rises += levels > chip->level;
	chip->level = levels;
	const bool held = chip->held;
	chip->held = false;
	pthread_mutex_unlock(&chip->lock);
	if (held) {
		sem_post(&chip->entered);
		sem_wait(&chip->let_go);
	}
	return 0;
}

int chip_get(struct chip *chip, uint32_t *levels)
{
	*levels = chip->level;
	return 0;
}

int chip_fd(const struct chip *chip)
{
	return chip->input ? chip->fd : -1;
}

int chip_read(struct chip *chip, struct chip_edge *edges, uint32_t most)
{
	uint64_t one;
	uint32_t count = 0;
	pthread_mutex_lock(&chip->lock);
	while (count < most && count < chip->edge_count && read(chip->fd, &one, sizeof(one)) == (ssize_t)sizeof(one)) {
		edges[count] = chip->edges[count];
		count++;
	}
	chip->edge_count -= count;
	memmove(chip->edges, chip->edges + count, chip->edge_count * sizeof(chip->edges[0]));
	pthread_mutex_unlock(&chip->lock);
	return (int)count;
}

static void put_edge(struct chip *chip, uint64_t time_ns)
{
	const uint64_t one = 1;
	pthread_mutex_lock(&chip->lock);
	chip->edges[chip->edge_count++] = (struct chip_edge){time_ns, true};
	CHECK(write(chip->fd, &one, sizeof(one)) == (ssize_t)sizeof(one));
	pthread_mutex_unlock(&chip->lock);
}

/* ---- the lab ---- */

static struct settings settings;
static struct log quiet;

static struct lab *begin_lab(const char *pattern, const char *trigger_line)
{
	const struct lab_params params = {
		.settings = &settings.lab, .clock = &real_clock, .log = &quiet, .period_ns = 8.0 * (double)MS};
	struct error error = {""};
	log_init(&quiet, LOG_LEVEL_ERROR);
	settings_defaults(&settings);
	CHECK_INT(settings_set(&settings, "lab-priority", "0", &error), 0);
	CHECK_INT(settings_set(&settings, "gpio-line", "M", &error), 0);
	CHECK_INT(settings_set(&settings, "gpio-pattern", pattern, &error), 0);
	CHECK_INT(settings_set(&settings, "gpio-pulse-us", "4000", &error), 0);
	CHECK_INT(settings_set(&settings, "trigger-line", trigger_line, &error), 0);
	begin_chip(&marker, false);
	begin_chip(&trigger, true);
	struct lab *lab = lab_create(&params, &error);
	CHECK(lab != NULL);
	return lab;
}

static void end_lab(struct lab *lab)
{
	lab_destroy(&lab);
	end_chip(&marker);
	end_chip(&trigger);
}

static uint64_t now_ns(void)
{
	return clock_now(&real_clock);
}

static void flip(struct lab *lab, uint64_t vblank, uint64_t flip_ns)
{
	const struct presenter_flip event = {.vblank = vblank, .target_ns = flip_ns, .flip_ns = flip_ns};
	const struct points points = {.vblank = vblank};
	lab_flip(lab, &event);
	lab_tell(lab, &points);
}

/* All rows, once there are so many. */
static json_t *wait_for_rows(struct lab *lab, json_int_t wanted)
{
	json_t *object = lab_rows_json(lab, 0, 10000);
	for (int i = 0; i < 6000 && json_integer_value(json_object_get(object, "total")) < wanted; i++) {
		json_decref(object);
		nanosleep(&(struct timespec){0, 10000000}, NULL);
		object = lab_rows_json(lab, 0, 10000);
	}
	json_t *rows = json_incref(json_object_get(object, "rows"));
	CHECK_INT(json_array_size(rows), wanted);
	json_decref(object);
	return rows;
}

static uint64_t value_of(const json_t *rows, size_t row, size_t column)
{
	return (uint64_t)json_integer_value(json_array_get(json_array_get(rows, row), column));
}

/* ---- tests ---- */

/* Pulses of 4 ms at flips that follow each other at once: what merges on the wire is one edge there and in the rows. */
static void test_pulses_that_merge(void)
{
	struct lab *lab = begin_lab("pulse", "");
	for (uint64_t i = 0; i < PAIRS; i++) {
		flip(lab, 2 * i + 1, now_ns());
		flip(lab, 2 * i + 2, now_ns());
		nanosleep(&(struct timespec){0, 20 * (long)MS}, NULL);
	}
	json_t *rows = wait_for_rows(lab, 2 * PAIRS);
	json_t *status = lab_status_json(lab);
	uint64_t known = 0, lost = 0;
	for (size_t i = 0; i < json_array_size(rows); i++) {
		known += value_of(rows, i, EDGE) != 0;
		lost += value_of(rows, i, EDGE_LOST);
	}
	CHECK_INT(known, marker.rises);
	CHECK_INT(lost, 2 * PAIRS - marker.rises);
	CHECK(marker.rises < 2 * PAIRS); /* else nothing was tested */
	CHECK_INT(json_integer_value(json_object_get(status, "edges")), marker.rises);
	json_decref(status);
	json_decref(rows);
	end_lab(lab);
}

/* Edges of the trigger and flips that the lab's thread sees only together. */
static void test_triggers_of_busy_times(void)
{
	struct lab *lab = begin_lab("toggle", "T");
	marker.held = true;
	flip(lab, 1, now_ns());
	sem_wait(&marker.entered);
	uint64_t times[3], flips[3];
	for (int i = 0; i < 3; i++) {
		times[i] = now_ns();
		put_edge(&trigger, times[i]);
		flips[i] = now_ns() + 1;
		/* The second and third edge both come before the third flip; the newer one is its. */
		if (i != 1)
			flip(lab, 2 + (uint64_t)i, flips[i]);
	}
	sem_post(&marker.let_go);
	json_t *rows = wait_for_rows(lab, 3);
	CHECK_INT(value_of(rows, 0, TRIGGER), 0);
	CHECK_INT(value_of(rows, 1, FLIP), flips[0]);
	CHECK_INT(value_of(rows, 1, TRIGGER), times[0]);
	CHECK_INT(value_of(rows, 2, TRIGGER), times[2]);
	json_decref(rows);
	end_lab(lab);
}

int main(void)
{
	clock_init_real(&real_clock);
	RUN(test_pulses_that_merge);
	RUN(test_triggers_of_busy_times);
	return test_result();
}
