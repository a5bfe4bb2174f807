/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * One display of one display controller: the only face of the kernel's
 * mode-setting interface (libdrm). Finds device, connector and mode (kms_find.c),
 * becomes master, sets the mode, flips buffers (kms_atomic.c, or the older calls)
 * and reads the kernel's events.
 *
 * Atomic mode setting where the driver has it (a mode is tried with a test that
 * changes nothing, before it is set), the older calls elsewhere.
 *
 * What was on display before is remembered and put back by kms_device_restore().
 * After a crash the kernel does that: it takes the buffers of a closed device
 * off the display, and when nobody has the device open any more it shows its
 * console again. Nothing of ours outlives the process, so nothing needs a
 * signal handler or a guardian.
 *
 * Threads: one at a time, the owner's lock; buffers can be made, and the cable looked at, on any thread.
 */
#ifndef PURSUIT_KMS_DEVICE_H
#define PURSUIT_KMS_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"
#include "daemon/present/kms_mode.h"
#include "daemon/present/rectangle.h"

struct kms_device;

struct kms_device_params {
	const char *device;    /* path; NULL or "": the first that has a display */
	const char *connector; /* name like "HDMI-A-1"; NULL or "": the first that a display is plugged into */
	struct kms_mode_wish mode;
	bool legacy; /* the older calls even where there are atomic ones */
};

/* A buffer in memory that the controller scans out: BGRX8, rows top to bottom. */
struct kms_buffer {
	uint8_t *data; /* mapped; write only, reading may be slow */
	size_t stride, size;
	uint32_t handle, framebuffer;
	/* What of it is shown, as large as fits and its shape kept; width 0: all. Only what kms_device_can_scale(). */
	struct rectangle part;
};

struct kms_events {
	/* Vblank `sequence` was at time_ns. */
	void (*vblank)(void *data, uint64_t sequence, uint64_t time_ns);
	/* The flip happened at vblank `sequence`, which was at time_ns. */
	void (*flipped)(void *data, uint64_t sequence, uint64_t time_ns);
	void *data;
};

/* NULL with a sentence that says what to do. Nothing is shown yet. */
struct kms_device *kms_device_create(const struct kms_device_params *params, struct error *error);
/* Puts back what was shown before, where that is still there. */
void kms_device_restore(struct kms_device *device);
/* Buffers must be gone by kms_device_destroy_buffer(). NULL accepted. */
void kms_device_destroy(struct kms_device **device);

int kms_device_get_fd(const struct kms_device *device);
const struct kms_mode *kms_device_get_mode(const struct kms_device *device);
/* "Virtual-1 of /dev/dri/card0 (vkms, atomic)". Lives as long as the device. */
const char *kms_device_get_name(const struct kms_device *device);

/* Of the mode's size, black; rows are multiples of 64 bytes apart where the driver lets us choose. */
int kms_device_create_buffer(struct kms_device *device, struct kms_buffer *buffer, struct error *error);
void kms_device_destroy_buffer(struct kms_device *device, struct kms_buffer *buffer);
/*
 * One of the mode's size that somebody else made (XRGB8888): data is NULL, and the handle stays his. Tries whether the
 * display takes it, where the driver can tell.
 */
int kms_device_adopt_buffer(struct kms_device *device, uint32_t handle, uint32_t stride, struct kms_buffer *buffer,
							struct error *error);

/* Would the display show this part of the buffer, enlarged by its controller? Asked without changing anything. */
bool kms_device_can_scale(const struct kms_device *device, const struct kms_buffer *buffer,
						  const struct rectangle *part);

/* Lights the display up with this buffer; waits until it is. */
int kms_device_show(struct kms_device *device, const struct kms_buffer *buffer, struct error *error);
/* Does it wait for a fence by itself? */
bool kms_device_takes_fences(const struct kms_device *device);
/*
 * Shows this buffer from the next vblank on; never waits. -EBUSY: a flip is under way; -EACCES: no longer master.
 * fence: a sync file, the caller's: from the next vblank on after it has signalled; -1: none, as always where fences
 * are not taken.
 */
int kms_device_flip(struct kms_device *device, const struct kms_buffer *buffer, int fence);

/* The last vblank. -EOPNOTSUPP: the driver does not count them. */
int kms_device_get_sequence(struct kms_device *device, uint64_t *sequence, uint64_t *time_ns);
/* Asks for an event at this vblank, or at the next one if it is over. */
int kms_device_queue_sequence(struct kms_device *device, uint64_t sequence);
/* Reads what the descriptor has; never waits when it is readable. */
int kms_device_read_events(struct kms_device *device, const struct kms_events *events);

/* Probing looks at the cable, which may take a tenth of a second; otherwise what the kernel knows. */
bool kms_device_is_connected(struct kms_device *device, bool probe);

/* Gives the display to another program, and takes it back. */
void kms_device_leave(struct kms_device *device);
int kms_device_return(struct kms_device *device);

#endif
