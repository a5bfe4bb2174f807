/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A presenter and the lab without engine and client: a real frame and two
 * in-betweens at a time, tiny pictures, each queued for its vblank. Who checks
 * it watches the kernel's tracepoints, not this program.
 *
 *   rig-lab [--flips F] [--pull PULL_FILE TRUTH_FILE] [--wire PULL_FILE TRUTH_FILE PERIOD_NS] [--bare]
 *           [--SETTING VALUE]...
 *
 * Prints the lab's status as JSON, with "flips", "cpu_us_per_flip" (of all
 * threads) and "threads" (of each; rig-cost.h, also for --bare). With --pull it plays the photodiode too (rig-pull.h),
 * with --wire the vsync of a display (rig-wire.h).
 */
#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <sys/resource.h>

#include "daemon/clock.h"
#include "daemon/lab/lab.h"
#include "daemon/options.h"
#include "daemon/present/presenter.h"
#include "tests/lab/rig-cost.h"
#include "tests/lab/rig-pull.h"
#include "tests/lab/rig-wire.h"
#include "tests/test.h"

#define PICTURE 16u
#define AHEAD 3u
#define CYCLE 3u
#define LAB_GROUPS (1u << OPTION_LAB | 1u << OPTION_OUTPUT)

struct rig {
	struct settings settings;
	struct clock clock;
	struct log log;
	struct lab *lab;
	struct presenter *presenter;
	struct rig_pull *pull;
	const char *pull_path, *truth_path;
	struct rig_wire *wire;
	const char *wire_path, *wire_truth;
	uint64_t wire_ns;
	struct rig_cost *bare;
	bool bare_wanted;
	json_t *threads;
	uint64_t flips_wanted, first_vblank;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	struct presenter_flip flip; /* the newest */
	uint64_t flips;
};

static void on_flip(void *data, const struct presenter_flip *flip)
{
	struct rig *rig = data;
	lab_flip(rig->lab, flip);
	rig_pull_flip(rig->pull, flip);
	rig_cost_flip(rig->bare);
	pthread_mutex_lock(&rig->lock);
	rig->flip = *flip;
	rig->flips++;
	pthread_cond_signal(&rig->wake);
	pthread_mutex_unlock(&rig->lock);
}

static void on_lost(void *data, const char *sentence)
{
	(void)data;
	fprintf(stderr, "the display is lost: %s\n", sentence);
	exit(1);
}

static enum points_show show_of(const struct rig *rig, uint64_t vblank)
{
	return (vblank - rig->first_vblank) % CYCLE ? POINTS_IN_BETWEEN : POINTS_REAL;
}

static void queue_picture(struct rig *rig, uint64_t vblank)
{
	const struct presenter_impl *impl = rig->presenter->impl;
	const uint64_t serial = vblank - rig->first_vblank + 1, group = (serial - 1) / CYCLE + 1;
	struct presenter_image image;
	if (impl->acquire(rig->presenter, PICTURE, PICTURE, &image) < 0)
		return;
	lab_mark_picture(rig->lab, &image, serial, vblank, show_of(rig, vblank));
	if (impl->present(rig->presenter, &image, vblank, group, serial) < 0)
		impl->release(rig->presenter, &image);
}

static void tell(struct rig *rig, const struct presenter_flip *flip)
{
	struct points points = {.vblank = flip->vblank, .frame_id = flip->group, .show = (uint8_t)POINTS_KEPT};
	if (flip->shown == PRESENTER_PICTURE)
		points.show = (uint8_t)show_of(rig, flip->vblank);
	points.time[POINT_READY] = flip->target_ns - 2000000;
	points.time[POINT_SUBMIT] = flip->target_ns - 9000000;
	points.time[POINT_INTAKE] = flip->target_ns - 8900000;
	snprintf(points.method, sizeof(points.method), "none");
	lab_tell(rig->lab, &points);
}

static void show_all(struct rig *rig)
{
	const struct grid grid = rig->presenter->impl->get_grid(rig->presenter);
	uint64_t next = grid_at_or_after(&grid, clock_now(&rig->clock)) + 6;
	rig->first_vblank = next;
	while (next < rig->first_vblank + AHEAD)
		queue_picture(rig, next++);
	for (uint64_t done = 0; done < rig->flips_wanted; done++) {
		pthread_mutex_lock(&rig->lock);
		while (rig->flips <= done)
			pthread_cond_wait(&rig->wake, &rig->lock);
		const struct presenter_flip flip = rig->flip;
		pthread_mutex_unlock(&rig->lock);
		tell(rig, &flip);
		if (next < rig->first_vblank + rig->flips_wanted)
			queue_picture(rig, next++);
	}
}

