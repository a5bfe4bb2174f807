/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/frame.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Static names, so that a refusal can carry one over the socket. */
struct plane_fields {
	const char *role, *format, *storage, *width, *height, *reserved0, *offset, *stride, *size, *curve, *gamma, *black,
		*peak, *reserved1;
};

#define PLANE_FIELDS(i)                                                                                            \
	{                                                                                                              \
		"planes[" #i "].role", "planes[" #i "].format", "planes[" #i "].storage", "planes[" #i "].width",          \
			"planes[" #i "].height", "planes[" #i "].reserved0", "planes[" #i "].offset", "planes[" #i "].stride", \
			"planes[" #i "].size", "planes[" #i "].transfer.curve", "planes[" #i "].transfer.gamma",               \
			"planes[" #i "].transfer.black", "planes[" #i "].transfer.peak", "planes[" #i "].reserved1",           \
	}

static const struct plane_fields plane_fields[PURSUIT_MAX_PLANES] = {
	PLANE_FIELDS(0), PLANE_FIELDS(1), PLANE_FIELDS(2), PLANE_FIELDS(3),
	PLANE_FIELDS(4), PLANE_FIELDS(5), PLANE_FIELDS(6), PLANE_FIELDS(7),
};

/* One validation: what it looks at and where a refusal goes. */
struct check {
	struct pursuit_frame_header *header;
	uint64_t planes_bytes;
	const char **field;
	uint64_t *value;
	struct error *error;
};

static int refuse_with(const struct check *check, const char *field, uint64_t value)
{
	if (check->field)
		*check->field = field;
	if (check->value)
		*check->value = value;
	return -EINVAL;
}

static int refuse(const struct check *check, const char *field, uint64_t value, const char *must)
{
	error_set(check->error, -EINVAL, "frame %" PRIu64 ": %s is %" PRIu64 ", must be %s", check->header->frame_id, field,
			  value, must);
	return refuse_with(check, field, value);
}

static int refuse_limit(const struct check *check, const char *field, uint64_t value, const char *relation,
						uint64_t limit, const char *what)
{
	error_set(check->error, -EINVAL, "frame %" PRIu64 ": %s is %" PRIu64 ", must be %s %" PRIu64 " (%s)",
			  check->header->frame_id, field, value, relation, limit, what);
	return refuse_with(check, field, value);
}

static int refuse_float(const struct check *check, const char *field, float value, const char *must)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof(bits));
	error_set(check->error, -EINVAL, "frame %" PRIu64 ": %s is %g, must be %s", check->header->frame_id, field,
			  (double)value, must);
	return refuse_with(check, field, bits);
}

static int check_format(const struct check *check, const struct pursuit_plane *plane, const struct plane_fields *name)
{
	const uint32_t f = plane->format;
	switch (plane->role) {
	case PURSUIT_ROLE_COLOR:
		if (f < PURSUIT_FORMAT_BGRA8 || f > PURSUIT_FORMAT_RGBA16F)
			return refuse(check, name->format, f, "1 (BGRA8), 2 (RGBA8), 3 (RGB10A2) or 4 (RGBA16F) for colour");
		return 0;
	case PURSUIT_ROLE_DEPTH:
		if (f < PURSUIT_FORMAT_DEPTH16 || f > PURSUIT_FORMAT_DEPTH32F)
			return refuse(check, name->format, f, "16 (DEPTH16), 17 (DEPTH24) or 18 (DEPTH32F) for depth");
		return 0;
	case PURSUIT_ROLE_MOTION:
		if (f != PURSUIT_FORMAT_RG16F && f != PURSUIT_FORMAT_RG32F)
			return refuse(check, name->format, f, "32 (RG16F) or 33 (RG32F) for motion");
		return 0;
	case PURSUIT_ROLE_UI:
		if (f != PURSUIT_FORMAT_BGRA8 && f != PURSUIT_FORMAT_RGBA8)
			return refuse(check, name->format, f, "1 (BGRA8) or 2 (RGBA8) for the UI");
		return 0;
	case PURSUIT_ROLE_OBJECT_ID:
		if (f < PURSUIT_FORMAT_R8UI || f > PURSUIT_FORMAT_R32UI)
			return refuse(check, name->format, f, "48 (R8UI), 49 (R16UI) or 50 (R32UI) for object ids");
		return 0;
	case 0:
		return refuse(check, name->role, 0, "1 (colour), 2 (depth), 3 (motion), 4 (UI), 5 (object id) or a later role");
	default:
		return 0;
	}
}

