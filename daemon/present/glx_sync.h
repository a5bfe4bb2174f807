/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The display server's own time stamps of swaps, by GLX_OML_sync_control: UST
 * in microseconds of CLOCK_MONOTONIC (Mesa), MSC the count of vblanks. On the
 * drawing thread, with the context current.
 */
#ifndef PURSUIT_GLX_SYNC_H
#define PURSUIT_GLX_SYNC_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/window.h"

struct glx_sync {
	void *display; /* NULL: not there */
	unsigned long drawable;
	int (*get_values)(void *display, unsigned long drawable, int64_t *ust, int64_t *msc, int64_t *sbc);
	int (*wait_for_sbc)(void *display, unsigned long drawable, int64_t target, int64_t *ust, int64_t *msc,
						int64_t *sbc);
};

/* Are they there, and of the clock now_ns comes from? */
bool glx_sync_init(struct glx_sync *sync, struct window *window, uint64_t now_ns);

/* Waits until the last swap is on display: its time and its vblank's count. False: not known. */
bool glx_sync_wait(struct glx_sync *sync, uint64_t *time_ns, uint64_t *sequence);

#endif
