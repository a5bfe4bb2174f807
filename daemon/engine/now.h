/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#ifndef PURSUIT_ENGINE_NOW_H
#define PURSUIT_ENGINE_NOW_H

#include <stdint.h>
#include <time.h>

/* CLOCK_MONOTONIC: for the report, and to tell engines' numbers apart (state.h). No picture depends on it. */
static inline uint64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

#endif