/* Offset, stride and size; each product and sum is checked before it is believed. */
static int check_extent(const struct check *check, const struct pursuit_plane *plane, const struct plane_fields *name)
{
	const uint32_t bytes = pursuit_format_bytes(plane->format);
	const uint64_t row = (uint64_t)plane->width * bytes;
	uint64_t least, end;

	if (plane->offset % PURSUIT_PLANE_ALIGNMENT != 0)
		return refuse(check, name->offset, plane->offset, "a multiple of 64");
	if (plane->stride < row)
		return refuse_limit(check, name->stride, plane->stride, "at least", row, "one row of pixels");
	if (bytes && plane->stride % bytes != 0)
		return refuse_limit(check, name->stride, plane->stride, "a multiple of", bytes, "one pixel");
	if (__builtin_mul_overflow(plane->stride, (uint64_t)plane->height - 1, &least) ||
		__builtin_add_overflow(least, row, &least))
		return refuse(check, name->stride, plane->stride, "small enough that the rows fit a frame");
	if (plane->size < least)
		return refuse_limit(check, name->size, plane->size, "at least", least, "all rows");
	if (plane->size > PURSUIT_MAX_FRAME_BYTES)
		return refuse_limit(check, name->size, plane->size, "at most", PURSUIT_MAX_FRAME_BYTES, "largest frame");
	if (plane->offset > check->planes_bytes)
		return refuse_limit(check, name->offset, plane->offset, "at most", check->planes_bytes, "bytes for planes");
	if (__builtin_add_overflow(plane->offset, plane->size, &end) || end > check->planes_bytes)
		return refuse_limit(check, name->size, plane->size, "at most", check->planes_bytes - plane->offset,
							"bytes from its offset to the end");
	return 0;
}

static int check_transfer(const struct check *check, const struct pursuit_plane *plane, const struct plane_fields *name)
{
	const struct pursuit_transfer *t = &plane->transfer;
	static const struct pursuit_transfer none;
	const bool is_none = memcmp(t, &none, sizeof(none)) == 0;

	if (plane->role > PURSUIT_ROLE_OBJECT_ID)
		return 0;
	if (is_none && plane->role != PURSUIT_ROLE_COLOR)
		return 0;
	if (plane->role != PURSUIT_ROLE_COLOR && plane->role != PURSUIT_ROLE_UI)
		return refuse(check, name->curve, t->curve, "0, as the whole transfer, for a plane that holds no colour");
	if (t->curve < PURSUIT_CURVE_SRGB || t->curve > PURSUIT_CURVE_LINEAR)
		return refuse(check, name->curve, t->curve, "1 (sRGB), 2 (gamma) or 3 (linear)");
	if (t->curve == PURSUIT_CURVE_GAMMA && !(t->gamma >= 1.0f && t->gamma <= 5.0f))
		return refuse_float(check, name->gamma, t->gamma, "1 to 5");
	if (t->curve != PURSUIT_CURVE_GAMMA && t->gamma != 0.0f)
		return refuse_float(check, name->gamma, t->gamma, "0 for a curve without gamma");
	if (!isfinite(t->black))
		return refuse_float(check, name->black, t->black, "finite");
	if (!isfinite(t->peak))
		return refuse_float(check, name->peak, t->peak, "finite");
	if (!(t->black == 0.0f && t->peak == 0.0f) && !(t->peak > t->black))
		return refuse_float(check, name->peak, t->peak, "above black, or both 0");
	return 0;
}

static int check_plane(const struct check *check, uint32_t index)
{
	const struct pursuit_plane *plane = &check->header->planes[index];
	const struct plane_fields *name = &plane_fields[index];
	int result = check_format(check, plane, name);
	if (result < 0)
		return result;
	if (plane->storage != PURSUIT_STORAGE_MEMORY)
		return refuse(check, name->storage, plane->storage, "1 (memory)");
	if (plane->width < 1 || plane->width > PURSUIT_MAX_SIZE)
		return refuse(check, name->width, plane->width, "1 to 16384");
	if (plane->height < 1 || plane->height > PURSUIT_MAX_SIZE)
		return refuse(check, name->height, plane->height, "1 to 16384");
	if (plane->reserved0 != 0)
		return refuse(check, name->reserved0, plane->reserved0, "0");
	if (plane->reserved1 != 0)
		return refuse(check, name->reserved1, plane->reserved1, "0");
	result = check_extent(check, plane, name);
	return result < 0 ? result : check_transfer(check, plane, name);
}

