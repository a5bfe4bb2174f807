/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/pictures.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/clock.h"
#include "daemon/present/vsync.h"

/* A thread that slept so many vblanks too long skips them. */
#define SKIP_AFTER 8u

void pictures_init(struct pictures *pictures, const struct presenter_impl *impl, const struct presenter_params *params)
{
	memset(pictures, 0, sizeof(*pictures));
	pictures->presenter.impl = impl;
	pictures->params = *params;
	pictures->grid.numerator = params->refresh_numerator;
	pictures->grid.denominator = params->refresh_denominator;
	pictures->grid.epoch_ns = clock_now(params->clock);
	pthread_mutex_init(&pictures->lock, NULL);
	clock_cond_init(&pictures->wake);
}

void pictures_finish(struct pictures *pictures)
{
	for (uint32_t i = 0; i < FLIPS_IMAGES; i++)
		free(pictures->memory[i].data);
	pthread_cond_destroy(&pictures->wake);
	pthread_mutex_destroy(&pictures->lock);
}

struct presenter_flip pictures_show_next(struct pictures *pictures, uint64_t now_ns)
{
	struct presenter_flip flip = {.flip_ns = now_ns};
	const uint64_t newest = grid_at_or_after(&pictures->grid, now_ns + 1) - 1;

	if (newest > pictures->next_vblank + SKIP_AFTER) {
		flip.skipped = (uint32_t)(newest - pictures->next_vblank);
		pictures->next_vblank = newest;
	}
	flip.vblank = pictures->next_vblank++;
	flip.target_ns = grid_time(&pictures->grid, flip.vblank);
	flip.shown = flips_show(&pictures->flips, flip.vblank);
	flip.dropped = pictures->flips.dropped;
	flip.late = flip.shown == PRESENTER_PICTURE && pictures->flips.front.vblank < flip.vblank;
	if (pictures->flips.has_front) {
		flip.serial = pictures->flips.front.serial;
		flip.group = pictures->flips.front.group;
	}
	return flip;
}

bool pictures_follow_vsync(struct pictures *pictures, uint64_t now_ns)
{
	struct grid grid;
	const uint64_t trust = vsync_get_grid(pictures->params.vsync, now_ns, &grid);
	if (trust != 0 && trust != pictures->vsync_trust) {
		const uint64_t half_ns = (uint64_t)(grid_period_ns(&grid) / 2.0);
		const uint64_t first_ns = grid.epoch_ns > half_ns ? grid.epoch_ns - half_ns : 0;
		pictures->vsync_shift = grid_at_or_after(&pictures->grid, first_ns) - grid.epoch_vblank;
	}
	pictures->vsync_trust = trust;
	if (trust == 0)
		return false;
	grid.epoch_vblank += pictures->vsync_shift;
	pictures->grid = grid;
	return true;
}

static struct pictures *pictures_of(struct presenter *presenter)
{
	return (struct pictures *)presenter;
}

struct grid pictures_get_grid(struct presenter *presenter)
{
	struct pictures *pictures = pictures_of(presenter);
	pthread_mutex_lock(&pictures->lock);
	const struct grid grid = pictures->grid;
	pthread_mutex_unlock(&pictures->lock);
	return grid;
}

uint64_t pictures_get_lead(struct presenter *presenter)
{
	struct pictures *pictures = pictures_of(presenter);
	pthread_mutex_lock(&pictures->lock);
	const uint64_t lead_ns = pictures->lead_ns;
	pthread_mutex_unlock(&pictures->lock);
	return lead_ns;
}

/* A free one; NULL: there is none. */
static struct pictures_memory *acquire_any(struct pictures *pictures, struct presenter_image *image)
{
	pthread_mutex_lock(&pictures->lock);
	const int index = flips_acquire(&pictures->flips);
	pthread_mutex_unlock(&pictures->lock);
	*image = (struct presenter_image){.index = index < 0 ? 0 : (uint32_t)index};
	return index < 0 ? NULL : &pictures->memory[index];
}

