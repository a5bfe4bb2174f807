/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The memory of pictures, and where in it a picture lies; on the render thread. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "daemon/present/kms.h"

/* Rows begin at a multiple of so many bytes. */
#define ROW_BYTES 64u
#define COLUMNS (ROW_BYTES / 4)

static void drop_fence(struct kms_picture *picture)
{
	if (picture->fence >= 0)
		close(picture->fence);
	picture->fence = -1;
}

static void free_large(struct kms_picture *picture)
{
	free(picture->large);
	picture->large = NULL;
	picture->large_size = 0;
	picture->memory.large = (struct contents){0, 0, 0};
}

void kms_destroy_pictures(struct kms *kms)
{
	for (uint32_t i = 0; i < FLIPS_IMAGES; i++) {
		struct kms_picture *picture = &kms->pictures[i];
		kms_device_destroy_buffer(kms->device, &picture->memory.buffer);
		kms_device_destroy_buffer(kms->device, &picture->in_gl.buffer);
		if (kms->gl)
			kms_gl_destroy_buffer(kms->gl, &picture->gl_buffer);
		free_large(picture);
		drop_fence(picture);
	}
	shrink_destroy(&kms->shrink);
}

/* ---- places ---- */

static bool is_large(const struct kms *kms, uint32_t width, uint32_t height)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	return width > mode->width || height > mode->height;
}

/* In the middle, and no larger than the display. */
static struct rectangle part_for(const struct kms *kms, uint32_t width, uint32_t height)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	struct rectangle part = {0, 0, width, height};
	if (is_large(kms, width, height))
		part = rectangle_fit(width, height, mode->width, mode->height);
	part.x = (mode->width - part.width) / 2 / COLUMNS * COLUMNS;
	part.y = (mode->height - part.height) / 2;
	return part;
}

static void tell_size(struct kms *kms, uint32_t width, uint32_t height, const struct rectangle *part)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	if (!log_limit_allows(&kms->size_limit, clock_now(kms->params.clock)))
		return;
	if (is_large(kms, width, height))
		log_info(kms->params.log, "kms: pictures of %ux%u on %ux%u: made smaller, to %ux%u", width, height, mode->width,
				 mode->height, part->width, part->height);
	else
		log_info(kms->params.log, "kms: pictures of %ux%u on %ux%u: %s", width, height, mode->width, mode->height,
				 kms->scales ? "enlarged by the display controller" : "as they are");
}

/* How pictures of this size are shown; the controller enlarges one that is smaller than the display, if it can. */
static void try_size(struct kms *kms, const struct kms_buffer *buffer, uint32_t width, uint32_t height,
					 const struct rectangle *part)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	const bool smaller = part->width < mode->width || part->height < mode->height;
	pthread_mutex_lock(&kms->lock);
	const bool ours = !kms->away;
	kms->scales = ours && smaller && !is_large(kms, width, height) && kms_device_can_scale(kms->device, buffer, part);
	pthread_mutex_unlock(&kms->lock);
	if (!ours)
		return; /* asked again when the display is */
	kms->tried_width = width;
	kms->tried_height = height;
	tell_size(kms, width, height, part);
}

bool kms_can_fence(const struct kms *kms)
{
	return kms_gl_can_fence(kms->gl) && kms_device_takes_fences(kms->device);
}

/* ---- acquiring ---- */

/* Makes what is missing for pictures of this size. Negative errno with a sentence. */
typedef int (*make_function)(struct kms *kms, struct kms_picture *picture, uint32_t width, uint32_t height,
							 struct error *error);

/* NULL: no memory. */
static struct shrink *shrink_for(struct kms *kms, uint32_t width, uint32_t height)
{
	const struct rectangle part = part_for(kms, width, height);
	if (kms->shrink && kms->shrink_width == width && kms->shrink_height == height)
		return kms->shrink;
	shrink_destroy(&kms->shrink);
	kms->shrink = shrink_create(width, height, part.width, part.height);
	kms->shrink_width = width;
	kms->shrink_height = height;
	return kms->shrink;
}