/* Each plane alone, then what they must be to each other. */
static int check_planes(const struct check *check)
{
	const struct pursuit_frame_header *header = check->header;
	uint32_t seen = 0;
	uint64_t total = 0;

	if (header->plane_count < 1 || header->plane_count > PURSUIT_MAX_PLANES)
		return refuse(check, "plane_count", header->plane_count, "1 to 8");
	for (uint32_t i = 0; i < header->plane_count; i++) {
		const uint32_t role = header->planes[i].role;
		int result = check_plane(check, i);
		if (result < 0)
			return result;
		if (role <= PURSUIT_ROLE_OBJECT_ID) {
			if (seen & (1u << role))
				return refuse(check, plane_fields[i].role, role, "of another role: there is one such plane already");
			seen |= 1u << role;
		}
		/* Planes may share bytes, but their sum is what a copy of them takes. */
		total += header->planes[i].size;
		if (total > PURSUIT_MAX_FRAME_BYTES)
			return refuse_limit(check, plane_fields[i].size, header->planes[i].size, "so small that all planes take",
								PURSUIT_MAX_FRAME_BYTES, "largest frame");
	}
	if (!(seen & (1u << PURSUIT_ROLE_COLOR)))
		return refuse(check, "planes[0].role", header->planes[0].role, "1 (colour) in one plane: the frame has none");
	return 0;
}

static int check_ui_size(const struct check *check)
{
	const struct pursuit_frame_header *header = check->header;
	const int color = frame_find_plane(header, PURSUIT_ROLE_COLOR);
	const int ui = frame_find_plane(header, PURSUIT_ROLE_UI);
	if (ui < 0)
		return 0;
	if (header->planes[ui].width != header->planes[color].width)
		return refuse_limit(check, plane_fields[ui].width, header->planes[ui].width, "equal to",
							header->planes[color].width, "the UI has the size of the colour");
	if (header->planes[ui].height != header->planes[color].height)
		return refuse_limit(check, plane_fields[ui].height, header->planes[ui].height, "equal to",
							header->planes[color].height, "the UI has the size of the colour");
	return 0;
}

static int check_kinds(const struct check *check)
{
	struct pursuit_frame_header *header = check->header;
	if (header->motion_kind > PURSUIT_MOTION_FORWARD)
		return refuse(check, "motion_kind", header->motion_kind, "0 (none), 1 (backward) or 2 (forward)");
	if (header->depth_kind > PURSUIT_DEPTH_LINEAR)
		return refuse(check, "depth_kind", header->depth_kind,
					  "0 (none), 1 (device), 2 (device reversed) or 3 (linear)");
	if (frame_find_plane(header, PURSUIT_ROLE_MOTION) < 0)
		header->motion_kind = PURSUIT_MOTION_NONE;
	else if (header->motion_kind == PURSUIT_MOTION_NONE)
		return refuse(check, "motion_kind", 0, "1 (backward) or 2 (forward): there is a motion plane");
	if (frame_find_plane(header, PURSUIT_ROLE_DEPTH) < 0)
		header->depth_kind = PURSUIT_DEPTH_NONE;
	else if (header->depth_kind == PURSUIT_DEPTH_NONE)
		return refuse(check, "depth_kind", 0, "1 (device), 2 (device reversed) or 3 (linear): there is a depth plane");
	return 0;
}

static int check_distances(const struct check *check)
{
	const float near_distance = check->header->near_distance, far_distance = check->header->far_distance;
	if (!(near_distance >= 0.0f) || isinf(near_distance))
		return refuse_float(check, "near_distance", near_distance, "finite and above 0, or 0 for unknown");
	if (far_distance != 0.0f && !(far_distance > near_distance))
		return refuse_float(check, "far_distance", far_distance, "above near_distance, infinity, or 0 for unknown");
	return 0;
}

/* Static names, as of planes. */
static const char *const damage_fields[PURSUIT_MAX_DAMAGE] = {"damage[0]", "damage[1]", "damage[2]", "damage[3]",
															  "damage[4]", "damage[5]", "damage[6]", "damage[7]"};

/* Whether the rectangles from `first` on are all 0. */
static bool damage_is_zero(const struct pursuit_frame_header *header, uint32_t first)
{
	static const struct pursuit_rectangle zero;
	for (uint32_t i = first; i < PURSUIT_MAX_DAMAGE; i++)
		if (memcmp(&header->damage[i], &zero, sizeof(zero)) != 0)
			return false;
	return true;
}

static int check_damage(const struct check *check)
{
	const struct pursuit_frame_header *header = check->header;
	const struct pursuit_plane *color = &header->planes[frame_find_plane(header, PURSUIT_ROLE_COLOR)];
	const bool set = header->flags & PURSUIT_FRAME_DAMAGE;
	if (set ? header->damage_since == 0 || header->damage_since >= header->frame_id : header->damage_since != 0)
		return refuse(check, "damage_since", header->damage_since,
					  set ? "1 or more and below frame_id" : "0 without the damage flag");
	if (header->damage_count > (set ? PURSUIT_MAX_DAMAGE : 0))
		return refuse(check, "damage_count", header->damage_count, set ? "0 to 8" : "0 without the damage flag");
	for (uint32_t i = 0; i < header->damage_count; i++) {
		const struct pursuit_rectangle *r = &header->damage[i];
		if (!r->width || r->x >= color->width || r->width > color->width - r->x)
			return refuse(check, damage_fields[i], r->width, "of a width of 1 or more within the colour plane");
		if (!r->height || r->y >= color->height || r->height > color->height - r->y)
			return refuse(check, damage_fields[i], r->height, "of a height of 1 or more within the colour plane");
	}
	if (!damage_is_zero(header, header->damage_count))
		return refuse(check, "damage", header->damage_count, "0 in the rectangles beyond damage_count");
	return 0;
}

