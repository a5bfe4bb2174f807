/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_clip.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "ahead.h"

#define ALIGNMENT 64u

struct clip *clip_create(uint32_t width, uint32_t height, uint32_t reals, uint32_t shown, uint32_t sites,
						 struct error *error)
{
	struct clip *clip = calloc(1, sizeof(*clip));
	if (clip) {
		*clip = (struct clip){
			.width = width,
			.height = height,
			.reals = calloc(reals, sizeof(*clip->reals)),
			.real_count = reals,
			.shown = calloc(shown, sizeof(*clip->shown)),
			.shown_count = shown,
			.sites = calloc(sites + 1u, sizeof(*clip->sites)),
			.site_count = sites,
		};
		if (clip->reals && clip->shown && clip->sites)
			return clip;
		clip->real_count = clip->shown_count = clip->site_count = 0;
		clip_destroy(&clip);
	}
	error_set(error, -ENOMEM, "out of memory for %u frames", reals);
	return NULL;
}

void clip_destroy(struct clip **clip)
{
	if (!clip || !*clip)
		return;
	for (uint32_t i = 0; i < (*clip)->real_count; i++)
		free((*clip)->reals[i].planes);
	for (uint32_t i = 0; i < (*clip)->shown_count; i++) {
		struct clip_shown *shown = &(*clip)->shown[i];
		free(shown->truth);
		free(shown->regions);
		free(shown->motion);
		free(shown->hidden);
	}
	for (uint32_t i = 0; i < (*clip)->site_count; i++) {
		struct clip_site *site = &(*clip)->sites[i];
		free(site->path.before);
		free(site->path.after);
		free(site->valid);
		free(site->truth);
	}
	free((*clip)->reals);
	free((*clip)->shown);
	free((*clip)->sites);
	free(*clip);
	*clip = NULL;
}

void *clip_plane(const struct clip *clip, size_t bytes, struct error *error)
{
	void *plane = malloc(bytes * clip->width * clip->height);
	if (!plane)
		error_set(error, -ENOMEM, "out of memory for pictures of %ux%u", clip->width, clip->height);
	return plane;
}

int clip_keep_frame(struct clip_real *real, const struct frame *frame, struct error *error)
{
	size_t bytes = 0;
	for (uint32_t i = 0; i < frame->header.plane_count; i++)
		bytes += (frame->header.planes[i].size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
	real->frame = *frame;
	real->planes = malloc(bytes + ALIGNMENT); /* aligned_alloc() fragments the heap of glibc before 2.38 */
	if (!real->planes)
		return error_set(error, -ENOMEM, "out of memory for a frame");
	uint8_t *start = real->planes + (ALIGNMENT - (uintptr_t)real->planes % ALIGNMENT) % ALIGNMENT;
	bytes = 0;
	for (uint32_t i = 0; i < frame->header.plane_count; i++) {
		memcpy(start + bytes, frame->planes[i], frame->header.planes[i].size);
		real->frame.planes[i] = start + bytes;
		bytes += (frame->header.planes[i].size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
	}
	return 0;
}

void clip_show_truth(const struct clip *clip, uint8_t *const *pictures)
{
	for (uint32_t i = 0; i < clip->shown_count; i++)
		memcpy(pictures[i], clip->shown[i].truth, 4 * (size_t)clip->width * clip->height);
}

int clip_play(const struct clip *clip, struct engine *engine, uint8_t *const *pictures, struct error *error)
{
	struct ahead ahead = {.engine = engine};
	int result = 0;
	for (uint32_t i = 0; i < clip->real_count && result == 0; i++) {
		const struct clip_real *real = &clip->reals[i];
		result = engine_begin(engine, &real->frame, &real->begin, error);
		for (uint32_t k = real->first_shown; k < real->first_shown + real->shown_count && result == 0; k++)
			result = ahead_render(&ahead, &clip->shown[k].request, pictures[k], 4 * (size_t)clip->width, error);
	}
	return ahead_finish(&ahead, result, error);
}
