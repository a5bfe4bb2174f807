/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Messages on the socket: AF_UNIX, SOCK_SEQPACKET, one message a packet.
 *
 * Every message starts with struct pursuit_message. `size` is the size of the
 * whole packet. A packet that is shorter or longer, an unknown type, reserved
 * bytes that are not zero, or file descriptors where none belong end the
 * connection with a REFUSED that names the field.
 *
 *   client                                   daemon
 *     HELLO {versions, name}         ->
 *                                    <-        WELCOME {version, limits}
 *     OPEN_STREAM {id, slots} + 2 fd ->
 *                                    <-        STREAM_OPENED {id, display} + 1 fd
 *     (frames travel in shared memory; one write to the eventfd wakes)
 *     CLOSE_STREAM {id}              ->
 *                                    <-        STREAM_CLOSED {id}
 *     CONTROL {text}                 ->
 *                                    <-        CONTROL_REPLY {status, text}
 *   at any time                      <-        REFUSED {code, field, value, text}
 *   a key was pressed                <-        KEY {id, code, time}
 *
 * File descriptors travel as SCM_RIGHTS: with OPEN_STREAM the control memfd
 * and the planes memfd, in this order; with STREAM_OPENED the eventfd, made by
 * the daemon, that the client writes to after each publication. The daemon
 * watches it edge-triggered and never reads it. With CONTROL "record" one file
 * open for writing.
 *
 * OPEN_STREAM may follow HELLO at once, without waiting for WELCOME. A REFUSED
 * with fatal 0 leaves the connection open: it refuses only the request with its
 * serial, or with serial 0 says that the named stream ended or a frame was bad.
 *
 * The daemon sends with MSG_DONTWAIT only; a client that does not read its
 * socket is dropped when the socket is full, never waited for.
 */
#ifndef PURSUIT_PROTO_WIRE_H
#define PURSUIT_PROTO_WIRE_H

#include <stdint.h>

#define PURSUIT_WIRE_MAGIC UINT32_C(0x54495550) /* "PUIT" */
/* The oldest and the newest version that this source speaks. */
#define PURSUIT_WIRE_VERSION_MIN 1u
#define PURSUIT_WIRE_VERSION_MAX 1u
/* No packet is longer. */
#define PURSUIT_WIRE_MAX_PACKET 65536u
#define PURSUIT_MAX_STREAMS_PER_CLIENT 4u

#define PURSUIT_MESSAGE_HELLO 1u
#define PURSUIT_MESSAGE_WELCOME 2u
#define PURSUIT_MESSAGE_REFUSED 3u
#define PURSUIT_MESSAGE_OPEN_STREAM 4u
#define PURSUIT_MESSAGE_STREAM_OPENED 5u
#define PURSUIT_MESSAGE_CLOSE_STREAM 6u
#define PURSUIT_MESSAGE_STREAM_CLOSED 7u
#define PURSUIT_MESSAGE_CONTROL 8u
#define PURSUIT_MESSAGE_CONTROL_REPLY 9u
#define PURSUIT_MESSAGE_KEY 10u

/* 16 bytes. */
struct pursuit_message {
	uint32_t type;
	uint32_t size;   /* bytes of the whole packet, this header included */
	uint32_t serial; /* chosen by the client, repeated in the answer; 0 in unasked messages */
	uint32_t reserved;
};

/* First message of a client. 96 bytes. */
struct pursuit_message_hello {
	struct pursuit_message header;
	uint32_t magic;
	uint32_t version_min;
	uint32_t version_max;
	uint32_t reserved;
	char name[64]; /* UTF-8, NUL-terminated: what logs and status call this client */
};

/* 128 bytes. */
struct pursuit_message_welcome {
	struct pursuit_message header;
	uint32_t version; /* the one that both speak from now on */
	uint32_t max_width;
	uint32_t max_height;
	uint32_t max_streams;
	uint32_t max_slots;
	uint32_t reserved0;
	uint64_t max_slot_bytes;
	char name[64]; /* the daemon's name and version */
	uint8_t reserved1[16];
};

/* struct pursuit_message_refused.code */
#define PURSUIT_REFUSED_VERSION 1u    /* no common version */
#define PURSUIT_REFUSED_MESSAGE 2u    /* malformed packet */
#define PURSUIT_REFUSED_MEMORY 3u     /* memfd unsealed, short, or of the wrong kind */
#define PURSUIT_REFUSED_VALUE 4u      /* a field out of range */
#define PURSUIT_REFUSED_IN_USE 5u     /* stream id already open */
#define PURSUIT_REFUSED_LIMIT 6u      /* too many clients, streams or bytes */
#define PURSUIT_REFUSED_FRAME 7u      /* a frame header in shared memory was invalid */
#define PURSUIT_REFUSED_SHUTDOWN 8u   /* the daemon is stopping */
#define PURSUIT_REFUSED_PERMISSION 9u /* this user may not be a client */

/* 256 bytes. */
struct pursuit_message_refused {
	struct pursuit_message header;
	uint32_t code;      /* PURSUIT_REFUSED_* */
	uint32_t fatal;     /* 1: the daemon closes the connection after this */
	uint64_t stream_id; /* 0: not about a stream */
	uint64_t value;     /* what was found in the field */
	char field[56];     /* the name of the field, "" if none */
	char text[160];     /* one sentence for a person */
};

/* struct pursuit_message_open_stream.flags */
#define PURSUIT_OPEN_KEYS UINT32_C(1) /* send KEY for this stream */

/* 64 bytes, with the two memfds. */
struct pursuit_message_open_stream {
	struct pursuit_message header;
	uint64_t stream_id;  /* chosen by the client, unique on its connection, not 0 */
	uint32_t slot_count; /* PURSUIT_MIN_SLOTS to PURSUIT_MAX_SLOTS */
	uint32_t flags;      /* PURSUIT_OPEN_*, or-ed */
	uint64_t slot_bytes; /* a multiple of 4096 */
	uint64_t reserved[3];
};

/* 64 bytes, with the eventfd. */
struct pursuit_message_stream_opened {
	struct pursuit_message header;
	uint64_t stream_id;
	uint64_t refresh_numerator; /* display rate in Hz = numerator / denominator */
	uint64_t refresh_denominator;
	uint64_t next_vblank_ns; /* CLOCK_MONOTONIC; 0: unknown */
	uint64_t reserved[2];
};

/* CLOSE_STREAM and STREAM_CLOSED. 32 bytes. */
struct pursuit_message_close_stream {
	struct pursuit_message header;
	uint64_t stream_id;
	uint64_t reserved;
};

/*
 * A key was pressed in the daemon's window while this stream was shown, and the daemon has no use for it itself. Only
 * for streams opened with PURSUIT_OPEN_KEYS. 48 bytes.
 */
struct pursuit_message_key {
	struct pursuit_message header;
	uint64_t stream_id;
	uint64_t time_ns; /* CLOCK_MONOTONIC */
	uint32_t code; /* Unicode code point of what is printed on the key, lower case; 27 escape; or PURSUIT_KEY_CLOSE */
	uint32_t reserved0;
	uint64_t reserved1;
};
/* Not a key: the window is to be closed. Like 'q' and escape it asks the client to end. */
#define PURSUIT_KEY_CLOSE UINT32_C(0x110100)

/* CONTROL and CONTROL_REPLY: this, then text_bytes bytes of UTF-8. 32 bytes. */
struct pursuit_message_control {
	struct pursuit_message header;
	uint32_t status; /* in a reply: 0 done, otherwise a positive errno; in a request 0 */
	uint32_t text_bytes;
	uint64_t reserved;
};

#endif
