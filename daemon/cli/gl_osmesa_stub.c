/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <stddef.h>

#include "gl_context.h"

static void *create(struct error *error)
{
	error_set(error, -ENOTSUP, "this program was built without OSMesa");
	return NULL;
}

/* Without create() the others are never called. */
const struct gl_context_kind gl_context_osmesa = {.name = "osmesa", .create = create};
