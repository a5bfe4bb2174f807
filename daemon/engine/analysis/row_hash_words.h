/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What row_hash.h wants of a level, for those without vectors of 64-bit products: a word at a time. */
#ifndef PURSUIT_ANALYSIS_ROW_HASH_WORDS_H
#define PURSUIT_ANALYSIS_ROW_HASH_WORDS_H

#include <stdint.h>
#include <string.h>

#include "daemon/engine/analysis/values.h"

typedef uint64_t hash_lanes;

static inline hash_lanes hash_load(const uint8_t *bytes)
{
	hash_lanes words;
	memcpy(&words, bytes, sizeof(words));
	return words;
}

static inline hash_lanes hash_step(hash_lanes hash, hash_lanes words)
{
	return plan_hash_step(hash, words);
}

#endif
