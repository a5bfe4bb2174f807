/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "interrupt.h"

#include <signal.h>
#include <stddef.h>

/* A signal handler has no other way to tell. */
static volatile sig_atomic_t seen;

static void note(int number)
{
	seen = 1;
	signal(number, SIG_DFL);
}

void interrupt_watch(void)
{
	static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
	struct sigaction action = {.sa_handler = note, .sa_flags = SA_RESTART};
	sigemptyset(&action.sa_mask);
	for (unsigned i = 0; i < sizeof(signals) / sizeof(*signals); i++)
		sigaction(signals[i], &action, NULL);
}

bool interrupt_seen(void)
{
	return seen != 0;
}
