/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A picture to the caller's memory, unless it was made there; and what that holds from now on. */
#include "daemon/engine/cpu/executor_cpu.h"

static int run(struct engine *engine, struct error *error)
{
	struct executor_cpu *executor = cpu_of(engine);
	const enum picture_id id = engine->job.picture;
	const struct sheet *shown;
	const int result = cpu_shown(engine, &shown, error);
	if (result < 0)
		return result;
	if (id != PICTURE_SHOWN)
		cpu_copy(executor, id, cpu_picture(engine, id));
	if (!engine->job.holds)
		engine->job.holds = engine_new_number(engine);
	const uint64_t kept = 4 * contents_close(&executor->contents, engine->job.holds, shown);
	engine->report.bytes_down += 4 * (uint64_t)engine->width * engine->height - kept;
	engine->report.bytes_kept += kept;
	return 0;
}

const struct pass cpu_pass_read = {.run = run};
