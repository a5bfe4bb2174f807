/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "control.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto/wire.h"

#define ANSWER_LIMIT_MS 10000
#define RECORDING_LIMIT_MS 600000 /* what is still to be compressed and written may fill memory */
#define MACHINE_SOCKET "/run/pursuit/socket"

/* A packet as it comes. */
union packet {
	struct pursuit_message header;
	struct pursuit_message_welcome welcome;
	struct pursuit_message_refused refused;
	struct pursuit_message_control control;
	uint8_t bytes[PURSUIT_WIRE_MAX_PACKET];
};

/* Of the folder's file. 0, -ENOENT if there is nothing, or another errno with a sentence. */
static int dial(struct control *control, const char *folder, const char *file, struct error *error)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int length = snprintf(address.sun_path, sizeof(address.sun_path), "%s%s", folder, file);
	if (length < 0 || (size_t)length >= sizeof(address.sun_path))
		return error_set(error, -ENAMETOOLONG, "%s%s: the path of a socket has at most %zu bytes", folder, file,
						 sizeof(address.sun_path) - 1);
	control->fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	if (control->fd < 0)
		return error_set(error, -errno, "no socket: %s", strerror(errno));
	if (connect(control->fd, (const struct sockaddr *)&address, sizeof(address)) == 0)
		return 0;
	const int result =
		error_set(error, -errno, "no daemon at %s (%s). Start one: pursuitd", address.sun_path, strerror(errno));
	control_close(control);
	return result;
}

/* As games have it: the user's own daemon, else the machine's. Told is the first, or the first one that is there. */
static int dial_usual(struct control *control, struct error *error)
{
	const char *named = getenv("PURSUIT_SOCKET"), *runtime = getenv("XDG_RUNTIME_DIR");
	struct error other = {""};
	if (named && *named)
		return dial(control, named, "", error);
	if (!runtime || !*runtime)
		return dial(control, MACHINE_SOCKET, "", error);
	int result = dial(control, runtime, "/pursuit/socket", error);
	if (result == 0)
		return 0;
	const int second = dial(control, MACHINE_SOCKET, "", &other);
	if (second == 0 || (result == -ENOENT && second != -ENOENT)) {
		*error = other;
		result = second;
	}
	return result;
}

/* Receives one packet. 0 or a negative errno with a sentence. */
static int receive(struct control *control, int limit_ms, union packet *packet, struct error *error)
{
	struct pollfd wait = {.fd = control->fd, .events = POLLIN};
	int ready;
	do {
		ready = poll(&wait, 1, limit_ms);
	} while (ready < 0 && errno == EINTR);
	if (ready == 0)
		return error_set(error, -ETIMEDOUT, "the daemon did not answer within %d s", limit_ms / 1000);
	ssize_t length = recv(control->fd, packet, sizeof(*packet), MSG_CMSG_CLOEXEC);
	if (length < 0)
		return error_set(error, -errno, "the connection to the daemon broke: %s", strerror(errno));
	if (length == 0)
		return error_set(error, -ECONNRESET, "the daemon closed the connection");
	if ((size_t)length < sizeof(packet->header) || packet->header.size != (size_t)length)
		return error_set(error, -EPROTO, "the daemon sent a packet of %zd bytes that says it has %u", length,
						 (size_t)length < sizeof(packet->header) ? 0 : packet->header.size);
	return 0;
}

static int refused(const union packet *packet, struct error *error)
{
	if (packet->header.size < sizeof(packet->refused))
		return error_set(error, -EPROTO, "the daemon refused without a reason");
	return error_set(error, -ECONNREFUSED, "the daemon refused: %.*s", (int)sizeof(packet->refused.text),
					 packet->refused.text);
}

static int greet(struct control *control, struct error *error)
{
	union packet packet;
	const struct pursuit_message_hello hello = {
		.header = {PURSUIT_MESSAGE_HELLO, sizeof(hello), ++control->serial, 0},
		.magic = PURSUIT_WIRE_MAGIC,
		.version_min = PURSUIT_WIRE_VERSION_MIN,
		.version_max = PURSUIT_WIRE_VERSION_MAX,
		.name = "pursuit",
	};
	if (send(control->fd, &hello, sizeof(hello), MSG_NOSIGNAL) < 0)
		return error_set(error, -errno, "the connection to the daemon broke: %s", strerror(errno));
	int result = receive(control, ANSWER_LIMIT_MS, &packet, error);
	if (result < 0)
		return result;
	if (packet.header.type == PURSUIT_MESSAGE_REFUSED)
		return refused(&packet, error);
	if (packet.header.type != PURSUIT_MESSAGE_WELCOME)
		return error_set(error, -EPROTO, "the daemon answered HELLO with a message of type %u", packet.header.type);
	return 0;
}