static void report(struct rig *rig)
{
	struct rusage usage;
	json_t *status = rig->lab ? lab_status_json(rig->lab) : json_object();
	getrusage(RUSAGE_SELF, &usage);
	const double cpu = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1e6 +
					   (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
	json_object_set_new(status, "threads", rig->threads);
	json_object_set_new(status, "flips", json_integer((json_int_t)rig->flips));
	json_object_set_new(status, "first_vblank", json_integer((json_int_t)rig->first_vblank));
	json_object_set_new(status, "cpu_us_per_flip", json_real(cpu / (double)rig->flips));
	json_dumpf(status, stdout, JSON_COMPACT | JSON_REAL_PRECISION(9));
	printf("\n");
	json_decref(status);
}

static int parse(struct rig *rig, int argc, char **argv, struct error *error)
{
	settings_defaults(&rig->settings);
	rig->flips_wanted = 120;
	for (int i = 1; i < argc; i++) {
		if (strcmp(argv[i], "--flips") == 0 && i + 1 < argc) {
			rig->flips_wanted = strtoull(argv[++i], NULL, 10);
			continue;
		}
		if (strcmp(argv[i], "--pull") == 0 && i + 2 < argc) {
			rig->pull_path = argv[++i];
			rig->truth_path = argv[++i];
			continue;
		}
		if (strcmp(argv[i], "--wire") == 0 && i + 3 < argc) {
			rig->wire_path = argv[++i];
			rig->wire_truth = argv[++i];
			rig->wire_ns = strtoull(argv[++i], NULL, 10);
			continue;
		}
		if (strcmp(argv[i], "--bare") == 0) {
			rig->bare_wanted = true;
			continue;
		}
		const int taken = settings_argument(&rig->settings, LAB_GROUPS, argc, argv, &i, error);
		if (taken < 0)
			return taken;
		if (taken == 0)
			return error_set(error, -EINVAL, "%s: no such option", argv[i]);
	}
	return 0;
}

static int start(struct rig *rig, struct error *error)
{
	const struct lab_params lab_params = {&rig->settings.lab, &rig->clock, &rig->log, 1e9 / 120.0, "program: rig-lab"};
	struct presenter_params params = {
		.clock = &rig->clock,
		.log = &rig->log,
		.refresh_numerator = rig->settings.refresh_numerator,
		.refresh_denominator = rig->settings.refresh_denominator,
		.options = {.mode = rig->settings.mode},
		.flip = on_flip,
		.lost = on_lost,
		.data = rig,
	};
	clock_init_real(&rig->clock);
	log_init(&rig->log, LOG_LEVEL_INFO);
	pthread_mutex_init(&rig->lock, NULL);
	pthread_cond_init(&rig->wake, NULL);
	if (lab_is_wanted(&rig->settings.lab)) {
		rig->lab = lab_create(&lab_params, error);
		if (!rig->lab)
			return -1;
	}
	params.vsync = lab_get_vsync(rig->lab);
	if (rig->pull_path && !(rig->pull = rig_pull_create(&rig->clock, rig->pull_path, rig->truth_path)))
		return error_set(error, -EIO, "%s or %s cannot be opened", rig->pull_path, rig->truth_path);
	if (rig->wire_path && !(rig->wire = rig_wire_create(&rig->clock, rig->wire_path, rig->wire_truth, rig->wire_ns)))
		return error_set(error, -EIO, "%s or %s cannot be opened", rig->wire_path, rig->wire_truth);
	if (rig->bare_wanted && !(rig->bare = rig_cost_create(rig->settings.lab.priority)))
		return error_set(error, -EAGAIN, "no bare thread");
	rig->presenter = presenter_create(rig->settings.present, &params, error);
	return rig->presenter ? 0 : -1;
}

int main(int argc, char **argv)
{
	static struct rig rig;
	struct error error = {""};
	if (parse(&rig, argc, argv, &error) < 0 || start(&rig, &error) < 0) {
		fprintf(stderr, "%s\n", error.text);
		return 1;
	}
	show_all(&rig);
	rig.presenter->impl->pause(rig.presenter);
	/* Rows settle, light comes. */
	clock_wait_until(&rig.clock, clock_now(&rig.clock) + 1500000000);
	rig.threads = rig_cost_threads(rig.flips);
	presenter_destroy(&rig.presenter);
	rig_cost_destroy(&rig.bare);
	rig_pull_destroy(&rig.pull);
	rig_wire_destroy(&rig.wire);
	report(&rig);
	lab_destroy(&rig.lab);
	return 0;
}
