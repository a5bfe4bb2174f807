/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Chance that is the same on every machine: SplitMix64 and what simulations draw from it. */
#ifndef PURSUIT_TESTS_PACING_RANDOM_H
#define PURSUIT_TESTS_PACING_RANDOM_H

#include <math.h>
#include <stdint.h>

/* The state is the seed. */
struct random {
	uint64_t state;
};

static inline uint64_t random_bits(struct random *random)
{
	uint64_t z = random->state += UINT64_C(0x9e3779b97f4a7c15);
	z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
	return z ^ z >> 31;
}

/* [0, 1) */
static inline double random_unit(struct random *random)
{
	return (double)(random_bits(random) >> 11) * 0x1p-53;
}

/* Mean 0, standard deviation 1: a sum of twelve, so that no library function's last bit matters; |x| <= 6. */
static inline double random_normal(struct random *random)
{
	double sum = -6.0;
	for (int i = 0; i < 12; i++)
		sum += random_unit(random);
	return sum;
}

/* Heavy tail: usually near 0.4, one in a hundred above 6, at most `most`. Never negative. */
static inline double random_tail(struct random *random, double most)
{
	const double x = 1.0 / sqrt(1.0 - random_unit(random)) - 1.0;
	return x < most ? x : most;
}

#endif
