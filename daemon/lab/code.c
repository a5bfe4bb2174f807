/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/code.h"

#include <stdlib.h>

#define MASK ((UINT32_C(1) << CODE_ORDER) - 1)

struct code {
	uint8_t bits[CODE_PERIOD];
	uint16_t index[MASK + 1]; /* of the newest bit of a window */
};

/* The bit that follows 16 bits, the newest lowest. */
static uint32_t next_bit(uint32_t bits)
{
	return (bits >> 15 ^ bits >> 13 ^ bits >> 12 ^ bits >> 10) & 1;
}

struct code *code_create(void)
{
	struct code *code = calloc(1, sizeof(*code));
	uint32_t window = 1;
	if (!code)
		return NULL;
	/* Once around fills the windows that reach over the start. */
	for (uint32_t i = 0; i < CODE_PERIOD; i++) {
		const uint32_t bit = next_bit(window);
		window = (window << 1 | bit) & MASK;
		code->bits[i] = (uint8_t)bit;
		code->index[window] = (uint16_t)i;
	}
	return code;
}

void code_destroy(struct code **code)
{
	free(*code);
	*code = NULL;
}

bool code_bit(const struct code *code, uint64_t number)
{
	return code->bits[number % CODE_PERIOD];
}

int32_t code_find(const struct code *code, uint32_t bits)
{
	return bits & MASK ? code->index[bits & MASK] : -1;
}

/* Does every bit of a full window follow from the 16 before it? */
static bool obeys(uint32_t window)
{
	for (uint32_t i = 0; i < CODE_WINDOW - CODE_ORDER; i++)
		if (next_bit(window >> (i + 1) & MASK) != (window >> i & 1))
			return false;
	return (window & MASK) != 0;
}

static void lock(struct code_reader *reader, uint32_t index)
{
	const uint32_t sample = (uint32_t)(reader->samples % CODE_PERIOD);
	const uint32_t offset = (index + CODE_PERIOD - sample) % CODE_PERIOD;
	if (reader->was_locked && offset != reader->offset) {
		const uint32_t ahead = (offset + CODE_PERIOD - reader->offset) % CODE_PERIOD;
		reader->slip = ahead <= CODE_PERIOD / 2 ? (int32_t)ahead : (int32_t)ahead - (int32_t)CODE_PERIOD;
		reader->slips++;
	}
	reader->offset = offset;
	reader->locked = reader->was_locked = true;
}

int32_t code_reader_add(struct code_reader *reader, const struct code *code, bool bit)
{
	reader->samples++;
	if (reader->locked && code_bit(code, reader->samples + reader->offset) != bit)
		reader->locked = false;
	reader->window = reader->window << 1 | bit;
	if (reader->filled < CODE_WINDOW)
		reader->filled++;
	if (!reader->locked && reader->filled == CODE_WINDOW && obeys(reader->window))
		lock(reader, (uint32_t)code_find(code, reader->window));
	return reader->locked ? (int32_t)((reader->samples + reader->offset) % CODE_PERIOD) : -1;
}

void code_reader_gap(struct code_reader *reader)
{
	reader->samples++;
	reader->filled = 0;
}
