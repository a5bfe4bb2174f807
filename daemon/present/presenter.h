/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Presenters: where displayed frames go. A presenter knows vblanks, pictures
 * and numbers that its user gave them; it knows neither engine nor stream.
 *
 * The render thread draws pictures ahead and queues each for one vblank; the
 * presenter shows at each vblank what is queued for it, and reports every
 * vblank in a flip event. Where nothing is queued, the standby picture of the
 * group on display is shown, and without one the picture stays.
 *
 *   group: a number that rises with every real frame. A real frame, its
 *          in-betweens and its standby picture have the same.
 *
 * Threads: every function is called on the render thread. flip() of the events
 * is called on a thread of the presenter's choice, never with a lock held.
 */
#ifndef PURSUIT_PRESENTER_H
#define PURSUIT_PRESENTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "daemon/clock.h"
#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/present/grid.h"

/* A picture in CPU memory: BGRA8, rows top to bottom. Owned by the presenter. */
struct presenter_image {
	uint8_t *data;
	size_t stride;
	uint32_t width, height;
	uint32_t index; /* the presenter's */
};

enum presenter_shown {
	PRESENTER_PICTURE, /* the one queued for this vblank */
	PRESENTER_STANDBY, /* nothing was queued: the standby picture */
	PRESENTER_KEPT,    /* nothing was queued: the same picture as before */
};

/* One vblank is over. */
struct presenter_flip {
	uint64_t vblank;
	uint64_t target_ns; /* the vblank's time on the grid */
	uint64_t flip_ns;   /* when it was handled */
	uint64_t serial;    /* of the picture on display, 0 none */
	uint64_t group;
	enum presenter_shown shown;
	bool late;          /* handled only after the next vblank's time */
	uint32_t skipped;   /* vblanks just before this one that were not handled at all */
};

struct presenter_params {
	struct clock *clock;
	const struct log *log;
	uint64_t refresh_numerator; /* wished for; a display of its own rate may differ */
	uint64_t refresh_denominator;
	void (*flip)(void *data, const struct presenter_flip *flip);
	void *data;
};

struct presenter;

/* All functions are mandatory. */
struct presenter_impl {
	const char *name;
	const char *description;
	/* NULL with a sentence that says what to do. */
	struct presenter *(*create)(const struct presenter_params *params, struct error *error);
	void (*destroy)(struct presenter *presenter);
	/*
	 * The grid that vblanks are counted on. A fixed rate is the special case of {earliest next flip, latest next
	 * flip, grain}; a display of variable rate will add these.
	 */
	const struct grid *(*get_grid)(const struct presenter *presenter);
	/* A free picture to draw into; never waits. -EBUSY: all are queued or shown; -ENOMEM. */
	int (*acquire)(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image);
	/* Gives a picture back undrawn. */
	void (*release)(struct presenter *presenter, const struct presenter_image *image);
	/*
	 * Queues a picture for a vblank; replaces what is queued for it and drops what is queued for later ones.
	 * Starts the vblank events if they had stopped. -ETIME: that vblank is over; the picture stays acquired.
	 */
	int (*present)(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank, uint64_t group,
	               uint64_t serial);
	/* The picture for vblanks that nothing is queued for while this group is on display; replaces one of the group. */
	void (*set_standby)(struct presenter *presenter, const struct presenter_image *image, uint64_t group,
	                    uint64_t serial);
	void (*clear_standby)(struct presenter *presenter);
	/* The picture stays, no vblank is reported until the next present(). */
	void (*pause)(struct presenter *presenter);
};

/* First member of every presenter. */
struct presenter {
	const struct presenter_impl *impl;
};

/* Presenters that were built in, ended by NULL, best first. */
const struct presenter_impl *const *presenter_impls(void);

/*
 * Checks a list like "kms,glfw,headless" without opening anything: 0, or -EINVAL with a sentence about the first
 * name that is unknown or was not built in.
 */
int presenter_check_list(const char *list, struct error *error);

/* Creates the first presenter of the list that works; why others did not is logged. NULL with the last sentence. */
struct presenter *presenter_create(const char *list, const struct presenter_params *params, struct error *error);
void presenter_destroy(struct presenter **presenter);

extern const struct presenter_impl presenter_headless;

#endif
