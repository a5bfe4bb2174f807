/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * libpursuit: the client shim. The only installed header; needs nothing else.
 *
 * A game opens a stream, and for each rendered frame takes a slot of shared
 * memory, fills its planes, and submits it. The daemon makes the in-between
 * frames and presents. No call waits for the daemon: with no daemon, a slow
 * one or a dead one every call returns at once (a submit then changes nothing
 * but counters), and the stream attaches again by itself when the daemon is
 * back. The only calls that may wait say so.
 *
 *   struct pursuit_stream_params params = { .width = 1280, .height = 720,
 *           .color_format = PURSUIT_COLOR_RGBA8,
 *           .depth_format = PURSUIT_DEPTH_FLOAT32,
 *           .motion_format = PURSUIT_MOTION_FLOAT16,
 *           .motion_kind = PURSUIT_MOTION_IS_BACKWARD };
 *   struct pursuit_stream *stream = pursuit_open(&params);
 *   for (;;) {
 *           struct pursuit_frame *frame = pursuit_acquire(stream);
 *           if (frame) {
 *                   ... write frame->color.data, frame->depth.data, frame->motion.data ...
 *                   frame->time_ns = simulated moment on CLOCK_MONOTONIC;
 *                   pursuit_submit(stream, frame);
 *           }
 *   }
 *   pursuit_close(&stream);
 *
 * fork(): the stream stays the parent's, and so do frames that are acquired. A
 * child that uses or closes its copy does the parent no harm: it attaches anew.
 *
 * Threads: a stream belongs to one thread at a time, of the caller's choice;
 * different streams are independent. The library starts no thread, installs no
 * signal handler, never changes the GL state that the caller can see, and
 * never prints.
 *
 * NULL streams and frames are accepted everywhere and do nothing.
 * Strings are UTF-8. Sizes are pixels, times CLOCK_MONOTONIC nanoseconds.
 */
#ifndef PURSUIT_H
#define PURSUIT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PURSUIT_VERSION_MAJOR 0
#define PURSUIT_VERSION_MINOR 1
#define PURSUIT_VERSION_PATCH 0

#if defined(__GNUC__)
#define PURSUIT_API __attribute__((visibility("default")))
#else
#define PURSUIT_API
#endif

enum pursuit_color_format {
	PURSUIT_COLOR_DEFAULT = 0, /* PURSUIT_COLOR_BGRA8 */
	PURSUIT_COLOR_BGRA8 = 1,   /* fastest */
	PURSUIT_COLOR_RGBA8 = 2,
	PURSUIT_COLOR_RGB10A2 = 3,
	PURSUIT_COLOR_RGBA16F = 4 /* linear light unless color_curve says otherwise */
};

enum pursuit_depth_format {
	PURSUIT_DEPTH_ABSENT = 0, /* folds are resolved by drawing order: worse pictures */
	PURSUIT_DEPTH_UNORM16 = 16,
	PURSUIT_DEPTH_UNORM24 = 17, /* uint32, depth in the low 24 bits */
	PURSUIT_DEPTH_FLOAT32 = 18
};

enum pursuit_depth_kind {
	PURSUIT_DEPTH_IS_DEVICE = 0,   /* 0 at near, 1 at far */
	PURSUIT_DEPTH_IS_REVERSED = 1, /* 1 at near, 0 at far */
	PURSUIT_DEPTH_IS_LINEAR = 2    /* a distance; only PURSUIT_DEPTH_FLOAT32, with near_ and far_distance set */
};

enum pursuit_motion_format {
	PURSUIT_MOTION_ABSENT = 0,   /* every in-between repeats the real frame */
	PURSUIT_MOTION_FLOAT16 = 32, /* two halves a pixel: x, y */
	PURSUIT_MOTION_FLOAT32 = 33  /* two floats a pixel: x, y */
};

enum pursuit_motion_kind {
	PURSUIT_MOTION_IS_BACKWARD = 0, /* position now minus position in the previous frame */
	PURSUIT_MOTION_IS_FORWARD = 1   /* position in the next frame minus position now */
};

enum pursuit_ui_format {
	PURSUIT_UI_ABSENT = 0,
	PURSUIT_UI_BGRA8 = 1, /* premultiplied alpha */
	PURSUIT_UI_RGBA8 = 2
};

enum pursuit_object_id_format {
	PURSUIT_OBJECT_ID_ABSENT = 0,
	PURSUIT_OBJECT_ID_UINT8 = 48,
	PURSUIT_OBJECT_ID_UINT16 = 49,
	PURSUIT_OBJECT_ID_UINT32 = 50
};

