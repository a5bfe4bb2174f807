/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The insides of the KMS presenter: a display controller of its own, without
 * any compositor. kms.c is the presenter's face, on the render thread,
 * kms_pictures.c the memory of its pictures; kms_events.c is the thread that
 * waits for the kernel.
 *
 * The way of a picture: it is drawn straight into a buffer that the controller
 * can scan out, queued, and given to the kernel `guard_ns` before its vblank:
 * late enough that a real frame can still replace an in-between, early enough
 * for the kernel to have it done. If there is none by then, one that comes
 * before the vblank goes straight to the kernel. Two events come back: the
 * vblank (asked for one at a time, time stamp in ns) and the flip. One that is
 * larger than the display is drawn beside it, and made smaller when it is queued.
 * One that the GPU draws still has a fence, for which the kernel waits.
 *
 * While another console is on display, vblanks are counted by the clock and
 * pictures go nowhere, so that client and engine notice nothing.
 */
#ifndef PURSUIT_KMS_H
#define PURSUIT_KMS_H

#include <pthread.h>

#include "daemon/present/contents.h"
#include "daemon/present/kms_cable.h"
#include "daemon/present/kms_console.h"
#include "daemon/present/kms_device.h"
#include "daemon/present/kms_gl.h"
#include "daemon/present/presenter.h"
#include "daemon/present/scanout.h"
#include "daemon/present/shrink.h"
#include "daemon/present/vblanks.h"

#define KMS_REPORTS 16u

/* Memory of one kind, the CPU's or GL's, that the controller scans out. */
struct kms_surface {
	struct kms_buffer buffer;
	struct contents contents;
	/* Of memory of the same kind for a picture that is larger than the display, and must be made smaller. */
	struct contents large;
	uint64_t shrunk; /* what of `large` the buffer shows, as its `holds`; 0: unknown */
};

/* It has both kinds, as soon as each is asked for. */
struct kms_picture {
	struct kms_surface memory, in_gl;
	struct kms_gl_buffer gl_buffer; /* of in_gl */
	struct kms_surface *shown;      /* which of them it was drawn into */
	struct rectangle part;          /* where in it the picture lies */
	bool is_large;
	uint8_t *large;
	size_t large_stride, large_size; /* bytes */
	struct kms_gl_large gl_large;
	int fence; /* a descriptor: drawn when it signals; -1: it is drawn */
};

struct kms {
	struct presenter presenter;
	struct presenter_params params;
	struct kms_device *device;
	struct kms_gl *gl; /* NULL: pictures come through CPU memory */
	struct kms_console console;
	struct kms_cable *cable;
	int wake;          /* -1: none */
	char display[256]; /* mode and connector */
	uint64_t guard_ns;
	struct kms_buffer backdrop; /* black: before the first picture */
	pthread_t thread;

	pthread_mutex_t lock; /* for all below */
	struct scanout scanout;
	struct vblanks vblanks;
	struct grid grid;
	uint64_t number, sequence; /* of the newest vblank: ours, the kernel's */
	uint64_t chosen;           /* the newest vblank that a picture was looked for */
	bool running, stop, away, lost;
	struct kms_picture pictures[FLIPS_IMAGES]; /* of an acquired one: the render thread's */
	uint32_t tried_width, tried_height;        /* the render thread's: does the controller enlarge these pictures? */
	bool scales;
	struct log_limit size_limit; /* the render thread's */
	bool lacks_memory, lacks_gl; /* the render thread's: the last picture could not be made, and that was said */
	struct shrink *shrink;       /* the render thread's, for pictures of this size; NULL: none yet */
	uint32_t shrink_width, shrink_height;
	struct error loss; /* does not change once `lost` is set */
	uint64_t heard_ns; /* of the display */

	/* the event thread's own */
	struct presenter_flip reports[KMS_REPORTS];
	uint32_t report_count;
	bool told_loss;
	uint64_t undrawn_vblank; /* the newest at which the GPU drew still what a flip that takes long waits for */
	bool asks;               /* for the vblank after the one that was heard */
};

static inline struct kms *kms_of(struct presenter *presenter)
{
	return (struct kms *)presenter;
}

/* kms_pictures.c; as in struct presenter_impl. */
int kms_acquire(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image);
int kms_acquire_texture(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image);
const struct presenter_context *kms_get_context(struct presenter *presenter);

/* Does the controller wait until GL, which there is, has drawn a picture? */
bool kms_can_fence(const struct kms *kms);
/* The image was drawn and is to be shown: makes it smaller if it must be, and fences it if it is drawn still. */
void kms_take_back(struct kms *kms, const struct presenter_image *image);
void kms_release(struct presenter *presenter, const struct presenter_image *image);
/* On main, at the end. */
void kms_destroy_pictures(struct kms *kms);

/* All with the lock. */

/* Looks for the picture of this vblank, which is close, and flips to it. */
void kms_choose(struct kms *kms, uint64_t vblank);
/* Vblanks come from now on, reported from this one on. */
void kms_start(struct kms *kms, uint64_t vblank);
/* Takes number and phase of vblanks anew from the kernel. Negative errno: it does not know them. */
int kms_anchor(struct kms *kms);
/* The display is gone; the event thread says so once. */
void kms_lose(struct kms *kms, const char *why);

/* The event thread; ends when `stop` is set and `wake` written. */
void *kms_run(void *kms);

#endif
