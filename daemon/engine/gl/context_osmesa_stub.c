/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/context.h"

#include <errno.h>

struct context *context_osmesa_create(struct error *error)
{
	error_set(error, -ENOTSUP, "built without OSMesa");
	return NULL;
}
