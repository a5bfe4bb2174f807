/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A set of frame slots: either plain memory, or the two sealed memfds of
 * proto/shm.h. Knows who owns each slot from memory of its own, so nothing
 * that a daemon writes into the shared page can make one slot be handed out
 * twice.
 *
 * The caller can have at most slot_count - 2 frames of a set at once, with and
 * without a daemon: in a shared set the other two are the daemon's and the one
 * named by `latest`.
 */
#ifndef PURSUIT_CLIENT_SLOTS_H
#define PURSUIT_CLIENT_SLOTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "client/layout.h"
#include "proto/shm.h"

enum shim_slot_owner {
	SHIM_SLOT_AWAY = 0, /* the daemon's, or named by `latest` */
	SHIM_SLOT_FREE,     /* ours, to be handed out */
	SHIM_SLOT_TAKEN     /* the caller fills it */
};

struct shim_slots {
	struct shim_slots *next;             /* for the owner's lists */
	struct pursuit_shm_control *control; /* NULL: plain memory */
	uint8_t *planes;
	size_t planes_bytes;
	int control_fd; /* -1 in a plain set and once forgotten */
	int planes_fd;
	uint32_t slot_count;
	uint32_t taken; /* how many slots are SHIM_SLOT_TAKEN */
	enum shim_slot_owner owners[PURSUIT_MAX_SLOTS];
	struct pursuit_frame frames[PURSUIT_MAX_SLOTS];
};

/* NULL with errno: ENOMEM, EMFILE, ENFILE, ENOSYS. A shared set is new memory that nobody else has seen. */
struct shim_slots *shim_slots_create_plain(const struct shim_layout *layout);
struct shim_slots *shim_slots_create_shared(const struct shim_layout *layout);

/* Unmaps and closes all, frames that are taken included. NULL and a pointer to NULL are accepted. */
void shim_slots_destroy(struct shim_slots **slots);

/* Closes the memfds once they are sent; the mappings stay. */
void shim_slots_forget_fds(struct shim_slots *slots);

/* A free slot with its fields reset, or NULL. */
struct pursuit_frame *shim_slots_take(struct shim_slots *slots, const struct shim_layout *layout);

/* The index of a frame that is taken from this set, or -1. `frame` may be any pointer. */
int shim_slots_index(const struct shim_slots *slots, const struct pursuit_frame *frame);

/* Gives a taken slot back unpublished. */
void shim_slots_give(struct shim_slots *slots, int index);

enum shim_published {
	SHIM_PUBLISHED,      /* and the one before was seen */
	SHIM_PUBLISHED_OVER, /* the one before was replaced before the daemon saw it */
	SHIM_PUBLISH_BROKEN  /* the daemon broke the rules; give this set up */
};

/* Publishes a taken slot of a shared set: header, then the exchange. Wait-free. */
enum shim_published shim_slots_publish(struct shim_slots *slots, int index, const struct pursuit_frame_header *header);

/* Lets the pages of a plain set go, if nothing of it is taken; they come back zeroed when written to. */
void shim_slots_release_pages(struct shim_slots *slots);

/* Closes *fd if it is open, and makes it -1. */
void shim_close_fd(int *fd);

#endif
