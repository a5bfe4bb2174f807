/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* One stored value to its number; the same bits in the kernels and for single pixels. */
#ifndef PURSUIT_ANALYSIS_VALUES_H
#define PURSUIT_ANALYSIS_VALUES_H

#include <math.h>
#include <string.h>

#include "daemon/engine/analysis/levels.h"

static inline float plan_float_of(uint32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof(value));
	return value;
}

static inline uint32_t plan_bits_of(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof(bits));
	return bits;
}

/* Exact, without float denormals, so that the mode of the FPU does not matter. */
static inline float plan_half_value(uint32_t half)
{
	uint32_t exponent = half & 0x7c00u;
	uint32_t shifted = (half & 0x7fffu) << 13;
	uint32_t normal = shifted + (112u << 23) + (exponent == 0x7c00u ? 112u << 23 : 0u);
	float tiny = plan_float_of(shifted + (113u << 23)) - plan_float_of(113u << 23);
	uint32_t bits = exponent == 0 ? plan_bits_of(tiny) : normal;
	return plan_float_of(bits | (half & 0x8000u) << 16);
}

/* To the nearest, ties to even; beyond the largest half that one, and NaN of what is no number. No branches. */
static inline uint16_t plan_half_of(float value)
{
	const uint32_t bits = plan_bits_of(value), sign = bits & 0x80000000u;
	uint32_t magnitude = bits & 0x7fffffffu;
	const uint32_t none = magnitude >= 0x7f800000u;
	magnitude = magnitude < 0x477fe000u ? magnitude : 0x477fe000u; /* 65504 */
	/* A power of two 13 bits above the lowest one that stays rounds the others away when it is added. */
	uint32_t exponent = magnitude & 0x7f800000u;
	exponent = exponent > 113u << 23 ? exponent : 113u << 23;
	const float rounder = plan_float_of(exponent + (13u << 23));
	const uint32_t rounded = plan_bits_of(plan_float_of(magnitude) + rounder) - plan_bits_of(rounder);
	const uint32_t half = rounded + ((exponent - (113u << 23)) >> 13);
	return (uint16_t)(none ? 0x7e00u : sign >> 16 | half);
}

static inline float plan_clamped(float value, float limit)
{
	value = value < limit ? value : limit;
	return value > -limit ? value : -limit;
}

/* The tracking factor f (docs/method.md, 1). */
static inline float plan_tracking(float speed)
{
	float t = (speed - 70.0f) / 20.0f;
	t = t > 0.0f ? t : 0.0f;
	t = t < 1.0f ? t : 1.0f;
	return 1.0f - t * t * (3.0f - 2.0f * t);
}

static inline uint32_t plan_is_finite(float value)
{
	return (plan_bits_of(value) & 0x7f800000u) != 0x7f800000u;
}

/* u of one motion (docs/method.md, 1), any bits; 0 if that is no number, else 1. */
static inline uint32_t plan_displacement(float x, float y, const struct plan_scale *scale, float *ux, float *uy)
{
	const uint32_t finite = plan_is_finite(x) & plan_is_finite(y);
	x = plan_clamped(finite ? x : 0.0f, 65504.0f);
	y = plan_clamped(finite ? y : 0.0f, 65504.0f);
	const float f = plan_tracking(sqrtf(x * x + y * y) * scale->degrees);
	*ux = plan_clamped(f * (scale->ratio * x), 16384.0f);
	*uy = plan_clamped(f * (scale->ratio * y), 16384.0f);
	return finite;
}

static inline float plan_depth_decode16(uint32_t raw)
{
	return (float)(int32_t)(raw & 0xffffu) / 65535.0f;
}

static inline float plan_depth_decode24(uint32_t raw)
{
	return (float)(int32_t)(raw & 0xffffffu) / 16777215.0f;
}

static inline float plan_depth_clamp(float z)
{
	z = z == z ? z : 1.0f;
	z = z > 0.0f ? z : 0.0f;
	return z < 1.0f ? z : 1.0f;
}

static inline float plan_depth_range(float d, float near_distance, float range)
{
	return plan_depth_clamp((d - near_distance) / range);
}

static inline float plan_depth_infinite(float d, float near_distance)
{
	float z = 1.0f - near_distance / d;
	return plan_depth_clamp(d <= near_distance ? 0.0f : z);
}

static inline float plan_depth_open(float d)
{
	return plan_depth_clamp(d / (1.0f + d));
}

/* z of one pixel from its bits. */
static inline float plan_depth_value(uint32_t raw, const struct plan_depth *depth)
{
	float d = depth->format == PURSUIT_FORMAT_DEPTH16   ? plan_depth_decode16(raw)
			  : depth->format == PURSUIT_FORMAT_DEPTH24 ? plan_depth_decode24(raw)
														: plan_float_of(raw);
	switch (depth->map) {
	case PLAN_DEPTH_REVERSED:
		return plan_depth_clamp(1.0f - d);
	case PLAN_DEPTH_RANGE:
		return plan_depth_range(d, depth->near_distance, depth->range);
	case PLAN_DEPTH_INFINITE:
		return plan_depth_infinite(d, depth->near_distance);
	case PLAN_DEPTH_OPEN:
		return plan_depth_open(d);
	case PLAN_DEPTH_AS_IS:
	default:
		return plan_depth_clamp(d);
	}
}

/* One to one in each of the two while the other stays; factors of 32 bits are all that vectors multiply fast. */
#define PLAN_HASH_FACTOR 0x9e3779b1u

static inline uint64_t plan_hash_step(uint64_t hash, uint64_t word)
{
	hash = (hash ^ word) * PLAN_HASH_FACTOR;
	return hash ^ hash >> 32;
}

#endif
