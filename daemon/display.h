/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The display of an output over its whole life: a presenter is made of the
 * first in the list that works and given to the user; when it is lost it is
 * taken away, destroyed, and the list is tried again, with a growing delay.
 * While a later one of the list is in use, the earlier ones are looked for now
 * and then, and one that works again takes over, as does one that other settings
 * ask for. What takes over is made beside the one in use, which goes when the
 * user has gone over to the other. Of windows and devices there can be but one of
 * a kind at a time: there the one in use goes first, and comes back if the other
 * cannot be made.
 *
 * Lives on main, since windows demand that; what other threads may call says so.
 */
#ifndef PURSUIT_DISPLAY_H
#define PURSUIT_DISPLAY_H

#include "daemon/clock.h"
#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/options.h"
#include "daemon/present/presenter.h"

struct display;

struct display_params {
	struct loop *loop;
	const struct log *log;
	struct clock *clock;
	const struct settings *settings; /* copied */
	/* On a thread of the presenter: of the one in use, or of the one before, as long as that lives. */
	void (*flip)(void *data, const struct presenter *presenter, const struct presenter_flip *flip);
	void (*key)(void *data, const struct presenter_key *key);
	/*
	 * On main: this presenter from now on, NULL none. The one before stays valid until the user has answered with
	 * display_let_go(), which it does soon: at once if that one is `lost`, else when what it was given was shown.
	 * NULL that is not lost is followed by another presenter or, if none can be made, by NULL that is, which needs no
	 * answer: there was none.
	 */
	void (*change)(void *data, struct presenter *presenter, bool lost);
	void *data;
	struct vsync *vsync; /* of the presenters, NULL: none */
};

/* Makes the first presenter; change() is called before it returns. NULL with a sentence. */
struct display *display_create(const struct display_params *params, struct error *error);
/* Nobody may use the presenter any more. NULL accepted. */
void display_destroy(struct display **display);

/* Any thread: the presenter that change() took away is not used any more. */
void display_let_go(struct display *display);

/* What keeps the presenter from showing anything, though there is one; "": nothing. */
void display_get_trouble(struct display *display, char *text, size_t size);

/* Between window and full screen, where the presenter has both. */
void display_toggle_fullscreen(struct display *display);

/*
 * Other settings, in two steps: makes the presenter that they ask for, if it is another one, beside the one in use;
 * then takes it (waits until the user uses it, at most some seconds), or leaves all as it was. Where the one in use
 * has to go first it is gone after the first step already, and the other one is in use. A negative errno with a
 * sentence: none can be made, all is as before, and the second step is left out.
 */
int display_prepare(struct display *display, const struct settings *fresh, struct error *error);
void display_commit(struct display *display);
void display_abandon(struct display *display);

#endif
