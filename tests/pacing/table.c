/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The table of the pacing bench: every simulated display with every simulated
 * client, 10,000 vblanks each.
 *   pacing-table [--csv | --json] [--vblanks N]
 * --json is a table for `pursuit report --tables`.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/pacing/simulation.h"

static const char *const names[] = {
	"display",   "client",     "vblanks",  "frames",    "real",          "in_betweens", "repeats",       "superseded",
	"dropped",   "doubled",    "late",     "most_late", "missed",        "wrong_n",     "plain",         "phase_p50",
	"phase_p99", "phase_most", "settle_s", "delay_ms",  "delay_span_ms", "interval_ms", "vblank_us_off",
};
#define FIRST_REAL_NUMBER 13u /* of the numbers: phase_p50 */
#define NUMBERS (sizeof(names) / sizeof(names[0]) - 2)

static void numbers_of(const struct simulation_result *r, double numbers[NUMBERS])
{
	const double all[NUMBERS] = {(double)r->vblanks, (double)r->frames,     (double)r->real,    (double)r->in_betweens,
								 (double)r->repeats, (double)r->superseded, (double)r->dropped, (double)r->doubled,
								 (double)r->late,    (double)r->most_late,  (double)r->missed,  (double)r->wrong_n,
								 (double)r->plain,   r->phase_p50,          r->phase_p99,       r->phase_most,
								 r->settle_s,        r->delay_ms,           r->delay_span_ms,   r->interval_ms,
								 r->vblank_us_off};
	memcpy(numbers, all, sizeof(all));
}

static void print_csv(const char *display, const char *client, const double numbers[NUMBERS])
{
	printf("%s,%s", display, client);
	for (size_t i = 0; i < NUMBERS; i++)
		printf(i < FIRST_REAL_NUMBER ? ",%.0f" : ",%.4f", numbers[i]);
	printf("\n");
}

static void print_json(const char *display, const char *client, const double numbers[NUMBERS], bool first)
{
	printf("%s\n  [\"%s\", \"%s\"", first ? "" : ",", display, client);
	for (size_t i = 0; i < NUMBERS; i++) {
		if (numbers[i] < 1e300)
			printf(i < FIRST_REAL_NUMBER ? ", %.0f" : ", %.4f", numbers[i]);
		else
			printf(", null");
	}
	printf("]");
}

static void print_json_head(void)
{
	printf("{\"title\": \"Pacing: simulated displays and clients\", \"columns\": [");
	for (size_t i = 0; i < NUMBERS + 2; i++)
		printf("%s\"%s\"", i ? ", " : "", names[i]);
	printf("], \"rows\": [");
}

static void print_text_head(void)
{
	printf("display        client         real  betw   rep  doub  drop late wrong  phase "
		   "p50 p99 most  settle  delay ms    span  vblank us\n");
}

static void print_text(const char *display, const char *client, const struct simulation_result *r)
{
	printf("%-14s %-12s %6" PRIu64 " %6" PRIu64 " %5" PRIu64 " %5" PRIu64 " %5" PRIu64 " %4" PRIu64 " %5" PRIu64
		   "  %.3f %.3f %.3f  %6.3f  %8.3f %7.3f  %6.1f\n",
		   display, client, r->real, r->in_betweens, r->repeats, r->doubled, r->dropped, r->late, r->wrong_n,
		   r->phase_p50, r->phase_p99, r->phase_most, r->settle_s, r->delay_ms, r->delay_span_ms, r->vblank_us_off);
}

int main(int argc, char **argv)
{
	uint64_t vblanks = 10000;
	bool csv = false, json = false, first = true;
	for (int i = 1; i < argc; i++) {
		csv |= strcmp(argv[i], "--csv") == 0;
		json |= strcmp(argv[i], "--json") == 0;
		if (strcmp(argv[i], "--vblanks") == 0 && i + 1 < argc)
			vblanks = strtoull(argv[++i], NULL, 10);
	}
	if (vblanks < 100 || vblanks > 10000000) {
		fprintf(stderr, "pacing-table: --vblanks is not from 100 to 10000000\n");
		return 2;
	}
	for (size_t i = 0; csv && i < NUMBERS + 2; i++)
		printf("%s%s", i ? "," : "", names[i]);
	if (csv)
		printf("\n");
	else if (json)
		print_json_head();
	else
		print_text_head();
	for (const struct simulated_display *d = simulated_displays; d->name; d++) {
		for (const struct simulated_client *c = simulated_clients; c->name; c++) {
			const struct simulation simulation = {.display = *d, .client = *c, .vblanks = vblanks};
			struct simulation_result result;
			double numbers[NUMBERS];
			simulation_run(&simulation, &result);
			numbers_of(&result, numbers);
			if (csv)
				print_csv(d->name, c->name, numbers);
			else if (json)
				print_json(d->name, c->name, numbers, first);
			else
				print_text(d->name, c->name, &result);
			first = false;
		}
	}
	if (json)
		printf("\n]}\n");
	return 0;
}
