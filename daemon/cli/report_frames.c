/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_frames.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/record/image.h"

#define REALS 3u

void frames_name(char name[4 * REPORT_NAME], const struct report *report, const struct report_gallery *gallery,
				 const char *method)
{
	snprintf(name, 4 * REPORT_NAME, "frames-%u-%s-%s.png", (unsigned)(gallery->work - report->works),
			 gallery->work->name, method);
}

/* From the real frame before the one that the pursuit camera looks at; of a recording from the first that is judged. */
static uint32_t choose_first(const struct report_gallery *gallery, const struct clip *clip)
{
	uint32_t first = 0;
	if (clip->site_count)
		return clip->sites[gallery->crop.site].first_shown - gallery->work->n;
	while (first < clip->shown_count && !clip->shown[first].scored)
		first++;
	return first;
}

static uint32_t choose_count(const struct report_gallery *gallery, const struct clip *clip)
{
	const uint32_t wanted = REALS * gallery->work->n;
	uint32_t count = 0;
	while (count < REPORT_SHOWN && count < wanted && gallery->shown_first + count < clip->shown_count &&
		   clip->shown[gallery->shown_first + count].truth)
		count++;
	return count;
}

static size_t part_bytes(const struct report_gallery *gallery)
{
	return 4 * (size_t)gallery->crop.width * gallery->crop.height;
}

static const uint8_t *row_of(const struct report_gallery *gallery, const struct clip *clip, const uint8_t *picture,
							 uint32_t y)
{
	return picture + 4 * ((size_t)(gallery->crop.y + y) * clip->width + gallery->crop.x);
}

static uint8_t above(uint8_t a, uint8_t b)
{
	return (uint8_t)(a > b ? a - b : 0);
}

/* What a has beyond b; b NULL: a itself. */
static void put_part(const struct report_gallery *gallery, const struct clip *clip, const uint8_t *a, const uint8_t *b,
					 uint8_t *part)
{
	for (uint32_t y = 0; y < gallery->crop.height; y++) {
		const uint8_t *left = row_of(gallery, clip, a, y), *right = b ? row_of(gallery, clip, b, y) : NULL;
		for (uint32_t i = 0; i < 4 * gallery->crop.width; i++)
			*part++ = above(left[i], right ? right[i] : 0);
	}
}

static int write_strip(const struct report *report, const struct report_gallery *gallery, const char *method,
					   const uint8_t *strip, struct error *error)
{
	char name[4 * REPORT_NAME], path[4200];
	const bool truth = strcmp(method, FRAMES_TRUTH) == 0;
	frames_name(name, report, gallery, method);
	snprintf(path, sizeof(path), "%s/pictures/%s", report->options.out, name);
	return image_write_png_small(path, strip, gallery->crop.width,
								 gallery->crop.height * gallery->shown_count * (truth ? 1u : 2u), !truth, error);
}

static void note_pictures(struct report_gallery *gallery, const struct clip *clip)
{
	gallery->shown_first = choose_first(gallery, clip);
	gallery->shown_count = choose_count(gallery, clip);
	for (uint32_t i = 0; i < gallery->shown_count; i++) {
		const struct clip_shown *shown = &clip->shown[gallery->shown_first + i];
		gallery->shown[i] = (struct report_shown){
			.time_s = shown->time,
			.phase = shown->request.phase,
			.real = shown->request.show == ENGINE_SHOW_REAL,
		};
	}
}

int frames_begin(const struct report *report, struct report_gallery *gallery, const struct clip *clip,
				 struct error *error)
{
	const size_t bytes = part_bytes(gallery);
	note_pictures(gallery, clip);
	if (gallery->shown_count == 0)
		return 0;
	uint8_t *strip = malloc(bytes * gallery->shown_count);
	if (!strip)
		return error_set(error, -ENOMEM, "out of memory for pictures");
	for (uint32_t i = 0; i < gallery->shown_count; i++)
		put_part(gallery, clip, clip->shown[gallery->shown_first + i].truth, NULL, strip + i * bytes);
	const int result = write_strip(report, gallery, FRAMES_TRUTH, strip, error);
	free(strip);
	return result;
}

int frames_add(const struct report *report, const struct report_gallery *gallery, const struct report_variant *variant,
			   const struct clip *clip, uint8_t *const *pictures, struct error *error)
{
	const size_t bytes = part_bytes(gallery);
	const uint32_t count = gallery->shown_count, late = variant->lag * clip->reals[0].shown_count;
	if (count == 0 || gallery->shown_first + late + count > clip->shown_count)
		return 0;
	uint8_t *strip = malloc(2 * bytes * count);
	if (!strip)
		return error_set(error, -ENOMEM, "out of memory for pictures");
	for (uint32_t i = 0; i < count; i++) {
		const uint8_t *picture = pictures[gallery->shown_first + late + i];
		const uint8_t *truth = clip->shown[gallery->shown_first + i].truth;
		put_part(gallery, clip, picture, truth, strip + i * bytes);
		put_part(gallery, clip, truth, picture, strip + (count + i) * bytes);
	}
	const int result = write_strip(report, gallery, variant->method, strip, error);
	free(strip);
	return result;
}
