/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * After start-up: what a daemon that was taken over would need, and neither we
 * nor a GL driver does, is refused by the kernel with EPERM, in all threads and
 * for good: new programs, new processes, tracing others, namespaces, mounts,
 * modules, sockets other than local ones, changing identity.
 *
 * A list of what is allowed instead would have to follow each driver: software
 * GL maps executable memory for the code it compiles, starts threads at any
 * time and writes a shader cache; hardware drivers add ioctls without end.
 */
#ifndef PURSUIT_SECCOMP_H
#define PURSUIT_SECCOMP_H

#include "daemon/error.h"

/* 0; -ENOSYS: not on this kernel or machine; other negative errno. With a sentence. */
int seccomp_apply(struct error *error);

#endif
