/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/engine/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void add_plane(struct pursuit_frame_header *header, uint32_t role, uint32_t format, uint32_t width,
					  uint32_t height)
{
	struct pursuit_plane *plane = &header->planes[header->plane_count++];
	*plane = (struct pursuit_plane){.role = role, .format = format, .width = width, .height = height};
	if (role == PURSUIT_ROLE_COLOR || role == PURSUIT_ROLE_UI)
		plane->transfer.curve = format == PURSUIT_FORMAT_RGBA16F ? PURSUIT_CURVE_LINEAR : PURSUIT_CURVE_SRGB;
}

void picture_init(struct picture *picture, uint32_t width, uint32_t height, uint32_t format, unsigned planes)
{
	*picture = (struct picture){.width = width, .height = height};
	struct pursuit_frame_header *header = &picture->frame.header;
	header->frame_id = 1;
	header->real_interval_ns = 25000000;
	add_plane(header, PURSUIT_ROLE_COLOR, format, width, height);
	if (planes & PICTURE_DEPTH) {
		header->depth_kind = PURSUIT_DEPTH_DEVICE;
		add_plane(header, PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH32F, width, height);
	}
	if (planes & PICTURE_MOTION) {
		header->motion_kind = PURSUIT_MOTION_BACKWARD;
		add_plane(header, PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG32F, width, height);
	}
	if (planes & PICTURE_UI)
		add_plane(header, PURSUIT_ROLE_UI, PURSUIT_FORMAT_BGRA8, width, height);
	uint64_t bytes = frame_layout(header);
	picture->memory = calloc(1, bytes);
	if (!picture->memory)
		abort();
	for (uint32_t i = 0; i < header->plane_count; i++)
		picture->frame.planes[i] = picture->memory + header->planes[i].offset;
}

void picture_finish(struct picture *picture)
{
	free(picture->memory);
	*picture = (struct picture){0};
}

uint8_t *picture_row(const struct picture *picture, uint32_t role, uint32_t y)
{
	int index = frame_find_plane(&picture->frame.header, role);
	if (index < 0)
		return NULL;
	const struct pursuit_plane *plane = &picture->frame.header.planes[index];
	return picture->memory + plane->offset + y * plane->stride;
}

void picture_set_motion(const struct picture *picture, uint32_t x, uint32_t y, float mx, float my)
{
	uint8_t *row = picture_row(picture, PURSUIT_ROLE_MOTION, y);
	if (row)
		memcpy(row + 8 * (size_t)x, (const float[]){mx, my}, 8);
}

void picture_set_depth(const struct picture *picture, uint32_t x, uint32_t y, float depth)
{
	uint8_t *row = picture_row(picture, PURSUIT_ROLE_DEPTH, y);
	if (row)
		memcpy(row + 4 * (size_t)x, &depth, 4);
}

uint32_t picture_random(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	uint32_t x = *state ^ (*state >> 15);
	x *= 0x2c1b3c6du;
	return x ^ (x >> 13);
}

void picture_fill_random(const struct picture *picture, uint32_t role, uint32_t seed)
{
	int index = frame_find_plane(&picture->frame.header, role);
	const struct pursuit_plane *plane = &picture->frame.header.planes[index];
	uint8_t *at = picture->memory + plane->offset;
	for (uint64_t i = 0; i < plane->size; i++)
		at[i] = (uint8_t)picture_random(&seed);
}

#define DISCS 7

struct disc {
	double x, y, radius, vx, vy, depth;
	uint32_t color;
};

struct point {
	double x, y;
};

static struct disc disc_at(int index, double t, double width, double height)
{
	uint32_t state = 77u + 1313u * (uint32_t)index;
	double r[5];
	for (int i = 0; i < 5; i++)
		r[i] = (double)(picture_random(&state) & 0xffffu) / 65536.0;
	struct disc disc = {.radius = (0.05 + 0.07 * r[0]) * height, .depth = 0.2 + 0.05 * index};
	disc.vx = (r[1] - 0.5) * 0.05 * width;
	disc.vy = (r[2] - 0.5) * 0.03 * height;
	disc.x = width * (0.1 + 0.8 * r[3]) + disc.vx * t;
	disc.y = height * (0.1 + 0.8 * r[4]) + disc.vy * t;
	disc.color = picture_random(&state) | 0x202020u;
	return disc;
}

