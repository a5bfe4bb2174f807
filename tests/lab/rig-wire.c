/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/lab/rig-wire.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#define SECOND UINT64_C(1000000000)
#define PULSE_NS UINT64_C(1000000)

struct rig_wire {
	struct clock *clock;
	uint64_t period_ns;
	int fd;
	FILE *truth;
	pthread_t thread;
	atomic_bool stop;
};

static void pull_to(struct rig_wire *wire, uint64_t time_ns, bool high)
{
	const char *word = high ? "pull-up" : "pull-down";
	clock_wait_until(wire->clock, time_ns);
	if (pwrite(wire->fd, word, strlen(word), 0) < 0)
		fprintf(stderr, "wire: %s\n", strerror(errno));
}

/* When it really was: a timer may be late. */
static uint64_t pulse(struct rig_wire *wire, uint64_t time_ns)
{
	clock_wait_until(wire->clock, time_ns);
	const uint64_t edge_ns = clock_now(wire->clock);
	pull_to(wire, time_ns, true);
	pull_to(wire, time_ns + PULSE_NS, false);
	return edge_ns;
}

static void *run(void *data)
{
	struct rig_wire *wire = data;
	const uint64_t start_ns = clock_now(wire->clock);
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	for (uint64_t at_ns = start_ns; !atomic_load(&wire->stop); at_ns += wire->period_ns) {
		const uint64_t second = (at_ns - start_ns) / SECOND % 5;
		if (second == 2) {
			clock_wait_until(wire->clock, at_ns);
			continue;
		}
		fprintf(wire->truth, "%" PRIu64 "\n", pulse(wire, at_ns));
		if (second == 4)
			pulse(wire, at_ns + wire->period_ns * 2 / 5);
	}
	return NULL;
}

struct rig_wire *rig_wire_create(struct clock *clock, const char *pull_path, const char *truth_path, uint64_t period_ns)
{
	struct rig_wire *wire = calloc(1, sizeof(*wire));
	if (!wire)
		return NULL;
	wire->clock = clock;
	wire->period_ns = period_ns;
	wire->fd = open(pull_path, O_WRONLY | O_CLOEXEC);
	wire->truth = fopen(truth_path, "we");
	if (wire->fd >= 0 && wire->truth && pthread_create(&wire->thread, NULL, run, wire) == 0)
		return wire;
	if (wire->truth)
		fclose(wire->truth);
	free(wire);
	return NULL;
}

void rig_wire_destroy(struct rig_wire **wire)
{
	struct rig_wire *self = *wire;
	*wire = NULL;
	if (!self)
		return;
	atomic_store(&self->stop, true);
	pthread_join(self->thread, NULL);
	fclose(self->truth);
	close(self->fd);
	free(self);
}
