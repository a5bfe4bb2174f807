/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/pacing/simulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/present/pacer.h"
#include "daemon/present/vblanks.h"
#include "tests/pacing/random.h"

#define START 1e9
#define HELD 64u /* frames under way */
/* What is ready so close to a vblank may be thought to be on either side of it: times are whole ns. */
#define EDGE_NS 1000.0
/* Two crystals' rates differ by no more. */
#define DRIFT_MOST 2.5e-4

const struct simulated_display simulated_displays[] = {
	{.name = "120", .hz = 120},
	{.name = "119.88", .hz = 120000.0 / 1001, .wished_hz = 120},
	{.name = "119.99", .hz = 119.99, .wished_hz = 120},
	{.name = "143.9", .hz = 143.9, .wished_hz = 144},
	{.name = "60", .hz = 60},
	{.name = "119.88 jitter", .hz = 120000.0 / 1001, .wished_hz = 120, .noise_us = 150, .tail_us = 50},
	{.name = "120 misses", .hz = 120, .noise_us = 20, .miss = 0.02, .counts = true},
	{.name = "120 to 144", .hz = 120, .step_hz = 144, .noise_us = 20},
	{.name = "120 to 60", .hz = 120, .step_hz = 60, .noise_us = 20, .counts = true},
	{.name = "120 suspend", .hz = 120, .suspend_s = 10, .noise_us = 20},
	{.name = NULL},
};

const struct simulated_client simulated_clients[] = {
	{.name = "23.976", .fps = 24000.0 / 1001},
	{.name = "30", .fps = 30},
	{.name = "40", .fps = 40},
	{.name = "45", .fps = 45},
	{.name = "59.94", .fps = 60000.0 / 1001},
	{.name = "60", .fps = 60},
	{.name = "72", .fps = 72},
	{.name = "90", .fps = 90},
	{.name = "119", .fps = 119},
	{.name = "120", .fps = 120},
	{.name = "144", .fps = 144},
	{.name = "60 declared", .fps = 60, .declares = true},
	{.name = "60 normal", .fps = 60, .noise_ms = 0.5, .jitter_ms = 1},
	{.name = "60 tail", .fps = 60, .tail_ms = 1},
	{.name = "45 tail", .fps = 45, .tail_ms = 1},
	{.name = "50 uneven", .fps = 50, .uneven = 0.15},
	{.name = "60 stalls", .fps = 60, .stall_ms = 300},
	{.name = "60 bursts", .fps = 60, .burst = 3},
	{.name = "30 to 120", .fps = 30, .step_fps = 120},
	{.name = "60 to 40", .fps = 60, .step_fps = 40},
	{.name = "40 to 60", .fps = 40, .step_fps = 60},
	{.name = "60 slower", .fps = 60, .age_ms = 5, .step_age_ms = 13.5},
	{.name = "60 ramp 40", .fps = 60, .step_fps = 40, .ramps = true},
	{.name = NULL},
};

struct sent {
	uint64_t id;
	double moment_ns, ready_ns; /* relative to START */
	double arrival_ns;
};

/* One picture on display, first shown at a vblank. */
struct shown {
	double vblank_ns, moment_ns, interval_ns;
	bool real;
};

struct run {
	const struct simulation *simulation;
	struct simulation_result *result;
	struct random random;
	struct vblanks vblanks;
	struct pacer pacer;
	double cost_ns, length_ns, middle_ns;
	double vblank_ns, period_ns; /* the true display: time of this vblank */
	uint64_t sequence;
	uint64_t learned; /* number of the vblank now, as the daemon counts */

	double moment_ns, even_ns, stall_ns; /* the client: of its next frame */
	uint64_t id;
	struct sent held[HELD]; /* sent, not yet taken */
	uint32_t held_count;
	double burst_ns; /* arrival of the burst under way */

	bool has_taken;
	struct sent taken;
	uint64_t taken_vblank; /* true */
	uint32_t n;
	uint64_t first_possible;
	struct shown *shown;
	double *delays, *guesses;
	uint64_t shown_count, guess_count;
};

