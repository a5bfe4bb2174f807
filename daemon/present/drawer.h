/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The drawing thread of a window: draws one picture at a time and swaps, which
 * may wait for the display, or for ever if the window cannot be seen. Whoever
 * orders never waits longer than he wants to. Owned by one thread.
 */
#ifndef PURSUIT_DRAWER_H
#define PURSUIT_DRAWER_H

#include "daemon/present/window.h"

/* What became of an order. */
struct drawer_swap {
	uint64_t time_ns, sequence; /* of the last swap */
	enum presenter_time_source source;
	uint64_t drawing_ns;  /* from the order to its first swap */
	uint64_t interval_ns; /* median of the intervals between swaps, 0 for fewer than four */
};

#define DRAWER_SWAPS 16u
#define DRAWER_START_NS UINT64_C(5000000000)

struct drawer;

/* Starts the thread, which takes the window's context. NULL with a sentence. */
struct drawer *drawer_create(struct window *window, struct error *error);
/*
 * Waits until it has, at most DRAWER_START_NS. 0, or a negative errno with a sentence, among them -EIO if the display
 * server went away meanwhile and -ETIMEDOUT if it does not answer. Before anything is ordered.
 */
int drawer_wait_for_start(struct drawer *drawer, struct error *error);
/*
 * False: the thread hangs in its start or in a swap, for longer than a second; it frees the drawer when it comes back,
 * if ever, and calls gone() then, until when the window and the picture that was ordered must stay. NULL accepted.
 */
bool drawer_destroy(struct drawer **drawer, void (*gone)(void *data), void *data);

/*
 * Orders this picture (NULL: black) for a window of that size, swapped so many times in a row (1 to DRAWER_SWAPS).
 * Its memory must stay as it is until drawer_wait() returns true. Only when none is under way.
 */
void drawer_order(struct drawer *drawer, const struct presenter_image *image, uint32_t width, uint32_t height,
				  uint32_t swaps);
/* Waits for it until a time of CLOCK_MONOTONIC. True: done, or none was under way. */
bool drawer_wait(struct drawer *drawer, uint64_t until_ns, struct drawer_swap *swap);

#endif
