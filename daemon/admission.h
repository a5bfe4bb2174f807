/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Who may be a client: the settings allow-users and allow-groups, and the numbers of what they name. Names may be known
 * to a server alone, which may hang: while the daemon runs they are looked up on a thread of its own, one at a time,
 * and who was let in before goes on to be until they are known. On main.
 */
#ifndef PURSUIT_ADMISSION_H
#define PURSUIT_ADMISSION_H

#include <stdint.h>

#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/options.h"
#include "daemon/peer.h"

struct admission;

struct admission_params {
	const struct log *log;
	const struct settings *settings;
	uint64_t patience_ns; /* that main waits for an answer; 0: five seconds */
};

/*
 * Looks up what the settings name, however long it takes: until it is known nobody could be let in or turned away. No
 * thread is made yet. NULL with a sentence.
 */
struct admission *admission_create(const struct admission_params *params, struct error *error);
/* NULL accepted. Before its loop. */
void admission_destroy(struct admission **admission);

/* Answers that come later than main waits are heard of in this loop. 0 or a negative errno with a sentence. */
int admission_watch(struct admission *admission, struct loop *loop, struct error *error);

bool admission_allows(const struct admission *admission, const struct peer *peer, int socket);

/*
 * As a live_owner (live.h), `data` is the admission. A name that there is not is refused. Where no answer comes in time
 * the settings are taken over all the same, who may be a client stays as it was until it comes, and for good if it says
 * that there is no such name; the log tells.
 */
int admission_prepare(void *data, const struct settings *now, const struct settings *fresh, struct error *error);
void admission_commit(void *data, const struct settings *fresh);
void admission_abandon(void *data);

#endif
