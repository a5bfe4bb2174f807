/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/attach.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define MS UINT64_C(1000000)
#define FIRST_DELAY (5 * MS)
#define LAST_DELAY (25 * MS)
#define REFUSED_DELAY (2000 * MS)
#define BROKEN_DELAY (1000 * MS)
#define PATIENCE (5000 * MS)
/* A daemon that floods us with packets gets this many read in one step. */
#define PACKETS_PER_STEP 8
/* One stream a connection, so its id never changes. */
#define STREAM_ID 1u

static void add_path(struct shim_attach *attach, const char *folder, const char *file)
{
	snprintf(attach->paths[attach->path_count++], SHIM_PATH_BYTES, "%s%s", folder, file);
}

static void find_paths(struct shim_attach *attach)
{
	const char *given = secure_getenv("PURSUIT_SOCKET");
	const char *runtime = secure_getenv("XDG_RUNTIME_DIR");

	if (given && *given) {
		add_path(attach, given, "");
		return;
	}
	if (runtime && *runtime) {
		add_path(attach, runtime, "/pursuit/socket");
	}
	add_path(attach, "/run", "/pursuit/socket");
}

bool shim_attach_init(struct shim_attach *attach, const char *socket_path, const char *name)
{
	memset(attach, 0, sizeof(*attach));
	attach->socket = -1;
	attach->wake = -1;
	attach->delay_ns = FIRST_DELAY;
	snprintf(attach->name, sizeof(attach->name), "%s", name ? name : program_invocation_short_name);
	snprintf(attach->message, sizeof(attach->message), "not tried yet");
	if (!socket_path) {
		find_paths(attach);
		return true;
	}
	add_path(attach, socket_path, "");
	return strlen(socket_path) < sizeof(((struct sockaddr_un *)NULL)->sun_path);
}

void shim_attach_finish(struct shim_attach *attach)
{
	/* A child that was forked may keep the connection open. */
	if (attach->socket >= 0 && attach->process == getpid()) {
		shutdown(attach->socket, SHUT_RDWR);
	}
	shim_close_fd(&attach->socket);
	shim_close_fd(&attach->wake);
	shim_slots_destroy(&attach->offered);
}

/* Leaves the connection; the next try is `delay` away. */
__attribute__((format(printf, 5, 6))) static void leave(struct shim_attach *attach, enum pursuit_state state,
														uint64_t now_ns, uint64_t delay, const char *format, ...)
{
	va_list arguments;

	shim_attach_finish(attach);
	attach->state = state;
	attach->greeted = false;
	attach->complained = false;
	attach->next_try_ns = now_ns + delay;
	va_start(arguments, format);
	vsnprintf(attach->message, sizeof(attach->message), format, arguments);
	va_end(arguments);
}

static const char *error_text(int code, char *buffer, size_t size)
{
	return strerror_r(code, buffer, size);
}

/* A daemon that is not there, or this process out of something: tried again soon. */
static void leave_for_now(struct shim_attach *attach, uint64_t now_ns, const char *what, const char *path, int code)
{
	char buffer[64];

	leave(attach, PURSUIT_STATE_DETACHED, now_ns, attach->delay_ns, "%s %.100s: %s", what, path,
		  error_text(code, buffer, sizeof(buffer)));
	attach->delay_ns = attach->delay_ns * 2 < LAST_DELAY ? attach->delay_ns * 2 : LAST_DELAY;
}

static int send_hello(struct shim_attach *attach)
{
	struct pursuit_message_hello hello = {
		.header = {.type = PURSUIT_MESSAGE_HELLO, .size = sizeof(hello), .serial = 1},
		.magic = PURSUIT_WIRE_MAGIC,
		.version_min = PURSUIT_WIRE_VERSION_MIN,
		.version_max = PURSUIT_WIRE_VERSION_MAX,
	};

	memcpy(hello.name, attach->name, sizeof(hello.name));
	return shim_packet_send(attach->socket, &hello, sizeof(hello), NULL, 0);
}

static int send_open_stream(struct shim_attach *attach, const struct shim_layout *layout)
{
	struct pursuit_message_open_stream open = {
		.header = {.type = PURSUIT_MESSAGE_OPEN_STREAM, .size = sizeof(open), .serial = 2},
		.stream_id = STREAM_ID,
		.slot_count = layout->slot_count,
		.slot_bytes = layout->slot_bytes,
		.flags = attach->wants_keys ? PURSUIT_OPEN_KEYS : 0,
	};
	const int fds[2] = {attach->offered->control_fd, attach->offered->planes_fd};

	return shim_packet_send(attach->socket, &open, sizeof(open), fds, 2);
}

static int offer_slots(struct shim_attach *attach, const struct shim_layout *layout)
{
	attach->offered = shim_slots_create_shared(layout);
	if (!attach->offered) {
		return -errno;
	}
	int result = send_hello(attach);
	if (result == 0) {
		result = send_open_stream(attach, layout);
	}
	shim_slots_forget_fds(attach->offered);
	return result;
}

