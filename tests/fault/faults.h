/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Calls that fail when a test says so. The linker puts the wrappers of faults.c
 * in the place of these functions of the C library in all of our own code that
 * is linked statically (--wrap); jansson is given them too.
 *
 * A plan says which kind of call, which one of them counted from when the plan
 * was made, and so the test can fail each one in turn until none is left.
 */
#ifndef PURSUIT_TESTS_FAULTS_H
#define PURSUIT_TESTS_FAULTS_H

#include <stdbool.h>
#include <stdint.h>

enum fault_kind {
	FAULT_NONE,
	FAULT_MEMORY,      /* malloc, calloc, realloc, aligned_alloc, strdup, mmap: ENOMEM */
	FAULT_DESCRIPTORS, /* open, socket, accept4, eventfd, memfd_create, epoll_create1, timerfd_create: EMFILE */
	FAULT_INTERRUPTED, /* read, write, pread, recvmsg, sendmsg: EINTR once */
	FAULT_SHORT,       /* read, write, pread: half of what was asked for */
	FAULT_DISK_FULL,   /* write, ftruncate, fsync: ENOSPC, and from then on */
	FAULT_IO,          /* read, write, pread, fsync: EIO, and from then on */
	FAULT_KINDS
};

/* Fails call number `index` (0 up) of this kind. */
void fault_plan(enum fault_kind kind, uint64_t index);
/* While the test itself is at work, calls neither count nor fail. */
void fault_pause(bool pause);
/* Nothing fails any more. Did the planned call come? */
bool fault_end(void);

const char *fault_name(enum fault_kind kind);

#endif
