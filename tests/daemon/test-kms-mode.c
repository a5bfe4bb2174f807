/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Modes: what a person writes, which one is chosen, timings that are made. */

#include <errno.h>

#include "daemon/present/kms_mode.h"
#include "tests/test.h"

#define INTERLACE (1u << 4)

static struct kms_mode mode_of(uint16_t width, uint16_t height, uint32_t clock_khz, uint16_t htotal, uint16_t vtotal)
{
	return (struct kms_mode){
		.width = width, .height = height, .clock_khz = clock_khz, .htotal = htotal, .vtotal = vtotal};
}

static void test_parse(void)
{
	static const char *const bad[] = {"1920",        "x1080",          "1920x",         "1920x1080@",   "1920x1080@0",
									  "1920x1080@x", "1920x1080@1e9",  "0x5@60",        "1920x1080 ",   "-1x5",
									  "99999x5",     "1920x1080@60Hz", "1920x1080@nan", "1920x1080@-60"};
	struct kms_mode_wish wish = {.refresh_hz = 120.0};
	struct error error;
	CHECK_INT(kms_mode_parse("", &wish, &error), 0);
	CHECK_INT(kms_mode_parse(NULL, &wish, &error), 0);
	CHECK_INT(wish.width, 0);
	CHECK_INT(kms_mode_parse("1920x1080", &wish, &error), 0);
	CHECK_INT(wish.width, 1920);
	CHECK_NEAR(wish.refresh_hz, 120.0, 0.0);
	CHECK(!wish.exact);
	CHECK_INT(kms_mode_parse("640x480@119.88", &wish, &error), 0);
	CHECK_INT(wish.height, 480);
	CHECK_NEAR(wish.refresh_hz, 119.88, 0.0);
	CHECK(wish.exact);
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		error.text[0] = 0;
		CHECK_INT(kms_mode_parse(bad[i], &wish, &error), -EINVAL);
		CHECK(strstr(error.text, bad[i]) != NULL);
		CHECK_INT(wish.width, 640);
	}
}

static void test_choose(void)
{
	struct kms_mode modes[] = {
		mode_of(3840, 2160, 594000, 4400, 2250), /* 60, preferred */
		mode_of(1920, 1080, 148500, 2200, 1125), /* 60 */
		mode_of(1920, 1080, 297000, 2200, 1125), /* 120 */
		mode_of(1920, 1080, 296703, 2200, 1125), /* 119.88 */
		mode_of(1280, 720, 148500, 1650, 750),   /* 120 */
		mode_of(1920, 1080, 594000, 2200, 1125), /* 240, interlaced */
	};
	const size_t count = sizeof(modes) / sizeof(modes[0]);
	modes[0].preferred = true;
	modes[5].flags = INTERLACE;
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){0}), 0);
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){.refresh_hz = 120}), 2);
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){.refresh_hz = 119.88}), 3);
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){.refresh_hz = 60}), 0);
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){.refresh_hz = 240}), 2);
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){1280, 720, 60, false}), 4);
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){1280, 720, 60, true}), -1);
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){1920, 1080, 60, true}), 1);
	CHECK_INT(kms_mode_choose(modes, count, &(struct kms_mode_wish){640, 480, 60, false}), -1);
	CHECK_INT(kms_mode_choose(modes, 0, &(struct kms_mode_wish){0}), -1);
}

/* VESA's own reduced-blanking timings, pixel clock apart, which they round to 250 kHz. */
static void test_make_known(void)
{
	static const struct {
		uint16_t width, height, hz, htotal, vsync_end, vtotal;
		uint32_t clock_khz;
	} known[] = {
		{1920, 1080, 60, 2080, 1088, 1111, 138500},
		{1024, 768, 120, 1184, 775, 813, 115500},
		{1280, 800, 120, 1440, 809, 847, 146250},
		{1400, 1050, 60, 1560, 1057, 1080, 101000},
	};
	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
		const struct kms_mode_wish wish = {known[i].width, known[i].height, known[i].hz, true};
		struct kms_mode mode;
		struct error error;
		CHECK_INT(kms_mode_make(&wish, &mode, &error), 0);
		CHECK_INT(mode.htotal, known[i].htotal);
		CHECK_INT(mode.vsync_start, known[i].height + 3);
		CHECK_INT(mode.vsync_end, known[i].vsync_end);
		CHECK_INT(mode.vtotal, known[i].vtotal);
		CHECK_NEAR(mode.clock_khz, known[i].clock_khz, 250.0);
		CHECK_NEAR(kms_mode_refresh_hz(&mode), known[i].hz, known[i].hz * 1e-5);
		CHECK(kms_mode_blank_ns(&mode) >= 460000);
		CHECK(mode.made);
	}
}

static void test_make_any(void)
{
	struct kms_mode mode;
	struct error error;
	for (uint32_t width = 20; width < 8000; width = width * 3 / 2)
		for (double hz = 24.0; hz < 500.0; hz *= 1.7) {
			const struct kms_mode_wish wish = {width, width / 2 + 3, hz, true};
			if (kms_mode_make(&wish, &mode, &error) < 0)
				continue;
			CHECK(mode.width == width && mode.width < mode.hsync_start && mode.hsync_start < mode.hsync_end);
			CHECK(mode.hsync_end < mode.htotal && mode.height < mode.vsync_start && mode.vsync_start < mode.vsync_end);
			CHECK(mode.vsync_end < mode.vtotal);
			CHECK_NEAR(kms_mode_refresh_hz(&mode), hz, hz * 0.51 / mode.clock_khz); /* the next whole kHz */
		}
	CHECK_INT(kms_mode_make(&(struct kms_mode_wish){16384, 16384, 1000, true}, &mode, &error), -ERANGE);
	CHECK_INT(kms_mode_make(&(struct kms_mode_wish){16, 16384, 999, true}, &mode, &error), 0);
}

static void test_print(void)
{
	struct kms_mode mode = mode_of(1920, 1080, 296703, 2200, 1125);
	char text[48];
	kms_mode_print(&mode, text, sizeof(text));
	CHECK_STRING(text, "1920x1080@119.88");
	mode.clock_khz = 297000;
	kms_mode_print(&mode, text, sizeof(text));
	CHECK_STRING(text, "1920x1080@120");
}

int main(void)
{
	RUN(test_parse);
	RUN(test_choose);
	RUN(test_make_known);
	RUN(test_make_any);
	RUN(test_print);
	return test_result();
}
