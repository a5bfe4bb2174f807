/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The contact sheet: some moments, one a row; real frame, in-between, truth and
 * error side by side, labelled. Large pictures are made smaller by whole
 * factors (mean of the pixels), small ones larger.
 */
#ifndef PURSUIT_CLI_CONTACT_H
#define PURSUIT_CLI_CONTACT_H

#include "daemon/error.h"
#include "daemon/measure/measure.h"

struct contact;

/* For pictures of this size. NULL: out of memory. */
struct contact *contact_create(uint32_t width, uint32_t height);
void contact_destroy(struct contact **contact);

/* One row; copies what it needs. 0 or -ENOMEM with a sentence. */
int contact_add(struct contact *contact, const char *label, const struct picture *real,
				const struct picture *in_between, const struct picture *truth, struct error *error);

/* Writes the sheet as PNG. The error is shown by a factor that is chosen for all rows and named. */
int contact_write(const struct contact *contact, const char *title, const char *path, struct error *error);

#endif
