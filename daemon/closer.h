/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Closes on a thread of its own, one after the other, what may wait for a disk. */
#ifndef PURSUIT_CLOSER_H
#define PURSUIT_CLOSER_H

#include "daemon/error.h"

struct closer;

/* No thread yet. NULL with a sentence. */
struct closer *closer_create(struct error *error);
/* Waits until all is closed. NULL accepted. */
void closer_destroy(struct closer **closer);

/*
 * Any thread, without waiting: `thing` is the closer's from now on. Where there is no thread or no memory to be had it
 * is closed here and now.
 */
void closer_add(struct closer *closer, void (*close)(void *thing), void *thing);

#endif
