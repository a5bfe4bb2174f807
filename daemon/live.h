/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Settings that change while the daemon runs, by request or because the
 * configuration was read again. Those that only main reads take effect at once,
 * those of the picture with the next real frame; no stream and no frame notices.
 * All others need a restart, and whoever sets them is told so. On main.
 */
#ifndef PURSUIT_LIVE_H
#define PURSUIT_LIVE_H

#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/options.h"
#include "daemon/output.h"

struct live {
	struct settings *settings; /* as they are now: main's */
	struct output *output;     /* has a copy of its own; NULL: none yet */
	struct log *log;
};

/*
 * "NAME=VALUE", or several with spaces between them: all, or none of them. Who is not the `owner` of the daemon may
 * change settings of the picture alone: a limit that a client may lift itself is none. 0, -EINVAL or -EPERM with a
 * sentence that names the setting and what it may be.
 */
int live_set(struct live *live, const char *text, bool owner, struct error *error);

/* Takes over what may change from `fresh`; the log tells of each. Gives how many settings took effect. */
unsigned live_reload(struct live *live, const struct settings *fresh);

/* May this setting change while the daemon runs? */
bool live_can_change(const struct option_row *row);

/* Names that mean something only together with what is linked in or with this machine. 0 or -EINVAL with a sentence. */
int live_check(const struct settings *settings, struct error *error);

#endif
