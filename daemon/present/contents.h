/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What a presenter knows about memory of one kind, CPU's or GL's, that pictures are drawn into. Zeroed: nothing. */
#ifndef PURSUIT_CONTENTS_H
#define PURSUIT_CONTENTS_H

#include "daemon/present/presenter.h"

struct contents {
	uint32_t width, height; /* of the picture that it was lent for last */
	uint64_t holds;         /* as struct presenter_image says; 0 while it is lent */
};

/*
 * Lends it for a picture of this size: sets the image's size and what the memory holds. False: it was lent for another
 * size before, so what lies there is of no use.
 */
static inline bool contents_lend(struct contents *contents, uint32_t width, uint32_t height,
								 struct presenter_image *image)
{
	const bool same = contents->width == width && contents->height == height;
	image->width = contents->width = width;
	image->height = contents->height = height;
	image->holds = same ? contents->holds : 0;
	contents->holds = 0;
	return same;
}

/* The image was given back. Before anybody else can acquire it. */
static inline void contents_take_back(struct contents *contents, const struct presenter_image *image)
{
	contents->holds = image->holds;
}

#endif
