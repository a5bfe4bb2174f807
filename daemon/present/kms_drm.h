/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The insides of struct kms_device, of kms_find.c, kms_atomic.c and
 * kms_device.c; nobody else includes this, or libdrm.
 */
#ifndef PURSUIT_KMS_DRM_H
#define PURSUIT_KMS_DRM_H

#include <xf86drm.h>
#include <xf86drmMode.h>

#include "daemon/present/kms_device.h"

#define KMS_NAME_BYTES 48
#define KMS_PATH_BYTES 64

/* Properties of atomic mode setting, by number. */
struct kms_atomic {
	bool usable;
	uint32_t plane;
	uint32_t connector_crtc, crtc_mode, crtc_active;
	uint32_t plane_framebuffer, plane_crtc;
	uint32_t plane_fence;          /* 0: it takes none */
	uint32_t source[4], target[4]; /* x, y, width, height */
	uint32_t mode_blob;
};

struct kms_device {
	int fd;
	bool away;
	char path[KMS_PATH_BYTES], connector_name[KMS_NAME_BYTES], name[192];
	uint32_t connector, crtc, crtc_index;
	struct kms_mode mode;
	drmModeModeInfo timings;
	struct kms_atomic atomic;
	drmModeCrtc *before;             /* what was shown, NULL nothing */
	const struct kms_events *events; /* while they are read */
};

/*
 * Opens the card, chooses connector, CRTC and mode, becomes master, remembers what is shown. Into a device that was
 * zeroed, with fd -1, and stays so if it fails. 0 or a negative errno with a sentence.
 */
int kms_find(struct kms_device *device, const struct kms_device_params *params, struct error *error);

/* Looks for all that atomic mode setting needs; `usable` says whether it is there. */
void kms_atomic_find(struct kms_device *device);
/*
 * fence: as of kms_device_flip(). flags: the kernel's DRM_MODE_ATOMIC_*, and DRM_MODE_PAGE_FLIP_EVENT. 0 or a negative
 * errno.
 */
int kms_atomic_commit(const struct kms_device *device, const struct kms_buffer *buffer, int fence, uint32_t flags);

#endif