/* For a picture that is larger than the display. */
static int make_large(struct kms *kms, struct kms_picture *picture, uint32_t width, uint32_t height)
{
	const size_t stride = ((size_t)width * 4 + ROW_BYTES - 1) / ROW_BYTES * ROW_BYTES, size = stride * height;
	picture->large_stride = stride;
	if (picture->large_size != size) {
		free_large(picture);
		picture->large = aligned_alloc(ROW_BYTES, size);
		picture->large_size = picture->large ? size : 0;
	}
	return picture->large && shrink_for(kms, width, height) ? 0 : -ENOMEM;
}

static int make_in_memory(struct kms *kms, struct kms_picture *picture, uint32_t width, uint32_t height,
						  struct error *error)
{
	if (!picture->memory.buffer.data && kms_device_create_buffer(kms->device, &picture->memory.buffer, error) < 0)
		return -ENOMEM;
	if (!is_large(kms, width, height))
		free_large(picture);
	else if (make_large(kms, picture, width, height) < 0)
		return error_set(error, -ENOMEM, "kms: no memory for a picture of %ux%u", width, height);
	return 0;
}

/* With the lock for the device, which may be given away meanwhile. */
static int adopt(struct kms *kms, struct kms_picture *picture, struct error *error)
{
	const struct kms_gl_buffer *gl = &picture->gl_buffer;
	pthread_mutex_lock(&kms->lock);
	const int result = kms_device_adopt_buffer(kms->device, gl->handle, gl->stride, &picture->in_gl.buffer, error);
	pthread_mutex_unlock(&kms->lock);
	return result;
}

static int make_gl_buffer(struct kms *kms, struct kms_picture *picture, struct error *error)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	if (kms_gl_create_buffer(kms->gl, mode->width, mode->height, &picture->gl_buffer, error) < 0)
		return -ENOTSUP;
	if (adopt(kms, picture, error) == 0)
		return 0;
	kms_gl_destroy_buffer(kms->gl, &picture->gl_buffer);
	return -ENOTSUP;
}

static int make_in_gl(struct kms *kms, struct kms_picture *picture, uint32_t width, uint32_t height,
					  struct error *error)
{
	if (!picture->in_gl.buffer.framebuffer && make_gl_buffer(kms, picture, error) < 0)
		return -ENOTSUP;
	struct kms_gl_large *large = &picture->gl_large;
	const bool wanted = is_large(kms, width, height);
	if (!wanted || large->width != width || large->height != height)
		picture->in_gl.large = (struct contents){0, 0, 0};
	return kms_gl_resize(kms->gl, large, wanted ? width : 0, wanted ? height : 0, error) < 0 ? -ENOTSUP : 0;
}

static struct kms_picture *acquire_any(struct kms *kms, struct presenter_image *image)
{
	pthread_mutex_lock(&kms->lock);
	const int index = flips_acquire(&kms->scanout.flips);
	pthread_mutex_unlock(&kms->lock);
	*image = (struct presenter_image){.index = index < 0 ? 0 : (uint32_t)index};
	return index < 0 ? NULL : &kms->pictures[index];
}

static void give_back(struct kms *kms, uint32_t index)
{
	pthread_mutex_lock(&kms->lock);
	flips_release(&kms->scanout.flips, index);
	pthread_mutex_unlock(&kms->lock);
}

/* When it begins and when it ends, since it is tried at each vblank. */
static void tell_lack(struct kms *kms, bool *lack, bool lacks, const struct error *error)
{
	if (lacks && !*lack)
		log_warning(kms->params.log, "%s", error->text);
	else if (*lack && !lacks)
		log_info(kms->params.log, "kms: there is memory for pictures again");
	*lack = lacks;
}

/* lack: of this kind of memory. */
static int acquire(struct kms *kms, make_function make, bool *lack, uint32_t width, uint32_t height,
				   struct presenter_image *image, struct kms_picture **picture)
{
	struct error error = {""};
	*picture = acquire_any(kms, image);
	if (!*picture)
		return -EBUSY;
	drop_fence(*picture);
	const int result = make(kms, *picture, width, height, &error);
	tell_lack(kms, lack, result < 0, &error);
	if (result < 0)
		give_back(kms, image->index);
	return result;
}

