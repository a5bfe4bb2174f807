/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#ifndef PURSUIT_SLICES_H
#define PURSUIT_SLICES_H

#include "daemon/log.h"

/*
 * Short slices for this thread, and for those that a software renderer starts
 * from it: no larger share, but let in at once when it wakes (Linux 6.12).
 * Otherwise each pass may wait 3 ms behind a busy game. A thread of real-time priority is left as it is.
 */
void slices_shorten(const struct log *log);

#endif
