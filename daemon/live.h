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
 * shown; no stream and no frame notices. All others have an owner, who makes
 * what they need beside what there is (a window, a socket, a file) and takes it
 * over only if everything can be made: else all stays as it is, and whoever set
 * them is told why. On main.
 */
#ifndef PURSUIT_LIVE_H
#define PURSUIT_LIVE_H

#include <jansson.h>

#include "daemon/arguments.h"
#include "daemon/configuration.h"
#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/options.h"
#include "daemon/output.h"

/* Who makes what some settings need. */
struct live_owner {
	/*
	 * Makes what the fresh settings need beside what there is; all settings, whoever owns them. 0, or a negative errno
	 * with a sentence that names the setting: then nothing has changed, and nothing follows.
	 */
	int (*prepare)(void *data, const struct settings *now, const struct settings *fresh, struct error *error);
	/* After 0 one of these two: takes it over, which cannot fail; or leaves all as it was. */
	void (*commit)(void *data, const struct settings *fresh);
	void (*abandon)(void *data);
	void *data;
};

#define LIVE_OWNERS 8u

/* When a setting takes effect that is set while the daemon runs. */
enum live_effect {
	LIVE_AT_ONCE,    /* main alone reads it */
	LIVE_NEXT_FRAME, /* with the next real frame */
	LIVE_TAKEN_OVER, /* what it needs is made beside what there is */
	LIVE_ONE_WAY,    /* as before, but it cannot be switched off again */
};

struct live {
	struct settings *settings; /* as they are now: main's */
	struct output *output;     /* has a copy of its own; NULL: none yet */
	struct log *log;
	struct settings base; /* without sections and what was asked for */
	struct profiles profiles;
	struct origin origins[OPTION_ROWS]; /* of `base` */
	struct settings asked;
	bool is_asked[OPTION_ROWS];              /* by the place of the row */
	char application[EXECUTABLE_NAME_BYTES]; /* that is shown; "": none, or not known */
	struct live_owner owners[LIVE_OWNERS];
	unsigned owner_count;
};

/* `settings` are those in force, read from command line and files; the profiles are taken over, and left empty. */
void live_init(struct live *live, struct settings *settings, struct profiles *profiles, struct log *log);
void live_finish(struct live *live);

/* Asked in this order; one whose preparing may show to the outside comes late. */
void live_add_owner(struct live *live, const struct live_owner *owner);

/*
 * "NAME=VALUE", or several with spaces between them (a backslash before a space or a backslash that is part of a value):
 * all, or none of them. Who is not the `owner` of the daemon may
 * change settings of the picture alone: a limit that a client may lift itself is none, and files are written with the
 * daemon's rights. 0, -EINVAL or -EPERM with a sentence that names the setting and what it may be, or an owner's errno
 * and sentence.
 */
int live_set(struct live *live, const char *text, bool owner, struct error *error);

/* "NAME", or several: takes back what was asked for, all or none of them. As live_set(). */
int live_unset(struct live *live, const char *text, bool owner, struct error *error);

/*
 * Takes over what was read again, and its profiles, which are left empty; the log tells of each. Gives how many
 * settings took effect. Where an owner cannot make what it needs, the settings that have one stay as they are, all
 * together, and the sentence is in `mistake`; "": there was none.
 */
unsigned live_reload(struct live *live, struct arguments *fresh, struct error *mistake);

/*
 * This application ("": none) is about to be shown: the settings that its frames are to be made with, NULL if they
 * are those of now. As output_params.shown; `live` is a struct live.
 */
const struct settings *live_show(void *live, const char *application);

/*
 * Where the value of a setting comes from, for a program: {"from": "default", "command line", "set", "configuration"
 * (with "file" and "line"), "profile" (with "application"), "environment" (with "variable")}.
 */
json_t *live_origin_json(const struct live *live, const struct option_row *row);

/* The profile that is in force, NULL none. */
const struct profile *live_profile(const struct live *live);

enum live_effect live_effect_of(const struct option_row *row);
/* "at once", "with the next real frame", ... Static. */
const char *live_effect_name(enum live_effect effect);

#endif
