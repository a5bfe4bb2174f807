/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * File descriptors that a process of the daemon's is not to keep, since what was opened with them would live on by it;
 * and those that it must have.
 */
#ifndef PURSUIT_DESCRIPTORS_H
#define PURSUIT_DESCRIPTORS_H

#include <limits.h>

#define DESCRIPTORS_ALL UINT_MAX

/* Closes all from `first` to `last`, both included, whatever their number. May be called between fork() and exec(). */
void descriptors_close(unsigned first, unsigned last);

/*
 * Standard input, output and error that nobody gave are opened, so that no file or socket gets their number and is read
 * or written as one of them. Output that nobody takes is an error still; messages are lost as before. First of all.
 */
void descriptors_fill(void);

#endif
