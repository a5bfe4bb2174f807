/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Watches whether a display is still plugged in, on a thread of its own, since
 * looking at the cable may take a tenth of a second and more: when the kernel
 * says that something has changed, it is looked at; once a second it is asked
 * what it knows, which costs nothing.
 */
#ifndef PURSUIT_KMS_CABLE_H
#define PURSUIT_KMS_CABLE_H

#include <stdbool.h>

#include "daemon/error.h"
#include "daemon/present/kms_device.h"

struct kms_cable;

/* unplugged() is called on the thread, once, and never after kms_cable_destroy(). NULL with a sentence. */
struct kms_cable *kms_cable_create(struct kms_device *device, void (*unplugged)(void *data), void *data,
								   struct error *error);
/* Waits for a look that is under way. NULL accepted. */
void kms_cable_destroy(struct kms_cable **cable);

/*
 * Is a display plugged into that connector (NULL or "": any) of that device (path; NULL or "": any), as far as the
 * kernel knows? Opens no device, never waits. Any thread.
 */
bool kms_cable_is_plugged(const char *device, const char *connector);

#endif
