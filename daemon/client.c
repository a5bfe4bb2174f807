/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/client.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/printable.h"
#include "daemon/version.h"

/* A client that floods gets so many packets read, then the others have their turn. */
#define PACKETS_AT_ONCE 16

static bool may_log(struct client *client)
{
	return log_limit_allows(&client->log_limit, clock_now(client->params->clock));
}

/* ---- life ---- */

struct client *client_create(const struct server_params *params, struct packet *packet, int fd, const struct peer *peer,
							 uint64_t id)
{
	struct client *client = calloc(1, sizeof(*client));
	if (!client)
		return NULL;
	client->peer = *peer;
	client->params = params;
	client->packet = packet;
	client->fd = fd;
	client->process = -1;
	client->id = id;
	client->connected_ns = clock_now(params->clock);
	snprintf(client->name, sizeof(client->name), "process %d", (int)client->peer.pid);
	return client;
}

static void end_stream(struct client_stream *entry)
{
	if (!entry->stream)
		return;
	loop_remove(&entry->wake);
	output_remove_stream(entry->client->params->output, entry->stream);
	entry->client->stream_bytes -= entry->stream->planes_bytes;
	stream_release(&entry->stream);
}

void client_destroy(struct client **client)
{
	struct client *self = *client;
	*client = NULL;
	if (!self)
		return;
	for (uint32_t i = 0; i < PURSUIT_MAX_STREAMS_PER_CLIENT; i++)
		end_stream(&self->streams[i]);
	loop_remove(&self->source);
	loop_remove(&self->process_source);
	if (self->process >= 0)
		close(self->process);
	packet_drain(self->fd);
	close(self->fd);
	free(self);
}

/* ---- sending ---- */

void client_send(struct client *client, const void *message, size_t bytes, int fd)
{
	if (client->gone)
		return;
	const int result = packet_send(client->fd, message, bytes, fd);
	if (result == 0)
		return;
	client->gone = true;
	if (result == -EAGAIN)
		log_warning(client->params->log, "client %s (pid %d) does not read its socket and is dropped", client->name,
					(int)client->peer.pid);
}

void client_refuse(struct client *client, uint32_t serial, uint64_t stream_id, bool fatal,
				   const struct refusal *refusal)
{
	struct pursuit_message_refused message = {
		.header = {.type = PURSUIT_MESSAGE_REFUSED, .size = sizeof(message), .serial = serial},
		.code = refusal->code,
		.fatal = fatal,
		.stream_id = stream_id,
		.value = refusal->value,
	};
	snprintf(message.field, sizeof(message.field), "%s", refusal->field);
	snprintf(message.text, sizeof(message.text), "%s", refusal->text);
	if (refusal->code != PURSUIT_REFUSED_SHUTDOWN && may_log(client))
		log_warning(client->params->log, "client %s (pid %d) refused: %s", client->name, (int)client->peer.pid,
					refusal->text);
	client_send(client, &message, sizeof(message), -1);
	if (fatal)
		client->gone = true;
}

/* A packet that breaks the rules of the wire: the connection ends. */
__attribute__((format(printf, 4, 5))) static void malformed(struct client *client, const char *field, uint64_t value,
															const char *format, ...)
{
	struct refusal refusal = {.code = PURSUIT_REFUSED_MESSAGE, .field = field, .value = value};
	const struct packet *packet = client->packet;
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(refusal.text, sizeof(refusal.text), format, arguments);
	va_end(arguments);
	client_refuse(client, packet->bytes >= sizeof(packet->header) ? packet->header.serial : 0, 0, true, &refusal);
}

/* ---- HELLO ---- */

static void set_name(struct client *client, const char *name)
{
	snprintf(client->name, sizeof(client->name), "%s", *name ? name : "unnamed");
	printable_clean(client->name);
}

