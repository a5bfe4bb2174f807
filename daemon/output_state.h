/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The output's inside, private to output.c (life, what main asks), output_streams.c (which stream is shown, with which
 * settings) and output_thread.c (the render thread).
 */
#ifndef PURSUIT_OUTPUT_STATE_H
#define PURSUIT_OUTPUT_STATE_H

#include <pthread.h>

#include "daemon/closer.h"
#include "daemon/display.h"
#include "daemon/output.h"
#include "daemon/render.h"

#define OUTPUT_FLIPS 64u

struct output {
	struct output_params params;
	struct display *display; /* main's */
	pthread_t thread;
	int event_fd;

	_Atomic uint64_t beats, rounds;
	_Atomic(const struct presenter *) presenter; /* in use; flips of others are nobody's */
	atomic_uint flipping;                        /* presenters' threads that may be telling the lab of a flip */
	pthread_mutex_t lock;                        /* the mailbox */
	pthread_cond_t wake;
	bool stop, woken, streams_changed, presenter_changed, view_changed, settings_changed, tee_changed;
	bool main_is_busy;
	bool wakes_soon; /* the render thread, by itself, if nobody wakes it */
	bool started;    /* the thread has said whether it could start */
	int start_result;
	struct error start_error;
	struct stream *streams[OUTPUT_STREAMS]; /* referenced; in the order of opening */
	uint32_t stream_count;
	struct output_presenter {
		struct presenter *presenter; /* NULL: none */
		bool lost;                   /* the one before it */
		bool answer;                 /* there was one before it, which the display waits for, seen here or not */
		char name[32], display[192]; /* as output_info says */
	} wished_presenter;
	uint32_t view;
	struct settings wished;       /* by main, for the render thread */
	struct tee *wished_tee;       /* with tee_changed */
	struct engine *wished_engine; /* NULL: none */
	struct output_flip {
		const struct presenter *presenter;
		struct presenter_flip flip;
	} flips[OUTPUT_FLIPS];
	uint32_t flip_count;
	struct presenter_key keys[OUTPUT_KEYS]; /* for main */
	uint32_t key_count, lost_keys;
	struct output_info info;

	pthread_mutex_t stats_lock;
	struct stats published;

	pthread_mutex_t record_lock;
	struct recorder *recorder;

	struct output_prepared {
		bool other_tee;
		struct tee *tee;       /* NULL: none */
		struct engine *engine; /* NULL: that which there is */
		bool display;
	} prepared; /* main's */

	/* the render thread's own */
	struct settings settings; /* a copy: some change while it runs */
	struct settings due;      /* what it becomes next */
	struct output_presenter coming;
	struct stats stats;
	struct render render;
	struct stream *own[OUTPUT_STREAMS]; /* referenced copy of streams */
	uint32_t own_count;
};

/* With the lock: the render thread looks into its mailbox. */
void output_wake_locked(struct output *output);

/* With the lock: the settings that the next real frames are made with. */
void output_wish_settings(struct output *output, const struct settings *settings);

/* Any thread: the tee (NULL: none), an output's, is to be closed without anybody waiting for it. */
void output_close_tee(void *output, struct tee *tee);

/*
 * The render thread: main is to tell the client of this stream, and to end it if it is broken. Kept with the stream, so
 * that it needs no room and goes with it; one that main has not seen yet is replaced, but for the end.
 */
void output_complain(struct output *output, enum output_event_kind kind, struct stream *stream,
					 const struct refusal *refusal);

/* The render thread; `output` is a struct output. */
void *output_run(void *output);

#endif
