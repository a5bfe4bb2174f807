/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What a display controller is given and what its vblanks are reported to have shown; nothing is drawn into too early.
 */

#include "daemon/present/scanout.h"
#include "tests/test.h"

static uint32_t queue(struct scanout *scanout, uint64_t vblank, uint64_t group, uint64_t serial)
{
	const int image = flips_acquire(&scanout->flips);
	CHECK(image >= 0);
	CHECK(flips_present(&scanout->flips, (uint32_t)image, vblank, group, serial));
	return (uint32_t)image;
}

static uint32_t vblank_comes(struct scanout *scanout, uint64_t vblank, struct presenter_flip reports[2])
{
	const struct presenter_flip flip = {.vblank = vblank, .target_ns = vblank * 100, .flip_ns = vblank * 100 + 3};
	return scanout_vblank(scanout, &flip, reports);
}

static uint32_t flip_ends(struct scanout *scanout, uint64_t vblank, struct presenter_flip reports[2])
{
	const struct presenter_flip flip = {.vblank = vblank, .target_ns = vblank * 100, .flip_ns = vblank * 100 + 3};
	return scanout_flipped(scanout, &flip, reports);
}

static void expect(const struct presenter_flip *flip, uint64_t vblank, enum presenter_shown shown, uint64_t serial,
				   bool late)
{
	CHECK_INT(flip->vblank, vblank);
	CHECK_INT(flip->shown, shown);
	CHECK_INT(flip->serial, serial);
	CHECK_INT(flip->late, late);
	CHECK_INT(flip->flip_ns, vblank * 100 + 3);
}

static uint32_t in_use(const struct scanout *scanout)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < FLIPS_IMAGES; i++)
		count += scanout->flips.references[i] != 0;
	return count;
}

/* The kernel tells of the flip before the vblank, or after it. */
static void test_either_order(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	scanout_start(&scanout, 5);
	const uint32_t first = queue(&scanout, 5, 1, 1), second = queue(&scanout, 6, 1, 2);
	CHECK_INT(scanout_choose(&scanout, 5), first);
	CHECK_INT(flip_ends(&scanout, 5, reports), 0);
	CHECK_INT(vblank_comes(&scanout, 5, reports), 1);
	expect(&reports[0], 5, PRESENTER_PICTURE, 1, false);
	CHECK_INT(scanout_choose(&scanout, 6), second);
	CHECK_INT(in_use(&scanout), 2); /* one on display, one under way */
	CHECK_INT(vblank_comes(&scanout, 6, reports), 0);
	CHECK_INT(flip_ends(&scanout, 6, reports), 1);
	expect(&reports[0], 6, PRESENTER_PICTURE, 2, false);
	CHECK_INT(in_use(&scanout), 1);
	CHECK_INT(scanout_choose(&scanout, 7), -1);
	CHECK_INT(vblank_comes(&scanout, 7, reports), 1);
	expect(&reports[0], 7, PRESENTER_KEPT, 2, false);
	CHECK_INT(reports[0].skipped, 0);
}

/* A flip that comes a vblank too late: the vblank before kept its picture, the next one shows it, what was queued for
 * that one is shown after it. */
static void test_missed_flip(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	queue(&scanout, 0, 1, 1);
	scanout_choose(&scanout, 0);
	flip_ends(&scanout, 0, reports);
	vblank_comes(&scanout, 0, reports);
	queue(&scanout, 1, 1, 2);
	queue(&scanout, 2, 2, 3); /* a real frame */
	scanout_choose(&scanout, 1);
	CHECK_INT(vblank_comes(&scanout, 1, reports), 0);
	CHECK_INT(scanout_choose(&scanout, 2), -1); /* under way still */
	CHECK_INT(in_use(&scanout), 3);
	CHECK_INT(flip_ends(&scanout, 2, reports), 1);
	expect(&reports[0], 1, PRESENTER_KEPT, 1, false);
	CHECK_INT(vblank_comes(&scanout, 2, reports), 1);
	expect(&reports[0], 2, PRESENTER_PICTURE, 2, true);
	CHECK(scanout_choose(&scanout, 3) >= 0);
	flip_ends(&scanout, 3, reports);
	CHECK_INT(vblank_comes(&scanout, 3, reports), 1);
	expect(&reports[0], 3, PRESENTER_PICTURE, 3, true);
	CHECK_INT(reports[0].group, 2);
	CHECK_INT(in_use(&scanout), 1);
}

