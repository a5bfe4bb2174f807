/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What keys do in `pursuit top`: one table. Each is a request to the daemon, made from its status. */
#ifndef PURSUIT_CLI_TOP_KEYS_H
#define PURSUIT_CLI_TOP_KEYS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#include "control.h"

/*
 * Does what this key is for. `message`: what came of it, for a person; "" for a key that does nothing. True: the
 * daemon was asked for something.
 */
bool top_keys_press(struct control *control, const json_t *status, char key, char *message, size_t size);

/* "m method  b blur ..." */
void top_keys_describe(char *text, size_t size);

#endif
