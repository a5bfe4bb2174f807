/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A display controller and a terminal that are the test's, instead of kms_device.c and kms_console.c: 160x90 at 250 Hz,
 * in real time. It scans out: at each event it reads what is on display, which must be one picture of one colour.
 * Nothing is locked here, so that a sanitizer sees who uses the device without the presenter's lock.
 */
#ifndef PURSUIT_FAKE_KMS_H
#define PURSUIT_FAKE_KMS_H

#include <semaphore.h>
#include <stdatomic.h>
#include <stdint.h>

#define FAKE_WIDTH 160u
#define FAKE_HEIGHT 90u

struct fake_kms {
	atomic_uint devices, buffers; /* that are there */
	atomic_uint flips;            /* that ended */
	atomic_uint torn;             /* pictures on display that were not of one colour */
	atomic_uint intruding;        /* flips while the display was given away */
	atomic_bool unplugged;
	atomic_uint busy;      /* so many of the next flips are refused with EBUSY */
	atomic_bool old_event; /* before each flip an event is read of a vblank that was long ago */
	atomic_bool stuck;     /* the flip under way does not end */
	atomic_bool full;      /* there is no memory for another buffer */
	int terminal[2];       /* a pipe: 'L', another console is wanted; 'R', it is back */
	sem_t left;            /* the display was given away */
};

extern struct fake_kms fake_kms;

#endif
