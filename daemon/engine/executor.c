/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/executor.h"

/* GL on a CPU is slower than the CPU itself, so that it is only used when asked for by name. */
static struct executor *create_auto(const struct engine_params *params, struct error *error)
{
	struct error no_gpu;
	struct executor *executor = executor_gl_create(params, &no_gpu);
	return executor ? executor : executor_cpu_create(params, error);
}

struct executor *executor_create(const struct engine_params *params, struct error *error)
{
	switch (params->context) {
	case ENGINE_CONTEXT_AUTO:
		return create_auto(params, error);
	case ENGINE_CONTEXT_CPU:
		return executor_cpu_create(params, error);
	default:
		return executor_gl_create(params, error);
	}
}

void executor_destroy(struct executor **executor)
{
	if (*executor)
		(*executor)->ops->destroy(executor);
}
