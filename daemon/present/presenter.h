/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Presenters: where displayed frames go. A presenter knows vblanks, pictures
 * and numbers that its user gave them; it knows neither engine nor stream.
 *
 * The render thread draws pictures ahead and queues each for one vblank; the
 * presenter shows at each vblank what is queued for it, and reports every
 * vblank in a flip event. Where nothing is queued, the standby picture of the
 * group on display is shown, and without one the picture stays.
 *
 *   group: a number that rises with every real frame. A real frame, its
 *          in-betweens and its standby picture have the same.
 *
 * Threads: create, destroy, get_event_fd, process_events, get_trouble and
 * toggle_fullscreen are called on main, where nothing may wait for a display; all others on the
 * render thread, only between create and destroy. Events (flip, lost, key) come
 * on a thread of the presenter's choice, never with a lock held, and none comes
 * once destroy has returned.
 */
#ifndef PURSUIT_PRESENTER_H
#define PURSUIT_PRESENTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "daemon/clock.h"
#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/present/grid.h"

/* A picture: BGRA8, rows top to bottom, in CPU memory or in GL. Owned by the presenter. */
struct presenter_image {
	uint8_t *data; /* NULL: in GL */
	size_t stride;
	uint32_t width, height;
	uint32_t index; /* the presenter's */
	/*
	 * What the memory holds, as its user said when it gave the picture back (present, set_standby or release); 0:
	 * unknown. The presenter keeps it with the memory and writes nothing there; whoever else does sets it to 0.
	 */
	uint64_t holds;
	uint32_t texture;              /* of the share group of get_context(), row 0 on top; 0: in CPU memory */
	uint32_t texture_x, texture_y; /* where the picture begins in it */
	/*
	 * In GL, as it is acquired: the presenter can wait for the GPU by itself, so the picture may be presented while it
	 * is drawn still. As it is presented: it may be so.
	 */
	bool fenced;
};

/*
 * A GL context (4.3 core, if the driver has it) for whoever draws the pictures, in a share group with that of the
 * presenter. All functions are called on the render thread.
 */
struct presenter_context {
	const char *name;            /* static */
	bool (*enter)(void *data);   /* makes it current on this thread; false: it is lost */
	void (*release)(void *data); /* leaves none current; also once it is lost */
	void (*(*find)(const char *name))(void);
	void *data;
};

enum presenter_shown {
	PRESENTER_PICTURE, /* the one queued for this vblank */
	PRESENTER_STANDBY, /* nothing was queued: the standby picture */
	PRESENTER_KEPT,    /* nothing was queued: the same picture as before */
};

/* Where flip_ns comes from. */
enum presenter_time_source {
	PRESENTER_TIME_ESTIMATED =
		0,                /* when the call that shows a picture came back: later than the flip by an unknown time */
	PRESENTER_TIME_TIMER, /* there is no display: when the timer of the grid fired */
	PRESENTER_TIME_DISPLAY_SERVER, /* told by the display server (OML_sync_control, presentation feedback) */
	PRESENTER_TIME_KERNEL,         /* the kernel's event of the page flip */
	PRESENTER_TIME_EXTERNAL,       /* a vblank of the external vsync (vsync.h) */
	PRESENTER_TIME_SOURCES,
};
/* "estimated", "timer", "display server", "kernel", "external vsync". Static. */
const char *presenter_time_source_name(enum presenter_time_source source);

/* One vblank is over. */
struct presenter_flip {
	uint64_t vblank;
	uint64_t target_ns; /* the vblank's time on the grid */
	uint64_t flip_ns;   /* when it was shown, as time_source knows it */
	uint64_t sequence;  /* the display's own count of vblanks, 0 unknown */
	enum presenter_time_source time_source;
	uint64_t serial; /* of the picture on display, 0 none */
	uint64_t group;
	enum presenter_shown shown;
	bool late;        /* handled only after the next vblank's time, or at a later one than it was queued for */
	uint32_t skipped; /* vblanks just before this one that were not handled at all */
	bool dropped;     /* the last picture queued for this vblank or before it came too late, and is never shown */
};

/* A key was pressed. */
struct presenter_key {
	uint32_t code;    /* Unicode code point of the letter without modifiers, lower case; or one of those below */
	uint64_t time_ns; /* when the presenter saw it */
};
#define PRESENTER_KEY_ESCAPE 0x1bu
#define PRESENTER_KEY_F1 0x110001u    /* beyond Unicode */
#define PRESENTER_KEY_CLOSE 0x110100u /* the window's close button */

/* What presenters with a display want to know; each takes what concerns it. Zeroed: the defaults. */
struct presenter_options {
	const char *monitor; /* name or number; NULL or "": the primary one */
	bool fullscreen;
	uint32_t width, height; /* of a window; 0: as the first picture */
	const char *connector;  /* NULL or "": the first that is connected */
	const char *mode;       /* "1920x1080@120"; NULL or "": by the refresh rate */
	const char *device;     /* NULL or "": the first with a display */
	const char *title;      /* of a window; NULL: "Pursuit" */
	bool share_gl;          /* pictures may come in GL: offer a context where it has one */
};

struct vsync;

