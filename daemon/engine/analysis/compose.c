/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/compose.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "daemon/engine/analysis/rows.h"
#include "daemon/engine/analysis/values.h"

#define LARGEST_MOTION 65504.0f
#define ALIKE 1.0f /* pixels of motion within which neighbours may be mixed */

struct step {
	const uint8_t *data; /* NULL: no motion to be used */
	uint64_t stride;
	bool half;
	uint32_t width, height;
	double scale_x, scale_y; /* motion pixels per colour pixel */
};

struct motion {
	float x, y;
	bool known;
};

static float limited(float value)
{
	return fminf(fmaxf(value, -LARGEST_MOTION), LARGEST_MOTION);
}

static struct motion motion_at(const struct step *step, uint32_t i, uint32_t j)
{
	const uint8_t *row = step->data + j * step->stride;
	uint16_t halves[2];
	float values[2];
	if (step->half) {
		memcpy(halves, row + sizeof(halves) * i, sizeof(halves));
		values[0] = plan_half_value(halves[0]);
		values[1] = plan_half_value(halves[1]);
	} else {
		memcpy(values, row + sizeof(values) * i, sizeof(values));
	}
	if (!isfinite(values[0]) || !isfinite(values[1]))
		return (struct motion){0, 0, false};
	return (struct motion){limited(values[0]), limited(values[1]), true};
}

static bool alike(const struct motion texels[4])
{
	for (int i = 0; i < 4; i++)
		for (int k = 0; k < i; k++)
			if (!texels[i].known || !texels[k].known || fabsf(texels[i].x - texels[k].x) > ALIKE ||
				fabsf(texels[i].y - texels[k].y) > ALIKE)
				return false;
	return true;
}

static float mixed(float v00, float v10, float v01, float v11, float fx, float fy)
{
	float upper = v00 + fx * (v10 - v00), lower = v01 + fx * (v11 - v01);
	return upper + fy * (lower - upper);
}

/* Motion at a place of the picture, in colour pixels from its upper left corner. */
static struct motion look_up(const struct step *step, double x, double y)
{
	double gx = fmin(fmax(x * step->scale_x - 0.5, 0), step->width - 1);
	double gy = fmin(fmax(y * step->scale_y - 0.5, 0), step->height - 1);
	uint32_t i0 = (uint32_t)gx, j0 = (uint32_t)gy;
	uint32_t i1 = i0 + 1 < step->width ? i0 + 1 : i0, j1 = j0 + 1 < step->height ? j0 + 1 : j0;
	float fx = (float)(gx - i0), fy = (float)(gy - j0);
	struct motion texels[4] = {motion_at(step, i0, j0), motion_at(step, i1, j0), motion_at(step, i0, j1),
							   motion_at(step, i1, j1)};
	if (!alike(texels))
		return texels[(fx >= 0.5f) + 2 * (fy >= 0.5f)];
	return (struct motion){mixed(texels[0].x, texels[1].x, texels[2].x, texels[3].x, fx, fy),
						   mixed(texels[0].y, texels[1].y, texels[2].y, texels[3].y, fx, fy), true};
}

static struct step step_of(const struct frame *frame)
{
	const struct pursuit_frame_header *header = &frame->header;
	int index = plan_find_plane(header, PURSUIT_ROLE_MOTION), colour = plan_find_plane(header, PURSUIT_ROLE_COLOR);
	const struct pursuit_plane *plane = &header->planes[index];
	bool usable = !(header->flags & (PURSUIT_FRAME_CUT | PURSUIT_FRAME_MOTION_INVALID));
	return (struct step){.data = usable ? frame->planes[index] : NULL,
						 .stride = plane->stride,
						 .half = plane->format == PURSUIT_FORMAT_RG16F,
						 .width = plane->width,
						 .height = plane->height,
						 .scale_x = (double)plane->width / header->planes[colour].width,
						 .scale_y = (double)plane->height / header->planes[colour].height};
}

static bool same_size(const struct pursuit_frame_header *a, const struct pursuit_frame_header *b)
{
	const struct pursuit_plane *p = &a->planes[plan_find_plane(a, PURSUIT_ROLE_COLOR)];
	const struct pursuit_plane *q = &b->planes[plan_find_plane(b, PURSUIT_ROLE_COLOR)];
	return p->width == q->width && p->height == q->height;
}

static int check(const struct frame *const *frames, uint32_t count, struct error *error)
{
	if (count == 0)
		return error_set(error, -EINVAL, "there are no frames whose motion could be composed");
	for (uint32_t k = 0; k < count; k++) {
		const struct pursuit_frame_header *header = &frames[k]->header;
		int motion = plan_find_plane(header, PURSUIT_ROLE_MOTION);
		if (motion < 0 || !frames[k]->planes[motion] || plan_find_plane(header, PURSUIT_ROLE_COLOR) < 0)
			return error_set(error, -EINVAL, "frame %" PRIu64 " has no motion plane to compose", header->frame_id);
		if (header->motion_kind != frames[0]->header.motion_kind || header->motion_kind == PURSUIT_MOTION_NONE)
			return error_set(error, -EINVAL, "frame %" PRIu64 ": motion_kind is %u, must be %u as in frame %" PRIu64,
							 header->frame_id, header->motion_kind, frames[0]->header.motion_kind,
							 frames[0]->header.frame_id);
		if (!same_size(header, &frames[0]->header))
			return error_set(error, -EINVAL, "frame %" PRIu64 " has another size than frame %" PRIu64, header->frame_id,
							 frames[0]->header.frame_id);
	}
	return 0;
}

/* The motion of one pixel of the first frame through all of them. */
static struct motion follow(const struct frame *const *frames, uint32_t count, const struct step *first, uint32_t i,
							uint32_t j)
{
	double way = frames[0]->header.motion_kind == PURSUIT_MOTION_BACKWARD ? -1 : 1;
	struct motion last = first->data ? motion_at(first, i, j) : (struct motion){0, 0, false};
	struct motion sum = last;
	for (uint32_t k = 1; k < count && sum.known; k++) {
		struct step step = step_of(frames[k]);
		if (step.data) {
			struct motion next = look_up(&step, (i + 0.5) / first->scale_x + way * (double)sum.x,
										 (j + 0.5) / first->scale_y + way * (double)sum.y);
			last = next.known ? next : last;
		}
		sum.x += last.x;
		sum.y += last.y;
	}
	return sum;
}

int motion_compose(const struct frame *const *frames, uint32_t count, float *out, struct error *error)
{
	int failed = check(frames, count, error);
	if (failed)
		return failed;
	struct step first = step_of(frames[0]);
	for (uint32_t j = 0; j < first.height; j++)
		for (uint32_t i = 0; i < first.width; i++) {
			struct motion sum = follow(frames, count, &first, i, j);
			out[0] = sum.known ? sum.x : NAN;
			out[1] = sum.known ? sum.y : NAN;
			out += 2;
		}
	return 0;
}
