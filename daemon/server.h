/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The server: clients on sockets, their streams, the conversation of
 * proto/wire.h. Everything that arrives is checked; a client that breaks a rule
 * is told which and, if the packet itself is malformed, dropped; the others do
 * not notice. A client that does not read its socket is dropped when the socket
 * is full. Runs on main.
 */
#ifndef PURSUIT_SERVER_H
#define PURSUIT_SERVER_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "daemon/admission.h"
#include "daemon/clock.h"
#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/options.h"
#include "daemon/output.h"

struct server;

struct server_params {
	struct loop *loop;
	const struct log *log;
	struct clock *clock;
	const struct settings *settings;
	struct output *output;
	/*
	 * A CONTROL request: answer with server_reply(), now or later. fd: came
	 * with it, -1 none; the callee's.
	 */
	void (*control)(void *data, uint64_t client_id, uint32_t serial, const char *text, int fd);
	void *data;
	/* A key was pressed in the presenter's window. */
	void (*key)(void *key_data, const struct presenter_key *key);
	void *key_data;
	const struct admission *admission; /* who may be a client; NULL: everybody */
};

/* Listens. NULL with a sentence. */
struct server *server_create(const struct server_params *params, struct error *error);
/* Tells every client SHUTDOWN and closes; the socket is removed. NULL accepted. */
void server_destroy(struct server **server);

/*
 * Another path of the socket, in two steps: listens there, too; then there alone, or as before. Clients stay, and
 * whoever has connected to the old path is let in. A negative errno with a sentence: nothing was changed, and the
 * second step is left out.
 */
int server_prepare(struct server *server, const char *path, struct error *error);
void server_commit(struct server *server);
void server_abandon(struct server *server);

const char *server_path(const struct server *server);

/*
 * Answers a CONTROL request; a client that is gone meanwhile is no error. What does not fit a packet is
 * answered with EMSGSIZE and a sentence, never cut.
 */
void server_reply(struct server *server, uint64_t client_id, uint32_t serial, int status, const char *text);

/* Tells the client that is shown of a key. False: it does not want to know, or there is none. */
bool server_send_key(struct server *server, const struct presenter_key *key);

/* Shows this client's newest stream: by number, or by name. -ENOENT with a sentence. */
int server_focus(struct server *server, const char *name, struct error *error);

/* Is this client's user the daemon's own, or root? */
bool server_is_owner(const struct server *server, uint64_t client_id);

/* One object per stream. */
json_t *server_streams_json(const struct server *server);
uint32_t server_client_count(const struct server *server);

#endif
