/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/stream.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "client/attach.h"
#include "client/feedback.h"
#include "client/pace.h"
#include "client/slots.h"

#define SECOND_NS UINT64_C(1000000000)
#define SLEEP_SLICE_NS UINT64_C(20000000)

#define TEXT(value) #value
#define VERSION(major, minor, patch) TEXT(major) "." TEXT(minor) "." TEXT(patch)

/* What the shim passes on of enum pursuit_frame_flag; other bits are not the caller's to set. */
#define CALLER_FLAGS                                                                                    \
	(PURSUIT_FRAME_CUT | PURSUIT_FRAME_MOTION_INVALID | PURSUIT_FRAME_MATRICES | PURSUIT_FRAME_JITTER | \
	 PURSUIT_FRAME_DAMAGE)

struct pursuit_stream {
	struct shim_layout layout;
	struct shim_attach attach;
	struct shim_feedback feedback;
	struct shim_pace pace;
	struct shim_slots *plain;   /* always there */
	struct shim_slots *shared;  /* only while attached */
	struct shim_slots *retired; /* list: their daemon is gone, but frames of them are still acquired */
	uint64_t last_id;
	uint64_t last_time_ns;
	uint64_t submitted;
	uint64_t published;
	uint64_t replaced;
	uint64_t no_slot;
	uint64_t attaches;
	uint64_t bytes_copied;
	uint32_t acquired; /* of all sets */
};

const char *pursuit_version(void)
{
	return VERSION(PURSUIT_VERSION_MAJOR, PURSUIT_VERSION_MINOR, PURSUIT_VERSION_PATCH);
}

static uint64_t clock_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * UINT64_C(1000000000) + (uint64_t)now.tv_nsec;
}

struct pursuit_stream *pursuit_open(const struct pursuit_stream_params *params)
{
	struct pursuit_stream *stream = calloc(1, sizeof(*stream));

	if (!stream) {
		return NULL;
	}
	if (!params || !shim_layout_init(&stream->layout, params) ||
		!shim_attach_init(&stream->attach, params->socket_path, params->name)) {
		free(stream);
		errno = EINVAL;
		return NULL;
	}
	stream->attach.wants_keys = params->wants_keys != 0;
	stream->plain = shim_slots_create_plain(&stream->layout);
	if (!stream->plain) {
		free(stream);
		errno = ENOMEM;
		return NULL;
	}
	pursuit_update(stream);
	return stream;
}

void pursuit_close(struct pursuit_stream **stream)
{
	if (!stream || !*stream) {
		return;
	}
	struct pursuit_stream *closed = *stream;
	*stream = NULL;
	shim_attach_finish(&closed->attach);
	shim_slots_destroy(&closed->plain);
	shim_slots_destroy(&closed->shared);
	while (closed->retired) {
		struct shim_slots *set = closed->retired;
		closed->retired = set->next;
		shim_slots_destroy(&set);
	}
	free(closed);
}

/* The daemon of the shared set is gone. Frames of it that the caller still has stay memory. */
static void retire_shared(struct pursuit_stream *stream)
{
	if (stream->shared && stream->shared->taken > 0) {
		stream->shared->next = stream->retired;
		stream->retired = stream->shared;
		stream->shared = NULL;
	}
	shim_slots_destroy(&stream->shared);
}

static void step(struct pursuit_stream *stream, uint64_t now_ns)
{
	switch (shim_attach_step(&stream->attach, &stream->layout, now_ns)) {
	case SHIM_ATTACH_GAINED:
		stream->shared = stream->attach.offered;
		stream->attach.offered = NULL;
		stream->feedback = (struct shim_feedback){0};
		stream->attaches++;
		shim_slots_release_pages(stream->plain);
		break;
	case SHIM_ATTACH_LOST:
		retire_shared(stream);
		break;
	case SHIM_ATTACH_SAME:
		break;
	}
}

void pursuit_update(struct pursuit_stream *stream)
{
	if (stream) {
		step(stream, clock_now());
	}
}

struct pursuit_frame *pursuit_acquire(struct pursuit_stream *stream)
{
	struct pursuit_frame *frame = NULL;

	if (!stream) {
		return NULL;
	}
	pursuit_update(stream);
	/* The limit holds over all sets, so that frames kept through many re-attachments stay few. */
	if (stream->acquired < stream->plain->slot_count) {
		frame = shim_slots_take(stream->shared ? stream->shared : stream->plain, &stream->layout);
	}
	if (frame) {
		stream->acquired++;
	} else {
		stream->no_slot++;
	}
	return frame;
}