/* ---- the client ---- */

static double fps_at(const struct run *run, double time_ns)
{
	const struct simulated_client *client = &run->simulation->client;
	const double share = time_ns / run->length_ns;
	if (client->step_fps == 0.0)
		return client->fps;
	if (!client->ramps)
		return share < 0.5 ? client->fps : client->step_fps;
	const double way = fmax(0.0, fmin(1.0, (share - 0.25) * 2.0));
	return client->fps + way * (client->step_fps - client->fps);
}

/* The frames of a burst arrive when its last one does. */
static double arrival_of(struct run *run, double arrival_ns)
{
	const struct simulated_client *client = &run->simulation->client;
	if (client->burst < 2)
		return arrival_ns;
	if (run->id % client->burst == 1)
		run->burst_ns = arrival_ns + (client->burst - 1) * 1e9 / client->fps;
	return run->burst_ns + (double)(run->id % client->burst) * 1000.0;
}

static struct sent send_frame(struct run *run)
{
	const struct simulated_client *client = &run->simulation->client;
	const double interval_ns = 1e9 / fps_at(run, run->moment_ns);
	const double age_ms = client->step_age_ms > 0.0 && run->moment_ns > run->middle_ns ? client->step_age_ms
						  : client->age_ms > 0.0                                       ? client->age_ms
																					   : 5.0;
	const double jitter_ms =
		client->jitter_ms * random_normal(&run->random) + client->tail_ms * random_tail(&run->random, 30.0);
	struct sent frame = {.id = ++run->id,
						 .moment_ns = run->moment_ns + client->noise_ms * 1e6 * random_normal(&run->random)};
	frame.arrival_ns = arrival_of(run, run->moment_ns + fmax(0.1, age_ms + jitter_ms) * 1e6);
	if (run->held_count > 0 && frame.arrival_ns < run->held[run->held_count - 1].arrival_ns)
		frame.arrival_ns = run->held[run->held_count - 1].arrival_ns + 1000.0;
	frame.ready_ns = frame.arrival_ns + run->cost_ns;
	run->even_ns += interval_ns;
	run->moment_ns += interval_ns * fmax(0.2, 1.0 + client->uneven * random_normal(&run->random));
	if (client->stall_ms > 0.0 && floor(run->moment_ns / 2e9) > floor((run->moment_ns - interval_ns) / 2e9))
		run->moment_ns += client->stall_ms * 1e6;
	return frame;
}

static void send_until(struct run *run, double time_ns)
{
	while (run->held_count < HELD && run->moment_ns < time_ns) {
		const struct sent frame = send_frame(run);
		run->held[run->held_count++] = frame;
	}
}

/* ---- the daemon ---- */

/* Drops the first `count` held frames; all but the last of them were superseded. */
static struct sent take_held(struct run *run, uint32_t count)
{
	const struct sent newest = run->held[count - 1];
	run->held_count -= count;
	memmove(run->held, run->held + count, run->held_count * sizeof(run->held[0]));
	run->result->superseded += count - 1;
	return newest;
}

/* Takes the newest frame that the daemon believes to be ready for the coming vblank. */
static void take(struct run *run, uint64_t vblank)
{
	const struct grid *grid = &run->pacer.params.grid;
	const double guess_ns = (double)(int64_t)(grid_time(grid, run->learned) - (uint64_t)START);
	uint32_t ready = 0;
	while (ready < run->held_count && run->held[ready].ready_ns <= guess_ns)
		ready++;
	if (ready == 0)
		return;
	const struct sent newest = take_held(run, ready);
	const struct pacer_frame frame = {
		.frame_id = newest.id,
		.time_ns = (uint64_t)(START + newest.moment_ns),
		.interval_ns = run->simulation->client.declares ? (uint64_t)(1e9 / fps_at(run, newest.moment_ns)) : 0,
		.intake_ns = (uint64_t)(START + newest.arrival_ns),
		.ready_ns = (uint64_t)(START + newest.ready_ns),
	};
	if (run->has_taken)
		run->result->wrong_n += run->n != vblank - run->taken_vblank;
	pacer_add_frame(&run->pacer, &frame);
	run->taken = newest;
	run->has_taken = true;
	run->first_possible = newest.ready_ns + EDGE_NS <= run->vblank_ns - run->period_ns ? vblank - 1 : vblank;
}

