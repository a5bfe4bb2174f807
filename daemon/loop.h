/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The loop of the main thread: file descriptors (epoll) and signals
 * (signalfd). Callbacks run on the thread that runs the loop and may add and
 * remove any source, their own included.
 */
#ifndef PURSUIT_LOOP_H
#define PURSUIT_LOOP_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/epoll.h>

#include "daemon/error.h"

struct loop;
struct loop_source;

/* `events` are those of epoll. */
typedef void (*loop_callback)(void *data, uint32_t events);
typedef void (*loop_signal_callback)(void *data, int number);

/* NULL with a sentence. */
struct loop *loop_create(struct error *error);
void loop_destroy(struct loop **loop);

/* Watches a fd, which stays the caller's. NULL with errno. */
struct loop_source *loop_add(struct loop *loop, int fd, uint32_t events, loop_callback callback, void *data);
/* Before the fd is closed. Clears *source; NULL accepted. */
void loop_remove(struct loop_source **source);

/* Blocks these signals in this thread (and those that it starts later) and reports them. 0 or -errno. */
int loop_add_signals(struct loop *loop, const int *numbers, unsigned count, loop_signal_callback callback, void *data,
					 struct error *error);

/* Runs until loop_quit(). 0 or -errno with a sentence. */
int loop_run(struct loop *loop, struct error *error);
void loop_quit(struct loop *loop);

/*
 * Whether it works or spins: rounds that it has gone, and pieces of work that its callbacks have told of (a message, a
 * connection, a wake-up: what others can cause at any rate). Far more rounds than work is a descriptor that stays
 * ready because nobody takes what is there.
 */
uint64_t loop_get_rounds(const struct loop *loop);
uint64_t loop_get_work(const struct loop *loop);
void loop_add_work(struct loop *loop, uint32_t pieces);

/* Handles what is due now and returns; for tests. timeout_ms as for epoll_wait(). */
int loop_step(struct loop *loop, int timeout_ms, struct error *error);

#endif
