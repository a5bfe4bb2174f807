/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/server.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/client.h"
#include "daemon/listener.h"
#include "daemon/printable.h"

/* A connection that has not said HELLO for so long makes room for another. */
#define SILENCE_NS UINT64_C(1000000000)
#define ACCEPT_AT_ONCE 16

struct server {
	struct server_params params;
	struct listener listener, prepared; /* prepared.fd -1: it stays */
	struct loop_source *accept_source, *event_source, *prepared_source;
	int reserve_fd; /* given up for a moment when there are no file descriptors left */
	struct client *clients;
	uint32_t client_count;
	uint64_t next_id;
	struct packet *packet;
	struct log_limit log_limit; /* of clients that are turned away */
};

/* ---- clients ---- */

static struct client *find_client(const struct server *server, uint64_t id)
{
	for (struct client *client = server->clients; client; client = client->next)
		if (client->id == id)
			return client;
	return NULL;
}

static void remove_client(struct server *server, struct client *client)
{
	struct client **link = &server->clients;
	while (*link != client)
		link = &(*link)->next;
	*link = client->next;
	server->client_count--;
	log_debug(server->params.log, "client %s (pid %d) is gone", client->name, (int)client->peer.pid);
	client_destroy(&client);
}

static void remove_gone(struct server *server)
{
	struct client *next;
	for (struct client *client = server->clients; client; client = next) {
		next = client->next;
		if (client->gone)
			remove_client(server, client);
	}
}

static void on_client(void *data, uint32_t events)
{
	struct client *client = data;
	loop_add_work(client->params->loop, (events & (EPOLLHUP | EPOLLERR)) != 0);
	struct server *server = (struct server *)((uintptr_t)client->params - offsetof(struct server, params));
	client_read(client, events);
	remove_gone(server);
}

/* Its children may keep the connection open; what it has sent still counts. */
static void on_process_ended(void *data, uint32_t events)
{
	struct client *client = data;
	(void)events;
	on_client(client, EPOLLHUP);
}

/* Without it the end of the connection is the end of the client. */
static void watch_process(struct client *client)
{
	client->process = peer_open_process(client->fd, client->peer.pid);
	if (client->process >= 0)
		client->process_source = loop_add(client->params->loop, client->process, EPOLLIN, on_process_ended, client);
}

/* Room for one more, if need be by dropping one that never spoke. */
static bool make_room(struct server *server)
{
	const uint64_t now_ns = clock_now(server->params.clock);
	struct client *oldest = NULL;
	if (server->client_count < server->params.settings->max_clients)
		return true;
	for (struct client *client = server->clients; client; client = client->next)
		if (!client->greeted && now_ns - client->connected_ns > SILENCE_NS)
			oldest = client;
	if (oldest)
		remove_client(server, oldest);
	return oldest != NULL;
}

__attribute__((format(printf, 6, 7))) static void turn_away(struct server *server, int fd, uint32_t code,
															const char *field, uint64_t value, const char *format, ...)
{
	struct pursuit_message_refused message = {
		.header = {.type = PURSUIT_MESSAGE_REFUSED, .size = sizeof(message)},
		.code = code,
		.fatal = 1,
		.value = value,
	};
	va_list arguments;
	snprintf(message.field, sizeof(message.field), "%s", field);
	va_start(arguments, format);
	vsnprintf(message.text, sizeof(message.text), format, arguments);
	va_end(arguments);
	packet_send(fd, &message, sizeof(message), -1);
	packet_drain(fd);
	close(fd);
	if (log_limit_allows(&server->log_limit, clock_now(server->params.clock)))
		log_warning(server->params.log, "%s", message.text);
}

static void add_client(struct server *server, int fd)
{
	const struct admission *admission = server->params.admission;
	const struct peer peer = peer_of(fd);
	if (admission && !admission_allows(admission, &peer, fd)) {
		turn_away(server, fd, PURSUIT_REFUSED_PERMISSION, "uid", peer.uid,
				  "uid is %u, which may not be a client of this daemon (allow-users, allow-groups)",
				  (unsigned)peer.uid);
		return;
	}
	if (!make_room(server)) {
		turn_away(server, fd, PURSUIT_REFUSED_LIMIT, "clients", server->client_count,
				  "clients is %" PRIu32 ", the most that this daemon serves (max-clients)", server->client_count);
		return;
	}
	struct client *client = client_create(&server->params, server->packet, fd, &peer, server->next_id++);
	if (!client) {
		close(fd);
		return;
	}
	client->source = loop_add(server->params.loop, fd, EPOLLIN | EPOLLRDHUP, on_client, client);
	if (!client->source) {
		client_destroy(&client);
		return;
	}
	watch_process(client);
	client->next = server->clients;
	server->clients = client;
	server->client_count++;
}

