/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The engine without its GL executor, for machines that are only emulated. */
#include <errno.h>

#include "daemon/engine/executor.h"

struct executor *executor_gl_create(const struct engine_params *params, struct error *error)
{
	error_set(error, -ENOTSUP, "this build has no GL");
	return NULL;
}
