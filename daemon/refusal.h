/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Why something of a client's was refused: what goes into a REFUSED message.
 */
#ifndef PURSUIT_REFUSAL_H
#define PURSUIT_REFUSAL_H

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

#include "proto/wire.h"

struct refusal {
	uint32_t code;     /* PURSUIT_REFUSED_* */
	const char *field; /* static; "" if none */
	uint64_t value;
	char text[160];
};

/* Gives `result` (a negative errno) back. */
__attribute__((format(printf, 6, 7))) static inline int
refuse(struct refusal *refusal, int result, uint32_t code, const char *field, uint64_t value, const char *format, ...)
{
	va_list arguments;
	refusal->code = code;
	refusal->field = field;
	refusal->value = value;
	va_start(arguments, format);
	vsnprintf(refusal->text, sizeof(refusal->text), format, arguments);
	va_end(arguments);
	return result;
}

#endif
