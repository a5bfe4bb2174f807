/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * An output: presenter, pacer and engine on a render thread of its own. Streams
 * are given to it; the one opened or focused last is shown, frames of the others
 * are taken and answered with REPLACED, and their control pages say background.
 *
 * The render thread takes frames in itself (the slot that it reads must not be
 * exchanged meanwhile); main only wakes it. Main never waits for it, apart from
 * output_create() and output_destroy().
 */
#ifndef PURSUIT_OUTPUT_H
#define PURSUIT_OUTPUT_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/clock.h"
#include "daemon/closer.h"
#include "daemon/error.h"
#include "daemon/intake.h"
#include "daemon/lab/lab.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/options.h"
#include "daemon/present/grid.h"
#include "daemon/present/presenter.h"
#include "daemon/record/recorder.h"
#include "daemon/stats.h"
#include "daemon/view.h"

#define OUTPUT_STREAMS 64u
#define OUTPUT_KEYS 64u

/* What the render thread tells main. */
enum output_event_kind {
	OUTPUT_FRAME_REFUSED, /* the stream goes on. Of a stream the newest, which is always told, but few a second */
	OUTPUT_STREAM_BROKEN, /* nothing more is taken from it: end it. Always told */
	OUTPUT_KEY, /* a key was pressed in the presenter's window; with OUTPUT_KEYS waiting it is lost, and said so */
};

struct output_event {
	enum output_event_kind kind;
	uint64_t client_id;
	uint64_t stream_id;
	uint64_t stream; /* its number: the client may have closed it since, and opened another with this id */
	struct refusal refusal;
	struct presenter_key key;
};

struct output_params {
	struct loop *loop;               /* main's */
	const struct settings *settings; /* copied */
	struct clock *clock;
	const struct log *log;
	struct lab *lab;       /* NULL: none; outlives the output */
	struct closer *closer; /* outlives the output */
	/*
	 * On main, before another application ("": none, or not known) comes to be shown: the settings that its frames are
	 * made with, all of them, or NULL: as before. NULL: never asked.
	 */
	const struct settings *(*shown)(void *data, const char *application);
	void *data;
};

struct output_info {
	char method[32];
	char display[192];  /* which one in which mode; "" without one */
	char trouble[96];   /* what keeps the presenter from showing anything; "": nothing */
	char presenter[32]; /* "none": lost, and no other works */
	char renderer[128], context[32];
	bool software;
	struct grid grid;                       /* as it is now */
	enum presenter_time_source time_source; /* of the last flip */
};

struct output;

/* Opens the display, starts the render thread and waits until its engine is there. NULL with a sentence. */
struct output *output_create(const struct output_params *params, struct error *error);
/*
 * Nothing is drawn from now on, whatever goes after this: streams that end with the daemon are no clients that leave.
 */
void output_stop(struct output *output);
/* Stops and joins. NULL accepted. */
void output_destroy(struct output **output);

/* ---- main thread ---- */

/* Keeps a reference. False: too many streams. */
bool output_add_stream(struct output *output, struct stream *stream);
void output_remove_stream(struct output *output, struct stream *stream);

/*
 * How often the render thread has gone round with all well; it stands still when that sleeps or is stuck, and while
 * the presenter reports no vblanks though it should (render_is_stuck()).
 */
uint64_t output_beats(const struct output *output);
/* How often it has gone round, well or not. Beside output_wake() it stands only in one long step. */
uint64_t output_rounds(const struct output *output);

/* Shows the newest stream of this client from the next vblank that it has a frame for. False: it has none. */
bool output_focus(struct output *output, uint64_t client_id);
/* The stream that is shown. False: there is none. */
bool output_get_shown(struct output *output, uint64_t *client_id, uint64_t *stream_id);

/* Something may have changed: a stream has a new frame. Never waits long. */
void output_wake(struct output *output);

/* Readable when there are events; the next event, false if there is none. */
int output_event_fd(const struct output *output);
bool output_next_event(struct output *output, struct output_event *event);

/* The engine's settings, governor and level from the next real frame on; checked already (live.h). Others are ignored.
 */
void output_set_settings(struct output *output, const struct settings *settings);
/*
 * All settings, in two steps: makes what the fresh ones need beside what there is (presenter, engine, file of what is
 * shown), then takes it over, each at the boundary of a frame; or leaves all as it was. A negative errno with a
 * sentence: it cannot be made, all is as before, and the second step is left out. These wait, for an engine some
 * seconds; frames that come meanwhile are taken and shown.
 */
int output_prepare(struct output *output, const struct settings *now, const struct settings *fresh,
				   struct error *error);
void output_commit(struct output *output, const struct settings *fresh);
void output_abandon(struct output *output);
/* Switches a part of the view (VIEW_...) on or off. */
void output_toggle_view(struct output *output, uint32_t part);
void output_toggle_fullscreen(struct output *output);

/* As if this key had been pressed in the presenter's window: an event. */
void output_press_key(struct output *output, const struct presenter_key *key);

/* Frames taken from now on go to this recorder (NULL: none) too. Gives the one before back. */
struct recorder *output_set_recorder(struct output *output, struct recorder *recorder);

void output_get_info(struct output *output, struct output_info *info);
/* A copy of the statistics, as the render thread has published them last: at each vblank and when it goes to sleep. */
void output_get_stats(struct output *output, struct stats *stats);

#endif