static void welcome(struct client *client, uint32_t serial)
{
	struct pursuit_message_welcome message = {
		.header = {.type = PURSUIT_MESSAGE_WELCOME, .size = sizeof(message), .serial = serial},
		.version = PURSUIT_WIRE_VERSION_MAX,
		.max_width = PURSUIT_MAX_SIZE,
		.max_height = PURSUIT_MAX_SIZE,
		.max_streams = client->params->settings->max_streams,
		.max_slots = PURSUIT_MAX_SLOTS,
		.max_slot_bytes = (uint64_t)client->params->settings->max_frame_mb << 20,
		.name = "pursuitd " PURSUITD_VERSION,
	};
	client_send(client, &message, sizeof(message), -1);
}

static void on_hello(struct client *client)
{
	const struct pursuit_message_hello *hello = &client->packet->hello;
	struct refusal refusal;

	if (client->greeted) {
		malformed(client, "type", PURSUIT_MESSAGE_HELLO, "type is 1: a second HELLO on one connection");
	} else if (hello->magic != PURSUIT_WIRE_MAGIC) {
		malformed(client, "magic", hello->magic, "magic is 0x%08" PRIx32 ", must be 0x%08" PRIx32, hello->magic,
				  PURSUIT_WIRE_MAGIC);
	} else if (hello->reserved != 0) {
		malformed(client, "reserved", hello->reserved, "reserved is %" PRIu32 ", must be 0", hello->reserved);
	} else if (!memchr(hello->name, 0, sizeof(hello->name))) {
		malformed(client, "name", sizeof(hello->name), "name has no terminating zero in its 64 bytes");
	} else if (hello->version_min > PURSUIT_WIRE_VERSION_MAX || hello->version_max < PURSUIT_WIRE_VERSION_MIN ||
			   hello->version_min > hello->version_max) {
		const bool newer = hello->version_min > PURSUIT_WIRE_VERSION_MAX;
		refuse(&refusal, -EINVAL, PURSUIT_REFUSED_VERSION, newer ? "version_min" : "version_max",
			   newer ? hello->version_min : hello->version_max,
			   "client speaks versions %" PRIu32 " to %" PRIu32 ", the daemon %u to %u; update the older of the two",
			   hello->version_min, hello->version_max, PURSUIT_WIRE_VERSION_MIN, PURSUIT_WIRE_VERSION_MAX);
		client_refuse(client, hello->header.serial, 0, true, &refusal);
	} else {
		client->greeted = true;
		set_name(client, hello->name);
		log_debug(client->params->log, "client %s (pid %d, uid %u) is here", client->name, (int)client->peer.pid,
				  (unsigned)client->peer.uid);
		welcome(client, hello->header.serial);
	}
}

/* ---- streams ---- */

struct client_stream *client_find_stream(struct client *client, uint64_t stream_id)
{
	for (uint32_t i = 0; i < PURSUIT_MAX_STREAMS_PER_CLIENT; i++)
		if (client->streams[i].stream && client->streams[i].stream->stream_id == stream_id)
			return &client->streams[i];
	return NULL;
}

static struct client_stream *free_entry(struct client *client)
{
	uint32_t open = 0;
	for (uint32_t i = 0; i < PURSUIT_MAX_STREAMS_PER_CLIENT; i++)
		open += client->streams[i].stream != NULL;
	for (uint32_t i = 0; i < PURSUIT_MAX_STREAMS_PER_CLIENT && open < client->params->settings->max_streams; i++)
		if (!client->streams[i].stream)
			return &client->streams[i];
	return NULL;
}

/* The eventfd is watched edge-triggered and never read: the client may have changed its flags. */
static void on_wake(void *data, uint32_t events)
{
	struct client_stream *entry = data;
	(void)events;
	loop_add_work(entry->client->params->loop, 1);
	atomic_store(&entry->stream->wake_ns, clock_now(entry->client->params->clock));
	output_wake(entry->client->params->output);
}

