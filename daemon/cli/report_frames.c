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

static const uint8_t *strip_picture(const struct report_gallery *gallery, const struct report_strip *strip, uint32_t i)
{
	return strip->pictures + i * part_bytes(gallery);
}

/* The part of a whole picture. */
static void cut_part(const struct report_gallery *gallery, const struct clip *clip, const uint8_t *picture,
					 uint8_t *part)
{
	const size_t row_bytes = 4 * (size_t)gallery->crop.width;
	for (uint32_t y = 0; y < gallery->crop.height; y++)
		memcpy(part + y * row_bytes, picture + 4 * ((size_t)(gallery->crop.y + y) * clip->width + gallery->crop.x),
			   row_bytes);
}

/* ---- what a picture is most like ---- */

/* Sum over red, green and blue; b NULL: black. No further than `enough`. */
static uint64_t distance(const uint8_t *a, const uint8_t *b, size_t bytes, uint64_t enough)
{
	static const uint8_t black[4] = {0};
	uint64_t sum = 0;
	for (size_t i = 0; i < bytes && sum < enough; i += 4) {
		const uint8_t *other = b ? b + i : black;
		sum += (uint64_t)(abs(a[i] - other[0]) + abs(a[i + 1] - other[1]) + abs(a[i + 2] - other[2]));
	}
	return sum;
}

struct search {
	const struct report_gallery *gallery;
	const uint8_t *picture;
	uint64_t least;
	struct report_base best;
};

static void try_base(struct search *search, int32_t strip, uint32_t picture)
{
	const struct report_gallery *gallery = search->gallery;
	const uint8_t *other = strip < 0 ? NULL : strip_picture(gallery, &gallery->strips[strip], picture);
	const uint64_t found = distance(search->picture, other, part_bytes(gallery), search->least);
	if (found < search->least) {
		search->least = found;
		search->best = (struct report_base){.strip = strip, .picture = picture};
	}
}

/* A method that repeats real frames, or itself, takes next to nothing. */
static struct report_base find_base(const struct report_gallery *gallery, const struct report_strip *strip, uint32_t i,
									bool *same)
{
	const int32_t own = (int32_t)(strip - gallery->strips);
	const uint32_t n = gallery->work->n, oldest = i < n ? 0 : i - n;
	struct search search = {.gallery = gallery, .picture = strip_picture(gallery, strip, i), .least = UINT64_MAX};
	try_base(&search, 0, i);
	try_base(&search, -1, 0);
	for (int32_t other = 1; other < own; other++)
		try_base(&search, other, i);
	for (uint32_t before = oldest; before < i; before++) {
		try_base(&search, 0, before);
		try_base(&search, own, before);
	}
	*same = search.least == 0;
	return search.best;
}

/* ---- writing ---- */

/* What a has beyond b; b NULL: a itself. */
static void put_above(const uint8_t *a, const uint8_t *b, size_t bytes, uint8_t *out)
{
	for (size_t i = 0; i < bytes; i++)
		out[i] = (uint8_t)(b && b[i] > a[i] ? 0 : a[i] - (b ? b[i] : 0));
}

static int write_file(const struct report *report, const struct report_gallery *gallery, const char *method,
					  const uint8_t *pictures, uint32_t count, struct error *error)
{
	char name[4 * REPORT_NAME], path[4200];
	frames_name(name, report, gallery, method);
	snprintf(path, sizeof(path), "%s/pictures/%s", report->options.out, name);
	return image_write_png_small(path, pictures, gallery->crop.width, gallery->crop.height * count,
								 strcmp(method, FRAMES_TRUTH) != 0, error);
}

static int write_differences(const struct report *report, const struct report_gallery *gallery,
							 const struct report_strip *strip, struct error *error)
{
	const size_t bytes = part_bytes(gallery);
	if (strip->differing == 0)
		return 0;
	uint8_t *above = malloc(2 * bytes * strip->differing), *below = above + bytes * strip->differing;
	uint8_t *black = calloc(1, bytes);
	int result = above && black ? 0 : error_set(error, -ENOMEM, "out of memory for pictures");
	for (uint32_t i = 0; i < gallery->shown_count && result == 0; i++) {
		const struct report_base *base = &strip->bases[i];
		const uint8_t *picture = strip_picture(gallery, strip, i), *other = black;
		if (base->differences < 0)
			continue;
		if (base->strip >= 0)
			other = strip_picture(gallery, &gallery->strips[base->strip], base->picture);
		put_above(picture, other, bytes, above + (size_t)base->differences * bytes);
		put_above(other, picture, bytes, below + (size_t)base->differences * bytes);
	}
	if (result == 0)
		result = write_file(report, gallery, strip->variant->method, above, 2 * strip->differing, error);
	free(black);
	free(above);
	return result;
}

/* ---- the work's pictures ---- */

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

static struct report_strip *add_strip(struct report_gallery *gallery, const struct report_variant *variant,
									  struct error *error)
{
	struct report_strip *grown = realloc(gallery->strips, (gallery->strip_count + 1) * sizeof(*grown));
	if (grown)
		gallery->strips = grown;
	struct report_strip *strip = grown ? &grown[gallery->strip_count] : NULL;
	if (strip)
		*strip = (struct report_strip){variant, malloc(part_bytes(gallery) * gallery->shown_count), {{0}}, 0};
	if (!strip || !strip->pictures) {
		error_set(error, -ENOMEM, "out of memory for pictures");
		return NULL;
	}
	gallery->strip_count++;
	return strip;
}

int frames_begin(const struct report *report, struct report_gallery *gallery, const struct clip *clip,
				 struct error *error)
{
	note_pictures(gallery, clip);
	if (gallery->shown_count == 0)
		return 0;
	struct report_strip *strip = add_strip(gallery, NULL, error);
	if (!strip)
		return -ENOMEM;
	for (uint32_t i = 0; i < gallery->shown_count; i++)
		cut_part(gallery, clip, clip->shown[gallery->shown_first + i].truth, strip->pictures + i * part_bytes(gallery));
	return write_file(report, gallery, FRAMES_TRUTH, strip->pictures, gallery->shown_count, error);
}

int frames_add(const struct report *report, struct report_gallery *gallery, const struct report_variant *variant,
			   const struct clip *clip, uint8_t *const *pictures, struct error *error)
{
	const uint32_t count = gallery->shown_count, late = variant->lag * clip->reals[0].shown_count;
	if (count == 0 || gallery->shown_first + late + count > clip->shown_count)
		return 0;
	struct report_strip *strip = add_strip(gallery, variant, error);
	if (!strip)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++) {
		bool same;
		cut_part(gallery, clip, pictures[gallery->shown_first + late + i], strip->pictures + i * part_bytes(gallery));
		strip->bases[i] = find_base(gallery, strip, i, &same);
		strip->bases[i].differences = same ? -1 : (int32_t)strip->differing++;
	}
	return write_differences(report, gallery, strip, error);
}

void frames_end(struct report_gallery *gallery)
{
	for (uint32_t i = 0; i < gallery->strip_count; i++) {
		free(gallery->strips[i].pictures);
		gallery->strips[i].pictures = NULL;
	}
}
