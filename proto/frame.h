/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The vocabulary of a frame: planes and the frame header.
 *
 * One layout serves shared memory (shm.h) and recordings (recording.h), so a
 * recording holds exactly what the client wrote. Little-endian, natural
 * alignment, no implicit padding; layouts are asserted in check.c.
 *
 * Every reserved field is written as zero and must be zero when read, so that
 * a later minor version can give it a meaning.
 *
 * Includes nothing of ours. Plain data only: C enums and bit-fields never
 * appear in shared memory, since their width is the compiler's choice.
 */
#ifndef PURSUIT_PROTO_FRAME_H
#define PURSUIT_PROTO_FRAME_H

#include <stdint.h>

#define PURSUIT_MAX_PLANES 8u
/* Largest width or height of a plane, in pixels. */
#define PURSUIT_MAX_SIZE 16384u
/* Largest size of all planes of one frame, in bytes. */
#define PURSUIT_MAX_FRAME_BYTES (UINT64_C(1) << 30)
/* Plane offsets are multiples of this, so that rows can be read by vectors. */
#define PURSUIT_PLANE_ALIGNMENT 64u

/* What a plane means. Unknown roles are carried, not refused. */
#define PURSUIT_ROLE_COLOR 1u
#define PURSUIT_ROLE_DEPTH 2u
#define PURSUIT_ROLE_MOTION 3u
#define PURSUIT_ROLE_UI 4u
#define PURSUIT_ROLE_OBJECT_ID 5u

/* Pixel formats. Components are named from the lowest address up. */
#define PURSUIT_FORMAT_BGRA8 1u    /* 4 bytes, B first */
#define PURSUIT_FORMAT_RGBA8 2u    /* 4 bytes, R first */
#define PURSUIT_FORMAT_RGB10A2 3u  /* uint32: R in bits 0-9, G 10-19, B 20-29, A 30-31 */
#define PURSUIT_FORMAT_RGBA16F 4u  /* 8 bytes, IEEE half */
#define PURSUIT_FORMAT_DEPTH16 16u /* uint16, 0 to 65535 is 0 to 1 */
#define PURSUIT_FORMAT_DEPTH24 17u /* uint32: depth in bits 0-23, bits 24-31 ignored */
#define PURSUIT_FORMAT_DEPTH32F 18u
#define PURSUIT_FORMAT_RG16F 32u /* motion, IEEE half */
#define PURSUIT_FORMAT_RG32F 33u /* motion, IEEE single */
#define PURSUIT_FORMAT_R8UI 48u  /* object id */
#define PURSUIT_FORMAT_R16UI 49u
#define PURSUIT_FORMAT_R32UI 50u

/* Where the bytes of a plane are. */
#define PURSUIT_STORAGE_MEMORY 1u /* at `offset` in the slot (shm) or the frame chunk (recording) */

/* How code values become light (struct pursuit_transfer.curve). */
#define PURSUIT_CURVE_SRGB 1u
#define PURSUIT_CURVE_GAMMA 2u  /* light = code ^ gamma, 1 <= gamma <= 5 */
#define PURSUIT_CURVE_LINEAR 3u /* light = code */

/*
 * Transfer of a plane that holds colour. `black` and `peak` are the decoded
 * values that the display shows as its darkest and brightest light; both 0
 * stands for 0 and 1. 16 bytes.
 */
struct pursuit_transfer {
	uint32_t curve;
	float gamma; /* only for PURSUIT_CURVE_GAMMA, otherwise 0 */
	float black;
	float peak;
};

/*
 * One plane. Rows run from the top of the picture to its bottom, `stride`
 * bytes apart. 72 bytes.
 */
struct pursuit_plane {
	uint32_t role;
	uint32_t format;
	uint32_t storage;
	uint32_t width;  /* pixels, 1 to PURSUIT_MAX_SIZE */
	uint32_t height; /* pixels, 1 to PURSUIT_MAX_SIZE */
	uint32_t reserved0;
	uint64_t offset;                  /* bytes, a multiple of PURSUIT_PLANE_ALIGNMENT */
	uint64_t stride;                  /* bytes, at least width x bytes per pixel, a multiple of the pixel size */
	uint64_t size;                    /* bytes, at least stride x (height - 1) + width x bytes per pixel */
	struct pursuit_transfer transfer; /* zero for planes that hold no colour */
	uint64_t reserved1;
};