/* Where on the ground pixel (x, y) looks at time t, and back. */
static struct point ground_from_screen(double x, double y, double t, double width, double height)
{
	double cx = (x - 0.5 * width) / height, cy = (y - 0.5 * height) / height;
	double depth = 1.0 / (1.4 + 0.6 * cy);
	double angle = 0.006 * t;
	double gx = cx * depth, gy = depth;
	return (struct point){gx * cos(angle) - gy * sin(angle) + 0.006 * t, gx * sin(angle) + gy * cos(angle) + 0.004 * t};
}

static struct point screen_from_ground(struct point ground, double t, double width, double height)
{
	double angle = 0.006 * t;
	double ax = ground.x - 0.006 * t, ay = ground.y - 0.004 * t;
	double gx = ax * cos(angle) + ay * sin(angle), depth = -ax * sin(angle) + ay * cos(angle);
	double cy = (1.0 / depth - 1.4) / 0.6, cx = gx / depth;
	return (struct point){cx * height + 0.5 * width, cy * height + 0.5 * height};
}

static uint32_t gray_mix(double r, double g, double b)
{
	return 0xff000000u | (uint32_t)(255.0 * r) << 16 | (uint32_t)(255.0 * g) << 8 | (uint32_t)(255.0 * b);
}

/* Checks with thin lines and a fine wave: edges of all directions, detail near the pixel. */
static uint32_t ground_color(struct point p)
{
	double u = p.x * 24.0, v = p.y * 24.0;
	bool odd = ((int64_t)floor(u) + (int64_t)floor(v)) & 1;
	double line = fmin(fabs(u - floor(u) - 0.5), fabs(v - floor(v) - 0.5));
	double wave = 0.12 * sin(p.x * 700.0) * sin(p.y * 650.0);
	double base = (odd ? 0.7 : 0.3) + wave;
	return line < 0.03 ? gray_mix(0.95, 0.9, 0.3) : gray_mix(base, base * 0.9, base * 0.7 + 0.1);
}

static int disc_over(const struct disc *discs, double x, double y)
{
	for (int i = 0; i < DISCS; i++)
		if (hypot(x - discs[i].x, y - discs[i].y) < discs[i].radius)
			return i;
	return -1;
}

static void set_color(const struct picture *picture, uint32_t x, uint32_t y, uint32_t color)
{
	memcpy(picture_row(picture, PURSUIT_ROLE_COLOR, y) + 4 * (size_t)x, &color, 4);
}

static void draw_disc_pixel(const struct picture *picture, const struct disc *disc, uint32_t x, uint32_t y)
{
	double stripe = sin((x + 0.5 - disc->x) * 0.8) + sin((y + 0.5 - disc->y) * 0.5);
	set_color(picture, x, y, 0xff000000u | (stripe > 0.0 ? disc->color : disc->color >> 1 & 0x7f7f7fu));
	picture_set_motion(picture, x, y, (float)disc->vx, (float)disc->vy);
	picture_set_depth(picture, x, y, (float)disc->depth);
}

static void draw(const struct picture *picture, double t, double ground_t, bool ground_moves)
{
	double width = picture->width, height = picture->height;
	struct disc discs[DISCS];
	for (int i = 0; i < DISCS; i++)
		discs[i] = disc_at(i, t, width, height);
	for (uint32_t y = 0; y < picture->height; y++)
		for (uint32_t x = 0; x < picture->width; x++) {
			int over = disc_over(discs, x + 0.5, y + 0.5);
			if (over >= 0) {
				draw_disc_pixel(picture, &discs[over], x, y);
				continue;
			}
			struct point ground = ground_from_screen(x + 0.5, y + 0.5, ground_t, width, height);
			struct point before = screen_from_ground(ground, ground_moves ? ground_t - 1.0 : ground_t, width, height);
			set_color(picture, x, y, ground_color(ground));
			picture_set_motion(picture, x, y, (float)(x + 0.5 - before.x), (float)(y + 0.5 - before.y));
			picture_set_depth(picture, x, y, 0.9f - 0.2f * (float)(y / height));
			if (!ground_moves)
				picture_set_motion(picture, x, y, 0.0f, 0.0f);
		}
}

void picture_draw_layers(const struct picture *picture, double t)
{
	draw(picture, t, t, true);
}

void picture_draw_discs(const struct picture *picture, double t)
{
	draw(picture, t, 0.0, false);
}