static void count_real(struct run *run, const struct pacer_decision *decision, uint64_t vblank)
{
	run->result->real++;
	run->result->plain += decision->phase == 0.0;
	const uint64_t late = vblank - run->first_possible;
	run->result->late += late > 0;
	if (late > run->result->most_late)
		run->result->most_late = (uint32_t)late;
	run->taken_vblank = vblank;
	run->n = decision->n;
}

static void note_shown(struct run *run, const struct pacer_decision *decision)
{
	if (pacer_passes_through(&run->pacer))
		return; /* nothing is extrapolated: frames are shown as they come */
	run->delays[run->shown_count] = (double)run->pacer.delay_ns;
	run->shown[run->shown_count++] =
		(struct shown){run->vblank_ns, run->taken.moment_ns + decision->phase * (double)decision->interval_ns,
					   (double)decision->interval_ns, decision->show == PACER_REAL};
}

static bool streams(const struct run *run)
{
	return run->vblank_ns - run->taken.arrival_ns < 1.5 * 1e9 / fps_at(run, run->taken.moment_ns);
}

static void show(struct run *run, uint64_t vblank)
{
	struct simulation_result *result = run->result;
	const bool missed = random_unit(&run->random) < run->simulation->display.miss;
	const struct pacer_decision decision = pacer_decide(&run->pacer, run->learned);
	if (decision.show == PACER_NOTHING)
		return;
	/* An in-between of a frame taken before is ready long since; a real frame is as it comes. */
	const bool over = decision.show == PACER_REAL && run->taken.ready_ns > run->vblank_ns;
	result->missed += over;
	result->vblanks++;
	if (missed || over) {
		pacer_missed(&run->pacer, &decision);
		run->first_possible = vblank + 1;
		return;
	}
	switch (decision.show) {
	case PACER_NOTHING:
		break;
	case PACER_REAL:
		count_real(run, &decision, vblank);
		note_shown(run, &decision);
		break;
	case PACER_IN_BETWEEN:
		result->in_betweens++;
		note_shown(run, &decision);
		break;
	case PACER_REPEAT:
		result->repeats++;
		result->doubled += !pacer_passes_through(&run->pacer) && streams(run);
		break;
	}
}

/* ---- the display ---- */

/* The flip is over: its stamp tells the daemon what the time was, and so what it will be. */
static void stamp(struct run *run)
{
	const struct simulated_display *display = &run->simulation->display;
	const double late_ns = display->noise_us * 1e3 * random_normal(&run->random) +
						   display->tail_us * 1e3 * random_tail(&run->random, 30.0);
	const uint64_t time_ns = (uint64_t)(START + run->vblank_ns + late_ns);
	run->learned = vblanks_add(&run->vblanks, display->counts ? run->sequence : 0, time_ns);
	const struct grid grid = vblanks_get_grid(&run->vblanks);
	pacer_set_grid(&run->pacer, &grid);
}

static void next_vblank(struct run *run, uint64_t vblank)
{
	const struct simulated_display *display = &run->simulation->display;
	if (vblank == run->simulation->vblanks / 2) {
		run->middle_ns = run->vblank_ns;
		if (display->step_hz > 0.0)
			run->period_ns = 1e9 / display->step_hz;
		run->vblank_ns += display->suspend_s * 1e9;
		if (display->suspend_s > 0.0) { /* the machine slept, the client too */
			run->moment_ns += display->suspend_s * 1e9;
			run->held_count = 0;
		}
	}
	run->vblank_ns += run->period_ns;
	run->sequence++;
	run->learned++;
	const struct grid *grid = &run->pacer.params.grid;
	run->guesses[run->guess_count++] =
		fabs((double)(int64_t)(grid_time(grid, run->learned) - (uint64_t)START) - run->vblank_ns);
}