/* struct pursuit_frame_header.flags */
#define PURSUIT_FRAME_CUT (1u << 0)            /* nothing in common with the previous real frame */
#define PURSUIT_FRAME_MOTION_INVALID (1u << 1) /* do not use the motion plane of this frame */
#define PURSUIT_FRAME_MATRICES (1u << 2)       /* view_projection and previous_ are set */
#define PURSUIT_FRAME_JITTER (1u << 3)         /* jitter_x, jitter_y are set */
#define PURSUIT_FRAME_TRUTH_ONLY (1u << 4)     /* recordings: used for scoring, never as a real frame */
#define PURSUIT_FRAME_DAMAGE (1u << 5)         /* damage_since, damage_count and damage are set */
#define PURSUIT_FRAME_FLAGS_KNOWN 0x3fu

/* struct pursuit_frame_header.motion_kind */
#define PURSUIT_MOTION_NONE 0u     /* no motion plane */
#define PURSUIT_MOTION_BACKWARD 1u /* position now minus position in the previous real frame */
#define PURSUIT_MOTION_FORWARD 2u  /* predicted position in the next real frame minus position now */

/* struct pursuit_frame_header.depth_kind */
#define PURSUIT_DEPTH_NONE 0u            /* no depth plane */
#define PURSUIT_DEPTH_DEVICE 1u          /* 0 at near, 1 at far */
#define PURSUIT_DEPTH_DEVICE_REVERSED 2u /* 1 at near, 0 at far */
#define PURSUIT_DEPTH_LINEAR 3u          /* distance; near and far give its range */

/* Largest number of rectangles that say what changed. */
#define PURSUIT_MAX_DAMAGE 8u

/* Pixels of the colour plane. 16 bytes. */
struct pursuit_rectangle {
	uint32_t x, y;
	uint32_t width, height; /* 1 or more, within the plane */
};

/*
 * The header of one real frame. 1024 bytes.
 *
 * Times are CLOCK_MONOTONIC nanoseconds of the client; 0 means unknown.
 * Motion is in pixels of the colour plane, +x right, +y down, whatever the
 * size of the motion plane. Matrices are column-major, clip = M x world.
 *
 * Damage: outside the rectangles all planes are as they were in the frame
 * `damage_since`, and nothing moves there; without rectangles nothing has
 * changed at all. The planes hold the whole picture nevertheless: who has not
 * that frame takes all of them. Without PURSUIT_FRAME_DAMAGE all of it is 0.
 */
struct pursuit_frame_header {
	uint64_t frame_id;           /* counted up by the client, never 0 */
	uint64_t time_ns;            /* the moment that the frame depicts */
	uint64_t submit_ns;          /* when the client published it */
	uint64_t real_interval_ns;   /* time_ns minus that of the previous real frame; 0: unknown */
	uint64_t motion_interval_ns; /* the interval that the motion spans; 0: the real interval */
	uint32_t flags;              /* PURSUIT_FRAME_* */
	uint32_t plane_count;        /* 1 to PURSUIT_MAX_PLANES, at most one of each known role */
	uint32_t motion_kind;        /* PURSUIT_MOTION_* */
	uint32_t depth_kind;         /* PURSUIT_DEPTH_* */
	float near_distance;         /* > 0, or 0: unknown */
	float far_distance;          /* > near; infinity: an infinite projection; 0: unknown */
	float jitter_x;              /* pixels by which the projection was shifted, +x right */
	float jitter_y;              /* +y down */
	float view_projection[16];
	float previous_view_projection[16];
	struct pursuit_plane planes[PURSUIT_MAX_PLANES];
	uint64_t damage_since; /* a frame_id below this one's */
	uint32_t damage_count; /* rectangles, 0 to PURSUIT_MAX_DAMAGE */
	uint32_t reserved0;
	struct pursuit_rectangle damage[PURSUIT_MAX_DAMAGE];
	uint8_t reserved[104];
};

/* Bytes of one pixel of a format, 0 for an unknown one. */
static inline uint32_t pursuit_format_bytes(uint32_t format)
{
	switch (format) {
	case PURSUIT_FORMAT_BGRA8:
	case PURSUIT_FORMAT_RGBA8:
	case PURSUIT_FORMAT_RGB10A2:
	case PURSUIT_FORMAT_DEPTH24:
	case PURSUIT_FORMAT_DEPTH32F:
	case PURSUIT_FORMAT_RG16F:
	case PURSUIT_FORMAT_R32UI:
		return 4;
	case PURSUIT_FORMAT_RGBA16F:
	case PURSUIT_FORMAT_RG32F:
		return 8;
	case PURSUIT_FORMAT_DEPTH16:
	case PURSUIT_FORMAT_R16UI:
		return 2;
	case PURSUIT_FORMAT_R8UI:
		return 1;
	default:
		return 0;
	}
}

#endif