static void say_opened(struct client *client, uint32_t serial, const struct stream *stream)
{
	struct output_info info;
	output_get_info(client->params->output, &info);
	const uint64_t next = grid_at_or_after(&info.grid, clock_now(client->params->clock) + 1);
	const struct pursuit_message_stream_opened message = {
		.header = {.type = PURSUIT_MESSAGE_STREAM_OPENED, .size = sizeof(message), .serial = serial},
		.stream_id = stream->stream_id,
		.refresh_numerator = info.grid.numerator,
		.refresh_denominator = info.grid.denominator,
		.next_vblank_ns = grid_time(&info.grid, next),
	};
	client_send(client, &message, sizeof(message), stream->wake_fd);
}

/* Registers with loop and output; the entry owns the stream from here on. */
static int enter_stream(struct client *client, struct client_stream *entry, struct stream *stream,
						struct refusal *refusal)
{
	entry->client = client;
	entry->stream = stream;
	entry->wants_keys = client->packet->open.flags & PURSUIT_OPEN_KEYS;
	client->stream_bytes += stream->planes_bytes;
	entry->wake = loop_add(client->params->loop, stream->wake_fd, EPOLLIN | EPOLLET, on_wake, entry);
	if (entry->wake && output_add_stream(client->params->output, stream))
		return 0;
	loop_remove(&entry->wake);
	client->stream_bytes -= stream->planes_bytes;
	stream_release(&entry->stream);
	return refuse(refusal, -ENOSPC, PURSUIT_REFUSED_LIMIT, "", OUTPUT_STREAMS,
				  "the daemon has no room for another stream (%u)", OUTPUT_STREAMS);
}

/* Absurd numbers are refused for what they are, later. */
static bool fits_client(const struct client *client, const struct pursuit_message_open_stream *open)
{
	const uint64_t most = (uint64_t)client->params->settings->max_client_mb << 20;
	uint64_t bytes;
	if (open->slot_count > PURSUIT_MAX_SLOTS || __builtin_mul_overflow(open->slot_bytes, open->slot_count, &bytes))
		return true;
	return client->stream_bytes <= most && bytes <= most - client->stream_bytes;
}

static int open_stream(struct client *client, struct refusal *refusal)
{
	const struct pursuit_message_open_stream *open = &client->packet->open;
	char application[EXECUTABLE_NAME_BYTES];
	executable_of(client->fd, client->peer.pid, application);
	const struct stream_params params = {
		.client_id = client->id,
		.stream_id = open->stream_id,
		.opened = client->opened,
		.client_name = client->name,
		.application = application,
		.slot_count = open->slot_count,
		.slot_bytes = open->slot_bytes,
		.max_slot_bytes = (uint64_t)client->params->settings->max_frame_mb << 20,
	};
	struct client_stream *entry = free_entry(client);
	if (client_find_stream(client, open->stream_id))
		return refuse(refusal, -EEXIST, PURSUIT_REFUSED_IN_USE, "stream_id", open->stream_id,
					  "stream_id is %" PRIu64 ", which is open already on this connection", open->stream_id);
	if (!entry)
		return refuse(refusal, -ENOSPC, PURSUIT_REFUSED_LIMIT, "stream_id", open->stream_id,
					  "stream_id is %" PRIu64 ": a client may have %u streams open, and has (max-streams)",
					  open->stream_id, client->params->settings->max_streams);
	if (!fits_client(client, open))
		return refuse(refusal, -ENOSPC, PURSUIT_REFUSED_LIMIT, "slot_bytes", open->slot_bytes,
					  "slot_bytes is %" PRIu64 " in %" PRIu32 " slots: with %" PRIu64
					  " bytes open that is more than a client may offer (max-client-mb)",
					  open->slot_bytes, open->slot_count, client->stream_bytes);
	struct stream *stream = stream_create(&params, client->packet->fds[0], client->packet->fds[1], refusal);
	if (!stream)
		return -EINVAL;
	client->opened++;
	const int result = enter_stream(client, entry, stream, refusal);
	if (result < 0)
		return result;
	log_info(client->params->log, "stream %" PRIu64 " of %s (pid %d) opened: %" PRIu32 " slots of %" PRIu64 " bytes",
			 open->stream_id, client->name, (int)client->peer.pid, open->slot_count, open->slot_bytes);
	say_opened(client, open->header.serial, stream);
	return 0;
}

