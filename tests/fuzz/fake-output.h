/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * daemon/output.h without a render thread, for targets that run server and
 * control: streams are kept, frames are taken when the target says so.
 */
#ifndef PURSUIT_TESTS_FAKE_OUTPUT_H
#define PURSUIT_TESTS_FAKE_OUTPUT_H

#include "daemon/output.h"

struct output *fake_output_create(struct clock *clock);
/* Expects that every stream was taken away. */
void fake_output_destroy(struct output **output);

/* Takes the newest frame of every stream, reads it, and tells what was found wrong, as a render thread does. */
void fake_output_take(struct output *output);

uint32_t fake_output_stream_count(const struct output *output);

#endif