int control_open(struct control *control, const char *path, struct error *error)
{
	*control = (struct control){.fd = -1};
	int result = path && *path ? dial(control, path, "", error) : dial_usual(control, error);
	if (result == 0)
		result = greet(control, error);
	if (result < 0)
		control_close(control);
	return result;
}

void control_close(struct control *control)
{
	if (control->fd >= 0)
		close(control->fd);
	control->fd = -1;
}

static int send_text(struct control *control, const char *text, int fd, struct error *error)
{
	size_t length = strlen(text);
	struct pursuit_message_control head = {
		.header = {PURSUIT_MESSAGE_CONTROL, (uint32_t)(sizeof(head) + length), ++control->serial, 0},
		.text_bytes = (uint32_t)length,
	};
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(sizeof(int))];
	} rights = {.bytes = {0}};
	if (length > PURSUIT_WIRE_MAX_PACKET - sizeof(head))
		return error_set(error, -E2BIG, "a request has at most %zu bytes", PURSUIT_WIRE_MAX_PACKET - sizeof(head));
	struct iovec parts[2] = {{&head, sizeof(head)}, {(void *)(uintptr_t)text, length}};
	struct msghdr message = {.msg_iov = parts, .msg_iovlen = 2};
	if (fd >= 0) {
		message.msg_control = rights.bytes;
		message.msg_controllen = sizeof(rights.bytes);
		struct cmsghdr *attached = CMSG_FIRSTHDR(&message);
		attached->cmsg_level = SOL_SOCKET;
		attached->cmsg_type = SCM_RIGHTS;
		attached->cmsg_len = CMSG_LEN(sizeof(int));
		memcpy(CMSG_DATA(attached), &fd, sizeof(fd));
	}
	if (sendmsg(control->fd, &message, MSG_NOSIGNAL) < 0)
		return error_set(error, -errno, "the connection to the daemon broke: %s", strerror(errno));
	return 0;
}

static json_t *read_reply(const char *text, size_t length)
{
	json_t *json = json_loadb(text, length, JSON_DECODE_ANY, NULL);
	return json ? json : json_stringn(text, length);
}

static int ask(struct control *control, const char *text, int fd, int limit_ms, json_t **reply, struct error *error)
{
	union packet packet;
	int result = send_text(control, text, fd, error);
	if (result == 0)
		result = receive(control, limit_ms, &packet, error);
	if (result < 0)
		return result;
	if (packet.header.type == PURSUIT_MESSAGE_REFUSED)
		return refused(&packet, error);
	size_t length = packet.header.size - sizeof(packet.control);
	if (packet.header.type != PURSUIT_MESSAGE_CONTROL_REPLY || packet.header.size < sizeof(packet.control) ||
		packet.control.text_bytes != length)
		return error_set(error, -EPROTO, "the daemon answered with a message of type %u and %u bytes",
						 packet.header.type, packet.header.size);
	const char *answer = (const char *)packet.bytes + sizeof(packet.control);
	if (packet.control.status)
		return error_set(error, -(int)packet.control.status, "the daemon says: %.*s",
						 (int)(length < 400 ? length : 400), answer);
	if (reply)
		*reply = read_reply(answer, length);
	return 0;
}

int control_ask(struct control *control, const char *text, int fd, json_t **reply, struct error *error)
{
	return ask(control, text, fd, ANSWER_LIMIT_MS, reply, error);
}

int control_end_recording(struct control *control, json_t **reply, struct error *error)
{
	return ask(control, "record-stop", -1, RECORDING_LIMIT_MS, reply, error);
}

/* The daemon's `name = value` lines as an object, in their order. */
static json_t *read_settings(const char *text)
{
	json_t *object = json_object();
	while (text && *text) {
		const size_t length = strcspn(text, "\n");
		const char *equals = strstr(text, " = ");
		char name[64];
		if (equals && equals < text + length && (size_t)(equals - text) < sizeof(name)) {
			snprintf(name, sizeof(name), "%.*s", (int)(equals - text), text);
			json_object_set_new(object, name, json_stringn(equals + 3, (size_t)(text + length - equals) - 3));
		}
		text += length + (text[length] == '\n');
	}
	return object;
}

int control_ask_settings(struct control *control, json_t **settings, struct error *error)
{
	json_t *reply = NULL;
	const int result = control_ask(control, "settings", -1, &reply, error);
	if (result == 0)
		*settings = read_settings(json_string_value(reply));
	json_decref(reply);
	return result;
}
