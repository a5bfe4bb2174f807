/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Colour of any format and transfer to the 8-bit code values of the display
 * (docs/method.md, 0), on the CPU, by tables: exact, since every component is
 * one of at most 65536 values.
 */
#ifndef PURSUIT_ENGINE_CONVERT_H
#define PURSUIT_ENGINE_CONVERT_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/engine.h"
#include "daemon/frame.h"

struct convert {
	/* What the table was made for. */
	uint32_t format;
	struct pursuit_transfer transfer;
	enum engine_curve curve;
	float gamma;
	bool made, identity;
	uint8_t table[65536]; /* component to code value */
};

/* Makes ready for planes of that format and transfer; NULL transfer: code values as they are. */
void convert_prepare(struct convert *convert, uint32_t format, const struct pursuit_transfer *transfer,
					 enum engine_curve curve, float gamma);

/* One row of pixels to BGRA bytes; `opaque` sets alpha to 255, else it is the source's. */
void convert_row(const struct convert *convert, uint8_t *to, const uint8_t *from, uint32_t width, bool opaque);

/* Of the display, in double precision: the reference for the table. */
double convert_to_light(double code, enum engine_curve curve, double gamma);
double convert_from_light(double light, enum engine_curve curve, double gamma);

#endif
