/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the three kinds of processes of the soak share: supervisor, daemon, clients. */
#ifndef PURSUIT_TESTS_SOAK_H
#define PURSUIT_TESTS_SOAK_H

#include <stdatomic.h>
#include <stdint.h>
#include <sys/types.h>

/* In memory that all see. */
struct soak {
	char socket[96];
	_Atomic uint64_t verified; /* pictures handed to the presenter that are exactly one frame of one client */
	_Atomic uint64_t spoilt;   /* that are not */
	_Atomic uint32_t spoilt_client, spoilt_frame;
	_Atomic uint64_t submitted, attached, killed, left, nonsense; /* by clients */
	_Atomic uint32_t clients;                                     /* numbers given out */
};

/* The daemon, its pictures checked on their way to the headless presenter; until SIGTERM. Its exit status. */
int soak_daemon(struct soak *soak);

/* One client's life, by chance from this seed: frames of one size and format, at some rate, and some end. */
void soak_client(struct soak *soak, uint32_t number, uint64_t seed);

#endif
