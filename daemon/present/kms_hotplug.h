/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The kernel's messages about displays that were plugged in or out. */
#ifndef PURSUIT_KMS_HOTPLUG_H
#define PURSUIT_KMS_HOTPLUG_H

#include <stdbool.h>

/* A descriptor that is readable when there may be a message; -1: none are to be had. */
int kms_hotplug_open(void);

/* Reads all messages; true if one was about displays. Never waits. */
bool kms_hotplug_read(int fd);

#endif
