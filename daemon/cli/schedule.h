/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What is displayed when, worked out before anything is rendered: the frames
 * of a recording through the pacer on a virtual clock, or each frame as a
 * prediction of the next. Plain data; nothing here depends on measured time.
 */
#ifndef PURSUIT_CLI_SCHEDULE_H
#define PURSUIT_CLI_SCHEDULE_H

#include <stdbool.h>
#include <stdint.h>

#include "args.h"
#include "daemon/engine/engine.h"
#include "daemon/record/recording.h"

/* What the schedule must know of a recorded frame. */
struct recorded_frame {
	uint64_t index;    /* in the reader */
	uint64_t position; /* counts the frames of the client from the first one of the recording, lost ones included */
	uint64_t frame_id;
	uint64_t time_ns;                         /* the moment that it depicts, made to rise */
	uint64_t interval_ns, motion_interval_ns; /* as declared, 0 unknown */
	uint32_t flags;
	uint32_t width, height;
	bool motion;
};

/* The whole frames of a recording, in order. Read once; what is damaged is named on stderr and left out. */
struct recorded_frames {
	struct recorded_frame *frames;
	uint32_t count;
	uint32_t damaged;
	uint64_t interval_ns; /* the usual one between recorded frames, 0 unknown */
};

/* 0 or a negative errno with a sentence; -ENODATA if no frame is whole. */
int recorded_frames_read(struct recorded_frames *frames, struct recording_reader *reader, struct error *error);
void recorded_frames_finish(struct recorded_frames *frames);

/* The recorded frame nearest to a moment if it is within `tolerance_ns`, otherwise -1. */
int64_t recorded_frames_find(const struct recorded_frames *frames, uint64_t time_ns, uint64_t tolerance_ns);

/* The rate of the recorded frames, a usual one if it is near one; false if unknown. */
bool recorded_frames_rate(const struct recorded_frames *frames, struct arg_rate *rate);

/* One displayed frame. */
struct showing {
	uint64_t number; /* it is written, hashed and compared under this one */
	enum engine_show show;
	bool repeat; /* the same picture as the showing before */
	double phase;
	uint64_t moment_ns; /* that it depicts */
	int64_t truth;      /* index in recorded_frames of that moment, -1: none */
};

/* One real frame that is displayed, and its showings. */
struct beginning {
	uint32_t frame; /* index in recorded_frames */
	uint32_t span;  /* recorded frames that its motion must span, 1 or more */
	struct engine_begin_params params;
	uint32_t first_showing, showing_count;
};

struct schedule {
	struct beginning *beginnings;
	uint32_t beginning_count, beginning_capacity;
	struct showing *showings;
	uint32_t showing_count, showing_capacity;
	uint32_t lost_real_frames;
	uint64_t duration_ns; /* of all that is displayed */
};

struct schedule_params {
	uint32_t every; /* only each such frame is real; 1: all */
	struct arg_rate refresh;
	uint32_t level; /* of the governor: which in-betweens the showing before stays for */
	bool numbered;  /* predictions: a recorded frame's number is its id - 1 + number_offset; else its index */
	uint64_t number_offset;
};

/* 0, -ENOMEM or -ENODATA (no frame can be real) with a sentence. */
int schedule_play(struct schedule *schedule, const struct recorded_frames *frames, const struct schedule_params *params,
				  struct error *error);
int schedule_predict(struct schedule *schedule, const struct recorded_frames *frames,
					 const struct schedule_params *params, struct error *error);
void schedule_finish(struct schedule *schedule);

/*
 * For a method that shows each real frame when the next one is begun: moments, and the truth within a twentieth of a
 * refresh period, become those of what it shows. Nothing is known of the first real frame. After schedule_play().
 */
void schedule_delay(struct schedule *schedule, const struct recorded_frames *frames, struct arg_rate refresh);

/* For those who make their own. -ENOMEM with a sentence. */
int schedule_add_beginning(struct schedule *schedule, const struct beginning *beginning, struct error *error);
int schedule_add_showing(struct schedule *schedule, const struct showing *showing, struct error *error);

#endif