enum pursuit_color_curve {
	PURSUIT_CURVE_DEFAULT = 0, /* sRGB; linear for RGBA16F */
	PURSUIT_CURVE_IS_SRGB = 1,
	PURSUIT_CURVE_IS_GAMMA = 2, /* light = code ^ color_gamma */
	PURSUIT_CURVE_IS_LINEAR = 3
};

/* What a stream carries. Zeroed fields are defaults; only width and height must be set. */
struct pursuit_stream_params {
	uint32_t width;  /* colour plane, 1 to 16384 */
	uint32_t height; /* colour plane, 1 to 16384 */
	enum pursuit_color_format color_format;
	enum pursuit_color_curve color_curve;
	float color_gamma; /* 1 to 5, only with PURSUIT_CURVE_IS_GAMMA */
	enum pursuit_depth_format depth_format;
	enum pursuit_depth_kind depth_kind;
	float near_distance; /* > 0; 0: unknown */
	float far_distance;  /* > near_distance, infinity allowed; 0: unknown */
	enum pursuit_motion_format motion_format;
	enum pursuit_motion_kind motion_kind;
	uint32_t geometry_width; /* depth, motion and object id planes; 0: as width */
	uint32_t geometry_height;
	enum pursuit_ui_format ui_format; /* the UI plane has width x height */
	enum pursuit_object_id_format object_id_format;
	uint32_t slot_count;     /* 3 to 8; 0: 4 */
	const char *socket_path; /* NULL: $PURSUIT_SOCKET if set; else $XDG_RUNTIME_DIR/pursuit/socket, and
								where no daemon answers there, /run/pursuit/socket. Copied. */
	const char *name;        /* what the daemon calls this stream; NULL: the program's name. Copied. */
	int wants_keys;          /* 1: pursuit_next_key() tells of keys pressed in the daemon's window */
};

/* One plane of a slot: `height` rows from top to bottom, `stride` bytes apart. data is NULL if absent. */
struct pursuit_plane_memory {
	uint8_t *data;
	size_t stride;
	uint32_t width;
	uint32_t height;
};

enum pursuit_frame_flag {
	PURSUIT_FLAG_CUT = 1,            /* nothing in common with the frame before */
	PURSUIT_FLAG_MOTION_INVALID = 2, /* ignore the motion plane */
	PURSUIT_FLAG_MATRICES = 4,       /* the two matrices are set */
	PURSUIT_FLAG_JITTER = 8,         /* jitter_x and jitter_y are set */
	PURSUIT_FLAG_DAMAGE = 32         /* damage_count and damage say what changed */
};

#define PURSUIT_DAMAGE_RECTANGLES 8

/* Pixels of the colour plane, y from the top. */
struct pursuit_damage {
	uint32_t x, y;
	uint32_t width, height; /* 1 or more, within the plane */
};

/*
 * A slot that the caller fills. Owned by the stream; the caller may write to it
 * from pursuit_acquire() to pursuit_submit() or pursuit_cancel(). Every field
 * but the planes is reset by pursuit_acquire().
 */
struct pursuit_frame {
	struct pursuit_plane_memory color;
	struct pursuit_plane_memory depth;
	struct pursuit_plane_memory motion;
	struct pursuit_plane_memory ui;
	struct pursuit_plane_memory object_id;
	uint64_t time_ns;            /* the moment that the picture depicts; 0: the moment of submit */
	uint64_t real_interval_ns;   /* since the frame submitted before; 0: taken from the times */
	uint64_t motion_interval_ns; /* that the motion spans; 0: the real interval. Set it where they differ,
									as after a rendered frame that was not submitted */
	uint32_t flags;              /* enum pursuit_frame_flag, or-ed */
	float jitter_x;              /* pixels, +x right */
	float jitter_y;              /* pixels, +y down */
	float view_projection[16];   /* column-major, clip = M x world */
	float previous_view_projection[16];
	/*
	 * With PURSUIT_FLAG_DAMAGE: outside these rectangles all planes are as in the frame submitted before, and nothing
	 * moves there; a count of 0 says that nothing has changed at all. The planes must hold the whole picture
	 * nevertheless. Saves the daemon work.
	 */
	uint32_t damage_count; /* 0 to PURSUIT_DAMAGE_RECTANGLES */
	struct pursuit_damage damage[PURSUIT_DAMAGE_RECTANGLES];
};

enum pursuit_state {
	PURSUIT_STATE_DETACHED = 0, /* no daemon; tried again by itself */
	PURSUIT_STATE_ATTACHING = 1,
	PURSUIT_STATE_ATTACHED = 2,
	PURSUIT_STATE_REFUSED = 3 /* the daemon said no: pursuit_get_status() says why; tried again, rarely */
};