/* Without file descriptors a waiting connection would wake the loop for ever: take it and hang up. */
static void hang_up_one(struct server *server)
{
	if (server->reserve_fd >= 0)
		close(server->reserve_fd);
	const int fd = accept4(server->listener.fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
	if (fd >= 0)
		close(fd);
	loop_add_work(server->params.loop, fd >= 0);
	server->reserve_fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
	if (log_limit_allows(&server->log_limit, clock_now(server->params.clock)))
		log_error(server->params.log, "out of file descriptors: a client was turned away");
}

static void on_accept(void *data, uint32_t events)
{
	struct server *server = data;
	(void)events;
	for (int i = 0; i < ACCEPT_AT_ONCE; i++) {
		const int fd = accept4(server->listener.fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
		if (fd >= 0) {
			loop_add_work(server->params.loop, 1);
			add_client(server, fd);
		} else if (errno == EMFILE || errno == ENFILE) {
			hang_up_one(server);
			return;
		} else if (errno != ECONNABORTED && errno != EINTR) {
			return;
		}
	}
}

/* ---- what the render thread has found ---- */

static void on_output_event(void *data, uint32_t events)
{
	struct server *server = data;
	struct output_event event;
	(void)events;
	while (output_next_event(server->params.output, &event)) {
		loop_add_work(server->params.loop, 1);
		if (event.kind == OUTPUT_KEY) {
			server->params.key(server->params.key_data, &event.key);
			continue;
		}
		struct client *client = find_client(server, event.client_id);
		struct client_stream *stream = client ? client_find_stream(client, event.stream_id) : NULL;
		if (!stream || stream->stream->number != event.stream)
			continue;
		client_refuse(client, 0, event.stream_id, false, &event.refusal);
		if (event.kind == OUTPUT_STREAM_BROKEN)
			client_close_stream(stream, 0);
	}
	remove_gone(server);
}

/* ---- life ---- */

static int start(struct server *server, struct error *error)
{
	const int result = listener_init(&server->listener, server->params.settings->socket, error);
	if (result < 0)
		return result;
	server->packet = calloc(1, sizeof(*server->packet));
	server->reserve_fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
	server->accept_source = loop_add(server->params.loop, server->listener.fd, EPOLLIN, on_accept, server);
	server->event_source =
		loop_add(server->params.loop, output_event_fd(server->params.output), EPOLLIN, on_output_event, server);
	if (!server->packet || !server->accept_source || !server->event_source)
		return error_set(error, -ENOMEM, "server: out of memory");
	return 0;
}

struct server *server_create(const struct server_params *params, struct error *error)
{
	struct server *server = calloc(1, sizeof(*server));
	if (!server) {
		error_set(error, -ENOMEM, "server: out of memory");
		return NULL;
	}
	server->params = *params;
	server->next_id = 1;
	server->reserve_fd = -1;
	server->listener.fd = server->listener.lock_fd = server->prepared.fd = server->prepared.lock_fd = -1;
	if (start(server, error) < 0)
		server_destroy(&server);
	return server;
}

void server_destroy(struct server **server)
{
	struct server *self = *server;
	struct refusal refusal;
	*server = NULL;
	if (!self)
		return;
	refuse(&refusal, 0, PURSUIT_REFUSED_SHUTDOWN, "", 0, "the daemon is stopping");
	while (self->clients) {
		struct client *client = self->clients;
		client_refuse(client, 0, 0, true, &refusal);
		remove_client(self, client);
	}
	loop_remove(&self->accept_source);
	loop_remove(&self->event_source);
	listener_finish(&self->listener);
	if (self->reserve_fd >= 0)
		close(self->reserve_fd);
	free(self->packet);
	free(self);
}

/* ---- another socket ---- */

int server_prepare(struct server *server, const char *path, struct error *error)
{
	if (listener_is_at(&server->listener, path))
		return 0;
	if (server->listener.lock_fd < 0)
		return error_set(error, -EBUSY,
						 "socket: %s is the service manager's, which opened it; its path is ListenSequentialPacket= of "
						 "the socket unit",
						 server->listener.path);
	int result = listener_init(&server->prepared, path, error);
	if (result == 0)
		server->prepared_source = loop_add(server->params.loop, server->prepared.fd, EPOLLIN, on_accept, server);
	if (result == 0 && !server->prepared_source) {
		result = error_set(error, -ENOMEM, "socket: out of memory");
		listener_finish(&server->prepared);
	}
	return result;
}

void server_commit(struct server *server)
{
	if (server->prepared.fd < 0)
		return;
	/* Who has come there already. */
	for (int i = 0; i < 4; i++)
		on_accept(server, EPOLLIN);
	loop_remove(&server->accept_source);
	listener_finish(&server->listener);
	server->listener = server->prepared;
	server->accept_source = server->prepared_source;
	server->prepared.fd = server->prepared.lock_fd = -1;
	server->prepared_source = NULL;
	log_info(server->params.log, "listening at %s", server->listener.path);
}

void server_abandon(struct server *server)
{
	loop_remove(&server->prepared_source);
	listener_finish(&server->prepared);
}

const char *server_path(const struct server *server)
{
	return server->listener.path;
}

uint32_t server_client_count(const struct server *server)
{
	return server->client_count;
}

/* ---- keys ---- */

bool server_send_key(struct server *server, const struct presenter_key *key)
{
	uint64_t client_id = 0, stream_id = 0;
	if (!output_get_shown(server->params.output, &client_id, &stream_id))
		return false;
	struct client *client = find_client(server, client_id);
	const struct client_stream *entry = client ? client_find_stream(client, stream_id) : NULL;
	if (!entry || !entry->wants_keys)
		return false;
	const struct pursuit_message_key message = {
		.header = {.type = PURSUIT_MESSAGE_KEY, .size = sizeof(message)},
		.stream_id = stream_id,
		.time_ns = key->time_ns,
		.code = key->code,
	};
	client_send(client, &message, sizeof(message), -1);
	return !client->gone;
}

/* ---- focus ---- */

/* By number, or by name (of several the newest). */
static struct client *find_named(const struct server *server, const char *name)
{
	char *end;
	const unsigned long long id = strtoull(name, &end, 10);
	if (*name >= '0' && *name <= '9' && !*end)
		return find_client(server, id);
	for (struct client *client = server->clients; client; client = client->next)
		if (strcmp(client->name, name) == 0)
			return client;
	return NULL;
}

int server_focus(struct server *server, const char *name, struct error *error)
{
	const struct client *client = find_named(server, name);
	if (!client)
		return error_set(error, -ENOENT, "focus: there is no client \"%.64s\"; pursuit status lists them", name);
	if (!output_focus(server->params.output, client->id))
		return error_set(error, -ENOENT, "focus: client %.64s has no stream open", client->name);
	log_info(server->params.log, "%s (pid %d) is shown", client->name, (int)client->peer.pid);
	return 0;
}

/* ---- control ---- */

bool server_is_owner(const struct server *server, uint64_t client_id)
{
	const struct client *client = find_client(server, client_id);
	return client && peer_is_owner(&client->peer);
}

void server_reply(struct server *server, uint64_t client_id, uint32_t serial, int status, const char *text)
{
	struct client *client = find_client(server, client_id);
	const size_t most = PURSUIT_WIRE_MAX_PACKET - sizeof(struct pursuit_message_control);
	char too_long[128];
	size_t length = strlen(text);
	if (!client)
		return;
	if (length > most) {
		snprintf(too_long, sizeof(too_long), "the answer has %zu bytes, more than the %zu that a packet holds", length,
				 most);
		text = too_long;
		length = strlen(text);
		status = EMSGSIZE;
	}
	const size_t bytes = sizeof(struct pursuit_message_control) + length;
	uint8_t *packet = malloc(bytes);
	if (!packet)
		return;
	const struct pursuit_message_control header = {
		.header = {.type = PURSUIT_MESSAGE_CONTROL_REPLY, .size = (uint32_t)bytes, .serial = serial},
		.status = (uint32_t)(status < 0 ? -status : status),
		.text_bytes = (uint32_t)length,
	};
	memcpy(packet, &header, sizeof(header));
	memcpy(packet + sizeof(header), text, length);
	client_send(client, packet, bytes, -1);
	free(packet);
}

static json_t *stream_json(const struct server *server, const struct client *client, struct stream *stream)
{
	uint64_t shown_client = 0, shown_stream = 0;
	output_get_shown(server->params.output, &shown_client, &shown_stream);
	struct stream_counters *c = &stream->counters;
	char application[EXECUTABLE_NAME_BYTES];
	snprintf(application, sizeof(application), "%s", stream->application);
	printable_clean(application);
	const uint64_t interval_ns = atomic_load(&c->interval_ns);
	return json_pack("{s:I, s:I, s:b, s:s, s:s, s:i, s:i, s:i, s:i, s:I, s:I, s:I, s:I, s:f}", "id",
					 (json_int_t)stream->stream_id, "client_id", (json_int_t)client->id, "shown",
					 (int)(shown_client == client->id && shown_stream == stream->stream_id), "client", client->name,
					 "application", application, "pid", (int)client->peer.pid, "uid", (int)client->peer.uid, "width",
					 (int)atomic_load(&c->width), "height", (int)atomic_load(&c->height), "frame_id",
					 (json_int_t)atomic_load(&c->last_frame_id), "real_frames",
					 (json_int_t)atomic_load(&c->real_frames), "refused_frames",
					 (json_int_t)atomic_load(&c->refused_frames), "lost_real_frames",
					 (json_int_t)atomic_load(&c->lost_frames), "fps", interval_ns ? 1e9 / (double)interval_ns : 0.0);
}

json_t *server_streams_json(const struct server *server)
{
	json_t *array = json_array();
	for (const struct client *client = server->clients; client; client = client->next)
		for (uint32_t i = 0; i < PURSUIT_MAX_STREAMS_PER_CLIENT; i++)
			if (client->streams[i].stream)
				json_array_append_new(array, stream_json(server, client, client->streams[i].stream));
	return array;
}
