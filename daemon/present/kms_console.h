/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The virtual terminal that this process was started on: it asks before it
 * shows another one (Ctrl+Alt+F4), so that the display can be given away first,
 * and tells when it is back. Started elsewhere (a remote shell, a service) there
 * is none, and nothing to do.
 *
 * The terminal stays in text mode: as long as we are master, what the kernel
 * writes on its console goes to a buffer that is not on display. So there is
 * nothing to put back after a crash: the next switch finds that the process is
 * gone, and the kernel takes the terminal back by itself.
 *
 * The terminal asks by SIGUSR1 and tells by SIGUSR2, which are read from a
 * descriptor. That needs them blocked in all threads, so whoever wants it blocks
 * them before the first thread starts.
 */
#ifndef PURSUIT_KMS_CONSOLE_H
#define PURSUIT_KMS_CONSOLE_H

#include <stdbool.h>

#include "daemon/log.h"

struct kms_console {
	int tty, signals; /* -1: none */
};

enum kms_console_event {
	KMS_CONSOLE_NOTHING = 0,
	KMS_CONSOLE_LEAVE,  /* give the display away, then kms_console_left() */
	KMS_CONSOLE_RETURN, /* it is ours again */
};

/* Always works; without a terminal, or without blocked signals, no event ever comes. */
void kms_console_init(struct kms_console *console, const struct log *log);
void kms_console_finish(struct kms_console *console);

/* Readable when there is an event; -1: never. */
int kms_console_get_fd(const struct kms_console *console);
enum kms_console_event kms_console_read(struct kms_console *console);
void kms_console_left(struct kms_console *console);

#endif
