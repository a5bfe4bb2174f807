/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "stream_view.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "daemon/record/half.h"

struct plane {
	const struct pursuit_plane *header;
	const uint8_t *bytes; /* NULL: no such plane */
};

static struct plane find(const struct frame *frame, uint32_t role)
{
	const int index = frame_find_plane(&frame->header, role);
	return index < 0 ? (struct plane){0} : (struct plane){&frame->header.planes[index], frame->planes[index]};
}

/* The pixel of a plane that lies under a pixel of a picture of this size. */
static const uint8_t *pixel_at(const struct plane *plane, const struct inspect_view *view, uint32_t x, uint32_t y)
{
	const uint64_t column = (2ull * x + 1) * plane->header->width / (2ull * view->width);
	const uint64_t row = (2ull * y + 1) * plane->header->height / (2ull * view->height);
	return plane->bytes + row * plane->header->stride + column * pursuit_format_bytes(plane->header->format);
}

static float half_at(const uint8_t *bytes)
{
	uint16_t half;
	memcpy(&half, bytes, sizeof(half));
	return half_to_float(half);
}

static float float_at(const uint8_t *bytes)
{
	float value;
	memcpy(&value, bytes, sizeof(value));
	return value;
}

static uint32_t word_at(const uint8_t *bytes)
{
	uint32_t word;
	memcpy(&word, bytes, sizeof(word));
	return word;
}

static float code_of_light(float light)
{
	light = light > 0.0f ? fminf(light, 1.0f) : 0.0f;
	return light <= 0.0031308f ? 12.92f * light : 1.055f * powf(light, 1.0f / 2.4f) - 0.055f;
}

/* Rec. 601 luma of code values, 0 to 1. */
static float luma_at(const struct pursuit_plane *plane, const uint8_t *pixel)
{
	float r, g, b;
	switch (plane->format) {
	case PURSUIT_FORMAT_RGBA16F:
		r = half_at(pixel);
		g = half_at(pixel + 2);
		b = half_at(pixel + 4);
		break;
	case PURSUIT_FORMAT_RGB10A2:
		r = (float)(word_at(pixel) & 1023u) / 1023.0f;
		g = (float)(word_at(pixel) >> 10 & 1023u) / 1023.0f;
		b = (float)(word_at(pixel) >> 20 & 1023u) / 1023.0f;
		break;
	default:
		r = (float)pixel[plane->format == PURSUIT_FORMAT_BGRA8 ? 2 : 0] / 255.0f;
		g = (float)pixel[1] / 255.0f;
		b = (float)pixel[plane->format == PURSUIT_FORMAT_BGRA8 ? 0 : 2] / 255.0f;
	}
	const float luma = 0.299f * r + 0.587f * g + 0.114f * b;
	if (plane->transfer.curve == PURSUIT_CURVE_LINEAR)
		return code_of_light(luma);
	return luma > 0.0f ? fminf(luma, 1.0f) : 0.0f;
}

static float depth_at(const struct pursuit_plane *plane, const uint8_t *pixel)
{
	if (plane->format == PURSUIT_FORMAT_DEPTH16)
		return (float)(pixel[0] | pixel[1] << 8) / 65535.0f;
	if (plane->format == PURSUIT_FORMAT_DEPTH24)
		return (float)(word_at(pixel) & 0xffffffu) / 16777215.0f;
	return float_at(pixel);
}

/* Binomial, 5 taps, along rows (step 1) or columns (step width); the ends stay. */
static void smooth(float *values, uint32_t count, size_t step)
{
	if (count < 5)
		return;
	float a = values[0], b = values[step];
	for (uint32_t i = 2; i + 2 < count; i++) {
		float *at = values + i * step;
		const float here = at[0];
		at[0] = (a + 4.0f * b + 6.0f * here + 4.0f * at[step] + at[2 * step]) / 16.0f;
		a = b;
		b = here;
	}
}

static void read_luma(struct stream_view *self, const struct plane *plane)
{
	struct inspect_view *view = &self->view;
	for (uint32_t y = 0; y < view->height; y++)
		for (uint32_t x = 0; x < view->width; x++)
			self->luma[(size_t)y * view->width + x] = luma_at(plane->header, pixel_at(plane, view, x, y));
	for (uint32_t y = 0; y < view->height; y++)
		smooth(self->luma + (size_t)y * view->width, view->width, 1);
	for (uint32_t x = 0; x < view->width; x++)
		smooth(self->luma + x, view->height, view->width);
	view->luma = self->luma;
}

