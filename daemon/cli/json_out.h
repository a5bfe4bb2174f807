/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What --json prints: one object on standard output, and nothing else there; and the same in a file. */
#ifndef PURSUIT_CLI_JSON_OUT_H
#define PURSUIT_CLI_JSON_OUT_H

#include <jansson.h>
#include <stdbool.h>

#include "daemon/error.h"

/* False: there was no memory for it. Of what standard output does not take main tells. */
bool json_print(const json_t *object);

/* Takes the object over; NULL is one that there was no memory for, or text that is no UTF-8. STATUS_DONE or _FAILED. */
int json_out(const char *verb, json_t *object);

/* Over what is in the file. 0, or a negative errno with a sentence that names it. */
int json_write(const json_t *object, const char *path, struct error *error);

#endif
