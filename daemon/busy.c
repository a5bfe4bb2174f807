/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/busy.h"

void busy_add(struct busy *busy, uint64_t from_ns, uint64_t to_ns)
{
	busy->spans[busy->count % BUSY_SPANS].from_ns = from_ns;
	busy->spans[busy->count % BUSY_SPANS].to_ns = to_ns;
	busy->count++;
}

uint64_t busy_within(const struct busy *busy, uint64_t from_ns, uint64_t to_ns)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < BUSY_SPANS && i < busy->count; i++) {
		const uint64_t from = busy->spans[i].from_ns > from_ns ? busy->spans[i].from_ns : from_ns;
		const uint64_t to = busy->spans[i].to_ns < to_ns ? busy->spans[i].to_ns : to_ns;
		sum += to > from ? to - from : 0;
	}
	return sum;
}
