/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/soak/code.h"
#include "tests/soak/soak.h"

struct life {
	struct soak *soak;
	uint32_t number;
	uint64_t noise;
	struct pursuit_stream_params params;
	bool attached;
};

static uint32_t draw(struct life *life, uint32_t below)
{
	life->noise ^= life->noise << 13;
	life->noise ^= life->noise >> 7;
	life->noise ^= life->noise << 17;
	return (uint32_t)(life->noise % below);
}

/* Sizes, formats and planes change from one life to the next, and within one. */
static void choose_params(struct life *life)
{
	static const uint32_t sizes[][2] = {{64, 48}, {160, 90}, {65, 33}, {320, 180}, {2, 2}};
	const uint32_t *size = sizes[draw(life, 5)];
	life->params = (struct pursuit_stream_params){
		.width = size[0],
		.height = size[1],
		.color_format = draw(life, 2) ? PURSUIT_COLOR_RGBA8 : PURSUIT_COLOR_BGRA8,
		.depth_format = draw(life, 2) ? PURSUIT_DEPTH_FLOAT32 : PURSUIT_DEPTH_ABSENT,
		.motion_format = draw(life, 2) ? PURSUIT_MOTION_FLOAT16 : PURSUIT_MOTION_ABSENT,
		.slot_count = 3 + draw(life, 4),
		.socket_path = life->soak->socket,
	};
}

/* Packets of noise, to see that only their sender notices. */
static void talk_nonsense(struct life *life)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	uint32_t words[64];
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", life->soak->socket);
	if (connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0) {
		for (size_t i = 0; i < 64; i++)
			words[i] = draw(life, UINT32_MAX);
		if (draw(life, 2))
			words[0] = 1 + draw(life, 9);
		words[1] = 16 + 4 * draw(life, 60);
		if (send(fd, words, words[1], MSG_NOSIGNAL) > 0)
			atomic_fetch_add(&life->soak->nonsense, 1);
	}
	close(fd);
}

static void submit(struct life *life, struct pursuit_stream *stream, uint32_t frame_number, bool die)
{
	struct pursuit_frame *frame = pursuit_acquire(stream);
	struct pursuit_status status;
	if (!frame)
		return;
	const uint32_t height = die ? life->params.height / 2 : life->params.height;
	code_write(frame->color.data, frame->color.stride, life->params.width, height,
			   life->params.color_format == PURSUIT_COLOR_RGBA8, life->number, frame_number);
	if (die)
		raise(SIGKILL); /* half a frame */
	pursuit_submit(stream, frame);
	pursuit_get_status(stream, &status);
	life->attached |= status.state == PURSUIT_STATE_ATTACHED;
	atomic_fetch_add(&life->soak->submitted, 1);
}

static void play(struct life *life, uint32_t first, bool may_die)
{
	const uint32_t count = 10 + draw(life, 120), pause_us = draw(life, 4) ? 1000 * (4 + draw(life, 40)) : 0;
	const bool dies = may_die && draw(life, 3) == 0;
	struct pursuit_stream *stream = pursuit_open(&life->params);
	for (uint32_t i = 0; i < count && stream; i++) {
		submit(life, stream, first + i, dies && i == count - 1);
		if (pause_us)
			usleep(pause_us);
	}
	if (may_die && draw(life, 3) == 0)
		_exit(0); /* without a word */
	pursuit_close(&stream);
}

void soak_client(struct soak *soak, uint32_t number, uint64_t seed)
{
	struct life life = {.soak = soak, .number = number & 0xffffff, .noise = seed * 2 + 88172645463325252u};
	for (int i = 0; i < 8; i++)
		draw(&life, 2);
	const uint32_t streams = 1 + draw(&life, 3);
	for (uint32_t i = 0; i < streams; i++) {
		if (draw(&life, 4) == 0)
			talk_nonsense(&life);
		choose_params(&life);
		play(&life, 1 + i * 1000, i + 1 == streams);
		if (life.attached)
			atomic_fetch_add(&soak->attached, 1);
		life.attached = false;
	}
	atomic_fetch_add(&soak->left, 1);
}
