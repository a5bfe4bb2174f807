/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A client that says what a fuzz input says, and checks what it is answered. */
#ifndef PURSUIT_TESTS_TALKER_H
#define PURSUIT_TESTS_TALKER_H

#include <stdbool.h>

#include "proto/shm.h"
#include "tests/fuzz/fuzz.h"

struct talker {
	int socket; /* -1: not connected */
	int control_fd, planes_fd, wake_fd;
	struct pursuit_shm_control *control; /* of the stream that was opened last, NULL none */
};

void talker_init(struct talker *talker);
/* Closes all. */
void talker_finish(struct talker *talker);

void talker_connect(struct talker *talker, const char *path);
/* A good HELLO. */
void talker_greet(struct talker *talker);

/* One thing that a client may do, good or bad, by the next bytes of the input. */
void talker_act(struct talker *talker, struct fuzz_input *input);

#endif
