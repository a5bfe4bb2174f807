/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Who makes what settings need while pursuitd runs (live.h). On main. */
#ifndef PURSUIT_OWNERS_H
#define PURSUIT_OWNERS_H

#include "daemon/aside.h"
#include "daemon/capture.h"
#include "daemon/closer.h"
#include "daemon/lab/lab.h"
#include "daemon/live.h"
#include "daemon/output.h"
#include "daemon/server.h"

#define OWNERS_FILES 4u

struct owners {
	struct server *server;
	struct admission *admission;
	struct capture *capture;
	struct lab *lab;
	struct output *output;
	const struct log *log;
	struct closer *closer;
	/* between the two steps */
	bool lab_changes;
	struct aside asides[OWNERS_FILES];
};

/*
 * Puts aside what lies where the fresh settings have files written that those of now (NULL: none) have not. 0, or a
 * negative errno with a sentence. `asides`: OWNERS_FILES, zeroed, or NULL.
 */
int owners_keep_files(const struct settings *now, const struct settings *fresh, const struct log *log,
					  struct aside *asides, struct error *error);

/* NULL with a sentence. Before any other thread. */
struct lab *owners_create_lab(const struct settings *settings, struct clock *clock, const struct log *log,
							  struct error *error);

/* `owners` lives as long as settings may change. */
void owners_add(struct live *live, struct owners *owners);

#endif