/* The set that an acquired frame is of, or NULL. */
static struct shim_slots *find_set(const struct pursuit_stream *stream, const struct pursuit_frame *frame, int *index)
{
	struct shim_slots *const sets[] = {stream->shared, stream->plain};

	for (size_t i = 0; i < sizeof(sets) / sizeof(*sets); i++) {
		if (sets[i] && (*index = shim_slots_index(sets[i], frame)) >= 0) {
			return sets[i];
		}
	}
	for (struct shim_slots *set = stream->retired; set; set = set->next) {
		if ((*index = shim_slots_index(set, frame)) >= 0) {
			return set;
		}
	}
	return NULL;
}

/* A frame that is not published: its slot is free again, and an old set that was kept for it goes. */
static void give_back(struct pursuit_stream *stream, struct shim_slots *set, int index)
{
	shim_slots_give(set, index);
	stream->acquired--;
	if (set == stream->plain && stream->shared) {
		shim_slots_release_pages(set);
	}
	for (struct shim_slots **link = &stream->retired; *link; link = &(*link)->next) {
		if (*link == set && set->taken == 0) {
			*link = set->next;
			shim_slots_destroy(&set);
			return;
		}
	}
}

void pursuit_cancel(struct pursuit_stream *stream, struct pursuit_frame *frame)
{
	int index;
	struct shim_slots *set = stream ? find_set(stream, frame, &index) : NULL;

	if (set) {
		give_back(stream, set, index);
	}
}

struct shim_ticket shim_stream_ticket(struct pursuit_stream *stream, const struct pursuit_frame *frame)
{
	struct shim_ticket ticket = {
		.frame_id = ++stream->last_id,
		.time_ns = frame->time_ns ? frame->time_ns : clock_now(),
		.real_interval_ns = frame->real_interval_ns,
	};

	if (!ticket.real_interval_ns && stream->last_time_ns && ticket.time_ns > stream->last_time_ns) {
		ticket.real_interval_ns = ticket.time_ns - stream->last_time_ns;
	}
	stream->last_time_ns = ticket.time_ns;
	stream->submitted++;
	return ticket;
}

/* Too many rectangles, or no frame before: everything may have changed. */
static void set_damage(struct pursuit_frame_header *header, const struct pursuit_frame *frame)
{
	if (header->frame_id < 2 || frame->damage_count > PURSUIT_MAX_DAMAGE) {
		header->flags &= ~PURSUIT_FRAME_DAMAGE;
	}
	if (!(header->flags & PURSUIT_FRAME_DAMAGE)) {
		return;
	}
	header->damage_since = header->frame_id - 1;
	header->damage_count = frame->damage_count;
	for (uint32_t i = 0; i < frame->damage_count; i++) {
		header->damage[i] = (struct pursuit_rectangle){frame->damage[i].x, frame->damage[i].y, frame->damage[i].width,
													   frame->damage[i].height};
	}
}

static struct pursuit_frame_header make_header(const struct pursuit_stream *stream, const struct pursuit_frame *frame,
											   const struct shim_ticket *ticket, uint64_t now_ns)
{
	struct pursuit_frame_header header = stream->layout.header;

	header.frame_id = ticket->frame_id;
	header.time_ns = ticket->time_ns;
	header.submit_ns = now_ns;
	header.real_interval_ns = ticket->real_interval_ns;
	header.motion_interval_ns = frame->motion_interval_ns;
	header.flags = frame->flags & CALLER_FLAGS;
	if (header.flags & PURSUIT_FRAME_JITTER) {
		header.jitter_x = frame->jitter_x;
		header.jitter_y = frame->jitter_y;
	}
	if (header.flags & PURSUIT_FRAME_MATRICES) {
		memcpy(header.view_projection, frame->view_projection, sizeof(header.view_projection));
		memcpy(header.previous_view_projection, frame->previous_view_projection,
			   sizeof(header.previous_view_projection));
	}
	set_damage(&header, frame);
	return header;
}

static void publish_shared(struct pursuit_stream *stream, int index, const struct pursuit_frame_header *header)
{
	stream->acquired--;
	stream->published++;
	switch (shim_slots_publish(stream->shared, index, header)) {
	case SHIM_PUBLISHED_OVER:
		stream->replaced++;
		break;
	case SHIM_PUBLISHED:
		break;
	case SHIM_PUBLISH_BROKEN:
		shim_attach_break(&stream->attach, header->submit_ns, "the daemon broke the rules of the frame slots");
		retire_shared(stream);
		return;
	}
	shim_attach_wake(&stream->attach);
}