static void on_open_stream(struct client *client)
{
	const struct pursuit_message_open_stream *open = &client->packet->open;
	struct refusal refusal;
	if (client->packet->fd_count != 2)
		malformed(client, "fds", client->packet->fd_count,
				  "fds is %" PRIu32 ", must be 2: the control memfd and the planes memfd", client->packet->fd_count);
	else if (open->flags & ~PURSUIT_OPEN_KEYS)
		malformed(client, "flags", open->flags, "flags is %" PRIu32 ", must be 0 or 1", open->flags);
	else if (open->reserved[0] | open->reserved[1] | open->reserved[2])
		malformed(client, "reserved", open->reserved[0] | open->reserved[1] | open->reserved[2], "reserved is not 0");
	else if (open_stream(client, &refusal) < 0)
		client_refuse(client, open->header.serial, open->stream_id, false, &refusal);
}

void client_close_stream(struct client_stream *entry, uint32_t serial)
{
	struct client *client = entry->client;
	const struct pursuit_message_close_stream message = {
		.header = {.type = PURSUIT_MESSAGE_STREAM_CLOSED, .size = sizeof(message), .serial = serial},
		.stream_id = entry->stream->stream_id,
	};
	log_info(client->params->log, "stream %" PRIu64 " of %s closed", message.stream_id, client->name);
	end_stream(entry);
	client_send(client, &message, sizeof(message), -1);
}

static void on_close_stream(struct client *client)
{
	const struct pursuit_message_close_stream *close_stream = &client->packet->close;
	struct client_stream *entry = client_find_stream(client, close_stream->stream_id);
	struct refusal refusal;
	if (close_stream->reserved != 0) {
		malformed(client, "reserved", close_stream->reserved, "reserved is %" PRIu64 ", must be 0",
				  close_stream->reserved);
	} else if (!entry) {
		refuse(&refusal, -ENOENT, PURSUIT_REFUSED_VALUE, "stream_id", close_stream->stream_id,
			   "stream_id is %" PRIu64 ", which is not open on this connection", close_stream->stream_id);
		client_refuse(client, close_stream->header.serial, close_stream->stream_id, false, &refusal);
	} else {
		client_close_stream(entry, close_stream->header.serial);
	}
}

/* ---- CONTROL ---- */

static void on_control(struct client *client)
{
	struct packet *packet = client->packet;
	const struct pursuit_message_control *control = &packet->control;
	char *text = (char *)packet->raw + sizeof(*control);

	if (control->text_bytes != packet->bytes - sizeof(*control)) {
		malformed(client, "text_bytes", control->text_bytes, "text_bytes is %" PRIu32 ", but the packet has %zu",
				  control->text_bytes, packet->bytes - sizeof(*control));
	} else if (control->status != 0 || control->reserved != 0) {
		malformed(client, control->status ? "status" : "reserved",
				  control->status ? control->status : control->reserved, "%s is not 0",
				  control->status ? "status" : "reserved");
	} else if (memchr(text, 0, control->text_bytes)) {
		malformed(client, "text", 0, "text holds a zero byte");
	} else {
		text[control->text_bytes] = 0; /* the buffer has one byte more than a packet */
		const bool wants_fd = strcmp(text, "record") == 0;
		if (packet->fd_count > (wants_fd ? 1u : 0u))
			malformed(client, "fds", packet->fd_count, "fds is %" PRIu32 ", must be %s", packet->fd_count,
					  wants_fd ? "1: a file open for writing" : "0 with this request");
		else
			client->params->control(client->params->data, client->id, control->header.serial, text,
									packet->fd_count ? packet_take_fd(packet, 0) : -1);
	}
}

/* ---- receiving ---- */