static void try_to_connect(struct shim_attach *attach, const struct shim_layout *layout, uint64_t now_ns)
{
	const char *path = "";
	int result = -ENOENT, why = ENOENT;

	/* Told is the one that answers, else the first one where there is something, else the first. */
	for (uint32_t i = 0; i < attach->path_count && result < 0; i++) {
		result = shim_packet_connect(attach->paths[i]);
		if (i == 0 || result >= 0 || (why == ENOENT && result != -ENOENT)) {
			path = attach->paths[i];
			why = -result;
		}
	}
	if (result < 0) {
		leave_for_now(attach, now_ns, "no daemon at", path, why);
		return;
	}
	attach->socket = result;
	attach->process = getpid();
	result = offer_slots(attach, layout);
	if (result < 0) {
		leave_for_now(attach, now_ns, "cannot offer a stream to the daemon at", path, -result);
		return;
	}
	attach->state = PURSUIT_STATE_ATTACHING;
	attach->give_up_ns = now_ns + PATIENCE;
	snprintf(attach->message, sizeof(attach->message), "waiting for the daemon at %.100s", path);
}

/* An eventfd has no file type; a pipe, socket, device or file could block or signal the game. */
static bool wake_is_safe(int fd)
{
	const uint64_t nothing = 0;
	struct stat status;
	int flags = fcntl(fd, F_GETFL);

	if (fstat(fd, &status) < 0 || (status.st_mode & S_IFMT) != 0 || flags < 0) {
		return false;
	}
	if (!(flags & O_NONBLOCK) && fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0) {
		return false;
	}
	return write(fd, &nothing, sizeof(nothing)) == (ssize_t)sizeof(nothing);
}

static double refresh_of(const struct pursuit_message_stream_opened *opened)
{
	if (opened->refresh_denominator == 0) {
		return 0.0;
	}
	double hz = (double)opened->refresh_numerator / (double)opened->refresh_denominator;
	return hz >= 1.0 && hz <= 10000.0 ? hz : 0.0;
}

/* Handlers return NULL, or what is wrong with the packet. */
static const char *on_welcome(struct shim_attach *attach, const struct shim_packet *packet)
{
	if (packet->bytes != sizeof(packet->welcome) || packet->fd_count > 0) {
		return "a malformed WELCOME";
	}
	if (attach->greeted || attach->state != PURSUIT_STATE_ATTACHING) {
		return "a second WELCOME";
	}
	if (packet->welcome.version < PURSUIT_WIRE_VERSION_MIN || packet->welcome.version > PURSUIT_WIRE_VERSION_MAX) {
		return "a WELCOME with a version that was not offered";
	}
	attach->greeted = true;
	return NULL;
}

static const char *on_stream_opened(struct shim_attach *attach, struct shim_packet *packet,
									enum shim_attach_change *change)
{
	if (packet->bytes != sizeof(packet->opened) || packet->opened.stream_id != STREAM_ID) {
		return "a malformed STREAM_OPENED";
	}
	if (!attach->greeted || attach->state != PURSUIT_STATE_ATTACHING) {
		return "a STREAM_OPENED out of turn";
	}
	attach->wake = shim_packet_take_fd(packet);
	if (attach->wake < 0 || !wake_is_safe(attach->wake)) {
		return "a STREAM_OPENED without one eventfd";
	}
	attach->state = PURSUIT_STATE_ATTACHED;
	attach->delay_ns = FIRST_DELAY;
	attach->refresh_hz = refresh_of(&packet->opened);
	snprintf(attach->message, sizeof(attach->message), "attached");
	*change = SHIM_ATTACH_GAINED;
	return NULL;
}

/* Text of another program, to be shown by ours: terminated, and without control characters. */
static void clean(char *text, size_t size)
{
	text[size - 1] = '\0';
	for (; *text; text++) {
		if ((unsigned char)*text < ' ' || *text == '\x7f') {
			*text = ' ';
		}
	}
}

static const char *on_refused(struct shim_attach *attach, struct shim_packet *packet, uint64_t now_ns)
{
	struct pursuit_message_refused *refused = &packet->refused;
	bool attached = attach->state == PURSUIT_STATE_ATTACHED;

	if (packet->bytes != sizeof(*refused) || packet->fd_count > 0) {
		return "a malformed REFUSED";
	}
	clean(refused->text, sizeof(refused->text));
	if (refused->code == PURSUIT_REFUSED_SHUTDOWN) {
		leave(attach, PURSUIT_STATE_DETACHED, now_ns, FIRST_DELAY, "%s", refused->text);
	} else if (refused->fatal || !attached) {
		leave(attach, PURSUIT_STATE_REFUSED, now_ns, REFUSED_DELAY, "%s", refused->text);
	} else {
		attach->complained = true;
		snprintf(attach->message, sizeof(attach->message), "%s", refused->text);
	}
	return NULL;
}

/* A stream that is closed after a complaint was refused; the complaint is why. */
static void on_stream_closed(struct shim_attach *attach, uint64_t now_ns)
{
	char why[SHIM_MESSAGE_BYTES];

	memcpy(why, attach->message, sizeof(why));
	if (attach->complained) {
		leave(attach, PURSUIT_STATE_REFUSED, now_ns, REFUSED_DELAY, "%s", why);
	} else {
		leave(attach, PURSUIT_STATE_DETACHED, now_ns, BROKEN_DELAY, "the daemon closed the stream");
	}
}