/* ---- figures ---- */

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double percentile(double *values, uint64_t count, double share)
{
	if (count == 0)
		return 0.0;
	qsort(values, count, sizeof(values[0]), compare);
	return values[(uint64_t)(share * (double)(count - 1))];
}

/* An even march: the delay, and by how much it grows where two crystals differ. */
struct march {
	double at_ns, delay_ns, drift;
};

static double error_of(const struct shown *shown, const struct march *march)
{
	const double delay_ns = march->delay_ns + march->drift * (shown->vblank_ns - march->at_ns);
	return (shown->vblank_ns - shown->moment_ns - delay_ns) / shown->interval_ns;
}

static double off_of(const struct shown *shown, const struct march *march)
{
	return fabs(error_of(shown, march));
}

/* Of the first picture in the last quarter of the run. */
static uint64_t last_quarter(const struct run *run)
{
	uint64_t first = run->shown_count;
	while (first > 0 && run->shown[first - 1].vblank_ns > run->vblank_ns * 0.75)
		first--;
	return first;
}

/* The middle delay of the pictures from `from` to before `to`. */
static double middle_delay(const struct run *run, uint64_t from, uint64_t to, double *scratch)
{
	for (uint64_t i = from; i < to; i++)
		scratch[i - from] = run->shown[i].vblank_ns - run->shown[i].moment_ns;
	return percentile(scratch, to - from, 0.5);
}

static uint64_t shown_since(const struct run *run, double time_ns)
{
	uint64_t first = 0;
	while (first < run->shown_count && run->shown[first].vblank_ns < time_ns)
		first++;
	return first;
}

/* The march that these pictures speak for. */
static struct march find_march(const struct run *run, uint64_t from, uint64_t to, double *scratch)
{
	const uint64_t middle = (from + to) / 2;
	if (to - from < 2)
		return (struct march){0.0, 0.0, 0.0};
	const double way = middle_delay(run, middle, to, scratch) - middle_delay(run, from, middle, scratch);
	const double drift = 2.0 * way / (run->shown[to - 1].vblank_ns - run->shown[from].vblank_ns);
	return (struct march){.at_ns = run->shown[middle].vblank_ns,
						  .delay_ns = middle_delay(run, from, to, scratch),
						  .drift = fabs(drift) <= DRIFT_MOST ? drift : 0.0};
}

/*
 * After `from_ns`: the first moment from which on 19 of 20 pictures of half a second, and of all up to five seconds
 * after from_ns, lie within 0.05 of the march of the last four of these.
 */
static double find_settling(const struct run *run, double from_ns, double *scratch)
{
	const uint64_t first = shown_since(run, from_ns), last = shown_since(run, from_ns + 5e9);
	if (last_quarter(run) == run->shown_count)
		return 0.0; /* it passes through */
	const struct march march = find_march(run, shown_since(run, from_ns + 1e9), last, scratch);
	const struct simulation *s = run->simulation;
	for (uint64_t i = 0; s->note && i < run->shown_count; i++)
		s->note(s->data, (run->shown[i].vblank_ns - from_ns) / 1e9, error_of(&run->shown[i], &march),
				run->shown[i].real);
	uint64_t off_later = 0;
	double settled_ns = INFINITY;
	for (uint64_t i = last; i-- > first;) {
		uint64_t count = 0, off = 0;
		const bool is_off = off_of(&run->shown[i], &march) > 0.0501;
		off_later += is_off;
		for (uint64_t j = i; j < last && run->shown[j].vblank_ns < run->shown[i].vblank_ns + 5e8; j++) {
			count++;
			off += off_of(&run->shown[j], &march) > 0.0501;
		}
		if (!is_off && off * 20 <= count && off_later * 20 <= last - i)
			settled_ns = run->shown[i].vblank_ns;
	}
	return (settled_ns - from_ns) / 1e9;
}