static int check_reserved(const struct check *check)
{
	if (check->header->reserved0 != 0)
		return refuse(check, "reserved0", check->header->reserved0, "0");
	for (size_t i = 0; i < sizeof(check->header->reserved); i++)
		if (check->header->reserved[i] != 0)
			return refuse(check, "reserved", check->header->reserved[i], "0 in all bytes");
	return 0;
}

static bool all_finite(const float *values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!isfinite(values[i]))
			return false;
	return true;
}

/* A difference of times that ran backwards wraps to more than 292 years. */
static void mend_time(uint64_t *time)
{
	if (*time > INT64_MAX)
		*time = 0;
}

/* What is merely absurd becomes "unknown": a game with a bad matrix still gets its picture. */
static void mend(struct pursuit_frame_header *header)
{
	const struct pursuit_plane *color = &header->planes[frame_find_plane(header, PURSUIT_ROLE_COLOR)];

	mend_time(&header->time_ns);
	mend_time(&header->submit_ns);
	mend_time(&header->real_interval_ns);
	mend_time(&header->motion_interval_ns);
	if (!(fabsf(header->jitter_x) <= (float)color->width) || !(fabsf(header->jitter_y) <= (float)color->height)) {
		header->jitter_x = header->jitter_y = 0.0f;
		header->flags &= ~PURSUIT_FRAME_JITTER;
	}
	if (!all_finite(header->view_projection, 16) || !all_finite(header->previous_view_projection, 16)) {
		memset(header->view_projection, 0, sizeof(header->view_projection));
		memset(header->previous_view_projection, 0, sizeof(header->previous_view_projection));
		header->flags &= ~PURSUIT_FRAME_MATRICES;
	}
	for (uint32_t i = header->plane_count; i < PURSUIT_MAX_PLANES; i++)
		header->planes[i] = (struct pursuit_plane){0};
}

int frame_validate(struct pursuit_frame_header *header, uint64_t planes_bytes, const char **field, uint64_t *value,
				   struct error *error)
{
	static int (*const checks[])(const struct check *) = {
		check_planes, check_ui_size, check_kinds, check_distances, check_damage, check_reserved,
	};
	const struct check check = {header, planes_bytes, field, value, error};

	if (header->frame_id == 0)
		return refuse(&check, "frame_id", 0, "1 or more");
	if (header->flags & ~PURSUIT_FRAME_FLAGS_KNOWN)
		return refuse(&check, "flags", header->flags, "made of the known flags only (0x3f)");
	for (size_t i = 0; i < sizeof(checks) / sizeof(checks[0]); i++) {
		int result = checks[i](&check);
		if (result < 0)
			return result;
	}
	mend(header);
	return 0;
}

int frame_find_plane(const struct pursuit_frame_header *header, uint32_t role)
{
	for (uint32_t i = 0; i < header->plane_count && i < PURSUIT_MAX_PLANES; i++)
		if (header->planes[i].role == role)
			return (int)i;
	return -1;
}

static uint64_t align(uint64_t bytes)
{
	return (bytes + PURSUIT_PLANE_ALIGNMENT - 1) / PURSUIT_PLANE_ALIGNMENT * PURSUIT_PLANE_ALIGNMENT;
}

uint64_t frame_layout(struct pursuit_frame_header *header)
{
	uint64_t end = 0;
	if (header->plane_count > PURSUIT_MAX_PLANES)
		return 0;
	for (uint32_t i = 0; i < header->plane_count; i++) {
		struct pursuit_plane *plane = &header->planes[i];
		const uint32_t bytes = pursuit_format_bytes(plane->format);
		if (plane->width > PURSUIT_MAX_SIZE || plane->height > PURSUIT_MAX_SIZE ||
			(!bytes && plane->size > PURSUIT_MAX_FRAME_BYTES))
			return 0;
		plane->storage = PURSUIT_STORAGE_MEMORY;
		plane->offset = end;
		if (bytes) {
			plane->stride = align((uint64_t)plane->width * bytes);
			plane->size = plane->stride * plane->height;
		}
		end += align(plane->size);
	}
	return end <= PURSUIT_MAX_FRAME_BYTES ? end : 0;
}
