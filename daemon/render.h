/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The render thread's work, in steps that return when the next one is due.
 * Private to the output: output.c calls it, render.c decides, draw.c draws.
 *
 * A step does the most urgent thing that can be done now:
 *   1. take a real frame and draw it for the first vblank that it can reach;
 *   2. draw the plain picture that stands by for late in-betweens;
 *   3. draw the in-between for the next vblank that has no picture, up to the
 *      vblank where the next real frame is expected; beyond it only when that
 *      vblank can no longer get a real one.
 */
#ifndef PURSUIT_RENDER_H
#define PURSUIT_RENDER_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "daemon/busy.h"
#include "daemon/cost.h"
#include "daemon/engine/engine.h"
#include "daemon/governor.h"
#include "daemon/output.h"
#include "daemon/present/pacer.h"
#include "daemon/present/presenter.h"
#include "daemon/showing.h"
#include "daemon/tees.h"
#include "daemon/view.h"

#define RENDER_NEVER UINT64_MAX

/* What the render thread calls on its owner. */
struct render_owner {
	void *data;
	void (*record)(void *data, const struct frame *frame);
	void (*report)(void *data, enum output_event_kind kind, struct stream *stream, const struct refusal *refusal);
	void (*engine_made)(void *data, const struct engine_info *info);
	void (*close_tee)(void *data, struct tee *tee); /* takes it; nobody waits */
};

struct render {
	struct settings *settings; /* the owner's; only this thread changes them */
	struct clock *clock;
	const struct log *log;
	struct render_owner owner;
	struct engine *engine;
	struct engine *other_engine;               /* to be used from the next real frame on; NULL: none */
	bool stand_in;                             /* it is one on the CPU, in place of one that was lost */
	uint64_t engine_retry_ns, engine_delay_ns; /* after a loss */
	uint64_t engine_made_ns;
	struct presenter *presenter; /* the display's; NULL: none */
	bool between_presenters;     /* there is none since another is being made: the newest frame waits for it */
	struct {
		struct stream *stream; /* referenced; NULL: none */
		struct pursuit_feedback report;
	} waiting;
	struct {
		bool wished;
		struct presenter *presenter; /* that is to be used next, NULL none */
		bool at_once;
		uint64_t since_ns;
	} next;
	const struct presenter_context *context; /* that it offers to draw in; NULL: none */
	struct engine_context brought;           /* the same, as the engine wants it */
	bool context_shunned;                    /* an engine was lost in it */
	bool through_memory;                     /* the presenter has refused a picture in GL */
	struct grid grid;
	uint64_t lead_ns; /* that the presenter wants pictures before their vblank */
	struct pacer pacer;
	struct showing showing;
	struct lab *lab; /* NULL: none */
	struct view view;
	struct tees tees;
	bool lacks_picture;          /* the presenter had none to draw into, and that was said */
	struct log_limit lack_limit; /* of saying so */
	struct log_limit draw_limit; /* of the engine's complaints */
	bool settings_changed;       /* the engine does not know yet */
	struct engine_params params; /* that the engine was given last; its method is a name below */
	char params_method[32];
	bool redraw;           /* the view has changed: a picture that stays is drawn anew */
	bool show_held;        /* `frame`, which the stream still lends, is due once more, unless a newer one comes first */
	struct stats *stats;   /* the owner's; only this thread touches them */
	struct stream *stream; /* the one that is shown, NULL none; the owner's reference */

