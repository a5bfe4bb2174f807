/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* How fast a renderer moves memory within itself: what the engine's passes on it are held against. */
#ifndef PURSUIT_TESTS_ENGINE_BENCH_COPY_H
#define PURSUIT_TESTS_ENGINE_BENCH_COPY_H

#include <stdint.h>

#include "daemon/engine/engine.h"

/*
 * Bytes per second of copies from texture to texture (BGRA8, `side` pixels a side), read and written bytes both
 * counted, median of a few dozen; by timer query where there is one, else by waiting. The textures are four in turn,
 * which no cache holds if `side` is large. In a context of its own, of the kind that the params ask for, gone
 * afterwards. Negative with a sentence: there is none.
 */
double bench_copy_rate(const struct engine_params *params, uint32_t side, struct error *error);

#endif
