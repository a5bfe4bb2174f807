/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Plots of the pacing bench for `pursuit report --tables`, as JSON: how phase errors are distributed, how many vblanks
 * real frames fill, and how pacing settles after steps. 10,000 vblanks each.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/pacing/simulation.h"

#define VBLANKS 10000u
#define BINS 60u
#define ERROR_MOST 0.06
#define TRACE_FROM_S -0.3
#define TRACE_TO_S 1.2

struct pair {
	const char *display, *client;
};

struct collected {
	uint64_t errors[BINS + 1], filled[10], shown, real; /* after settling */
	double last_real_s, vblank_s;
	bool traces, any;
};

static void note(void *data, double time_s, double error, bool real)
{
	struct collected *c = data;
	if (c->traces && time_s >= TRACE_FROM_S && time_s <= TRACE_TO_S) {
		printf("%s[%.4f, %.4f]", c->any ? ", " : "", time_s, error);
		c->any = true;
	}
	if (c->traces || time_s < 1.0)
		return;
	const uint64_t bin = (uint64_t)(fabs(error) / ERROR_MOST * BINS);
	c->errors[bin < BINS ? bin : BINS]++;
	c->shown++;
	if (!real)
		return;
	const uint64_t vblanks = (uint64_t)((time_s - c->last_real_s) / c->vblank_s + 0.5);
	if (c->last_real_s > 0.0 && vblanks < 10) {
		c->filled[vblanks]++;
		c->real++;
	}
	c->last_real_s = time_s;
}

static void simulate(const struct pair *pair, struct collected *collected)
{
	const struct simulated_display *display = simulated_displays;
	const struct simulated_client *client = simulated_clients;
	struct simulation_result result;
	while (strcmp(display->name, pair->display) != 0)
		display++;
	while (strcmp(client->name, pair->client) != 0)
		client++;
	collected->vblank_s = 1.0 / display->hz;
	const struct simulation simulation = {
		.display = *display, .client = *client, .vblanks = VBLANKS, .note = note, .data = collected};
	simulation_run(&simulation, &result);
}

static void begin_plot(const char *title, const char *x, const char *y, bool steps)
{
	printf("{\"title\": \"%s\", \"columns\": [], \"rows\": [], \"plot\": {\"x\": \"%s\", \"y\": \"%s\", \"steps\": %s, "
		   "\"curves\": [",
		   title, x, y, steps ? "true" : "false");
}

static void begin_curve(const struct pair *pair, bool first)
{
	printf("%s\n  {\"name\": \"%s on %s Hz\", \"points\": [", first ? "" : ",", pair->client, pair->display);
}

static void plot_errors(void)
{
	static const struct pair pairs[] = {{"120", "60"},        {"120", "59.94"},        {"143.9", "60"},
										{"120", "60 normal"}, {"119.88 jitter", "45"}, {"120", "50 uneven"}};
	begin_plot("Pacing: phase errors", "phase error below, in real intervals", "share of displayed frames", true);
	for (size_t i = 0; i < sizeof(pairs) / sizeof(pairs[0]); i++) {
		struct collected c = {.shown = 0};
		uint64_t sum = 0;
		simulate(&pairs[i], &c);
		begin_curve(&pairs[i], i == 0);
		for (uint32_t bin = 0; bin < BINS; bin++) {
			sum += c.errors[bin];
			printf("%s[%.4f, %.4f]", bin ? ", " : "", (bin + 1) * ERROR_MOST / BINS, (double)sum / (double)c.shown);
		}
		printf("]}");
	}
	printf("]}},\n");
}

static void plot_intervals(void)
{
	static const struct pair pairs[] = {{"120", "23.976"}, {"120", "45"},      {"120", "59.94"},
										{"120", "72"},     {"120", "60 tail"}, {"143.9", "40"}};
	begin_plot("Pacing: vblanks from real frame to real frame", "vblanks", "share of real frames", true);
	for (size_t i = 0; i < sizeof(pairs) / sizeof(pairs[0]); i++) {
		struct collected c = {.shown = 0};
		simulate(&pairs[i], &c);
		begin_curve(&pairs[i], i == 0);
		for (uint32_t n = 1; n < 10; n++) /* a bar from n - 1/2 to n + 1/2 */
			printf("%s[%.1f, %.4f]", n > 1 ? ", " : "", n - 0.5, (double)c.filled[n] / (double)c.real);
		printf("]}");
	}
	printf("]}},\n");
}

static void plot_settling(void)
{
	static const struct pair pairs[] = {{"120", "60 slower"},  {"120", "60 to 40"},     {"120 to 144", "60"},
										{"120 to 144", "40"},  {"120 to 60", "23.976"}, {"120", "60 ramp 40"},
										{"119.88", "40 to 60"}};
	begin_plot("Pacing: settling after a step at 0 s", "s", "phase error, in real intervals", false);
	for (size_t i = 0; i < sizeof(pairs) / sizeof(pairs[0]); i++) {
		struct collected c = {.traces = true};
		begin_curve(&pairs[i], i == 0);
		simulate(&pairs[i], &c);
		printf("]}");
	}
	printf("]}}\n");
}

int main(void)
{
	printf("[");
	plot_errors();
	plot_intervals();
	plot_settling();
	printf("]\n");
	return 0;
}
