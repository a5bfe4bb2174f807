/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/fault/game.h"

#include <sys/resource.h>

#include "tests/daemon/fixture.h"

struct pursuit_stream *game_open(const char *socket)
{
	const struct pursuit_stream_params params = {.width = 64,
												 .height = 48,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT16,
												 .socket_path = socket};
	return pursuit_open(&params);
}

bool game_is_attached(struct pursuit_stream *stream)
{
	struct pursuit_status status;
	pursuit_get_status(stream, &status);
	return status.state == PURSUIT_STATE_ATTACHED;
}

/* Of this thread, so far. */
static long count_sleeps(void)
{
	struct rusage usage;
	getrusage(RUSAGE_THREAD, &usage);
	return usage.ru_nvcsw;
}

uint64_t game_play_frame(struct pursuit_stream *stream)
{
	const long sleeps = count_sleeps();
	const uint64_t start = now_ns();
	struct pursuit_frame *frame = pursuit_acquire(stream);
	if (frame)
		pursuit_submit(stream, frame);
	const uint64_t taken = now_ns() - start;
	const bool slept = count_sleeps() > sleeps;
	sleep_ms(GAME_FRAME_MS);
	return slept ? taken : 0;
}
