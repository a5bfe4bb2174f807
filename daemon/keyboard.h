/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What pressed keys do: the daemon's own (keys.h), all others go to the client that is shown. On main. */
#ifndef PURSUIT_KEYBOARD_H
#define PURSUIT_KEYBOARD_H

#include "daemon/live.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/output.h"
#include "daemon/server.h"

struct keyboard {
	struct loop *loop;
	const struct log *log;
	struct output *output;
	struct live *live;
	struct server *server; /* NULL: none yet */
	uint64_t asked_client; /* to quit, by a key; 0: none */
};

/* As server_params.key. */
void keyboard_press(void *data, const struct presenter_key *key);

#endif
