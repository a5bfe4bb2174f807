/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/executor.h"

struct executor *executor_create(const struct engine_params *params, struct error *error)
{
	return executor_gl_create(params, error);
}

void executor_destroy(struct executor **executor)
{
	if (*executor)
		(*executor)->ops->destroy(executor);
}
