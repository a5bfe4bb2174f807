/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Which picture a vblank shows: queue, standby, replacement, nothing lost. */

#include "daemon/present/flips.h"
#include "tests/test.h"

static uint32_t acquire(struct flips *flips)
{
	const int image = flips_acquire(flips);
	CHECK(image >= 0);
	return (uint32_t)image;
}

static void present(struct flips *flips, uint64_t vblank, uint64_t group, uint64_t serial)
{
	CHECK(flips_present(flips, acquire(flips), vblank, group, serial));
}

static void expect(struct flips *flips, uint64_t vblank, enum presenter_shown shown, uint64_t serial)
{
	CHECK_INT(flips_show(flips, vblank), shown);
	CHECK_INT(flips->front.serial, serial);
}

static uint32_t in_use(const struct flips *flips)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < FLIPS_IMAGES; i++)
		count += flips->references[i] != 0;
	return count;
}

static void test_in_order(void)
{
	struct flips flips = {0};
	CHECK_INT(flips_show(&flips, 0), PRESENTER_KEPT);
	present(&flips, 1, 1, 1);
	present(&flips, 2, 1, 2);
	present(&flips, 4, 2, 3);
	expect(&flips, 1, PRESENTER_PICTURE, 1);
	expect(&flips, 2, PRESENTER_PICTURE, 2);
	expect(&flips, 3, PRESENTER_KEPT, 2);
	expect(&flips, 4, PRESENTER_PICTURE, 3);
	CHECK_INT(in_use(&flips), 1);
}

static void test_newer_picture_drops_later_ones(void)
{
	struct flips flips = {0};
	present(&flips, 1, 1, 1);
	present(&flips, 2, 1, 2);
	present(&flips, 3, 1, 3);
	present(&flips, 2, 2, 4); /* a real frame that came early */
	CHECK_INT(in_use(&flips), 2);
	expect(&flips, 1, PRESENTER_PICTURE, 1);
	expect(&flips, 2, PRESENTER_PICTURE, 4);
	expect(&flips, 3, PRESENTER_KEPT, 4);
}

static void test_skipped_vblanks(void)
{
	struct flips flips = {0};
	present(&flips, 1, 1, 1);
	present(&flips, 2, 1, 2);
	present(&flips, 3, 1, 3);
	expect(&flips, 1, PRESENTER_PICTURE, 1);
	expect(&flips, 3, PRESENTER_PICTURE, 3);
	CHECK(!flips.dropped);
	CHECK_INT(in_use(&flips), 1);
	present(&flips, 5, 1, 4);
	expect(&flips, 9, PRESENTER_KEPT, 3);
	CHECK(flips.dropped);
	CHECK_INT(in_use(&flips), 1);
}

/* The first picture of a frame that was not on display yet is late, never lost; unless a newer frame is due too. */
static void test_skipped_real_frame(void)
{
	struct flips flips = {0};
	present(&flips, 1, 1, 1);
	expect(&flips, 9, PRESENTER_PICTURE, 1); /* the first of all */
	present(&flips, 11, 1, 2);
	present(&flips, 12, 2, 3);
	expect(&flips, 20, PRESENTER_PICTURE, 3);
	present(&flips, 21, 3, 4);
	present(&flips, 22, 3, 5);
	present(&flips, 23, 3, 6);
	present(&flips, 24, 3, 7);
	expect(&flips, 23, PRESENTER_PICTURE, 4);
	CHECK(flips.dropped);
	expect(&flips, 24, PRESENTER_PICTURE, 7);
	CHECK(!flips.dropped);
	present(&flips, 30, 4, 8);
	present(&flips, 31, 5, 9);
	present(&flips, 32, 5, 10);
	expect(&flips, 40, PRESENTER_PICTURE, 9);
	CHECK_INT(in_use(&flips), 1);
}

static void test_standby(void)
{
	struct flips flips = {0};
	present(&flips, 1, 1, 1);
	flips_set_standby(&flips, acquire(&flips), 1, 2);
	expect(&flips, 1, PRESENTER_PICTURE, 1);
	expect(&flips, 2, PRESENTER_STANDBY, 2); /* the boosted picture is not shown twice */
	expect(&flips, 3, PRESENTER_KEPT, 2);
	present(&flips, 4, 1, 3);
	expect(&flips, 4, PRESENTER_PICTURE, 3);
	expect(&flips, 5, PRESENTER_STANDBY, 2);
	/* a standby of the next group waits for it */
	present(&flips, 7, 2, 4);
	flips_set_standby(&flips, acquire(&flips), 2, 5);
	expect(&flips, 6, PRESENTER_KEPT, 2);
	expect(&flips, 7, PRESENTER_PICTURE, 4);
	CHECK_INT(in_use(&flips), 2); /* the older standby is free */
	expect(&flips, 8, PRESENTER_STANDBY, 5);
	flips_clear_standby(&flips);
	expect(&flips, 9, PRESENTER_KEPT, 5);
	CHECK_INT(in_use(&flips), 1);
}

static void test_many_standbys(void)
{
	struct flips flips = {0};
	for (uint64_t group = 1; group < 100; group++) {
		flips_set_standby(&flips, acquire(&flips), group / 2, group);
		CHECK(in_use(&flips) <= FLIPS_STANDBYS);
	}
}

static void test_full_queue(void)
{
	struct flips flips = {0};
	for (uint64_t i = 0; i < FLIPS_QUEUED; i++)
		present(&flips, i, 1, i + 1);
	const uint32_t image = acquire(&flips);
	CHECK(!flips_present(&flips, image, 100, 1, 100));
	flips_release(&flips, image);
	CHECK_INT(in_use(&flips), FLIPS_QUEUED);
	for (uint32_t i = FLIPS_QUEUED; i < FLIPS_IMAGES; i++)
		acquire(&flips);
	CHECK_INT(flips_acquire(&flips), -1);
}

/* Any sequence: the picture queued for a vblank is shown there, and no picture is lost. */
static void test_random(void)
{
	struct flips flips = {0};
	uint32_t random = 1;
	uint64_t vblank = 1, serial = 0, wanted[64] = {0};
	for (int i = 0; i < 100000; i++) {
		random = random * 1664525u + 1013904223u;
		const uint64_t ahead = vblank + (random >> 8) % 5;
		switch (random >> 28) {
		case 0:
			flips_set_standby(&flips, acquire(&flips), vblank / 3, ++serial);
			break;
		case 1:
			flips_clear_standby(&flips);
			break;
		case 2:
		case 3:
		case 4:
		case 5: {
			const uint32_t image = acquire(&flips);
			if (flips_present(&flips, image, ahead, vblank / 3, ++serial)) {
				for (uint64_t k = ahead; k < ahead + 8; k++)
					wanted[k % 64] = k == ahead ? serial : 0;
			} else {
				flips_release(&flips, image);
			}
			break;
		}
		default: {
			const enum presenter_shown shown = flips_show(&flips, vblank);
			CHECK((shown == PRESENTER_PICTURE) == (wanted[vblank % 64] != 0));
			if (shown == PRESENTER_PICTURE)
				CHECK_INT(flips.front.serial, wanted[vblank % 64]);
			wanted[vblank++ % 64] = 0;
		}
		}
		CHECK(in_use(&flips) <= flips.queued + flips.standbys + flips.has_front);
	}
}

int main(void)
{
	RUN(test_in_order);
	RUN(test_newer_picture_drops_later_ones);
	RUN(test_skipped_vblanks);
	RUN(test_skipped_real_frame);
	RUN(test_standby);
	RUN(test_many_standbys);
	RUN(test_full_queue);
	RUN(test_random);
	return test_result();
}
