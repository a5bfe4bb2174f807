/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* File descriptors that a process of the daemon's is not to keep: what was opened with them would live on by it. */
#ifndef PURSUIT_DESCRIPTORS_H
#define PURSUIT_DESCRIPTORS_H

#include <limits.h>

#define DESCRIPTORS_ALL UINT_MAX

/* Closes all from `first` to `last`, both included, whatever their number. May be called between fork() and exec(). */
void descriptors_close(unsigned first, unsigned last);

#endif
