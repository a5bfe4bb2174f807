/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* When a thread worked last, to tell what of a wait was its work. Pure; one thread. */
#ifndef PURSUIT_BUSY_H
#define PURSUIT_BUSY_H

#include <stdint.h>

#define BUSY_SPANS 16u

/* Zeroed: it never did. */
struct busy {
	struct {
		uint64_t from_ns, to_ns;
	} spans[BUSY_SPANS];
	uint64_t count; /* ever; the newest are kept */
};

/* It worked from then to then; spans rise and do not overlap. */
void busy_add(struct busy *busy, uint64_t from_ns, uint64_t to_ns);

/* How long it did between two moments, as far as is known. */
uint64_t busy_within(const struct busy *busy, uint64_t from_ns, uint64_t to_ns);

#endif
