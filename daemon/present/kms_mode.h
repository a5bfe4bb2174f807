/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Modes of a display controller: the timings, what a person writes for one, the
 * choice among those that a display lists, and timings made here where it lists
 * none. Pure arithmetic.
 */
#ifndef PURSUIT_KMS_MODE_H
#define PURSUIT_KMS_MODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"

/* Pixels and lines, counted from the left and upper edge of the picture. */
struct kms_mode {
	uint32_t clock_khz;
	uint16_t width, hsync_start, hsync_end, htotal;
	uint16_t height, vsync_start, vsync_end, vtotal;
	uint32_t flags; /* the kernel's DRM_MODE_FLAG_*: of sync signals; others make a mode unfit */
	bool preferred; /* the display likes it best */
	bool made;      /* not listed by the display */
};

/* What is asked for; zeroed: any size. */
struct kms_mode_wish {
	uint32_t width, height; /* 0: as the display prefers */
	double refresh_hz;      /* 0: as the display prefers */
	bool exact;             /* no other rate will do */
};

/* "1920x1080@119.88", or "1920x1080", which leaves the refresh rate of the wish as it is; NULL or empty leaves all. */
int kms_mode_parse(const char *text, struct kms_mode_wish *wish, struct error *error);

/* Hz = numerator / denominator, exactly. */
void kms_mode_refresh(const struct kms_mode *mode, uint64_t *numerator, uint64_t *denominator);
double kms_mode_refresh_hz(const struct kms_mode *mode);

/* From the last line of a picture to the first of the next. */
uint64_t kms_mode_blank_ns(const struct kms_mode *mode);

/*
 * The listed mode that fits best: the size asked for, then the rate nearest to the wish (those within half a percent
 * pass for the same), then the display's preferred size, then the largest. -1: none has the size, or, if the wish is
 * exact, the rate within half a percent.
 */
int kms_mode_choose(const struct kms_mode *modes, size_t count, const struct kms_mode_wish *wish);

/*
 * Timings with reduced blanking (VESA Coordinated Video Timings 1.1, section 3.4.2; horizontal blank 160, sync 32 x 4
 * to 10 lines, vertical blank at least 460 us), but with a pixel clock in steps of 1 kHz, so that the refresh rate of
 * usual sizes is met to a few millionths. Needs a size and 1 to 1000 Hz. -ERANGE with a sentence where no pixel clock
 * or counter holds them.
 */
int kms_mode_make(const struct kms_mode_wish *wish, struct kms_mode *mode, struct error *error);

/* "1024x768@119.99" */
void kms_mode_print(const struct kms_mode *mode, char *text, size_t size);
/* Those, divided by commas, as far as there is room. */
void kms_mode_list(const struct kms_mode *modes, size_t count, char *text, size_t size);

#endif
