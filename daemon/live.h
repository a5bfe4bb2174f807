/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Settings that change while the daemon runs. Each comes from the last of these
 * that has it:
 *
 *   1. the default;
 *   2. command line and configuration files, in their order;
 *   3. the section of the application that is shown (settings of the picture);
 *   4. what was asked for while it runs (`pursuit set`, a key), until it is
 *      taken back or the daemon ends.
 *
 * Those that only main reads take effect at once, those of the picture with the
 * next real frame, and with the first one of a client when that comes to be
 * shown; no stream and no frame notices. All others need a restart, and whoever
 * sets them is told so. On main.
 */
#ifndef PURSUIT_LIVE_H
#define PURSUIT_LIVE_H

#include "daemon/configuration.h"
#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/options.h"
#include "daemon/output.h"

struct live {
	struct settings *settings; /* as they are now: main's */
	struct output *output;     /* has a copy of its own; NULL: none yet */
	struct log *log;
	struct settings base; /* without sections and what was asked for */
	struct profiles profiles;
	struct settings asked;
	bool is_asked[OPTION_ROWS];              /* by the place of the row */
	char application[EXECUTABLE_NAME_BYTES]; /* that is shown; "": none, or not known */
};

/* `settings` are those in force, read from command line and files; the profiles are taken over, and left empty. */
void live_init(struct live *live, struct settings *settings, struct profiles *profiles, struct log *log);
void live_finish(struct live *live);

/*
 * "NAME=VALUE", or several with spaces between them: all, or none of them. Who is not the `owner` of the daemon may
 * change settings of the picture alone: a limit that a client may lift itself is none. 0, -EINVAL or -EPERM with a
 * sentence that names the setting and what it may be.
 */
int live_set(struct live *live, const char *text, bool owner, struct error *error);

/* "NAME", or several: takes back what was asked for, all or none of them. As live_set(). */
int live_unset(struct live *live, const char *text, bool owner, struct error *error);

/*
 * Takes over what may change, and the profiles, which are left empty; the log tells of each. Gives how many settings
 * took effect.
 */
unsigned live_reload(struct live *live, const struct settings *fresh, struct profiles *profiles);

/*
 * This application ("": none) is about to be shown: the settings that its frames are to be made with, NULL if they
 * are those of now. As output_params.shown; `live` is a struct live.
 */
const struct settings *live_show(void *live, const char *application);

/* The profile that is in force, NULL none. */
const struct profile *live_profile(const struct live *live);

/* May this setting change while the daemon runs? */
bool live_can_change(const struct option_row *row);

#endif
