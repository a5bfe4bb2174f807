/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Names from outside may be any bytes; logs, JSON and pages want text. Any thread, no state. */
#ifndef PURSUIT_PRINTABLE_H
#define PURSUIT_PRINTABLE_H

#include <stddef.h>

/* What is no printable UTF-8 becomes '?'. */
void printable_clean(char *name);

/* Copies what there is room for, whole characters only, and cleans it; `bytes` with the 0 at the end, 1 or more. */
void printable_copy(char *out, size_t bytes, const char *name);

#endif
