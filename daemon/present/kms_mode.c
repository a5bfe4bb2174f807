/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms_mode.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The kernel's; the values are its interface. */
#define FLAG_HSYNC_POSITIVE (1u << 0)
#define FLAG_VSYNC_NEGATIVE (1u << 3)
#define FLAG_INTERLACE (1u << 4)
#define FLAG_DOUBLE_SCAN (1u << 5)

#define SIZE_MOST 16384u
#define CLOCK_MOST_KHZ 10e6
#define SAME_RATE 0.005

/* Reduced blanking. */
#define BLANK_WIDTH 160u
#define BLANK_LEAST_US 460.0
#define FRONT_WIDTH 48u
#define SYNC_WIDTH 32u
#define FRONT_LINES 3u
#define BACK_LINES_LEAST 6u

static const char *parse_size(const char *text, uint32_t *width, uint32_t *height)
{
	char *end;
	if (!isdigit((unsigned char)*text))
		return NULL;
	const unsigned long w = strtoul(text, &end, 10);
	if (*end != 'x' || !isdigit((unsigned char)end[1]))
		return NULL;
	const unsigned long h = strtoul(end + 1, &end, 10);
	if (w == 0 || h == 0 || w > SIZE_MOST || h > SIZE_MOST)
		return NULL;
	*width = (uint32_t)w;
	*height = (uint32_t)h;
	return end;
}

int kms_mode_parse(const char *text, struct kms_mode_wish *wish, struct error *error)
{
	struct kms_mode_wish parsed = *wish;
	if (!text || !*text)
		return 0;
	const char *at = parse_size(text, &parsed.width, &parsed.height);
	char *end = NULL;
	if (at && *at == '@' && isdigit((unsigned char)at[1]))
		parsed.refresh_hz = strtod(at + 1, &end);
	parsed.exact = end != NULL;
	if (!at || (*at != 0 && (!end || *end)) || !(parsed.refresh_hz >= 0.0 && parsed.refresh_hz <= 1000.0) ||
		(end && parsed.refresh_hz < 1.0))
		return error_set(error, -EINVAL, "mode: \"%.64s\" is not a mode like 1920x1080@120 (up to %ux%u, 1 to 1000 Hz)",
						 text, SIZE_MOST, SIZE_MOST);
	*wish = parsed;
	return 0;
}

void kms_mode_refresh(const struct kms_mode *mode, uint64_t *numerator, uint64_t *denominator)
{
	*numerator = (uint64_t)mode->clock_khz * 1000;
	*denominator = (uint64_t)mode->htotal * mode->vtotal;
}

double kms_mode_refresh_hz(const struct kms_mode *mode)
{
	uint64_t numerator, denominator;
	kms_mode_refresh(mode, &numerator, &denominator);
	return denominator ? (double)numerator / (double)denominator : 0.0;
}

uint64_t kms_mode_blank_ns(const struct kms_mode *mode)
{
	const uint64_t lines = (uint64_t)(mode->vtotal - mode->height);
	return mode->clock_khz ? lines * mode->htotal * UINT64_C(1000000) / mode->clock_khz : 0;
}

/* ---- choice ---- */

static bool is_fit(const struct kms_mode *mode)
{
	return (mode->flags & (FLAG_INTERLACE | FLAG_DOUBLE_SCAN)) == 0 && mode->clock_khz > 0 && mode->htotal > 0 &&
		   mode->vtotal > mode->height && mode->height > 0 && mode->width > 0;
}

/* Distance of rates as a share; those that pass for the same are 0. */
static double rate_distance(const struct kms_mode *mode, double refresh_hz)
{
	const double distance = fabs(kms_mode_refresh_hz(mode) / refresh_hz - 1.0);
	return distance <= SAME_RATE ? 0.0 : distance;
}

struct score {
	double rate;
	bool preferred;
	uint32_t area;
	double exact;
};

static bool is_better(const struct score *a, const struct score *b)
{
	if (a->rate < b->rate || a->rate > b->rate)
		return a->rate < b->rate;
	if (a->preferred != b->preferred)
		return a->preferred;
	return a->area != b->area ? a->area > b->area : a->exact < b->exact;
}

static const struct kms_mode *find_preferred(const struct kms_mode *modes, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (modes[i].preferred && is_fit(&modes[i]))
			return &modes[i];
	return NULL;
}

