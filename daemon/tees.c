/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/tees.h"

#include <inttypes.h>
#include <string.h>

/* The oldest ones. */
static void close_first(struct tees *tees, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		tees->close(tees->data, tees->before[i].tee);
	tees->count -= count;
	memmove(&tees->before[0], &tees->before[count], tees->count * sizeof(tees->before[0]));
}

/* Those without a picture after this one. */
static void close_up_to(struct tees *tees, uint64_t serial)
{
	uint32_t count = 0;
	while (count < tees->count && tees->before[count].last <= serial)
		count++;
	close_first(tees, count);
}

void tees_follow(struct tees *tees, struct tee *tee, uint64_t group, uint64_t serial)
{
	if (tees->now && serial == tees->since)
		tees->close(tees->data, tees->now);
	else if (tees->now) {
		if (tees->count == TEES_BEFORE) {
			log_warning(tees->log,
						"tee: changed more than %u times within a real frame; pictures up to %" PRIu64
						" that are still "
						"to be shown are in no file",
						TEES_BEFORE, tees->before[0].last);
			close_first(tees, 1);
		}
		tees->before[tees->count++] = (struct tees_before){tees->now, tees->since, serial, group};
	}
	tees->now = tee;
	tees->since = serial;
}

void tees_flip(struct tees *tees, const struct presenter_flip *flip, const struct grid *grid)
{
	uint32_t over = 0;
	while (over < tees->count && tees->before[over].group < flip->group)
		over++;
	close_first(tees, over);
	if (tees->now && flip->serial > tees->since)
		tee_flip(tees->now, flip, grid);
	for (uint32_t i = 0; i < tees->count; i++)
		if (flip->serial > tees->before[i].since && flip->serial <= tees->before[i].last)
			tee_flip(tees->before[i].tee, flip, grid);
	if (tees->awaited != 0 && flip->serial == tees->awaited) {
		close_up_to(tees, tees->awaited);
		tees->awaited = 0;
	}
}

void tees_rest(struct tees *tees, uint64_t awaited)
{
	tees->awaited = awaited;
	if (awaited == 0)
		close_first(tees, tees->count);
}

void tees_finish(struct tees *tees)
{
	for (uint32_t i = 0; i < tees->count; i++)
		tee_destroy(&tees->before[i].tee);
	tees->count = 0;
	tee_destroy(&tees->now);
}
