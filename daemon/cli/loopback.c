/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "loopback.h"

#include <errno.h>
#include <poll.h>
#include <sched.h>
#include <stddef.h>
#include <string.h>

#include "daemon/clock.h"
#include "daemon/lab/chip.h"

#define LOST_MS 100
#define PRIORITY 20
#define FIRST_TRIES 3u

bool loopback_are_lines(const char *lines)
{
	const char *colon = strchr(lines, ':');
	return colon && colon != lines && colon[1] && !strchr(lines, ',') && colon - lines < (ptrdiff_t)CHIP_NAME_BYTES &&
		   strlen(colon + 1) < CHIP_NAME_BYTES;
}

static int open_both(const struct loopback_params *params, struct chip *chips[2], struct error *error)
{
	char out[CHIP_NAME_BYTES], in[CHIP_NAME_BYTES];
	const char *colon = strchr(params->lines, ':');
	if (!loopback_are_lines(params->lines))
		return error_set(error, -EINVAL, "--loopback is %.64s, must be OUT:IN, two lines by offset or name",
						 params->lines);
	snprintf(out, sizeof(out), "%.*s", (int)(colon - params->lines), params->lines);
	snprintf(in, sizeof(in), "%s", colon + 1);
	const struct chip_params output = {.chip = params->chip, .lines = out, .option = "loopback output"};
	const struct chip_params input = {.chip = params->chip, .lines = in, .option = "loopback input", .input = true};
	chips[0] = chip_open(&output, error);
	chips[1] = chips[0] ? chip_open(&input, error) : NULL;
	return chips[1] ? 0 : -ENODEV;
}

/* The edge of this direction; those that came before the line was set are no answer. 0: none. */
static uint64_t wait_for_edge(struct chip *input, bool rising, uint64_t since_ns)
{
	struct pollfd poll_fd = {.fd = chip_fd(input), .events = POLLIN};
	struct chip_edge edges[16];
	while (poll(&poll_fd, 1, LOST_MS) > 0) {
		const int count = chip_read(input, edges, 16);
		for (int i = 0; i < count; i++)
			if (edges[i].rising == rising && edges[i].time_ns >= since_ns)
				return edges[i].time_ns;
		if (count < 0)
			return 0;
	}
	return 0;
}

static int measure_edge(struct chip *const chips[2], struct clock *clock, bool level, struct loopback_result *result)
{
	const uint64_t before_ns = clock_now(clock);
	const int failed = chip_set(chips[0], level);
	const uint64_t after_ns = clock_now(clock);
	if (failed < 0)
		return failed;
	histogram_add(&result->set, (int64_t)(after_ns - before_ns));
	const uint64_t edge_ns = wait_for_edge(chips[1], level, before_ns);
	if (edge_ns == 0)
		result->lost++;
	else
		histogram_add(level ? &result->rising : &result->falling, (int64_t)(edge_ns - before_ns));
	return 0;
}

static int measure(const struct loopback_params *params, struct chip *const chips[2], struct loopback_result *result,
				   struct error *error)
{
	struct clock clock;
	clock_init_real(&clock);
	for (uint32_t i = 0; i < 2 * params->count; i++) {
		const uint64_t next_ns = clock_now(&clock) + (uint64_t)params->interval_us * 1000;
		const int failed = measure_edge(chips, &clock, i % 2 == 0, result);
		if (failed < 0)
			return error_set(error, failed, "the line cannot be set any more: %s", strerror(-failed));
		if (result->lost >= FIRST_TRIES && result->rising.count + result->falling.count == 0)
			return error_set(error, -ENXIO, "no edge arrives: is there a wire from the one line to the other of %s?",
							 params->lines);
		clock_wait_until(&clock, next_ns);
	}
	return 0;
}

int loopback_measure(const struct loopback_params *params, struct loopback_result *result, struct error *error)
{
	const struct sched_param priority = {.sched_priority = PRIORITY};
	struct chip *chips[2] = {NULL, NULL};
	memset(result, 0, sizeof(*result));
	int failed = open_both(params, chips, error);
	if (failed == 0) {
		const bool realtime = sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
		snprintf(result->text, sizeof(result->text), "%.90s, %s, %s", chip_text(chips[0]), chip_library(),
				 realtime ? "real-time priority" : "no real-time priority (not permitted)");
		failed = measure(params, chips, result, error);
	}
	chip_close(&chips[0]);
	chip_close(&chips[1]);
	return failed;
}
