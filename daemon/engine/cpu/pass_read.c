/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A picture to the caller's memory, unless it was made there. */
#include "daemon/engine/cpu/executor_cpu.h"

static int run(struct engine *engine, struct error *error)
{
	struct rows shown;
	engine->report.bytes_down += 4 * (uint64_t)engine->width * engine->height;
	if (engine->job.picture == PICTURE_SHOWN)
		return 0;
	int result = cpu_shown(engine, &shown, error);
	if (result == 0)
		cpu_copy(cpu_of(engine), cpu_picture(engine, engine->job.picture), &shown);
	return result;
}

const struct pass cpu_pass_read = {.run = run};
