/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/patch.h"
#include "daemon/lab/rows.h"
#include "daemon/lab/spans.h"
#include "tests/test.h"

#define NOW UINT64_C(5000000000)

static struct row *add(struct rows *rows, uint64_t vblank)
{
	struct row *row = rows_add(rows);
	row->points.vblank = vblank;
	row->points.time[POINT_FLIP] = row->points.time[POINT_EVENT] = NOW;
	return row;
}

static void tell(struct rows *rows, uint64_t vblank)
{
	struct points points = {.vblank = vblank, .frame_id = vblank / 3, .show = POINTS_REAL, .method = "grid"};
	points.time[POINT_SUBMIT] = NOW - 7000000;
	rows_tell(rows, &points);
}

static void test_order(void)
{
	static struct rows rows;
	struct points points;
	memset(&rows, 0, sizeof(rows));
	for (uint64_t i = 0; i < 4; i++)
		add(&rows, 10 + i);
	rows_find(&rows, 11)->edge_open = true;
	for (uint64_t i = 4; i-- > 0;)
		tell(&rows, 10 + i);
	CHECK(rows_take(&rows, NOW, false, &points));
	CHECK_INT(points.vblank, 10);
	CHECK_INT(points.time[POINT_SUBMIT], NOW - 7000000);
	CHECK_INT(points.time[POINT_READY], POINT_UNKNOWN);
	/* 11 waits for its edge, and the others for it. */
	CHECK(!rows_take(&rows, NOW, false, &points));
	CHECK_INT(rows_next(&rows), NOW + ROWS_WAIT_NS);
	CHECK(rows_take(&rows, NOW + ROWS_WAIT_NS, false, &points));
	CHECK_INT(points.vblank, 11);
	CHECK(points.edge_lost);
	CHECK(rows_take(&rows, NOW, false, &points));
	CHECK(rows_take(&rows, NOW, false, &points));
	CHECK(!rows_take(&rows, NOW, true, &points));
	CHECK(rows_next(&rows) == UINT64_MAX);
}

static void test_untold(void)
{
	static struct rows rows;
	struct points points;
	memset(&rows, 0, sizeof(rows));
	for (uint64_t i = 0; i < ROWS; i++)
		add(&rows, i);
	CHECK(rows_full(&rows));
	tell(&rows, 999); /* of a flip that was never seen */
	CHECK(!rows_take(&rows, NOW, false, &points));
	CHECK(rows_take(&rows, NOW, true, &points));
	CHECK_INT(points.time[POINT_SUBMIT], POINT_UNKNOWN);
	CHECK(!rows_full(&rows));
	CHECK(!rows_find(&rows, 0));
	CHECK(rows_find(&rows, 1) != NULL);
}

static struct row *add_at(struct rows *rows, uint64_t vblank, uint64_t flip_ns)
{
	struct row *row = add(rows, vblank);
	row->points.time[POINT_FLIP] = flip_ns;
	return row;
}

/* An edge of the trigger goes with the first flip that is not before it, in whatever order they are heard of. */
static void test_triggers(void)
{
	static struct rows rows;
	struct points points;
	memset(&rows, 0, sizeof(rows));
	rows.hold_ns = 100;
	CHECK(!rows_trigger(&rows, 900));
	const struct row *first = add_at(&rows, 1, 1000), *second = add_at(&rows, 2, 2000);
	CHECK(rows_trigger(&rows, 900));
	CHECK(rows_trigger(&rows, 1000));
	CHECK_INT(first->points.time[POINT_TRIGGER], 1000);
	CHECK(!rows_trigger(&rows, 2001));
	CHECK(rows_trigger(&rows, 1001));
	CHECK_INT(second->points.time[POINT_TRIGGER], 1001);
	tell(&rows, 1);
	tell(&rows, 2);
	CHECK(!rows_take(&rows, NOW + 99, false, &points));
	CHECK_INT(rows_next(&rows), NOW + 100);
	CHECK(rows_take(&rows, NOW + 100, false, &points));
	CHECK_INT(points.time[POINT_TRIGGER], 1000);
	/* Too late for the one that was taken; the other one is not its flip. */
	CHECK(rows_trigger(&rows, 950));
	CHECK_INT(second->points.time[POINT_TRIGGER], 1001);
}

static void test_spans(void)
{
	static struct spans spans;
	struct points points = {.vblank = 5, .show = POINTS_REAL, .set_ns = 2500};
	int64_t span;
	memset(&spans, 0, sizeof(spans));
	points.time[POINT_SUBMIT] = 1000;
	points.time[POINT_FLIP] = 9000;
	points.time[POINT_TARGET] = 9100;
	points.time[POINT_EDGE] = 12000;
	points.time[POINT_PHOTON] = POINT_NOT_YET;
	CHECK(span_of(&points, SPAN_SUBMIT_TO_FLIP, &span) && span == 8000);
	CHECK(span_of(&points, SPAN_TARGET_TO_FLIP, &span) && span == -100);
	CHECK(span_of(&points, SPAN_GPIO_SET, &span) && span == 2500);
	CHECK(!span_of(&points, SPAN_FLIP_TO_PHOTON, &span));
	CHECK(!span_of(&points, SPAN_INTAKE_TO_READY, &span));
	spans_add(&spans, &points);
	points.vblank = 6;
	points.show = POINTS_IN_BETWEEN;
	points.time[POINT_FLIP] = 17333;
	CHECK(!span_of(&points, SPAN_SUBMIT_TO_FLIP, &span));
	spans_add(&spans, &points);
	points.vblank = 9;
	spans_add(&spans, &points);
	CHECK_INT(spans.rows, 3);
	CHECK_INT(spans.histograms[SPAN_REFRESH].count, 1);
	CHECK_INT(spans.histograms[SPAN_REFRESH].most, 8333);
	CHECK_INT(spans.histograms[SPAN_SUBMIT_TO_FLIP].count, 1);
}

static void test_patch(void)
{
	static uint8_t pixels[10 * 64];
	const struct presenter_image image = {.data = pixels, .stride = 64, .width = 12, .height = 10};
	for (uint32_t corner = 0; corner < 4; corner++) {
		uint32_t white = 0, wrong = 0;
		memset(pixels, 7, sizeof(pixels));
		patch_draw(&image, corner, 4, true);
		for (uint32_t y = 0; y < 10; y++) {
			for (uint32_t x = 0; x < 16; x++) {
				const bool inside = (corner & 1 ? x >= 8 && x < 12 : x < 4) && (corner & 2 ? y >= 6 : y < 4);
				white += pixels[y * 64 + x * 4] == 255;
				wrong += pixels[y * 64 + x * 4 + 2] != (inside ? 255 : 7);
			}
		}
		CHECK_INT(white, 16);
		CHECK_INT(wrong, 0);
	}
	patch_draw(&image, 3, 100, false);
	CHECK_INT(pixels[0], 0);
	CHECK_INT(pixels[9 * 64 + 47], 255);
	CHECK_INT(pixels[9 * 64 + 48], 7);
}

int main(void)
{
	RUN(test_order);
	RUN(test_untold);
	RUN(test_triggers);
	RUN(test_spans);
	RUN(test_patch);
	return test_result();
}
