/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * plant-mistake KIND IN.pursuit OUT.pursuit: a copy of a recording with one of the mistakes that streams are made with.
 * Motion must be RG32F or RG16F, depth DEPTH32F, colour BGRA8.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/record/half.h"
#include "daemon/record/recording.h"

struct planted {
	struct frame frame;
	uint8_t *planes[PURSUIT_MAX_PLANES];
	uint64_t index;
	float jitter[2], jitter_before[2];
};

typedef void (*change_motion)(const struct planted *planted, float width, float height, float m[2]);

static void turn(const struct planted *p, float width, float height, float m[2])
{
	m[0] = -m[0];
	m[1] = -m[1];
}
static void turn_x(const struct planted *p, float width, float height, float m[2])
{
	m[0] = -m[0];
}
static void turn_y(const struct planted *p, float width, float height, float m[2])
{
	m[1] = -m[1];
}
static void swap(const struct planted *p, float width, float height, float m[2])
{
	float x = m[0];
	m[0] = m[1];
	m[1] = x;
}
static void halve(const struct planted *p, float width, float height, float m[2])
{
	m[0] *= 0.5f;
	m[1] *= 0.5f;
}
static void twice(const struct planted *p, float width, float height, float m[2])
{
	m[0] *= 2.0f;
	m[1] *= 2.0f;
}
static void to_ndc(const struct planted *p, float width, float height, float m[2])
{
	m[0] *= 2.0f / width;
	m[1] *= -2.0f / height;
}
static void to_uv(const struct planted *p, float width, float height, float m[2])
{
	m[0] /= width;
	m[1] /= height;
}
static void to_zero(const struct planted *p, float width, float height, float m[2])
{
	m[0] = m[1] = 0.0f;
}
static void to_nan(const struct planted *p, float width, float height, float m[2])
{
	if (lrintf(m[0] * 64.0f) % 7 == 0)
		m[0] = NAN;
}
static void add_jitter(const struct planted *p, float width, float height, float m[2])
{
	m[0] += p->jitter[0] - p->jitter_before[0];
	m[1] += p->jitter[1] - p->jitter_before[1];
}

static void each_motion(struct planted *planted, change_motion change)
{
	const int index = frame_find_plane(&planted->frame.header, PURSUIT_ROLE_MOTION);
	const struct pursuit_plane *plane = &planted->frame.header.planes[index];
	const bool half = plane->format == PURSUIT_FORMAT_RG16F;
	for (uint32_t y = 0; y < plane->height; y++) {
		uint8_t *row = planted->planes[index] + y * plane->stride;
		for (uint32_t x = 0; x < plane->width; x++) {
			float m[2];
			uint16_t h[2];
			if (half) {
				memcpy(h, row + 4 * (size_t)x, sizeof(h));
				m[0] = half_to_float(h[0]);
				m[1] = half_to_float(h[1]);
			} else {
				memcpy(m, row + 8 * (size_t)x, sizeof(m));
			}
			change(planted, (float)plane->width, (float)plane->height, m);
			h[0] = half_from_float(m[0]);
			h[1] = half_from_float(m[1]);
			memcpy(row + (half ? 4u : 8u) * (size_t)x, half ? (const void *)h : (const void *)m, half ? 4 : 8);
		}
	}
}

static void each_depth(struct planted *planted, float scale, float offset)
{
	const int index = frame_find_plane(&planted->frame.header, PURSUIT_ROLE_DEPTH);
	const struct pursuit_plane *plane = &planted->frame.header.planes[index];
	for (uint32_t y = 0; y < plane->height; y++) {
		uint8_t *row = planted->planes[index] + y * plane->stride;
		for (uint32_t x = 0; x < plane->width; x++) {
			float d;
			memcpy(&d, row + 4 * (size_t)x, sizeof(d));
			d = scale * d + offset;
			memcpy(row + 4 * (size_t)x, &d, sizeof(d));
		}
	}
}

/* The picture as if it had been rendered with the frame's jitter. */
static void shake_color(struct planted *planted)
{
	const int index = frame_find_plane(&planted->frame.header, PURSUIT_ROLE_COLOR);
	const struct pursuit_plane *plane = &planted->frame.header.planes[index];
	const long width = plane->width, height = plane->height;
	uint8_t *copy = malloc(plane->size);
	memcpy(copy, planted->planes[index], plane->size);
	for (long y = 0; y < height; y++) {
		for (long x = 0; x < width; x++) {
			float px = fminf(fmaxf((float)x - planted->jitter[0], 0.0f), (float)(width - 1));
			float py = fminf(fmaxf((float)y - planted->jitter[1], 0.0f), (float)(height - 1));
			long left = (long)px, top = (long)py, right = left + 1 < width ? left + 1 : left,
				 bottom = top + 1 < height ? top + 1 : top;
			float u = px - (float)left, v = py - (float)top;
			for (long channel = 0; channel < 4; channel++) {
				const uint8_t *upper = copy + (size_t)top * plane->stride + channel,
							  *lower = copy + (size_t)bottom * plane->stride + channel;
				float value = (1 - v) * ((1 - u) * (float)upper[4 * left] + u * (float)upper[4 * right]) +
							  v * ((1 - u) * (float)lower[4 * left] + u * (float)lower[4 * right]);
				planted->planes[index][(size_t)y * plane->stride + 4 * (size_t)x + (size_t)channel] =
					(uint8_t)lrintf(value);
			}
		}
	}
	free(copy);
}

