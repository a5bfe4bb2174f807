/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#ifndef PURSUIT_ASIDE_H
#define PURSUIT_ASIDE_H

#include "daemon/error.h"
#include "daemon/log.h"

/*
 * A daemon that was killed is started again with the options that it had, and must not write over what it measured
 * before: a file that holds something is renamed to PATH.1, .2 and so on, the first that is free, and that is logged.
 * Devices, pipes, empty files and an empty path are left alone. 0, or a negative errno with a sentence that names the
 * option.
 */
int aside_put(const char *option, const char *path, const struct log *log, struct error *error);

#endif
