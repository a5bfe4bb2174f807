/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/flips.h"

#include <assert.h>
#include <string.h>

int flips_acquire(struct flips *flips)
{
	for (uint32_t i = 0; i < FLIPS_IMAGES; i++) {
		if (flips->references[i] == 0) {
			flips->references[i] = 1;
			return (int)i;
		}
	}
	return -1;
}

void flips_release(struct flips *flips, uint32_t image)
{
	assert(image < FLIPS_IMAGES && flips->references[image] > 0);
	flips->references[image]--;
}

static void drop_queued_from(struct flips *flips, uint64_t vblank)
{
	while (flips->queued > 0 && flips->queue[flips->queued - 1].vblank >= vblank)
		flips_release(flips, flips->queue[--flips->queued].image);
}

bool flips_present(struct flips *flips, uint32_t image, uint64_t vblank, uint64_t group, uint64_t serial)
{
	drop_queued_from(flips, vblank);
	if (flips->queued == FLIPS_QUEUED)
		return false;
	flips->queue[flips->queued++] = (struct flips_picture){vblank, serial, group, image};
	return true;
}

static void remove_standby(struct flips *flips, uint32_t index)
{
	flips_release(flips, flips->standby[index].image);
	flips->standbys--;
	memmove(&flips->standby[index], &flips->standby[index + 1], (flips->standbys - index) * sizeof(flips->standby[0]));
}

void flips_set_standby(struct flips *flips, uint32_t image, uint64_t group, uint64_t serial)
{
	for (uint32_t i = flips->standbys; i-- > 0;)
		if (flips->standby[i].group == group)
			remove_standby(flips, i);
	if (flips->standbys == FLIPS_STANDBYS)
		remove_standby(flips, 0);
	flips->standby[flips->standbys++] = (struct flips_picture){0, serial, group, image};
}

void flips_clear_standby(struct flips *flips)
{
	while (flips->standbys > 0)
		remove_standby(flips, flips->standbys - 1);
}

/* The picture's reference becomes the front's. */
static void set_front(struct flips *flips, const struct flips_picture *picture)
{
	if (flips->has_front)
		flips_release(flips, flips->front.image);
	flips->front = *picture;
	flips->has_front = true;
	/* Standby pictures of groups that are over. */
	for (uint32_t i = flips->standbys; i-- > 0;)
		if (flips->standby[i].group < picture->group)
			remove_standby(flips, i);
}

static enum presenter_shown show_standby(struct flips *flips)
{
	for (uint32_t i = 0; flips->has_front && i < flips->standbys; i++) {
		const struct flips_picture standby = flips->standby[i];
		if (standby.group == flips->front.group && standby.serial != flips->front.serial) {
			flips->references[standby.image]++;
			set_front(flips, &standby);
			return PRESENTER_STANDBY;
		}
	}
	return PRESENTER_KEPT;
}

enum presenter_shown flips_show(struct flips *flips, uint64_t vblank)
{
	struct flips_picture next = {0};
	bool found = false;
	uint32_t passed = 0;

	while (passed < flips->queued && flips->queue[passed].vblank <= vblank) {
		if (found)
			flips_release(flips, next.image);
		next = flips->queue[passed++];
		found = next.vblank == vblank;
		if (!found)
			flips_release(flips, next.image);
	}
	flips->queued -= passed;
	memmove(&flips->queue[0], &flips->queue[passed], flips->queued * sizeof(flips->queue[0]));
	if (!found)
		return show_standby(flips);
	set_front(flips, &next);
	return PRESENTER_PICTURE;
}
