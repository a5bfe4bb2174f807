/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Messages to the lab's thread: one writer, one reader, no lock, no wait. A
 * full queue drops and counts: whoever shows pictures is never held up.
 */
#ifndef PURSUIT_LAB_QUEUE_H
#define PURSUIT_LAB_QUEUE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "daemon/lab/points.h"
#include "daemon/present/presenter.h"

#define QUEUE_MESSAGES 256u

/* A picture that may be shown from now on. */
struct lab_picture {
	uint64_t serial;
	uint32_t code; /* number of its bit in the sequence */
	uint8_t show;  /* enum points_show */
	bool level;    /* of its patch */
};

struct queue_message {
	enum { QUEUE_FLIP, QUEUE_PICTURE, QUEUE_POINTS } kind;
	uint64_t event_ns; /* of a flip: when the lab was told */
	union {
		struct presenter_flip flip;
		struct lab_picture picture;
		struct points points;
	};
};

/* Zeroed is empty. */
struct queue {
	struct queue_message messages[QUEUE_MESSAGES];
	_Atomic uint64_t written, read;
	_Atomic uint64_t dropped;
};

static inline bool queue_push(struct queue *queue, const struct queue_message *message)
{
	const uint64_t written = atomic_load_explicit(&queue->written, memory_order_relaxed);
	if (written - atomic_load_explicit(&queue->read, memory_order_acquire) == QUEUE_MESSAGES) {
		atomic_fetch_add_explicit(&queue->dropped, 1, memory_order_relaxed);
		return false;
	}
	queue->messages[written % QUEUE_MESSAGES] = *message;
	atomic_store_explicit(&queue->written, written + 1, memory_order_release);
	return true;
}

/* The oldest message, NULL if there is none; valid until queue_pop(). */
static inline const struct queue_message *queue_front(struct queue *queue)
{
	const uint64_t read = atomic_load_explicit(&queue->read, memory_order_relaxed);
	if (atomic_load_explicit(&queue->written, memory_order_acquire) == read)
		return NULL;
	return &queue->messages[read % QUEUE_MESSAGES];
}

static inline void queue_pop(struct queue *queue)
{
	atomic_fetch_add_explicit(&queue->read, 1, memory_order_release);
}

#endif