bool shim_stream_publish(struct pursuit_stream *stream, struct pursuit_frame *frame, const struct shim_ticket *ticket)
{
	uint64_t now_ns = clock_now();
	int index;

	step(stream, now_ns);
	struct shim_slots *set = find_set(stream, frame, &index);
	if (!set) {
		return false;
	}
	if (set != stream->shared) {
		give_back(stream, set, index);
		return true;
	}
	shim_pace_publish(&stream->pace, ticket->frame_id, now_ns);
	struct pursuit_frame_header header = make_header(stream, frame, ticket, now_ns);
	publish_shared(stream, index, &header);
	return true;
}

uint64_t pursuit_submit(struct pursuit_stream *stream, struct pursuit_frame *frame)
{
	int index;

	if (!stream || !find_set(stream, frame, &index)) {
		return 0;
	}
	struct shim_ticket ticket = shim_stream_ticket(stream, frame);
	shim_stream_publish(stream, frame, &ticket);
	return ticket.frame_id;
}

int pursuit_poll_feedback(struct pursuit_stream *stream, struct pursuit_feedback_report *report)
{
	return stream && report && stream->shared && shim_feedback_poll(&stream->feedback, stream->shared->control, report);
}

uint64_t pursuit_next_start(struct pursuit_stream *stream)
{
	if (!stream) {
		return 0;
	}
	uint64_t now_ns = clock_now();
	uint64_t next_id = stream->last_id + 1;
	step(stream, now_ns);
	uint64_t start_ns = stream->shared ? shim_pace_start(&stream->pace, stream->shared->control, next_id, now_ns) : 0;
	shim_pace_begin(&stream->pace, next_id, start_ns > now_ns ? start_ns : now_ns);
	return start_ns;
}

/* Sleeps until then, whatever signals come; in slices, so that a daemon that goes away ends it. */
static bool sleep_attached(struct pursuit_stream *stream, uint64_t until_ns)
{
	uint64_t now_ns = clock_now();

	while (now_ns < until_ns && stream->shared) {
		uint64_t slice_ns = until_ns - now_ns < SLEEP_SLICE_NS ? until_ns : now_ns + SLEEP_SLICE_NS;
		const struct timespec then = {(time_t)(slice_ns / SECOND_NS), (long)(slice_ns % SECOND_NS)};
		clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &then, NULL);
		now_ns = clock_now();
		step(stream, now_ns);
	}
	return now_ns >= until_ns;
}

int pursuit_wait_next(struct pursuit_stream *stream, uint64_t timeout_ns)
{
	uint64_t start_ns = pursuit_next_start(stream);

	if (start_ns == 0) {
		return 0;
	}
	uint64_t now_ns = clock_now();
	bool in_time = start_ns <= now_ns || start_ns - now_ns <= timeout_ns;
	bool slept = sleep_attached(stream, in_time ? start_ns : now_ns + timeout_ns);
	shim_pace_begin(&stream->pace, stream->last_id + 1, clock_now());
	return in_time && slept;
}

int pursuit_next_key(struct pursuit_stream *stream, struct pursuit_key *key)
{
	if (!stream || !key) {
		return 0;
	}
	step(stream, clock_now());
	return shim_attach_next_key(&stream->attach, key);
}

void pursuit_get_status(struct pursuit_stream *stream, struct pursuit_status *status)
{
	if (!status) {
		return;
	}
	memset(status, 0, sizeof(*status));
	if (!stream) {
		return;
	}
	status->state = stream->attach.state;
	status->submitted = stream->submitted;
	status->published = stream->published;
	status->replaced = stream->replaced;
	status->no_slot = stream->no_slot;
	status->attaches = stream->attaches;
	status->bytes_copied = stream->bytes_copied;
	status->refresh_hz = stream->attach.refresh_hz;
	status->background = stream->shared && __atomic_load_n(&stream->shared->control->background, __ATOMIC_ACQUIRE) != 0;
	memcpy(status->message, stream->attach.message, sizeof(status->message));
}

const struct shim_layout *shim_stream_layout(const struct pursuit_stream *stream)
{
	return &stream->layout;
}

bool shim_stream_is_attached(const struct pursuit_stream *stream)
{
	return stream->shared != NULL;
}

void shim_stream_count_copied(struct pursuit_stream *stream, uint64_t bytes)
{
	stream->bytes_copied += bytes;
}

void shim_stream_say(struct pursuit_stream *stream, const char *format, ...)
{
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(stream->attach.message, sizeof(stream->attach.message), format, arguments);
	va_end(arguments);
}
