/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A stream under test: every call of the shim is timed, since none may wait. */
#ifndef PURSUIT_TEST_HARNESS_H
#define PURSUIT_TEST_HARNESS_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "client/pursuit.h"
#include "tests/client/fake_daemon.h"

/* A call that waits for anything takes longer, and gives the processor away meanwhile: one that was robbed of it does
 * not. */
#define AT_ONCE_NS UINT64_C(100000000)
#define MS UINT64_C(1000000)
/* Longer than any machine keeps a process waiting: only what never comes takes so long. */
#define PATIENCE_NS (60000 * MS)

/* Where the tests' daemon listens. The folder is made by harness_start() and removed by harness_finish(). */
struct harness {
	char folder[40];
	char path[64];
	uint64_t slowest_ns; /* of the calls since the last close */
	unsigned waits;      /* calls that took longer than AT_ONCE_NS and slept, though nobody had stopped us */
	volatile sig_atomic_t continued; /* after we were stopped */
};
extern struct harness harness;

bool harness_start(void);
void harness_finish(void);

uint64_t now(void);
void sleep_ms(long ms);
int open_files(void);

struct pursuit_frame *timed_acquire(struct pursuit_stream *stream);
uint64_t timed_submit(struct pursuit_stream *stream, struct pursuit_frame *frame);

/* 64 x 32, colour and 32-bit depth, at harness.path. */
struct pursuit_stream *open_stream(uint32_t slot_count);

/* Closes, prints the slowest call; false if one waited. */
bool close_stream(struct pursuit_stream **stream);
struct pursuit_status status_of(struct pursuit_stream *stream);

/* One frame filled with `value`; its id, 0 if there was no slot. */
uint64_t send_frame(struct pursuit_stream *stream, uint8_t value);

/* Steps both sides until attached, PATIENCE_NS at most; the time between tries has to pass. */
bool attach(struct pursuit_stream *stream, struct fake_daemon *daemon);

/* Submits at 60 a second until the stream is in `state`; false if that takes PATIENCE_NS. */
bool submit_until(struct pursuit_stream *stream, enum pursuit_state state);

#endif