	struct frame frame; /* begun last */
	struct engine_begin_params begun_with;
	uint64_t take_again_ns; /* after a refused frame: one look a vblank is enough for a client that sends nonsense */
	uint64_t hold_until_ns; /* a frame that came too early for a vblank of its own is not begun before */
	bool begun;             /* the engine has it */
	bool report_due;        /* the engine's report about it was not counted yet */
	bool boosted;           /* it gives light that in-betweens take away */
	bool still;             /* its in-betweens look like itself */
	bool standby_done;
	bool front_plain; /* the picture queued last may stay for good */
	bool front_black; /* it is black: nobody's */
	bool orphan;      /* the stream of the frame begun last is gone */
	struct {
		uint8_t *data; /* packed; NULL: none */
		uint32_t width, height;
	} kept;                 /* what stays of an orphan where the engine does not have it any more */
	uint64_t stream_number; /* of the frame taken last */
	uint64_t group, serial;
	uint32_t n;
	uint64_t real_vblank;   /* of its first showing */
	uint64_t next_vblank;   /* first one that was not decided */
	uint32_t pause_vblanks; /* that nothing was due at, in a row */
	uint32_t stay_tries;    /* to queue the picture that stays through the pause */
	uint64_t awaited;       /* serial of the picture queued last, whose flip was not heard of yet; 0: none */
	uint64_t awaited_vblank;
	bool paused; /* the presenter sleeps */
	struct {
		uint32_t pictures;          /* queued, or without room for them, since the last vblank that was reported */
		uint64_t first_ns, last_ns; /* when that was */
	} unanswered;
	struct cost real_cost, between_cost, plain_cost, empty_cost;
	struct busy busy; /* with pictures other than real ones */
	struct governor governor;
	bool passes_through;   /* the engine makes nothing of frames but a picture */
	uint64_t work_ns;      /* drawing since the last real frame began */
	uint64_t late_counted; /* late in-betweens that the governor knows of */
	uint64_t margin_ns;    /* on top of real_cost: grows with each late real frame, shrinks with each that is in time */
};

/* Begins the file of what is shown, if one is wished for, and makes the engine. 0 or -errno with a sentence. */
int render_start(struct render *render, struct error *error);
void render_finish(struct render *render);

/* Presents there from now on, beginning anew; NULL: nowhere, until there is one again. */
void render_set_presenter(struct render *render, struct presenter *presenter);
/*
 * The same soon; no real frame is begun until then. at_once: the one in use is of no use any more. With NULL the newest
 * frame waits then for the presenter that is on its way; at once, where nobody knows when there will be one, all are
 * answered with REPLACED.
 */
void render_wish_presenter(struct render *render, struct presenter *presenter, bool at_once);
/*
 * Goes over to the one wished for: at the boundary of a frame, when each real frame that was given to the one in use
 * has been shown there and the next one is there, at most a tenth of a second after the wish, or two seconds where one
 * is to be shown still. The picture that stays is drawn for the new one. Has it gone over now?
 */
bool render_go_over(struct render *render);
/* What is drawn over the pictures, VIEW_... or-ed. */
void render_set_view(struct render *render, uint32_t switches);
/* The next real frames are made with these; checked already. */
void render_set_settings(struct render *render, const struct settings *settings);
/* What is drawn from now on goes there (NULL: nowhere), what was drawn before to the one before. Takes it. */
void render_set_tee(struct render *render, struct tee *tee);
/* The next real frame is the first that is made with it. Takes it; it is on no thread. */
void render_set_engine(struct render *render, struct engine *engine);
/* Takes over the presenter's grid as it is now. Has it changed? */
bool render_follow_grid(struct render *render);

/*
 * All streams that there are; the last one is shown from now on (none: the picture stays, or black). Others of before
 * are not touched any more.
 */
void render_set_streams(struct render *render, struct stream *const *streams, uint32_t count);
/* A stream that is not shown: its frames are taken and answered. */
void render_skip_frames(struct render *render, struct stream *stream);
/* A vblank is over. */
void render_flip(struct render *render, const struct presenter_flip *flip);

/* Has the presenter reported no vblank for long, though there were pictures for it? Idle is not stuck. */
bool render_is_stuck(const struct render *render);

/* Does one thing, or nothing. The time when the next step is due: 0 at once, RENDER_NEVER only when something happens.
 */