/* The flip is never heard of while two vblanks pass. */
static void test_silent_flip(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	queue(&scanout, 0, 1, 1);
	scanout_choose(&scanout, 0);
	CHECK_INT(vblank_comes(&scanout, 0, reports), 0);
	CHECK_INT(vblank_comes(&scanout, 1, reports), 1);
	expect(&reports[0], 0, PRESENTER_KEPT, 0, false);
	CHECK_INT(flip_ends(&scanout, 1, reports), 1);
	expect(&reports[0], 1, PRESENTER_PICTURE, 1, true);
}

static void test_refused_flip(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	const uint32_t image = queue(&scanout, 0, 1, 1);
	CHECK_INT(scanout_choose(&scanout, 0), image);
	scanout_failed(&scanout);
	CHECK_INT(vblank_comes(&scanout, 0, reports), 1);
	expect(&reports[0], 0, PRESENTER_KEPT, 0, false);
	CHECK_INT(scanout_choose(&scanout, 1), image); /* tried again */
	flip_ends(&scanout, 1, reports);
	CHECK_INT(vblank_comes(&scanout, 1, reports), 1);
	expect(&reports[0], 1, PRESENTER_PICTURE, 1, true);
}

/* What comes on display in a pause is reported with that vblank, once, in the order of vblanks. */
static void test_flip_in_a_pause(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	queue(&scanout, 1, 1, 1);
	scanout_choose(&scanout, 1);
	scanout_pause(&scanout);
	CHECK_INT(flip_ends(&scanout, 7, reports), 1);
	expect(&reports[0], 7, PRESENTER_PICTURE, 1, true);
	CHECK_INT(reports[0].skipped, 0);
	scanout_start(&scanout, 9);
	CHECK_INT(vblank_comes(&scanout, 9, reports), 1);
	expect(&reports[0], 9, PRESENTER_KEPT, 1, false);
	CHECK_INT(reports[0].skipped, 0);
	queue(&scanout, 10, 1, 2);
	scanout_choose(&scanout, 10);
	scanout_pause(&scanout);
	scanout_start(&scanout, 12); /* before its flip ends */
	CHECK_INT(flip_ends(&scanout, 10, reports), 1);
	expect(&reports[0], 10, PRESENTER_PICTURE, 2, false);
	CHECK_INT(vblank_comes(&scanout, 11, reports), 0);
	CHECK_INT(vblank_comes(&scanout, 12, reports), 1);
	expect(&reports[0], 12, PRESENTER_KEPT, 2, false);
}

/* The pause comes between a vblank and the end of its flip: neither is lost. */
static void test_pause_that_is_waited_in(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	queue(&scanout, 0, 1, 1);
	scanout_choose(&scanout, 0);
	CHECK_INT(vblank_comes(&scanout, 0, reports), 0);
	scanout_pause(&scanout);
	CHECK_INT(flip_ends(&scanout, 3, reports), 2);
	expect(&reports[0], 0, PRESENTER_KEPT, 0, false);
	expect(&reports[1], 3, PRESENTER_PICTURE, 1, true);
	scanout_start(&scanout, 2);
	CHECK_INT(vblank_comes(&scanout, 3, reports), 0);
	CHECK_INT(vblank_comes(&scanout, 4, reports), 1);
	expect(&reports[0], 4, PRESENTER_KEPT, 1, false);
	CHECK_INT(reports[0].skipped, 0);
}

