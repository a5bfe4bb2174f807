/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The thread that talks to a display server, which may not answer: it may hang in any of its calls, for as long as the
 * server does, while nobody waits for it longer than he wants to. One that has hung too long is left behind, and clears
 * up by itself when the server answers after all.
 */
#ifndef PURSUIT_WINDOW_THREAD_H
#define PURSUIT_WINDOW_THREAD_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/error.h"

struct window_thread;

/* All on the thread; each may hang. */
struct window_work {
	/* 0, or a negative errno with a sentence. The thread may be used from now on until release(). */
	int (*open)(void *data, struct window_thread *thread, struct error *error);
	/* Readable when there is something to do; negative: none. */
	int (*get_fd)(void *data);
	/* Each time that there is, that it was woken, and every 10 ms. False: there will be nothing to do any more. */
	bool (*process)(void *data);
	/* Also when open() failed. */
	void (*close)(void *data);
	/* Frees the data, when thread and owner are done with it: the last call, on the thread or the owner's. */
	void (*release)(void *data);
	void *data;
};

/*
 * Starts the thread and waits until it is open, at most limit_ns. 0, or what open() gave, -ENOMEM or -ETIMEDOUT with a
 * sentence; *thread is NULL then, and the data are released, sooner or later.
 */
int window_thread_start(const struct window_work *work, uint64_t limit_ns, struct window_thread **thread,
						struct error *error);
/* Has everything closed and released; later, if that takes longer than two seconds. NULL accepted. Any thread. */
void window_thread_stop(struct window_thread **thread);

/* Any thread: process() is to be called. */
void window_thread_wake(struct window_thread *thread);

/*
 * Whoever calls the owner, on any thread, does it between these two. False: the owner listens no more; then there is
 * nothing to end. Not within each other.
 */
bool window_thread_begin_call(struct window_thread *thread);
void window_thread_end_call(struct window_thread *thread);
/* The owner listens no more. */
void window_thread_mute(struct window_thread *thread);

/* Any thread: how long it has been in its present call; 0: in none. */
uint64_t window_thread_busy_ns(const struct window_thread *thread);

/* At the process's exit nothing is tidied up, since others hang, or would, in what is to be. */
void window_thread_leave_at_exit(void);

#endif
