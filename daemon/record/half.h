/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* IEEE 754 half precision in plain C, so that a recording does not depend on the compiler or the CPU. */
#ifndef PURSUIT_RECORD_HALF_H
#define PURSUIT_RECORD_HALF_H

#include <stdint.h>
#include <string.h>

static inline float half_to_float(uint16_t half)
{
	const uint32_t sign = (uint32_t)(half & 0x8000u) << 16, exponent = (half >> 10) & 0x1fu;
	uint32_t mantissa = half & 0x3ffu, bits;
	float value;

	if (exponent == 0x1f) {
		bits = sign | 0x7f800000u | mantissa << 13;
	} else if (exponent) {
		bits = sign | (exponent + 112) << 23 | mantissa << 13;
	} else {
		value = (float)mantissa * 0x1p-24f;
		return sign ? -value : value;
	}
	memcpy(&value, &bits, sizeof(value));
	return value;
}

/* Rounds to the nearest, ties to even; what is too large becomes infinite. */
static inline uint16_t half_from_float(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof(bits));
	const uint32_t sign = bits >> 16 & 0x8000u, magnitude = bits & 0x7fffffffu;

	if (magnitude > 0x7f800000u)
		return (uint16_t)(sign | 0x7e00u | (magnitude >> 13 & 0x3ffu));
	if (magnitude >= 0x477ff000u)
		return (uint16_t)(sign | 0x7c00u);
	if (magnitude < 0x33000001u)
		return (uint16_t)sign;
	if (magnitude < 0x38800000u) {
		/* A denormal half: so many units of 2^-24. */
		const uint32_t shift = 126 - (magnitude >> 23), whole = (magnitude & 0x7fffffu) | 0x800000u;
		const uint32_t units = whole >> shift, rest = whole & ((1u << shift) - 1), tie = 1u << (shift - 1);
		return (uint16_t)(sign | (units + (rest > tie || (rest == tie && (units & 1)))));
	}
	const uint32_t rounded = magnitude + 0xfffu + (magnitude >> 13 & 1);
	return (uint16_t)(sign | (rounded - 0x38000000u) >> 13);
}

#endif