/* A Halton sequence, as temporal filters use it; pixels. */
static float halton(uint64_t index, uint64_t base)
{
	float fraction = 1.0f, sum = 0.0f;
	for (; index; index /= base) {
		fraction /= (float)base;
		sum += fraction * (float)(index % base);
	}
	return sum - 0.5f;
}

static void declare_jitter(struct planted *planted)
{
	planted->frame.header.flags |= PURSUIT_FRAME_JITTER;
	planted->frame.header.jitter_x = planted->jitter[0];
	planted->frame.header.jitter_y = planted->jitter[1];
}

static void freeze(struct planted *planted, uint32_t role, uint8_t **kept)
{
	const int index = frame_find_plane(&planted->frame.header, role);
	const uint64_t size = planted->frame.header.planes[index].size;
	if (!*kept) {
		*kept = malloc(size);
		memcpy(*kept, planted->planes[index], size);
	}
	memcpy(planted->planes[index], *kept, size);
}

static bool plant(const char *kind, struct planted *planted, uint8_t **kept)
{
	static const struct {
		const char *name;
		change_motion change;
	} motions[] = {{"sign", turn},   {"x-sign", turn_x}, {"y-sign", turn_y}, {"swapped", swap}, {"half", halve},
				   {"twice", twice}, {"ndc", to_ndc},    {"uv", to_uv},      {"zero", to_zero}, {"nan", to_nan}};
	struct pursuit_frame_header *header = &planted->frame.header;
	for (size_t i = 0; i < sizeof(motions) / sizeof(motions[0]); i++)
		if (strcmp(kind, motions[i].name) == 0)
			return each_motion(planted, motions[i].change), true;
	if (strcmp(kind, "none") == 0)
		return true;
	if (strcmp(kind, "kind") == 0)
		header->motion_kind = PURSUIT_MOTION_BACKWARD + PURSUIT_MOTION_FORWARD - header->motion_kind;
	else if (strcmp(kind, "depth-reversed") == 0)
		each_depth(planted, -1.0f, 1.0f);
	else if (strcmp(kind, "depth-range") == 0)
		each_depth(planted, 100.0f, 1.0f);
	else if (strcmp(kind, "depth-constant") == 0)
		each_depth(planted, 0.0f, 0.5f);
	else if (strcmp(kind, "jitter-motion") == 0)
		each_motion(planted, add_jitter);
	else if (strcmp(kind, "jitter-motion-declared") == 0)
		declare_jitter(planted), each_motion(planted, add_jitter);
	else if (strcmp(kind, "jitter-picture") == 0)
		shake_color(planted);
	else if (strcmp(kind, "jitter-picture-declared") == 0)
		declare_jitter(planted), shake_color(planted);
	else if (strcmp(kind, "frozen-motion") == 0)
		freeze(planted, PURSUIT_ROLE_MOTION, kept);
	else if (strcmp(kind, "frozen-depth") == 0)
		freeze(planted, PURSUIT_ROLE_DEPTH, kept);
	else if (strcmp(kind, "frozen-color") == 0)
		freeze(planted, PURSUIT_ROLE_COLOR, kept);
	else if (strcmp(kind, "interval") == 0)
		header->real_interval_ns *= 2;
	else if (strcmp(kind, "time-order") == 0)
		header->time_ns = 1000000000u;
	else
		return false;
	return true;
}

static int copy(const char *kind, struct recording_reader *reader, struct recording_writer *writer)
{
	struct error error = {""};
	uint8_t *kept = NULL;
	int result = 0;
	for (uint64_t i = 0; i < recording_reader_frame_count(reader) && result == 0; i++) {
		struct planted planted = {.index = i};
		uint64_t time_ns;
		result = recording_reader_frame(reader, i, 0, &planted.frame, &time_ns, &error);
		for (uint32_t plane = 0; result == 0 && plane < planted.frame.header.plane_count; plane++) {
			const uint64_t size = planted.frame.header.planes[plane].size;
			planted.planes[plane] = malloc(size);
			memcpy(planted.planes[plane], planted.frame.planes[plane], size);
			planted.frame.planes[plane] = planted.planes[plane];
		}
		for (uint64_t axis = 0; axis < 2; axis++) {
			planted.jitter[axis] = halton(i % 8 + 1, 2 + axis);
			planted.jitter_before[axis] = i ? halton((i + 7) % 8 + 1, 2 + axis) : 0.0f;
		}
		if (result == 0 && !plant(kind, &planted, &kept)) {
			fprintf(stderr, "no such mistake: %s\n", kind);
			result = -1;
		}
		if (result == 0)
			result = recording_writer_frame(writer, &planted.frame, time_ns, &error);
		for (uint32_t plane = 0; plane < PURSUIT_MAX_PLANES; plane++)
			free(planted.planes[plane]);
	}
	free(kept);
	if (error.text[0])
		fprintf(stderr, "%s\n", error.text);
	return result;
}

int main(int argc, char **argv)
{
	struct error error = {""};
	if (argc != 4)
		return 2;
	const struct recording_reader_params from = {.path = argv[2]};
	const struct recording_writer_params to = {.path = argv[3], .level = -5};
	struct recording_reader *reader = recording_reader_create(&from, &error);
	struct recording_writer *writer = reader ? recording_writer_create(&to, &error) : NULL;
	int result = writer ? copy(argv[1], reader, writer) : -1;
	if (writer && recording_writer_close(&writer, &error) < 0)
		result = -1;
	recording_reader_destroy(&reader);
	if (result < 0 && error.text[0])
		fprintf(stderr, "%s\n", error.text);
	return result < 0;
}
