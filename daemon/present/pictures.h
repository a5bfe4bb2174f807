/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What presenters share that have no display controller to queue for them:
 * pictures in CPU memory, the queue of flips.h under a lock, and whether
 * vblanks are handled at all now. First member of such a presenter; the
 * functions of its impl are those here, create and destroy apart.
 */
#ifndef PURSUIT_PICTURES_H
#define PURSUIT_PICTURES_H

#include <pthread.h>

#include "daemon/present/contents.h"
#include "daemon/present/flips.h"
#include "daemon/present/presenter.h"
#include "daemon/present/texture.h"

struct pictures {
	struct presenter presenter;
	struct presenter_params params;
	pthread_mutex_t lock; /* for all below */
	pthread_cond_t wake;  /* of the presenter's thread; waits by CLOCK_MONOTONIC */
	struct grid grid;
	uint64_t lead_ns; /* a picture must be queued so long before its vblank */
	struct flips flips;
	uint64_t next_vblank; /* the first one not handled */
	uint64_t vsync_trust; /* of the external vsync that the grid follows, 0 none (vsync.h) */
	uint64_t vsync_shift; /* numbers of the grid less those of the external vsync, modulo 2^64 */
	bool running;         /* vblanks are handled */
	bool stop;
	struct pictures_memory {
		uint8_t *data;
		size_t size;
		struct texture texture; /* the same in GL, once it was asked for */
		struct contents in_memory, in_gl;
	} memory[FLIPS_IMAGES];                      /* of an acquired picture: the render thread's; else as `shape` says */
	struct presenter_image shapes[FLIPS_IMAGES]; /* as acquired last */
};

void pictures_init(struct pictures *pictures, const struct presenter_impl *impl, const struct presenter_params *params);
/* Once the presenter's threads have ended. */
void pictures_finish(struct pictures *pictures);

/*
 * With the lock: handles vblank next_vblank, that is, changes the front; says what is known before it is really shown.
 * A thread that slept over many vblanks skips them rather than showing them in a burst; a real frame that was queued
 * for one of them is late. now_ns: for that.
 */
struct presenter_flip pictures_show_next(struct pictures *pictures, uint64_t now_ns);

/*
 * With the lock: lets the grid follow the external vsync as long as that is to be trusted, with numbers that go on;
 * then true. Else the grid goes on at the rate that it has.
 */
bool pictures_follow_vsync(struct pictures *pictures, uint64_t now_ns);

/* As in struct presenter_impl. */
struct grid pictures_get_grid(struct presenter *presenter);
uint64_t pictures_get_lead(struct presenter *presenter);
int pictures_acquire(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image);
/* Without the presenter's context: with the functions of the one that is current. */
int pictures_acquire_texture(struct pictures *pictures, const struct texture_functions *gl, uint32_t width,
							 uint32_t height, struct presenter_image *image);
void pictures_release(struct presenter *presenter, const struct presenter_image *image);
int pictures_present(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank, uint64_t group,
					 uint64_t serial);
void pictures_set_standby(struct presenter *presenter, const struct presenter_image *image, uint64_t group,
						  uint64_t serial);
void pictures_clear_standby(struct presenter *presenter);
void pictures_pause(struct presenter *presenter);

#endif