static void give_back(struct pictures *pictures, const struct presenter_image *image)
{
	pthread_mutex_lock(&pictures->lock);
	flips_release(&pictures->flips, image->index);
	pthread_mutex_unlock(&pictures->lock);
}

/* there: the contents has memory of that size. */
static int lend(struct pictures *pictures, struct contents *contents, bool there, uint32_t width, uint32_t height,
				struct presenter_image *image)
{
	if (!there) {
		*contents = (struct contents){0, 0, 0};
		give_back(pictures, image);
		return -ENOMEM;
	}
	contents_lend(contents, width, height, image);
	pictures->shapes[image->index] = *image;
	return 0;
}

static bool resize(struct pictures_memory *memory, size_t size)
{
	if (memory->size == size)
		return true;
	free(memory->data);
	memory->data = aligned_alloc(64, size);
	memory->size = memory->data ? size : 0;
	return memory->data != NULL;
}

int pictures_acquire(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image)
{
	struct pictures *pictures = pictures_of(presenter);
	struct pictures_memory *memory = acquire_any(pictures, image);
	if (!memory)
		return -EBUSY;
	image->stride = ((size_t)width * 4 + 63) / 64 * 64;
	const bool there = resize(memory, image->stride * height);
	image->data = memory->data;
	return lend(pictures, &memory->in_memory, there, width, height, image);
}

int pictures_acquire_texture(struct pictures *pictures, const struct texture_functions *gl, uint32_t width,
							 uint32_t height, struct presenter_image *image)
{
	struct pictures_memory *memory = acquire_any(pictures, image);
	if (!memory)
		return -EBUSY;
	const bool there = texture_resize(&memory->texture, gl, width, height);
	image->texture = memory->texture.name;
	return lend(pictures, &memory->in_gl, there, width, height, image);
}

static void take_back(struct pictures *pictures, const struct presenter_image *image)
{
	struct pictures_memory *memory = &pictures->memory[image->index];
	contents_take_back(image->data ? &memory->in_memory : &memory->in_gl, image);
}

void pictures_release(struct presenter *presenter, const struct presenter_image *image)
{
	struct pictures *pictures = pictures_of(presenter);
	take_back(pictures, image);
	give_back(pictures, image);
}

int pictures_present(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank, uint64_t group,
					 uint64_t serial)
{
	struct pictures *pictures = pictures_of(presenter);
	int result = -ETIME;

	take_back(pictures, image);
	pthread_mutex_lock(&pictures->lock);
	const uint64_t latest_ns = clock_now(pictures->params.clock) + pictures->lead_ns;
	const bool in_time = latest_ns < grid_time(&pictures->grid, vblank);
	if (in_time && (!pictures->running || vblank >= pictures->next_vblank))
		result = flips_present(&pictures->flips, image->index, vblank, group, serial) ? 0 : -EBUSY;
	if (result == 0 && !pictures->running) {
		pictures->running = true;
		pictures->next_vblank = vblank;
		pthread_cond_signal(&pictures->wake);
	}
	pthread_mutex_unlock(&pictures->lock);
	return result;
}

void pictures_set_standby(struct presenter *presenter, const struct presenter_image *image, uint64_t group,
						  uint64_t serial)
{
	struct pictures *pictures = pictures_of(presenter);
	take_back(pictures, image);
	pthread_mutex_lock(&pictures->lock);
	flips_set_standby(&pictures->flips, image->index, group, serial);
	pthread_mutex_unlock(&pictures->lock);
}

void pictures_clear_standby(struct presenter *presenter)
{
	struct pictures *pictures = pictures_of(presenter);
	pthread_mutex_lock(&pictures->lock);
	flips_clear_standby(&pictures->flips);
	pthread_mutex_unlock(&pictures->lock);
}

void pictures_pause(struct presenter *presenter)
{
	struct pictures *pictures = pictures_of(presenter);
	pthread_mutex_lock(&pictures->lock);
	pictures->running = false;
	pthread_mutex_unlock(&pictures->lock);
}