static void judge(struct run *run)
{
	struct simulation_result *result = run->result;
	const uint64_t from = last_quarter(run), count = run->shown_count - from;
	double *scratch = calloc(run->simulation->vblanks + 1, sizeof(double));
	if (!scratch)
		abort();
	const struct march march = find_march(run, from, run->shown_count, scratch);
	for (uint64_t i = from; i < run->shown_count; i++)
		scratch[i - from] = off_of(&run->shown[i], &march);
	result->phase_p50 = percentile(scratch, count, 0.5);
	result->phase_p99 = percentile(scratch, count, 0.99);
	result->phase_most = percentile(scratch, count, 1.0);
	const bool steps = run->simulation->client.step_fps > 0.0 || run->simulation->client.step_age_ms > 0.0 ||
					   run->simulation->display.step_hz > 0.0 || run->simulation->display.suspend_s > 0.0;
	const double from_ns = run->simulation->client.ramps ? run->length_ns * 0.75
						   : steps                       ? run->middle_ns + run->simulation->display.suspend_s * 1e9
						   : run->shown_count            ? run->shown[0].vblank_ns
														 : 0.0;
	result->settle_s = find_settling(run, from_ns, scratch);
	result->delay_ms = (double)run->pacer.delay_ns / 1e6;
	double *delays = run->delays + from;
	result->delay_span_ms = count ? (percentile(delays, count, 1.0) - percentile(delays, count, 0.0)) / 1e6 : 0.0;
	result->interval_ms = (double)run->pacer.interval_ns / 1e6;
	result->vblank_us_off =
		percentile(run->guesses + run->guess_count * 3 / 4, run->guess_count - run->guess_count * 3 / 4, 0.99) / 1e3;
	free(scratch);
}

static void begin(struct run *run)
{
	const struct simulation *s = run->simulation;
	const double wished = s->display.wished_hz > 0.0 ? s->display.wished_hz : s->display.hz;
	run->random.state = s->seed ? s->seed : 1;
	run->cost_ns = (s->cost_ms > 0.0 ? s->cost_ms : 2.0) * 1e6;
	run->period_ns = 1e9 / s->display.hz;
	run->vblank_ns = 3e6;
	run->length_ns = (double)s->vblanks * run->period_ns;
	run->middle_ns = run->length_ns / 2.0;
	run->sequence = 1000;
	vblanks_init(&run->vblanks, (uint64_t)(wished * 1000.0 + 0.5), 1000, (uint64_t)(START + run->vblank_ns));
	const struct pacer_params params = {.grid = vblanks_get_grid(&run->vblanks)};
	pacer_init(&run->pacer, &params);
	run->shown = calloc(s->vblanks, sizeof(*run->shown));
	run->delays = calloc(s->vblanks, sizeof(*run->delays));
	run->guesses = calloc(s->vblanks, sizeof(*run->guesses));
	if (!run->shown || !run->delays || !run->guesses)
		abort();
}

void simulation_run(const struct simulation *simulation, struct simulation_result *result)
{
	struct run run = {.simulation = simulation, .result = result};
	memset(result, 0, sizeof(*result));
	begin(&run);
	for (uint64_t vblank = 1; vblank < simulation->vblanks; vblank++) {
		send_until(&run, run.vblank_ns);
		take(&run, vblank);
		show(&run, vblank);
		if (random_unit(&run.random) >= simulation->display.miss)
			stamp(&run);
		next_vblank(&run, vblank);
	}
	result->frames = run.id;
	const uint64_t known = result->real + result->superseded + run.held_count;
	result->dropped = known < run.id ? run.id - known : 0;
	judge(&run);
	free(run.shown);
	free(run.delays);
	free(run.guesses);
}
