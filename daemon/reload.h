/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Reads command line and configuration files again: when one of the files has
 * changed, for SIGHUP, and on request. With a mistake in them all stays as it
 * is, and the log says where the mistake is. The folders of the files are
 * watched, and whether those above them move, so that a file may be written in
 * place, be replaced, be taken away and come back, its folders too; a burst of
 * changes counts as one. A file that is still being written is not read. Not
 * noticed: another end of a link among the folders above. On main; frames do not
 * notice.
 */
#ifndef PURSUIT_RELOAD_H
#define PURSUIT_RELOAD_H

#include <limits.h>

#include "daemon/arguments.h"
#include "daemon/error.h"
#include "daemon/live.h"
#include "daemon/log.h"
#include "daemon/loop.h"

/* The folder of the file, and that of what it is a link to. */
#define RELOAD_PLACES (2u * ARGUMENTS_FILES)

/* Folders above these: more than paths have, as a rule. */
#define RELOAD_ABOVE 64u

struct reload_place {
	char name[NAME_MAX + 1]; /* in the folder that is watched: of the file, or of the missing folder above it */
	int watch;               /* of inotify; negative: the kernel gives none */
};

struct reload {
	struct live *live;
	struct log *log;
	int argc;
	char **argv;
	const char *files[ARGUMENTS_FILES];
	unsigned file_count;
	struct error mistake; /* of the last reading; "": none */
	int watch_fd, timer_fd;
	struct loop_source *watch_source, *timer_source;
	struct reload_place places[RELOAD_PLACES];
	unsigned place_count;
	int above[RELOAD_ABOVE]; /* watches of the folders above, which may move or go */
	unsigned above_count;
	uint64_t first_ns; /* change that was not read yet; 0: none */
};

/* Keeps argv. */
void reload_init(struct reload *reload, struct live *live, struct log *log, const struct arguments *arguments, int argc,
				 char **argv);
/* Watches the files. Where the kernel has no watch to give, it says so and does without. */
void reload_watch(struct reload *reload, struct loop *loop);
void reload_finish(struct reload *reload);

/*
 * Now. `why` is what the log begins with. Gives how many settings changed, or -EINVAL with a sentence: none did, or
 * those that need something new did not (live_reload()).
 */
int reload_now(struct reload *reload, const char *why, struct error *error);

#endif