struct presenter_params {
	struct clock *clock;
	const struct log *log;
	uint64_t refresh_numerator; /* wished for; a display of its own rate may differ */
	uint64_t refresh_denominator;
	struct presenter_options options; /* strings live as long as the presenter */
	struct vsync *vsync;              /* for displays that stamp nothing themselves; NULL: none. Lives as long */
	void (*flip)(void *data, const struct presenter_flip *flip);
	/*
	 * The display is gone for good and shows nothing any more; said once. Calls after it do nothing and succeed, or
	 * return an error. The user destroys the presenter soon.
	 */
	void (*lost)(void *data, const char *sentence);
	/* Optional: one of the list could not be made; what it has said up to here is void. */
	void (*failed)(void *data);
	void (*key)(void *data, const struct presenter_key *key);
	void *data;
};

struct presenter;

/* Which options concern it, and whether there may be two of it at a time, as when one takes over from the other. */
enum presenter_kind {
	PRESENTER_MEMORY = 0, /* none; as many as you like */
	PRESENTER_WINDOW,     /* monitor, fullscreen, width, height; one */
	PRESENTER_DEVICE,     /* connector, mode, device; one */
};

/* All functions are mandatory unless said otherwise; a presenter that was not built in has none (a stub). */
struct presenter_impl {
	const char *name;
	const char *description;
	enum presenter_kind kind;
	/*
	 * Optional: may create() work by now? On main, while another presenter is in use: takes nothing from anybody and
	 * does not wait. Without it create() is only tried when no presenter is in use.
	 */
	bool (*is_possible)(const struct presenter_params *params);
	/* NULL with a sentence that says what to do. */
	struct presenter *(*create)(const struct presenter_params *params, struct error *error);
	void (*destroy)(struct presenter *presenter);
	/*
	 * The grid that vblanks are counted on, as it is known now: its rate and phase may follow the display's, while
	 * the numbers of vblanks go on. Asked again after each flip event. A fixed rate is the special case of {earliest
	 * next flip, latest next flip, grain}; a display of variable rate will add these.
	 */
	struct grid (*get_grid)(struct presenter *presenter);
	/* A picture must be queued so long before the time of its vblank; may grow and shrink. Asked with get_grid(). */
	uint64_t (*get_lead)(struct presenter *presenter);
	/* Optional: which display in which mode, for a person. Lives as long as the presenter. */
	const char *(*get_display)(struct presenter *presenter);
	/*
	 * A free picture to draw into; never waits. One that is larger than the display is made smaller. -EBUSY: all are
	 * queued or shown; -ENOMEM.
	 */
	int (*acquire)(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image);
	/*
	 * Optional, both or none. The context, NULL: it has none to offer; it may be current nowhere when the presenter is
	 * destroyed. And acquire() of a picture in GL: with that context current; what is bound to its texture unit 0 and
	 * as framebuffer changes, then and when the picture is presented. Other errors than -EBUSY: pictures had better
	 * come by acquire().
	 */
	const struct presenter_context *(*get_context)(struct presenter *presenter);
	int (*acquire_texture)(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image);
	/* Gives a picture back undrawn. */
	void (*release)(struct presenter *presenter, const struct presenter_image *image);
	/*
	 * Queues a picture for a vblank; replaces what is queued for it and drops what is queued for later ones.
	 * Starts the vblank events if they had stopped. -ETIME: that vblank is over; the picture stays acquired.
	 */
	int (*present)(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank, uint64_t group,
				   uint64_t serial);
	/* The picture for vblanks that nothing is queued for while this group is on display; replaces one of the group. */
	void (*set_standby)(struct presenter *presenter, const struct presenter_image *image, uint64_t group,
						uint64_t serial);
	void (*clear_standby)(struct presenter *presenter);
	/* The picture stays, no vblank is reported until the next present() but that of a picture which is on its way. */
	void (*pause)(struct presenter *presenter);
	/*
	 * Optional, both or none: a descriptor that is readable when process_events() has something to do, which may
	 * call key() and lost(). It never waits.
	 */
	int (*get_event_fd)(struct presenter *presenter);
	void (*process_events)(struct presenter *presenter);
	/* Optional: is it kept from showing anything, though it is not lost? Then a sentence says by what. */
	bool (*get_trouble)(struct presenter *presenter, char *text, size_t size);
	/* Optional: between window and full screen. */
	void (*toggle_fullscreen)(struct presenter *presenter);
};

/* First member of every presenter. */
struct presenter {
	const struct presenter_impl *impl;
};

/* All presenters that the project knows, ended by NULL; those without create() were not built in. */
const struct presenter_impl *const *presenter_impls(void);

/*
 * Checks a list like "kms,glfw,headless" without opening anything: 0, or -EINVAL with a sentence about the first
 * name that is unknown or was not built in.
 */
int presenter_check_list(const char *list, struct error *error);

/* Creates the first presenter of the list that works; why others did not is logged. NULL with the last sentence. */
struct presenter *presenter_create(const char *list, const struct presenter_params *params, struct error *error);
/* The same with those that stand before this one in the list; all, if it is not in the list. */
struct presenter *presenter_create_before(const char *list, const struct presenter_impl *than,
										  const struct presenter_params *params, struct error *error);
bool presenter_is_listed(const char *list, const struct presenter_impl *impl);
/*
 * The first that works of those that stand before this one in the list and look possible; quietly NULL if there is
 * none. The one that there is already goes on meanwhile.
 */
struct presenter *presenter_create_better(const char *list, const struct presenter_impl *than,
										  const struct presenter_params *params);
/* Can there ever be one? */
bool presenter_has_better(const char *list, const struct presenter_impl *than);
void presenter_destroy(struct presenter **presenter);

extern const struct presenter_impl presenter_headless;
extern const struct presenter_impl presenter_glfw;
extern const struct presenter_impl presenter_kms;

#endif
