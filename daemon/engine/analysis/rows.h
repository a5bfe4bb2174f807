/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Rows of a plane, seen at the size of the colour plane (nearest pixel, docs/method.md, 0).
 * Where another process may change the plane, rows are copied before they are parsed and
 * single pixels are read exactly once.
 */
#ifndef PURSUIT_ANALYSIS_ROWS_H
#define PURSUIT_ANALYSIS_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/frame.h"

/* Storage cut into pieces; with base NULL it only adds up what they take. */
struct plan_arena {
	uint8_t *base; /* 64-byte aligned */
	size_t used;
};

/* 64-byte aligned; NULL without base. */
void *plan_arena_take(struct plan_arena *arena, size_t bytes);

struct plan_rows {
	const uint8_t *data; /* NULL: no such plane */
	size_t stride;
	uint32_t pixel_bytes;
	uint32_t width, height;               /* of the plane */
	uint32_t colour_width, colour_height; /* of what is asked for */
	bool copies;                          /* rows are copied before they are parsed */
	uint32_t *columns;                    /* plane column of each colour column; NULL: the same */
	uint8_t *copy;                        /* one row of the plane */
	uint8_t *mapped;                      /* one row at colour width */
	uint32_t mapped_row;                  /* plane row in `mapped` or `copy`; UINT32_MAX: none */
};

/* The plane of that role, if the frame has one of a known format. Takes its buffers from the arena. */
void plan_rows_init(struct plan_rows *rows, const struct frame *frame, uint32_t role, struct plan_arena *arena);

/* Index of the plane of a role, -1 if there is none. */
int plan_find_plane(const struct pursuit_frame_header *header, uint32_t role);

/* Row of the plane that colour row y shows, where it lies. */
const uint8_t *plan_rows_source(const struct plan_rows *rows, uint32_t y);

/* colour_width pixels of colour row y, safe to parse, aligned for their words. Valid until the next call. */
const void *plan_rows_get(struct plan_rows *rows, uint32_t y);

/* Bits of the pixel at colour position (x, y), read once; 2 or 4 bytes a pixel. */
uint32_t plan_rows_pixel(const struct plan_rows *rows, uint32_t x, uint32_t y);

/* Hints that the pixel will be read soon. */
void plan_rows_expect(const struct plan_rows *rows, uint32_t x, uint32_t y);

/* Hints that colour row y will be read soon; any y. */
void plan_rows_expect_row(const struct plan_rows *rows, uint32_t y);

#endif
