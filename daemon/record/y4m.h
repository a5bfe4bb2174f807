/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Video as YUV4MPEG2, which ffmpeg, mpv and x264 read, into a pipe or a file.
 * Limited range; the header declares it, and the matrix, which the format has
 * no word for, in an X field.
 */
#ifndef PURSUIT_Y4M_H
#define PURSUIT_Y4M_H

#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"

struct y4m;

struct y4m_params {
	const char *path; /* "-": stdout */
	uint32_t width, height;
	uint32_t rate, rate_scale; /* frames a second = rate / rate_scale */
	uint32_t chroma;           /* 420 (sited like JPEG) or 444; 0: 420 */
	uint32_t matrix;           /* 601 or 709; 0: 709 from 720 lines up, as players assume */
};

/* NULL with a sentence. The caller ignores SIGPIPE: a reader that went away is then an error like others. */
struct y4m *y4m_create(const struct y4m_params *params, struct error *error);

/* One frame, BGRA8, alpha ignored. 0 or a negative errno with a sentence (-EPIPE: the reader went away). */
int y4m_frame(struct y4m *y4m, const uint8_t *bgra, size_t stride, struct error *error);

/* Flushes and closes; clears *y4m; NULL accepted. */
int y4m_destroy(struct y4m **y4m, struct error *error);

#endif
