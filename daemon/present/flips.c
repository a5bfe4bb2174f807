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

/*
 * Of the pictures that are due, the last of them queued for `vblank` or one before it. What belongs to the frame on
 * display is shown at its vblank or not at all; a newer real frame is shown at the next possible vblank, with its first
 * picture, whatever of it was due meanwhile. -1: none.
 */
static int choose(const struct flips *flips, uint32_t due, uint64_t vblank)
{
	const struct flips_picture *last = &flips->queue[due - 1];
	int chosen = (int)due - 1;
	if (flips->has_front && last->group == flips->front.group)
		return last->vblank == vblank ? chosen : -1;
	while (chosen > 0 && flips->queue[chosen - 1].group == last->group)
		chosen--;
	return chosen;
}

enum presenter_shown flips_show(struct flips *flips, uint64_t vblank)
{
	uint32_t due = 0;
	while (due < flips->queued && flips->queue[due].vblank <= vblank)
		due++;
	const int chosen = due > 0 ? choose(flips, due, vblank) : -1;
	if (chosen >= 0)
		set_front(flips, &flips->queue[chosen]);
	for (uint32_t i = 0; i < due; i++)
		if ((int)i != chosen)
			flips_release(flips, flips->queue[i].image);
	flips->dropped = due > 0 && chosen != (int)due - 1;
	flips->queued -= due;
	memmove(&flips->queue[0], &flips->queue[due], flips->queued * sizeof(flips->queue[0]));
	return chosen >= 0 ? PRESENTER_PICTURE : show_standby(flips);
}