struct pursuit_status {
	enum pursuit_state state;
	uint64_t submitted;    /* frames given to pursuit_submit() and pursuit_gl_submit() */
	uint64_t published;    /* of these, published to a daemon */
	uint64_t replaced;     /* of these, replaced by a newer one before the daemon took them */
	uint64_t no_slot;      /* pursuit_acquire() found no free slot */
	uint64_t attaches;     /* how often a daemon accepted the stream */
	uint64_t bytes_copied; /* by the shim itself: GL read-back into slots */
	double refresh_hz;     /* of the display; 0: unknown */
	int background;        /* 1: the daemon shows another stream instead of this one */
	char message[192];     /* why the state is what it is, for a person */
};

enum pursuit_shown {
	PURSUIT_SHOWN = 1,    /* shown; the times are known */
	PURSUIT_REPLACED = 2, /* never shown: a newer frame came first */
	PURSUIT_REFUSED = 3   /* the daemon found it invalid */
};

/* What became of one real frame. A time of 0 is unknown. */
struct pursuit_feedback_report {
	uint64_t frame_id; /* as pursuit_submit() returned it */
	uint64_t submit_ns;
	uint64_t intake_ns;
	uint64_t target_ns; /* the vblank aimed at */
	uint64_t ready_ns;  /* its picture was done */
	uint64_t flip_ns;   /* it was first shown */
	uint64_t vblank;    /* the number of that vblank */
	enum pursuit_shown shown;
	uint32_t vblanks;          /* that it and its in-betweens filled */
	uint32_t in_betweens;      /* of these, in-between frames */
	uint32_t late_in_betweens; /* of these, vblanks whose in-between was not ready: plain, or the picture before */
	uint64_t next_submit_ns;   /* the daemon's hint when this was written; pursuit_next_start() knows newer ones */
};

/* A key was pressed in the daemon's window while this stream was shown. */
struct pursuit_key {
	uint64_t time_ns; /* CLOCK_MONOTONIC */
	uint32_t code;    /* Unicode code point, lower case; 27: escape */
};
/* Not a key: the window is to be closed. Like 'q' and escape it asks the program to end. */
#define PURSUIT_KEY_CODE_CLOSE 0x110100u

struct pursuit_stream;

/* The version that the library was built as, "0.1.0". Static. Any thread. */
PURSUIT_API const char *pursuit_version(void);

/*
 * Opens a stream and begins to attach. Returns NULL with errno: EINVAL (a
 * parameter is out of range), ENOMEM. A missing daemon is no error, nor is a
 * lack of file descriptors: pursuit_get_status() says so, and it is tried again.
 * The caller owns the stream and gives it to pursuit_close().
 */
PURSUIT_API struct pursuit_stream *pursuit_open(const struct pursuit_stream_params *params);

/* Closes and clears *stream; frames still acquired are gone with it. NULL and a pointer to NULL are accepted. */
PURSUIT_API void pursuit_close(struct pursuit_stream **stream);

/*
 * A slot to fill, or NULL when none is free: slot_count - 2 frames can be
 * acquired at once - then skip this frame. Works without a daemon, so that a
 * caller needs no second path. The planes hold an earlier frame's pixels or
 * zeros. A frame stays valid memory until it is submitted or cancelled, even
 * if the daemon dies meanwhile; it is published only to the daemon that was
 * attached when it was acquired.
 */
PURSUIT_API struct pursuit_frame *pursuit_acquire(struct pursuit_stream *stream);

/*
 * Publishes the frame; it is the daemon's from then on. Frames are published
 * in the order of these calls. Returns the frame's id (1, 2, ...), also when no
 * daemon is attached; 0 if `frame` is not an acquired one of this stream.
 */
PURSUIT_API uint64_t pursuit_submit(struct pursuit_stream *stream, struct pursuit_frame *frame);

/* Gives an acquired frame back unpublished. */
PURSUIT_API void pursuit_cancel(struct pursuit_stream *stream, struct pursuit_frame *frame);

/*
 * Fetches the oldest feedback not yet fetched. 1: *report is filled, 0: none.
 * If the caller polls too rarely the oldest reports are lost, never the newest.
 */
PURSUIT_API int pursuit_poll_feedback(struct pursuit_stream *stream, struct pursuit_feedback_report *report);

/*
 * When to begin the next frame so that it is submitted just in time for the vblank that the daemon expects it at: the
 * least latency that the present rate allows. CLOCK_MONOTONIC ns; a moment that is over means at once. 0: unknown,
 * since there is no daemon, it has not shown two frames yet, or shows nothing. The next frame is taken to begin at
 * that moment, and what frames take from there to their submission is learned. Does not wait.
 */