static void test_skipped_vblanks(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	scanout_start(&scanout, 10);
	CHECK_INT(vblank_comes(&scanout, 9, reports), 0);
	CHECK_INT(vblank_comes(&scanout, 13, reports), 1);
	CHECK_INT(reports[0].skipped, 3);
	CHECK_INT(vblank_comes(&scanout, 13, reports), 0);
}

static void test_standby(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	queue(&scanout, 0, 1, 1);
	flips_set_standby(&scanout.flips, (uint32_t)flips_acquire(&scanout.flips), 1, 2);
	scanout_choose(&scanout, 0);
	flip_ends(&scanout, 0, reports);
	vblank_comes(&scanout, 0, reports);
	CHECK(scanout_choose(&scanout, 1) >= 0);
	flip_ends(&scanout, 1, reports);
	CHECK_INT(vblank_comes(&scanout, 1, reports), 1);
	expect(&reports[0], 1, PRESENTER_STANDBY, 2, false);
}

/*
 * Any order of events: reports in the order of vblanks, each picture reported at most once as new, no picture lost, and
 * what is on display or under way is never free.
 */
static void test_random(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	uint32_t random = 7;
	uint64_t vblank = 0, serial = 0, next = 0, last_new = 0;
	for (int i = 0; i < 200000; i++) {
		uint32_t count = 0;
		random = random * 1664525u + 1013904223u;
		switch (random >> 29) {
		case 0:
		case 1:
			count = vblank_comes(&scanout, vblank++, reports);
			break;
		case 2:
			count = flip_ends(&scanout, vblank + (random >> 12) % 2 - (vblank > 0), reports);
			break;
		case 3:
			scanout_failed(&scanout);
			break;
		case 4:
			if (scanout.flips.queued < FLIPS_QUEUED)
				queue(&scanout, vblank + (random >> 8) % 3, vblank / 3 + 1, ++serial);
			break;
		default:
			scanout_choose(&scanout, vblank);
		}
		for (uint32_t k = 0; k < count; k++) {
			CHECK(reports[k].vblank >= next);
			CHECK_INT(reports[k].skipped, reports[k].vblank - next);
			next = reports[k].vblank + 1;
			if (reports[k].shown == PRESENTER_KEPT)
				continue;
			CHECK(reports[k].serial != last_new);
			last_new = reports[k].serial;
		}
		CHECK(!scanout.shown.any || scanout.flips.references[scanout.shown.image] > 0);
		CHECK(!scanout.under_way.any || scanout.flips.references[scanout.under_way.image] > 0);
		CHECK(in_use(&scanout) <= scanout.flips.queued + 3);
	}
}

/* A vblank comes before its picture was chosen: one of the frame on display is dropped, and that is told. */
static void test_a_choice_that_comes_too_late(void)
{
	struct scanout scanout = {0};
	struct presenter_flip reports[2];
	queue(&scanout, 0, 1, 1);
	scanout_choose(&scanout, 0);
	flip_ends(&scanout, 0, reports);
	CHECK_INT(vblank_comes(&scanout, 0, reports), 1);
	CHECK(!reports[0].dropped);
	queue(&scanout, 1, 1, 2);
	CHECK_INT(vblank_comes(&scanout, 1, reports), 1);
	CHECK(!reports[0].dropped);
	CHECK_INT(scanout_choose(&scanout, 2), -1);
	CHECK_INT(vblank_comes(&scanout, 2, reports), 1);
	expect(&reports[0], 2, PRESENTER_KEPT, 1, false);
	CHECK(reports[0].dropped && reports[0].skipped == 0);
	CHECK_INT(in_use(&scanout), 1);
	CHECK_INT(vblank_comes(&scanout, 3, reports), 1);
	CHECK(!reports[0].dropped);
}

int main(void)
{
	RUN(test_either_order);
	RUN(test_missed_flip);
	RUN(test_silent_flip);
	RUN(test_refused_flip);
	RUN(test_flip_in_a_pause);
	RUN(test_pause_that_is_waited_in);
	RUN(test_skipped_vblanks);
	RUN(test_a_choice_that_comes_too_late);
	RUN(test_standby);
	RUN(test_random);
	return test_result();
}
