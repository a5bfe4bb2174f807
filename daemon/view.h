/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What is drawn over displayed frames: help, statistics, and the comparison
 * whose right half lacks in-betweens. On the render thread.
 */
#ifndef PURSUIT_VIEW_H
#define PURSUIT_VIEW_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/presenter.h"

struct render;

/* Bits of what is switched on. */
#define VIEW_HELP 1u
#define VIEW_STATISTICS 2u
#define VIEW_SPLIT 4u

/* Zeroed: nothing is drawn. */
struct view {
	uint32_t switches;
	uint8_t *plain; /* the right half's picture, packed, with its size and the group that it is of */
	uint32_t plain_width, plain_height;
	uint64_t plain_group;
	char text[512]; /* statistics, as of text_ns */
	uint64_t text_ns, text_frames, text_active_ns;
	char message[96]; /* what has just changed */
	uint64_t message_until_ns;
};

void view_finish(struct view *view);

/* Shows a line for two seconds. */
void view_say(struct view *view, const char *message, uint64_t now_ns);

/* When the line goes; UINT64_MAX without one. */
uint64_t view_message_end(const struct view *view);
/* Has it gone just now? True once. */
bool view_message_is_over(struct view *view, uint64_t now_ns);

/* Is there anything to be drawn over a picture? */
bool view_draws(const struct view *view, uint64_t now_ns);
/*
 * Draws what is switched on over a picture that the engine has just made of the frame begun last, or over an empty one
 * before the first; image->holds is 0 if that is anything. Nothing over a picture in GL.
 */
void view_draw(struct render *render, struct presenter_image *image);

#endif
