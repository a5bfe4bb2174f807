/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The display's transfer as tables, and what the compensation needs besides (docs/method.md, 6). */
#ifndef PURSUIT_ENGINE_CPU_LIGHT_H
#define PURSUIT_ENGINE_CPU_LIGHT_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/engine.h"

/* Between code values: lerped within a sixteenth, wrong by less than 1e-4 of a code value. */
#define LIGHT_FINE 16u
/* By exponent and the first bits of the mantissa of a float. */
#define LIGHT_MANTISSA_BITS 6u
#define LIGHT_MOST_OCTAVES 64u

struct light {
	/* What the tables were made for. */
	bool made;
	enum engine_curve curve;
	float gamma;
	float fine[255 * LIGHT_FINE + 2];                             /* light of code i / LIGHT_FINE */
	float codes[(LIGHT_MOST_OCTAVES << LIGHT_MANTISSA_BITS) + 2]; /* code value, 0 to 255, from `least` light on */
	uint32_t least_bits;                                          /* of the float `least`, a power of two */
	float below;                                                  /* code values per light below `least` */
	/* Of the frame. */
	float count;   /* N */
	float boost;   /* k */
	bool mix_only; /* no compensation */
};

/* Makes the tables for a display. */
void light_prepare(struct light *light, enum engine_curve curve, float gamma);

#endif