uint64_t render_step(struct render *render);

/* Nothing is due at the vblanks from next_vblank to before this one. */
void render_plan_pause_until(struct render *render, uint64_t vblank);

/* The first vblank that a picture queued now can be shown at. */
uint64_t render_first_vblank(const struct render *render);

/* What a real frame from its intake to its picture, there as early as the presenter wants it, is expected to take. */
uint64_t render_real_cost(const struct render *render);

/* What pictures other than real ones cost is to be learned anew: they are made or written in another way now. */
void render_forget_costs(struct render *render);

/* A picture was queued, or would have been if the presenter had room: vblanks are to be reported from now on. */
void render_expect_flips(struct render *render);

/* ---- render_waiting.c ---- */

/* Takes the newest frame of the stream that is shown, to be shown when there is a presenter again. */
void render_keep_newest(struct render *render);
/* The frame that waits, if any, is not to be shown. */
void render_answer_waiting(struct render *render);
/* The frame begun is the one that waits, if it is: it is answered when it has been shown. */
void render_show_waiting(struct render *render);

/* ---- draw.c ---- */

/* Takes the newest frame and draws it, unless it is refused. */
void draw_real(struct render *render, uint64_t now_ns);
/* Draws the in-between that was decided for this vblank. */
void draw_in_between(struct render *render, const struct pacer_decision *decision, uint64_t vblank);
/* Begins render->frame, which was shown before or would have been, and draws it, to stay from this vblank on. */
void draw_held(struct render *render, uint64_t vblank);
/* Draws the plain picture, as standby or, for a vblank > 0, to be shown there. */
void draw_plain(struct render *render, uint64_t vblank);
/* Queues a black picture with what is drawn over it: before the first frame, and when its client has gone. */
void draw_empty(struct render *render, uint64_t vblank);
/* Adds the engine's report about the frame begun last, now that all its pictures are drawn. */
void draw_count_report(struct render *render);

/*
 * Queues a picture of this show for a vblank; -ETIME if it is over. With an error the picture is the caller's still.
 */
int draw_queue(struct render *render, struct presenter_image *image, uint64_t vblank, enum stats_show show,
			   double phase);

/* ---- draw_kept.c ---- */

/* The engine goes, or might: an orphan's picture is kept in memory. Nothing for others. */
void draw_keep(struct render *render);
void draw_forget_kept(struct render *render);
/* Draws it, to stay from this vblank on. */
void draw_kept(struct render *render, uint64_t vblank);

/* ---- draw_engine.c ---- */

/* The engine's settings, at the governor's level. 0 or -errno with a sentence. */
int draw_get_params(const struct render *render, struct engine_params *params, struct error *error);
/* The engine has these now; where they take other work, what pictures cost is forgotten. */
void draw_note_params(struct render *render, const struct engine_params *params);
/* The engine's context is to be that which the presenter offers, if any: one that cannot go on is destroyed. */
void draw_follow_context(struct render *render);
/* Makes the engine. 0 or -errno with a sentence. */
int draw_make_engine(struct render *render, struct error *error);
/* Does what engine_begin() or engine_render() gave mean that the engine is of no more use? */
bool draw_is_lost(const struct render *render, int result);
/*
 * Destroys it and puts one on the CPU in its place, which has no frame yet; NULL if not even that can be made. The real
 * one is tried again after 100 ms, then 200, up to a minute if it does not last.
 */
void draw_lose_engine(struct render *render, int result, const char *why);
/* Makes a lost engine anew, if there is none at all, when its time has come. Is there one? */
bool draw_revive_engine(struct render *render, uint64_t now_ns);
/* Between two frames: the engine that render_set_engine() gave, if any, in place of the one that there is. */
void draw_take_engine(struct render *render);
/* Before a frame is begun: the real engine again in place of the one that stands in, when its time has come. */
void draw_replace_stand_in(struct render *render, uint64_t now_ns);

#endif
