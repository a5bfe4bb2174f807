/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What program is at the other end of a socket: the kernel's word, not the
 * client's. The file that /proc/PID/exe stands for, where the daemon may look
 * (its own user's processes, or all as root), read while a pidfd shows that the
 * process has not ended meanwhile, so that its number is nobody else's.
 */
#ifndef PURSUIT_EXECUTABLE_H
#define PURSUIT_EXECUTABLE_H

#include <stdbool.h>
#include <sys/types.h>

/* With the zero: as long as the name of a file may be. */
#define EXECUTABLE_NAME_BYTES 256u

/*
 * Name of the executable, without folders, of the process `pid` that connected `socket`: any bytes but / and zero.
 * False, and "": it has ended, or may not be looked at.
 */
bool executable_of(int socket, pid_t pid, char name[EXECUTABLE_NAME_BYTES]);

#endif
