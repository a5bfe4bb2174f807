/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Layout asserts: what crosses a process boundary or a disk never moves. */

#include <stddef.h>

#include "frame.h"
#include "recording.h"
#include "shm.h"
#include "wire.h"

#define SIZE(type, bytes, reason) _Static_assert(sizeof(type) == (bytes), #type " is " #bytes " bytes: " reason)
#define OFFSET(type, field, bytes, reason) \
	_Static_assert(offsetof(type, field) == (bytes), #type "." #field " is at " #bytes ": " reason)

#define WIRE "both ends of the socket are built apart"
#define SHARED "both sides map it"
#define DISK "recordings outlive the program"

SIZE(struct pursuit_transfer, 16, SHARED);
SIZE(struct pursuit_plane, 72, SHARED);
OFFSET(struct pursuit_plane, offset, 24, SHARED);
OFFSET(struct pursuit_plane, transfer, 48, SHARED);
SIZE(struct pursuit_frame_header, 1024, DISK);
OFFSET(struct pursuit_frame_header, flags, 40, DISK);
OFFSET(struct pursuit_frame_header, view_projection, 72, DISK);
OFFSET(struct pursuit_frame_header, planes, 200, DISK);
OFFSET(struct pursuit_frame_header, damage_since, 776, DISK);
SIZE(struct pursuit_rectangle, 16, DISK);
OFFSET(struct pursuit_frame_header, damage, 792, DISK);
OFFSET(struct pursuit_frame_header, reserved, 920, DISK);

SIZE(struct pursuit_feedback, 96, SHARED);
SIZE(struct pursuit_hint, 32, SHARED);
OFFSET(struct pursuit_shm_control, latest, 64, "the exchanged word has a cache line of its own");
OFFSET(struct pursuit_shm_control, feedback_count, 128, "written by the daemon only, a line of its own");
OFFSET(struct pursuit_shm_control, headers, 192, SHARED);
OFFSET(struct pursuit_shm_control, hint, 136, SHARED);
OFFSET(struct pursuit_shm_control, feedback, 8384, SHARED);
SIZE(struct pursuit_shm_control, 16384, "four pages, mapped whole");

SIZE(struct pursuit_message, 16, WIRE);
SIZE(struct pursuit_message_hello, 96, WIRE);
SIZE(struct pursuit_message_welcome, 128, WIRE);
SIZE(struct pursuit_message_refused, 256, WIRE);
OFFSET(struct pursuit_message_refused, field, 40, WIRE);
OFFSET(struct pursuit_message_refused, text, 96, WIRE);
SIZE(struct pursuit_message_open_stream, 64, WIRE);
SIZE(struct pursuit_message_stream_opened, 64, WIRE);
SIZE(struct pursuit_message_close_stream, 32, WIRE);
SIZE(struct pursuit_message_key, 48, WIRE);
OFFSET(struct pursuit_message_key, code, 32, WIRE);
SIZE(struct pursuit_message_control, 32, WIRE);

SIZE(struct pursuit_recording_header, 32, DISK);
SIZE(struct pursuit_chunk_header, 64, DISK);
OFFSET(struct pursuit_chunk_header, header_checksum, 56, "it covers the bytes before it");
