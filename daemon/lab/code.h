/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The sequence that identifies each displayed frame by light alone: bit number
 * i of a maximal-length sequence of order 16 (taps 16, 14, 13, 11; Golomb,
 * Shift Register Sequences, 1967), which repeats after 65535 bits, 9 minutes at
 * 120 Hz. Any 16 bits in a row occur once in it. The reader wants 32 in a row
 * that obey the recurrence, so that a sample that was lost or doubled among
 * them is noticed (missed once in 65536 cases), and says how far the count of
 * samples has slipped since.
 *
 * Pure; one thread.
 */
#ifndef PURSUIT_LAB_CODE_H
#define PURSUIT_LAB_CODE_H

#include <stdbool.h>
#include <stdint.h>

#define CODE_ORDER 16u
#define CODE_PERIOD 65535u
#define CODE_WINDOW 32u

struct code;

/* NULL: out of memory. */
struct code *code_create(void);
/* NULL accepted. */
void code_destroy(struct code **code);

/* The bit for any number; it repeats. */
bool code_bit(const struct code *code, uint64_t number);

/* The index (0 to CODE_PERIOD - 1) of the newest of 16 bits, the newest lowest; -1 for 16 zeros, which never occur. */
int32_t code_find(const struct code *code, uint32_t bits);

/* Zeroed is ready. */
struct code_reader {
	uint32_t window;  /* the newest bit lowest */
	uint32_t filled;  /* bits in a row, at most CODE_WINDOW */
	uint64_t samples; /* ever, unknown ones too */
	uint64_t slips;   /* times that the count was found to have slipped */
	int32_t slip;     /* the last: samples lost since the lock before (> 0), or counted twice (< 0) */
	uint32_t offset;  /* index - sample number, modulo the period */
	bool locked, was_locked;
};

/* One sample a flip. The index of the frame that it shows, or -1 as long as that is not known. */
int32_t code_reader_add(struct code_reader *reader, const struct code *code, bool bit);
/* A sample whose bit is not known. */
void code_reader_gap(struct code_reader *reader);

#endif