static const char *on_key(struct shim_attach *attach, const struct shim_packet *packet)
{
	const struct pursuit_message_key *message = &packet->key;

	if (packet->bytes != sizeof(*message) || packet->fd_count > 0) {
		return "a malformed KEY";
	}
	if (!attach->wants_keys || attach->state != PURSUIT_STATE_ATTACHED) {
		return "a KEY that nobody asked for";
	}
	attach->keys[attach->keys_put++ % SHIM_KEYS] =
		(struct pursuit_key){.time_ns = message->time_ns, .code = message->code};
	return NULL;
}

bool shim_attach_next_key(struct shim_attach *attach, struct pursuit_key *key)
{
	if (attach->keys_put - attach->keys_taken > SHIM_KEYS) {
		attach->keys_taken = attach->keys_put - SHIM_KEYS;
	}
	if (attach->keys_taken == attach->keys_put) {
		return false;
	}
	*key = attach->keys[attach->keys_taken++ % SHIM_KEYS];
	return true;
}

static const char *on_packet(struct shim_attach *attach, struct shim_packet *packet, uint64_t now_ns,
							 enum shim_attach_change *change)
{
	if (packet->truncated || packet->fds_lost || packet->bytes < sizeof(packet->header) ||
		packet->header.size != packet->bytes) {
		return packet->fds_lost ? "file descriptors that did not fit" : "a packet of the wrong size";
	}
	switch (packet->header.type) {
	case PURSUIT_MESSAGE_WELCOME:
		return on_welcome(attach, packet);
	case PURSUIT_MESSAGE_STREAM_OPENED:
		return on_stream_opened(attach, packet, change);
	case PURSUIT_MESSAGE_REFUSED:
		return on_refused(attach, packet, now_ns);
	case PURSUIT_MESSAGE_KEY:
		return on_key(attach, packet);
	case PURSUIT_MESSAGE_STREAM_CLOSED:
		on_stream_closed(attach, now_ns);
		return NULL;
	default:
		return "a packet of unknown type";
	}
}

static enum shim_attach_change read_packets(struct shim_attach *attach, uint64_t now_ns)
{
	enum shim_attach_change change = SHIM_ATTACH_SAME;
	struct shim_packet packet;

	for (int i = 0; i < PACKETS_PER_STEP && attach->socket >= 0; i++) {
		int got = shim_packet_receive(attach->socket, &packet);
		if (got == 0) {
			break;
		}
		if (got < 0) {
			leave(attach, PURSUIT_STATE_DETACHED, now_ns, FIRST_DELAY, "the daemon is gone");
			break;
		}
		const char *wrong = on_packet(attach, &packet, now_ns, &change);
		shim_packet_finish(&packet);
		if (wrong) {
			leave(attach, PURSUIT_STATE_DETACHED, now_ns, BROKEN_DELAY, "not a daemon of ours: it sent %s", wrong);
		}
	}
	/* Gained and lost in one step: `offered` went with the connection. */
	return attach->state == PURSUIT_STATE_ATTACHED ? change : SHIM_ATTACH_SAME;
}

enum shim_attach_change shim_attach_step(struct shim_attach *attach, const struct shim_layout *layout, uint64_t now_ns)
{
	bool was_attached = attach->state == PURSUIT_STATE_ATTACHED;

	if (attach->socket < 0) {
		if (now_ns >= attach->next_try_ns) {
			try_to_connect(attach, layout, now_ns);
		}
		return SHIM_ATTACH_SAME;
	}
	if (attach->process != getpid()) {
		leave(attach, PURSUIT_STATE_DETACHED, now_ns, 0, "this process was forked from the one that was attached");
		return was_attached ? SHIM_ATTACH_LOST : SHIM_ATTACH_SAME;
	}
	enum shim_attach_change change = read_packets(attach, now_ns);
	if (attach->state == PURSUIT_STATE_ATTACHING && now_ns >= attach->give_up_ns) {
		leave(attach, PURSUIT_STATE_DETACHED, now_ns, LAST_DELAY, "the daemon does not answer");
	}
	return was_attached && attach->state != PURSUIT_STATE_ATTACHED ? SHIM_ATTACH_LOST : change;
}

void shim_attach_wake(struct shim_attach *attach)
{
	const uint64_t one = 1;
	struct pollfd wake = {.fd = attach->wake, .events = POLLOUT};

	/*
	 * The file is shared, so the daemon can fill the counter and clear O_NONBLOCK at any time.
	 * If the counter is full, the daemon has not lost the wake-up.
	 */
	if (poll(&wake, 1, 0) == 1 && (wake.revents & POLLOUT)) {
		ssize_t written = write(attach->wake, &one, sizeof(one));
		(void)written;
	}
}

void shim_attach_break(struct shim_attach *attach, uint64_t now_ns, const char *why)
{
	leave(attach, PURSUIT_STATE_DETACHED, now_ns, BROKEN_DELAY, "%s", why);
}
