/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Displayed frames into memory, one after the other: on a GPU each is drawn while the one before comes back. Nothing
 * else is unfinished in that engine meanwhile.
 */
#ifndef PURSUIT_CLI_AHEAD_H
#define PURSUIT_CLI_AHEAD_H

#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/engine.h"

struct ahead {
	struct engine *engine;
	uint32_t count; /* pictures that are not taken yet; 0 to begin with */
};

/*
 * Asks for one into data, stride x height bytes, which is the engine's until the next but one is asked for or all are
 * finished. 0 or a negative errno with a sentence; ahead_finish() follows in any case.
 */
int ahead_render(struct ahead *ahead, const struct engine_request *request, uint8_t *data, size_t stride,
				 struct error *error);

/* All are there, or, with a negative result, given up. The result, or what went wrong now with a sentence. */
int ahead_finish(struct ahead *ahead, int result, struct error *error);

#endif