int kms_mode_choose(const struct kms_mode *modes, size_t count, const struct kms_mode_wish *wish)
{
	const struct kms_mode *preferred = find_preferred(modes, count);
	struct score best = {.rate = HUGE_VAL};
	int chosen = -1;

	for (size_t i = 0; i < count; i++) {
		const struct kms_mode *mode = &modes[i];
		if (!is_fit(mode) || (wish->width != 0 && (mode->width != wish->width || mode->height != wish->height)))
			continue;
		struct score score = {.area = (uint32_t)mode->width * mode->height};
		score.preferred = wish->refresh_hz > 0.0
							  ? preferred && preferred->width == mode->width && preferred->height == mode->height
							  : mode->preferred;
		if (wish->refresh_hz > 0.0) {
			score.rate = rate_distance(mode, wish->refresh_hz);
			score.exact = fabs(kms_mode_refresh_hz(mode) - wish->refresh_hz);
		}
		if (wish->exact && score.rate > 0.0)
			continue;
		if (chosen < 0 || is_better(&score, &best)) {
			best = score;
			chosen = (int)i;
		}
	}
	return chosen;
}

/* ---- modes made here ---- */

/* Lines of the sync pulse tell the shape of the picture. */
static uint32_t sync_lines(uint32_t width, uint32_t height)
{
	static const struct {
		uint32_t width, height, lines;
	} shapes[] = {{4, 3, 4}, {16, 9, 5}, {16, 10, 6}, {5, 4, 7}, {15, 9, 7}};
	for (size_t i = 0; i < sizeof(shapes) / sizeof(shapes[0]); i++)
		if (height * shapes[i].width / shapes[i].height == width)
			return shapes[i].lines;
	return 10;
}

int kms_mode_make(const struct kms_mode_wish *wish, struct kms_mode *mode, struct error *error)
{
	const uint32_t sync = sync_lines(wish->width, wish->height), width = wish->width;
	const double frame_us = 1e6 / wish->refresh_hz;
	const double line_us = (frame_us - BLANK_LEAST_US) / wish->height;
	const uint32_t least = FRONT_LINES + sync + BACK_LINES_LEAST;
	const double wanted = line_us > 0.0 ? floor(BLANK_LEAST_US / line_us) + 1.0 : HUGE_VAL;
	const double lines = wanted < least ? least : wanted;
	const double clock_khz = wish->refresh_hz * (wish->height + lines) * (width + BLANK_WIDTH) / 1e3;

	if (width == 0 || !(wish->height + lines <= UINT16_MAX) || !(clock_khz <= CLOCK_MOST_KHZ))
		return error_set(error, -ERANGE, "mode: there are no timings for %ux%u at %.6g Hz", wish->width, wish->height,
						 wish->refresh_hz);
	*mode = (struct kms_mode){
		.clock_khz = (uint32_t)lround(clock_khz),
		.width = (uint16_t)width,
		.hsync_start = (uint16_t)(width + FRONT_WIDTH),
		.hsync_end = (uint16_t)(width + FRONT_WIDTH + SYNC_WIDTH),
		.htotal = (uint16_t)(width + BLANK_WIDTH),
		.height = (uint16_t)wish->height,
		.vsync_start = (uint16_t)(wish->height + FRONT_LINES),
		.vsync_end = (uint16_t)(wish->height + FRONT_LINES + sync),
		.vtotal = (uint16_t)(wish->height + (uint32_t)lines),
		.flags = FLAG_HSYNC_POSITIVE | FLAG_VSYNC_NEGATIVE,
		.made = true,
	};
	return 0;
}

void kms_mode_print(const struct kms_mode *mode, char *text, size_t size)
{
	snprintf(text, size, "%ux%u@%.6g", mode->width, mode->height, round(kms_mode_refresh_hz(mode) * 1000.0) / 1000.0);
}

void kms_mode_list(const struct kms_mode *modes, size_t count, char *text, size_t size)
{
	char one[48], last[48] = "";
	size_t used = 0;
	for (size_t i = 0; i < count && used + 40 < size; i++) {
		kms_mode_print(&modes[i], one, sizeof(one));
		if (strcmp(one, last) != 0)
			used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "", one);
		snprintf(last, sizeof(last), "%s", one);
	}
}
