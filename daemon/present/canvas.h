/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What a presenter knows about memory of one kind, CPU's or GL's, that pictures are drawn into. Zeroed: nothing. */
#ifndef PURSUIT_CANVAS_H
#define PURSUIT_CANVAS_H

#include "daemon/present/presenter.h"

struct canvas {
	uint32_t width, height; /* of the picture that it was lent for last */
	uint64_t holds;         /* as struct presenter_image says; 0 while it is lent */
};

/*
 * Lends it for a picture of this size: sets the image's size and what the memory holds. False: it was lent for another
 * size before, so what lies there is of no use.
 */
static inline bool canvas_lend(struct canvas *canvas, uint32_t width, uint32_t height, struct presenter_image *image)
{
	const bool same = canvas->width == width && canvas->height == height;
	image->width = canvas->width = width;
	image->height = canvas->height = height;
	image->holds = same ? canvas->holds : 0;
	canvas->holds = 0;
	return same;
}

/* The image was given back. Before anybody else can acquire it. */
static inline void canvas_take_back(struct canvas *canvas, const struct presenter_image *image)
{
	canvas->holds = image->holds;
}

#endif