PURSUIT_API uint64_t pursuit_next_start(struct pursuit_stream *stream);

/*
 * WAITS until pursuit_next_start(), at most timeout_ns and never longer than a quarter of a second. 1: it is that
 * moment now. 0: it is not known (returns at once), the timeout came first, or the daemon went away. The rate stays
 * what it was; a caller that wants another one paces itself until that is what it has.
 */
PURSUIT_API int pursuit_wait_next(struct pursuit_stream *stream, uint64_t timeout_ns);

/*
 * The oldest key press not yet fetched, of a stream opened with wants_keys. 1: *key is filled, 0: none. Does the
 * attach work that is due, as pursuit_update() does. Of more than 32 that were not fetched the oldest are lost.
 */
PURSUIT_API int pursuit_next_key(struct pursuit_stream *stream, struct pursuit_key *key);

/* The state of the stream and its counters. */
PURSUIT_API void pursuit_get_status(struct pursuit_stream *stream, struct pursuit_status *status);

/*
 * Does the attach work that is due, without waiting. pursuit_acquire() and
 * pursuit_submit() do it too; only a caller that submits nothing for a while
 * needs this.
 */
PURSUIT_API void pursuit_update(struct pursuit_stream *stream);

/* ---- GL helper: asynchronous read-back ---- */

/* Looks up a GL or GLES function of the caller's current context by name. */
typedef void *(*pursuit_gl_lookup)(const char *name);

/*
 * GL texture names (2D, single-sampled, level 0, at least as large as their
 * plane) that hold the frame; 0 where there is none: a plane of the stream
 * without a texture is published as zeros, and motion as invalid.
 *
 * On desktop GL the texture's format may differ from the plane's; GL converts.
 * GLES converts less: colour and UI of 8 bits need RGBA8, RGB10A2 needs
 * RGB10_A2, RGBA16F, depth and motion need float or half float textures.
 */
struct pursuit_gl_textures {
	uint32_t color;
	uint32_t depth;  /* a depth texture, or a one-channel float one (always so on GLES) */
	uint32_t motion; /* float, x in R, y in G */
	uint32_t ui;
	uint32_t object_id; /* unsigned integer, in R */
	int bottom_up;      /* 1: row 0 is the bottom of the picture, as GL renders; rows are turned while copied */
	int motion_y_up;    /* 1: the motion's y points up; its sign is turned while copied */
};

struct pursuit_gl;

/*
 * Makes a read-back helper for `stream` in the current context (GL 3.2 or GLES
 * 3.0 and later). NULL with errno ENOTSUP (a function is missing, or float
 * planes cannot be read back on this context), ENOMEM, EINVAL. Same thread as
 * the stream; destroyed in the same context before the stream is closed.
 */
PURSUIT_API struct pursuit_gl *pursuit_gl_create(struct pursuit_stream *stream, pursuit_gl_lookup lookup);
PURSUIT_API void pursuit_gl_destroy(struct pursuit_gl **gl);

/*
 * Publishes the newest read-back whose rendering is done, then starts that of
 * the frame just rendered. No call waits for rendering: a fence that is not
 * signalled yet is asked again in the next call. Up to three read-backs are
 * under way, as many frames as drivers queue; where all three are, this frame
 * is dropped. Of several that are done at once only the newest is copied, as
 * the daemon would take no other. So a frame leaves with the call after its
 * own where the GPU keeps up - or earlier, with pursuit_gl_update().
 *
 * `frame` gives times, flags and matrices; its planes are ignored. All GL
 * state that it changes is restored. With no daemon attached nothing is read.
 * Returns the id of the frame that this call published, 0 if none; ids count
 * the calls, so a frame that was dropped leaves a gap. If a texture cannot be
 * read back, the message of pursuit_get_status() says which and why.
 *
 * Costs: the calls that start the read-back, and one copy of each plane. On a
 * software renderer starting a read-back renders and reads at once.
 */
PURSUIT_API uint64_t pursuit_gl_submit(struct pursuit_gl *gl, const struct pursuit_gl_textures *textures,
									   const struct pursuit_frame *frame);

/*
 * Publishes the newest read-back whose rendering is done, without waiting, so
 * that it does not wait for the next pursuit_gl_submit(): call it where
 * convenient between frames. Returns its id, 0 if none is done.
 */
PURSUIT_API uint64_t pursuit_gl_update(struct pursuit_gl *gl);

/* Publishes the newest frame that is under way; WAITS for its rendering, a second at most. Its id or 0. */
PURSUIT_API uint64_t pursuit_gl_flush(struct pursuit_gl *gl);

#ifdef __cplusplus
}
#endif

#endif