static const struct {
	uint32_t type;
	size_t bytes;   /* of the message without text */
	bool text, fds; /* may have them */
	void (*handle)(struct client *client);
} messages[] = {
	{PURSUIT_MESSAGE_HELLO, sizeof(struct pursuit_message_hello), false, false, on_hello},
	{PURSUIT_MESSAGE_OPEN_STREAM, sizeof(struct pursuit_message_open_stream), false, true, on_open_stream},
	{PURSUIT_MESSAGE_CLOSE_STREAM, sizeof(struct pursuit_message_close_stream), false, false, on_close_stream},
	{PURSUIT_MESSAGE_CONTROL, sizeof(struct pursuit_message_control), true, true, on_control},
};

/* What every packet must be. */
static bool check_packet(struct client *client)
{
	const struct packet *packet = client->packet;
	if (packet->too_long)
		malformed(client, "size", packet->bytes, "the packet is longer than %u bytes", PURSUIT_WIRE_MAX_PACKET);
	else if (packet->bytes < sizeof(packet->header))
		malformed(client, "size", packet->bytes, "the packet has %zu bytes, must have at least %zu", packet->bytes,
				  sizeof(packet->header));
	else if (packet->fds_lost)
		malformed(client, "fds", PACKET_FDS, "the packet has too many file descriptors");
	else if (packet->header.size != packet->bytes)
		malformed(client, "size", packet->header.size, "size is %" PRIu32 ", but the packet has %zu bytes",
				  packet->header.size, packet->bytes);
	else if (packet->header.reserved != 0)
		malformed(client, "reserved", packet->header.reserved, "reserved is %" PRIu32 ", must be 0",
				  packet->header.reserved);
	else
		return true;
	return false;
}

static void dispatch(struct client *client)
{
	const struct packet *packet = client->packet;
	const uint32_t type = packet->header.type;
	size_t i = 0;
	while (i < sizeof(messages) / sizeof(messages[0]) && messages[i].type != type)
		i++;
	if (i == sizeof(messages) / sizeof(messages[0]))
		malformed(client, "type", type, "type is %" PRIu32 ", which no client sends", type);
	else if (packet->bytes < messages[i].bytes || (packet->bytes > messages[i].bytes && !messages[i].text))
		malformed(client, "size", packet->bytes, "a packet of type %" PRIu32 " has %zu bytes, must have %zu", type,
				  packet->bytes, messages[i].bytes);
	else if (packet->fd_count > 0 && !messages[i].fds)
		malformed(client, "fds", packet->fd_count, "fds is %" PRIu32 ", must be 0 in a packet of type %" PRIu32,
				  packet->fd_count, type);
	else if (!client->greeted && type != PURSUIT_MESSAGE_HELLO)
		malformed(client, "type", type, "type is %" PRIu32 ", must be 1: HELLO comes first", type);
	else
		messages[i].handle(client);
}

/* A client that sends without end costs the others time. */
static bool within_rate(struct client *client)
{
	const uint64_t second = clock_now(client->params->clock) / UINT64_C(1000000000);
	const uint32_t most = client->params->settings->max_messages;
	struct refusal refusal;
	if (second != client->rate.second)
		client->rate = (struct message_rate){.second = second};
	if (client->rate.count++ < most)
		return true;
	refuse(&refusal, -EBUSY, PURSUIT_REFUSED_LIMIT, "messages", most,
		   "messages in a second are more than %" PRIu32 ", the most of a client (max-messages)", most);
	client_refuse(client, 0, 0, true, &refusal);
	return false;
}

void client_read(struct client *client, uint32_t events)
{
	for (int i = 0; i < PACKETS_AT_ONCE && !client->gone; i++) {
		const int got = packet_receive(client->fd, client->packet);
		if (got == 0 && (events & (EPOLLHUP | EPOLLERR)))
			client->gone = true;
		if (got < 0)
			client->gone = true;
		if (got <= 0)
			return;
		loop_add_work(client->params->loop, 1);
		if (within_rate(client) && check_packet(client))
			dispatch(client);
		packet_finish(client->packet);
	}
}
