/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Writes the frames of a recording as images and video: colour and UI as PNG,
 * depth and motion as PFM (motion as x, y, 0), video as YUV4MPEG2. Numbers are
 * those of the images at import, else 0 up. Damaged frames are named and left out.
 */
#ifndef PURSUIT_EXPORT_H
#define PURSUIT_EXPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/error.h"

struct export_params {
	const char *path;
	/* Patterns as in pattern.h; NULL: not written. */
	const char *color, *ui, *depth, *motion;
	const char *video; /* a file, "-" for stdout, NULL: none */
	uint32_t chroma;   /* of the video, 420 or 444; 0: 420 */
	bool has_first, has_last;
	uint64_t first, last; /* numbers */
	/* Called for each frame that is damaged; may be NULL. */
	void (*on_damage)(void *data, const char *sentence);
	void *data;
};

struct export_summary {
	uint64_t frames;  /* exported */
	uint64_t damaged; /* could not be decoded */
	uint64_t files;
};

/* 0 or a negative errno with a sentence; -EPIPE: the reader of the video went away. */
int export_run(const struct export_params *params, struct export_summary *summary, struct error *error);

#endif
