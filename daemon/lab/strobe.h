/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * When a backlight is flashed (Didyk et al. 2010, Section 4: shorter light
 * within each refresh, less hold-type blur), and how much of it is permitted.
 * The hard limit is a bucket of light: it fills at `limit` nanoseconds a
 * nanosecond, holds five quarters of a refresh's worth, and a pulse that it
 * does not hold is left out. So over any time W the line is on for at most
 * limit x (W + 1.25 periods), however flips and wake-ups come. What is measured
 * to have been on too long is taken from later pulses.
 *
 * Pure; one thread.
 */
#ifndef PURSUIT_LAB_STROBE_H
#define PURSUIT_LAB_STROBE_H

#include <stdbool.h>
#include <stdint.h>

#define STROBE_MOST 0.5 /* a limit above this is not accepted */

struct strobe {
	double phase, duty, limit; /* shares of a period; duty <= limit <= STROBE_MOST */
	double period_ns;
	double bucket_ns;          /* light that may be used now; below zero after a pulse that was too long */
	uint64_t filled_ns;        /* when the bucket was brought up to date, 0 never */
	uint64_t on_ns;            /* since when the line is on, 0 off */
	uint64_t pulses, left_out; /* begun; not permitted, or too late to be worth it */
	uint64_t too_long;         /* on for longer than the limit allows within one refresh: switched off late */
};

/* Shares as above, taken as they are after clamping to the limits. */
void strobe_init(struct strobe *strobe, double phase, double duty, double limit, double period_ns);

/* Other shares from the next pulse on; what light there was counts on. */
void strobe_change(struct strobe *strobe, double phase, double duty, double limit);

/* When the pulse of this flip is due. */
uint64_t strobe_due(const struct strobe *strobe, uint64_t flip_ns);

/* To be asked when the pulse is due: when to switch off again, 0 if it must not be switched on. */
uint64_t strobe_begin(struct strobe *strobe, uint64_t due_ns, uint64_t now_ns);
/* It is off again. */
void strobe_end(struct strobe *strobe, uint64_t now_ns);

#endif
