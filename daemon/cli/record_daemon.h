/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* `pursuit record` without a scene: asks a running daemon to record what it receives. */
#ifndef PURSUIT_CLI_RECORD_DAEMON_H
#define PURSUIT_CLI_RECORD_DAEMON_H

#include <jansson.h>

/*
 * seconds 0: until Ctrl-C. socket NULL: the usual one. *written becomes {recording, frames, dropped, bytes}, to be
 * given to json_decref(). `verb` asks for it, and what fails, or that no frame came, is said in its name; where there
 * is no daemon `otherwise` follows. Gives the exit status back.
 */
int record_daemon(const char *verb, const char *otherwise, const char *path, const char *socket, double seconds,
				  json_t **written);

#endif
