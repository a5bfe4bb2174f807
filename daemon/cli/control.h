/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Talking to a running daemon: one CONTROL text, one JSON reply (proto/wire.h). Waits, with a time limit. */
#ifndef PURSUIT_CLI_CONTROL_H
#define PURSUIT_CLI_CONTROL_H

#include <jansson.h>

#include "daemon/error.h"

struct control {
	int fd;
	unsigned serial;
};

/*
 * Connects and says HELLO. path NULL: $PURSUIT_SOCKET if set; else
 * $XDG_RUNTIME_DIR/pursuit/socket and, where no daemon answers there,
 * /run/pursuit/socket. 0 or a negative errno with a sentence that says what to do.
 */
int control_open(struct control *control, const char *path, struct error *error);
void control_close(struct control *control);

/*
 * Asks and waits for the answer. fd >= 0 travels along and stays the caller's.
 * *reply (may be NULL) is the JSON of the answer, to be given to json_decref(),
 * or a string if it is none. 0, or a negative errno with the daemon's sentence.
 */
int control_ask(struct control *control, const char *text, int fd, json_t **reply, struct error *error);

/* Ends the recording, and waits until all frames of it are in its file, which may take minutes. As control_ask(). */
int control_end_recording(struct control *control, json_t **reply, struct error *error);

/* All settings as texts, in the daemon's order. *settings, to be given to json_decref(), only after 0. */
int control_ask_settings(struct control *control, json_t **settings, struct error *error);

#endif