/* False: around the picture's place there is something else still. */
static bool lend(struct kms *kms, struct kms_picture *picture, struct kms_surface *surface, uint32_t width,
				 uint32_t height, struct presenter_image *image)
{
	picture->shown = surface;
	picture->is_large = is_large(kms, width, height);
	picture->part = part_for(kms, width, height);
	if (kms->tried_width != width || kms->tried_height != height)
		try_size(kms, &surface->buffer, width, height, &picture->part);
	surface->buffer.part = kms->scales ? picture->part : (struct rectangle){0, 0, 0, 0};
	const bool same = contents_lend(&surface->contents, picture->part.width, picture->part.height, image);
	if (!same || !picture->is_large)
		surface->shrunk = 0;
	if (picture->is_large)
		contents_lend(&surface->large, width, height, image);
	return same;
}

int kms_acquire(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image)
{
	struct kms *kms = kms_of(presenter);
	struct kms_picture *picture;
	const int result = acquire(kms, make_in_memory, &kms->lacks_memory, width, height, image, &picture);
	if (result < 0)
		return result;
	const struct kms_buffer *buffer = &picture->memory.buffer;
	if (!lend(kms, picture, &picture->memory, width, height, image))
		memset(buffer->data, 0, buffer->size);
	image->stride = picture->is_large ? picture->large_stride : buffer->stride;
	image->data = picture->is_large ? picture->large
									: buffer->data + picture->part.y * buffer->stride + (size_t)picture->part.x * 4;
	return 0;
}

int kms_acquire_texture(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image)
{
	struct kms *kms = kms_of(presenter);
	struct kms_picture *picture;
	const int result = acquire(kms, make_in_gl, &kms->lacks_gl, width, height, image, &picture);
	if (result < 0)
		return result;
	if (!lend(kms, picture, &picture->in_gl, width, height, image))
		kms_gl_blacken(kms->gl, &picture->gl_buffer);
	image->fenced = kms_can_fence(kms);
	image->texture = picture->is_large ? picture->gl_large.texture : picture->gl_buffer.texture;
	image->texture_x = picture->is_large ? 0 : picture->part.x;
	image->texture_y = picture->is_large ? 0 : picture->part.y;
	return 0;
}

const struct presenter_context *kms_get_context(struct presenter *presenter)
{
	const struct kms *kms = kms_of(presenter);
	return kms->gl ? kms_gl_get_context(kms->gl) : NULL;
}

/* ---- giving back ---- */

/* Of what is drawn there, to hand it out again. */
static struct contents *contents_of(const struct kms_picture *picture)
{
	return picture->is_large ? &picture->shown->large : &picture->shown->contents;
}

void kms_release(struct presenter *presenter, const struct presenter_image *image)
{
	struct kms *kms = kms_of(presenter);
	contents_take_back(contents_of(&kms->pictures[image->index]), image);
	give_back(kms, image->index);
}

static void shrink_in_memory(struct kms *kms, const struct kms_picture *picture, const struct presenter_image *image)
{
	const struct kms_buffer *buffer = &picture->memory.buffer;
	const struct rectangle *part = &picture->part;
	struct shrink *shrink = shrink_for(kms, image->width, image->height);
	if (shrink)
		shrink_run(shrink, image->data, image->stride, buffer->data + part->y * buffer->stride + (size_t)part->x * 4,
				   buffer->stride);
}

/* True: GL is at it now. */
static bool make_smaller(struct kms *kms, struct kms_picture *picture, const struct presenter_image *image)
{
	struct kms_surface *surface = picture->shown;
	if (!picture->is_large || (image->holds != 0 && image->holds == surface->shrunk))
		return false;
	surface->shrunk = image->holds;
	if (image->texture)
		kms_gl_shrink(kms->gl, &picture->gl_large, &picture->gl_buffer, &picture->part);
	else
		shrink_in_memory(kms, picture, image);
	return image->texture != 0;
}

void kms_take_back(struct kms *kms, const struct presenter_image *image)
{
	struct kms_picture *picture = &kms->pictures[image->index];
	drop_fence(picture);
	const bool drawing = make_smaller(kms, picture, image);
	contents_take_back(contents_of(picture), image);
	if (image->fenced)
		picture->fence = kms_gl_fence(kms->gl);
	if (picture->fence < 0 && (drawing || image->fenced))
		kms_gl_wait(kms->gl);
}