static void read_motion(struct stream_view *self, const struct plane *plane)
{
	struct inspect_view *view = &self->view;
	const bool half = plane->bytes && plane->header->format == PURSUIT_FORMAT_RG16F;
	if (!plane->bytes)
		return;
	for (uint32_t y = 0; y < view->height; y++) {
		for (uint32_t x = 0; x < view->width; x++) {
			const uint8_t *pixel = pixel_at(plane, view, x, y);
			float *m = self->motion + 2 * ((size_t)y * view->width + x);
			m[0] = half ? half_at(pixel) : float_at(pixel);
			m[1] = half ? half_at(pixel + 2) : float_at(pixel + 4);
			view->invalid_motion += !isfinite(m[0]) || !isfinite(m[1]);
		}
	}
	view->motion = self->motion;
}

static void read_depth(struct stream_view *self, const struct plane *plane, uint32_t kind)
{
	struct inspect_view *view = &self->view;
	if (!plane->bytes)
		return;
	for (uint32_t y = 0; y < view->height; y++) {
		for (uint32_t x = 0; x < view->width; x++) {
			const float d = depth_at(plane->header, pixel_at(plane, view, x, y));
			view->outside_depth += kind != PURSUIT_DEPTH_LINEAR && !(d >= 0.0f && d <= 1.0f);
			self->nearness[(size_t)y * view->width + x] = kind == PURSUIT_DEPTH_DEVICE_REVERSED ? d : -d;
		}
	}
	view->nearness = self->nearness;
}

static uint64_t hash_of(const struct plane *plane)
{
	XXH3_state_t *state = plane->bytes ? XXH3_createState() : NULL;
	if (!state)
		return 0;
	XXH3_64bits_reset(state);
	const size_t bytes = (size_t)plane->header->width * pursuit_format_bytes(plane->header->format);
	for (uint32_t y = 0; y < plane->header->height; y++)
		XXH3_64bits_update(state, plane->bytes + y * plane->header->stride, bytes);
	const uint64_t hash = XXH3_64bits_digest(state);
	XXH3_freeState(state);
	return hash;
}

static int make_room(struct stream_view *self, size_t pixels)
{
	if (pixels <= self->capacity)
		return 0;
	stream_view_finish(self);
	self->luma = malloc(pixels * sizeof(float));
	self->motion = malloc(2 * pixels * sizeof(float));
	self->nearness = malloc(pixels * sizeof(float));
	self->capacity = pixels;
	return self->luma && self->motion && self->nearness ? 0 : -ENOMEM;
}

int stream_view_read(struct stream_view *self, const struct frame *frame)
{
	const struct pursuit_frame_header *header = &frame->header;
	const struct plane color = find(frame, PURSUIT_ROLE_COLOR), depth = find(frame, PURSUIT_ROLE_DEPTH),
					   motion = find(frame, PURSUIT_ROLE_MOTION);
	if (make_room(self, (size_t)color.header->width * color.header->height) < 0)
		return -ENOMEM;
	self->view = (struct inspect_view){
		.width = color.header->width,
		.height = color.header->height,
		.forward = header->motion_kind == PURSUIT_MOTION_FORWARD,
		.usable_motion = motion.bytes && !(header->flags & (PURSUIT_FRAME_CUT | PURSUIT_FRAME_MOTION_INVALID)),
		.has_jitter = header->flags & PURSUIT_FRAME_JITTER,
		.jitter = {header->jitter_x, header->jitter_y},
		.frame_id = header->frame_id,
		.time_ns = header->time_ns,
		.real_interval_ns = header->real_interval_ns,
		.motion_interval_ns = header->motion_interval_ns,
		.color_hash = hash_of(&color),
		.depth_hash = hash_of(&depth),
		.motion_hash = hash_of(&motion),
	};
	read_luma(self, &color);
	read_motion(self, &motion);
	read_depth(self, &depth, header->depth_kind);
	return 0;
}

void stream_view_finish(struct stream_view *self)
{
	free(self->luma);
	free(self->motion);
	free(self->nearness);
	*self = (struct stream_view){0};
}
