/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/scanout.h"

static bool is_same(const struct scanout_picture *picture, const struct flips_picture *front)
{
	return picture->any && picture->image == front->image && picture->serial == front->serial;
}

void scanout_start(struct scanout *scanout, uint64_t vblank)
{
	scanout->is_waiting = scanout->paused = false;
	scanout->next_vblank = vblank > scanout->told ? vblank : scanout->told;
}

void scanout_pause(struct scanout *scanout)
{
	scanout->paused = true;
}

int scanout_choose(struct scanout *scanout, uint64_t vblank)
{
	struct flips *flips = &scanout->flips;
	const enum presenter_shown chosen_as = flips_show(flips, vblank);

	scanout->dropped |= flips->dropped;
	if (chosen_as != PRESENTER_KEPT) {
		scanout->chosen_as = chosen_as;
		scanout->chosen_vblank = chosen_as == PRESENTER_PICTURE ? flips->front.vblank : vblank;
	}
	if (!flips->has_front || scanout->under_way.any || is_same(&scanout->shown, &flips->front))
		return -1;
	flips->references[flips->front.image]++;
	scanout->under_way = (struct scanout_picture){true, flips->front.image, flips->front.serial, flips->front.group};
	scanout->under_way_vblank = vblank;
	scanout->under_way_wanted = scanout->chosen_vblank;
	scanout->under_way_as = scanout->chosen_as;
	return (int)flips->front.image;
}

void scanout_failed(struct scanout *scanout)
{
	if (scanout->under_way.any)
		flips_release(&scanout->flips, scanout->under_way.image);
	scanout->under_way.any = false;
}

static void report(struct scanout *scanout, const struct presenter_flip *flip, struct presenter_flip *out)
{
	*out = *flip;
	out->serial = scanout->shown.any ? scanout->shown.serial : 0;
	out->group = scanout->shown.any ? scanout->shown.group : 0;
	out->shown = scanout->fresh ? scanout->fresh_as : PRESENTER_KEPT;
	out->late = scanout->fresh && scanout->fresh_late;
	out->skipped = 0;
	out->dropped = scanout->dropped;
	scanout->fresh = scanout->dropped = false;
	scanout->told = flip->vblank + 1;
}

static void report_next(struct scanout *scanout, const struct presenter_flip *flip, struct presenter_flip *out)
{
	report(scanout, flip, out);
	out->skipped = (uint32_t)(flip->vblank - scanout->next_vblank);
	scanout->next_vblank = flip->vblank + 1;
}

static uint32_t report_waiting(struct scanout *scanout, struct presenter_flip *out)
{
	if (!scanout->is_waiting)
		return 0;
	scanout->is_waiting = false;
	report_next(scanout, &scanout->waiting, out);
	return 1;
}

/* No report of its vblank will follow: it was in a pause. */
static uint32_t report_in_pause(struct scanout *scanout, const struct presenter_flip *flip, struct presenter_flip *out)
{
	const bool is_before = scanout->paused || flip->vblank < scanout->next_vblank;
	if (!scanout->fresh || !is_before || flip->vblank < scanout->told)
		return 0;
	report(scanout, flip, out);
	return 1;
}

uint32_t scanout_flipped(struct scanout *scanout, const struct presenter_flip *flip, struct presenter_flip reports[2])
{
	uint32_t count = 0;
	if (!scanout->under_way.any)
		return 0;
	if (scanout->is_waiting && scanout->waiting.vblank < flip->vblank)
		count = report_waiting(scanout, reports);
	if (scanout->shown.any)
		flips_release(&scanout->flips, scanout->shown.image);
	scanout->shown = scanout->under_way;
	scanout->under_way.any = false;
	scanout->fresh = true;
	scanout->fresh_as = scanout->under_way_as;
	scanout->fresh_wanted = scanout->under_way_wanted;
	scanout->fresh_late = flip->vblank > scanout->fresh_wanted;
	count += report_waiting(scanout, reports + count);
	return count + report_in_pause(scanout, flip, reports + count);
}

uint32_t scanout_vblank(struct scanout *scanout, const struct presenter_flip *flip, struct presenter_flip reports[2])
{
	const uint32_t count = report_waiting(scanout, reports);
	if (flip->vblank < scanout->next_vblank)
		return count;
	if (scanout->under_way.any && scanout->under_way_vblank <= flip->vblank) {
		scanout->waiting = *flip;
		scanout->is_waiting = true;
		return count;
	}
	report_next(scanout, flip, reports + count);
	return count + 1;
}
