/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A picture made in memory becomes SHOWN. */
#include "daemon/engine/cpu/executor_cpu.h"

static int run(struct engine *engine, struct error *error)
{
	const struct bitmap *from = &engine->pixels.shown;
	const struct canvas picture = {
		.width = from->width, .height = from->height, .stride = 4 * (size_t)from->width, .pixels = from->data};
	const struct sheet *shown;
	int result = cpu_shown(engine, &shown, error);
	if (result == 0)
		cpu_copy(cpu_of(engine), PICTURE_SHOWN, &picture);
	return result;
}

const struct pass cpu_pass_put = {.run = run};
