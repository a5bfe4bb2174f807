/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_gallery.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact.h"

#define PART_WIDTH 160u
#define PART_HEIGHT 120u
#define SHEET_WIDTH 160u
#define SHEET_HEIGHT 90u
#define SEARCH_STEP 10u

/* Motion that crosses detail is what a held picture smears. */
static double interest(const struct clip *clip, const struct clip_site *site, size_t pixel)
{
	if (!site->valid[pixel] || (pixel + 1) % clip->width == 0 ||
		pixel + clip->width >= (size_t)clip->width * clip->height)
		return 0.0;
	const uint8_t *here = site->truth + 4 * pixel, *right = here + 4, *below = here + 4 * (size_t)clip->width;
	const float *before = site->path.before + 2 * pixel, *after = site->path.after + 2 * pixel;
	const double across = abs(here[1] - right[1]), down = abs(here[1] - below[1]);
	return fabs((double)(after[0] - before[0])) * across + fabs((double)(after[1] - before[1])) * down;
}

static double interest_of_part(const struct clip *clip, const struct clip_site *site, const struct crop *crop)
{
	double sum = 0.0;
	for (uint32_t y = crop->y; y < crop->y + crop->height; y += 3)
		for (uint32_t x = crop->x; x < crop->x + crop->width; x += 3)
			sum += interest(clip, site, (size_t)y * clip->width + x);
	return sum;
}

static void choose_part(struct report_gallery *gallery, const struct clip *clip)
{
	double most = -1.0;
	struct crop crop = {
		.site = clip->site_count / 2,
		.width = clip->width < PART_WIDTH ? clip->width : PART_WIDTH,
		.height = clip->height < PART_HEIGHT ? clip->height : PART_HEIGHT,
	};
	crop.x = (clip->width - crop.width) / 2; /* of a recording, about which nothing is known, the middle */
	crop.y = (clip->height - crop.height) / 2;
	gallery->crop = crop;
	for (crop.y = 0; clip->site_count && crop.y + crop.height <= clip->height; crop.y += SEARCH_STEP) {
		for (crop.x = 0; crop.x + crop.width <= clip->width; crop.x += SEARCH_STEP) {
			const double found = interest_of_part(clip, &clip->sites[crop.site], &crop);
			if (found > most) {
				most = found;
				gallery->crop = crop;
			}
		}
	}
}

static double mean_speed(const struct clip_site *site, const struct crop *crop)
{
	double sum = 0.0;
	for (uint32_t y = crop->y; y < crop->y + crop->height; y++) {
		for (uint32_t x = crop->x; x < crop->x + crop->width; x++) {
			const size_t i = 2 * ((size_t)y * site->path.width + x);
			sum += hypot((double)(site->path.after[i] - site->path.before[i]),
						 (double)(site->path.after[i + 1] - site->path.before[i + 1]));
		}
	}
	return sum / ((double)crop->width * crop->height) / site->window_s;
}

/* The contact sheet shows a part about the middle of the other one. */
static struct crop sheet_part(const struct report_gallery *gallery, const struct clip *clip)
{
	struct crop part = {
		.width = clip->width < SHEET_WIDTH ? clip->width : SHEET_WIDTH,
		.height = clip->height < SHEET_HEIGHT ? clip->height : SHEET_HEIGHT,
	};
	const struct crop *crop = &gallery->crop;
	const uint32_t x = crop->x + crop->width / 2, y = crop->y + crop->height / 2;
	part.x = x < part.width / 2 ? 0 : x - part.width / 2;
	part.y = y < part.height / 2 ? 0 : y - part.height / 2;
	part.x = part.x + part.width > clip->width ? clip->width - part.width : part.x;
	part.y = part.y + part.height > clip->height ? clip->height - part.height : part.y;
	return part;
}

int gallery_begin(struct report_gallery *gallery, const struct report_work *work, const struct clip *clip,
				  struct error *error)
{
	choose_part(gallery, clip);
	const struct crop part = sheet_part(gallery, clip);
	gallery->work = work;
	gallery->sheet = contact_create(part.width, part.height);
	gallery->truth = malloc(4 * (size_t)gallery->crop.width * gallery->crop.height);
	if (!gallery->sheet || !gallery->truth)
		return error_set(error, -ENOMEM, "out of memory for pictures");
	if (clip->site_count == 0) {
		free(gallery->truth);
		gallery->truth = NULL;
		return 0;
	}
	const struct crop *crop = &gallery->crop;
	const struct clip_site *site = &clip->sites[crop->site];
	gallery->time_s = site->time;
	gallery->speed = mean_speed(site, crop);
	for (uint32_t y = 0; y < crop->height; y++)
		memcpy(gallery->truth + 4 * (size_t)y * crop->width,
			   site->truth + 4 * ((size_t)(crop->y + y) * clip->width + crop->x), 4 * (size_t)crop->width);
	return 0;
}

static struct picture part_of(const struct clip *clip, const struct crop *part, const uint8_t *data)
{
	const size_t stride = 4 * (size_t)clip->width;
	return (struct picture){data + part->y * stride + 4 * (size_t)part->x, stride, part->width, part->height};
}

int gallery_add(struct report_gallery *gallery, const struct report_variant *variant, const struct clip *clip,
				uint8_t *const *pictures, struct error *error)
{
	const uint32_t late = variant->lag * clip->reals[0].shown_count;
	uint32_t last = clip->shown_count > late ? clip->shown_count - late : 0;
	while (last > 0 && !clip->shown[last - 1].scored)
		last--;
	if (last == 0)
		return 0;
	last--;
	uint32_t real = last;
	while (real > 0 && clip->shown[real].request.show == ENGINE_SHOW_IN_BETWEEN)
		real--;
	const struct crop part = sheet_part(gallery, clip);
	const struct picture shown = part_of(clip, &part, pictures[last + late]);
	const struct picture truth = part_of(clip, &part, clip->shown[last].truth);
	const bool predicted = clip->site_count == 0 && last > 0 && clip->shown[last - 1].truth;
	const struct picture before = part_of(clip, &part, predicted ? clip->shown[last - 1].truth : pictures[real + late]);
	char label[REPORT_NAME];
	snprintf(label, sizeof(label), "%s%s: PSNR %.2f dB here", variant->method, late ? ", late" : "",
			 measure_psnr(&shown, &truth));
	return contact_add(gallery->sheet, label, &before, &shown, &truth, error);
}

void gallery_end(struct report_gallery *gallery, const struct report *report)
{
	char path[4096], title[128];
	struct error error;
	snprintf(gallery->contact, sizeof(gallery->contact), "contact-%u-%s-n%u-%ux%u.png",
			 (unsigned)(gallery->work - report->works), gallery->work->name, gallery->work->n,
			 gallery->work->size.width, gallery->work->size.height);
	snprintf(path, sizeof(path), "%s/pictures/%s", report->options.out, gallery->contact);
	snprintf(title, sizeof(title), "%s, N = %u", gallery->work->name, gallery->work->n);
	if (contact_write(gallery->sheet, title, path, &error) < 0) {
		fprintf(stderr, "pursuit report: %s\n", error.text);
		gallery->contact[0] = '\0';
	}
	contact_destroy(&gallery->sheet);
}
