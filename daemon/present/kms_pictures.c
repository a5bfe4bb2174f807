/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The memory of pictures, and where in it a picture lies; on the render thread. */
#include <errno.h>
#include <string.h>

#include "daemon/present/kms.h"

/* Rows begin at a multiple of 64 bytes. */
#define COLUMNS 16u

void kms_destroy_picture(struct kms *kms, struct kms_picture *picture)
{
	kms_device_destroy_buffer(kms->device, &picture->memory.buffer);
	kms_device_destroy_buffer(kms->device, &picture->in_gl.buffer);
	if (kms->gl)
		kms_gl_destroy_buffer(kms->gl, &picture->gl_buffer);
}

/* Where a picture begins that lies in the middle. */
static uint32_t left_of(const struct kms_mode *mode, uint32_t width)
{
	return (mode->width - width) / 2 / COLUMNS * COLUMNS;
}

static uint32_t top_of(const struct kms_mode *mode, uint32_t height)
{
	return (mode->height - height) / 2;
}

static void try_scaler(struct kms *kms, const struct kms_buffer *buffer, const struct kms_rectangle *part)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	pthread_mutex_lock(&kms->lock);
	const bool ours = !kms->away;
	kms->scales =
		(part->width < mode->width || part->height < mode->height) && kms_device_can_scale(kms->device, buffer, part);
	pthread_mutex_unlock(&kms->lock);
	if (!ours)
		return; /* asked again when the display is */
	kms->tried_width = part->width;
	kms->tried_height = part->height;
	log_info(kms->params.log, "kms: pictures of %ux%u on %ux%u: %s", part->width, part->height, mode->width,
			 mode->height, kms->scales ? "enlarged by the display controller" : "as they are");
}

/* The controller enlarges a picture that is smaller than the display, if it can; else there is black around it. */
static void choose_part(struct kms *kms, struct kms_buffer *buffer, const struct kms_rectangle *part)
{
	if (kms->tried_width != part->width || kms->tried_height != part->height)
		try_scaler(kms, buffer, part);
	buffer->part = kms->scales ? *part : (struct kms_rectangle){0, 0, 0, 0};
}

/* ---- lending ---- */

static int refuse_size(struct kms *kms, uint32_t width, uint32_t height)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	if (kms->refused_width != width || kms->refused_height != height)
		log_error(kms->params.log,
				  "kms: a picture of %ux%u is larger than the display (%ux%u) and is not shown; use a larger --mode or "
				  "smaller frames",
				  width, height, mode->width, mode->height);
	kms->refused_width = width;
	kms->refused_height = height;
	return -E2BIG;
}

/* A free one. Negative errno. */
static int acquire_any(struct kms *kms, uint32_t width, uint32_t height, struct presenter_image *image)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	if (width > mode->width || height > mode->height)
		return refuse_size(kms, width, height);
	pthread_mutex_lock(&kms->lock);
	const int index = flips_acquire(&kms->scanout.flips);
	pthread_mutex_unlock(&kms->lock);
	if (index < 0)
		return -EBUSY;
	*image = (struct presenter_image){.index = (uint32_t)index};
	return 0;
}

/* Makes what is missing. Negative errno with a sentence. */
typedef int (*make_function)(struct kms *kms, struct kms_picture *picture, struct error *error);

static int make_in_memory(struct kms *kms, struct kms_picture *picture, struct error *error)
{
	if (picture->memory.buffer.data)
		return 0;
	return kms_device_create_buffer(kms->device, &picture->memory.buffer, error) < 0 ? -ENOMEM : 0;
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

static int make_in_gl(struct kms *kms, struct kms_picture *picture, struct error *error)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	if (picture->in_gl.buffer.framebuffer)
		return 0;
	if (kms_gl_create_buffer(kms->gl, mode->width, mode->height, &picture->gl_buffer, error) < 0)
		return -ENOTSUP;
	if (adopt(kms, picture, error) == 0)
		return 0;
	kms_gl_destroy_buffer(kms->gl, &picture->gl_buffer);
	return -ENOTSUP;
}

static int acquire(struct kms *kms, make_function make, uint32_t width, uint32_t height, struct presenter_image *image,
				   struct kms_picture **picture)
{
	struct error error;
	int result = acquire_any(kms, width, height, image);
	if (result < 0)
		return result;
	*picture = &kms->pictures[image->index];
	result = make(kms, *picture, &error);
	if (result == 0)
		return 0;
	log_warning(kms->params.log, "%s", error.text);
	kms_give_back(kms, image->index);
	return result;
}

/* Where the picture lies in it. False: there is something else around it still. */
static bool lend(struct kms *kms, struct kms_surface *surface, uint32_t width, uint32_t height,
				 struct presenter_image *image, struct kms_rectangle *part)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	*part = (struct kms_rectangle){left_of(mode, width), top_of(mode, height), width, height};
	choose_part(kms, &surface->buffer, part);
	return canvas_lend(&surface->canvas, width, height, image);
}

int kms_acquire(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image)
{
	struct kms *kms = kms_of(presenter);
	struct kms_picture *picture;
	struct kms_rectangle part;
	const int result = acquire(kms, make_in_memory, width, height, image, &picture);
	if (result < 0)
		return result;
	const struct kms_buffer *buffer = &picture->memory.buffer;
	if (!lend(kms, &picture->memory, width, height, image, &part))
		memset(buffer->data, 0, buffer->size);
	picture->shown = &picture->memory;
	image->stride = buffer->stride;
	image->data = buffer->data + part.y * buffer->stride + (size_t)part.x * 4;
	return 0;
}

int kms_acquire_texture(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image)
{
	struct kms *kms = kms_of(presenter);
	struct kms_picture *picture;
	struct kms_rectangle part;
	const int result = acquire(kms, make_in_gl, width, height, image, &picture);
	if (result < 0)
		return result;
	if (!lend(kms, &picture->in_gl, width, height, image, &part))
		kms_gl_blacken(kms->gl, &picture->gl_buffer);
	picture->shown = &picture->in_gl;
	image->texture = picture->gl_buffer.texture;
	image->texture_x = part.x;
	image->texture_y = part.y;
	return 0;
}

const struct presenter_context *kms_get_context(struct presenter *presenter)
{
	const struct kms *kms = kms_of(presenter);
	return kms->gl ? kms_gl_get_context(kms->gl) : NULL;
}

/* ---- taking back ---- */

void kms_take_back(struct kms *kms, const struct presenter_image *image)
{
	canvas_take_back(&kms->pictures[image->index].shown->canvas, image);
}

void kms_give_back(struct kms *kms, uint32_t index)
{
	pthread_mutex_lock(&kms->lock);
	flips_release(&kms->scanout.flips, index);
	pthread_mutex_unlock(&kms->lock);
}
