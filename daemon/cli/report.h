/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What a report is made of: works (a scene or recording, a size, an N), times
 * variants (a method and its settings), give rows (figures of both).
 */
#ifndef PURSUIT_CLI_REPORT_H
#define PURSUIT_CLI_REPORT_H

#include <jansson.h>

#include "args.h"
#include "report_score.h"

struct contact;

#define REPORT_NAME 64u
/* No method: every displayed frame is rendered by the game. The least error that a display of this rate can have. */
#define REPORT_RENDERED "rendered"

struct report_work {
	char name[REPORT_NAME];
	const char *recording; /* path; NULL: a scene */
	struct arg_size size;  /* 0x0 until a recording is read */
	uint32_t n;
};

struct report_variant {
	char method[32];
	char setting[REPORT_NAME]; /* "default", "cell=4", "blur=off+cell=16" */
	uint32_t lag;              /* real frames by which the method is late */
	bool plain;                /* the default setting */
	bool every_n;              /* played for each N, else for the first only */
	struct settings settings;
	struct engine *engine;   /* NULL: REPORT_RENDERED */
	struct engine_info info; /* borrowed texts of the engine */
};

struct report_row {
	const struct report_work *work;
	const struct report_variant *variant;
	double *engine_ms; /* one a real frame: per displayed frame; owned */
	uint32_t engine_ms_count, engine_ms_capacity;
	uint64_t bytes_up, bytes_down, displayed; /* sums over displayed frames */
	struct score score;
	uint8_t *seen; /* by the pursuit camera, the work's crop; owned, may be NULL */
};

/* Displayed pictures of a work that the page's viewer has, at most. */
#define REPORT_SHOWN 8u

struct report_shown {
	double time_s, phase;
	bool real;
};

/*
 * How a picture of the viewer is stored: another one that is like it, and how far it is above and below that. Never in
 * a circle: an earlier strip, or an earlier picture of the same one.
 */
struct report_base {
	int32_t strip;       /* -1: black; 0: the truth */
	uint32_t picture;    /* of that strip */
	int32_t differences; /* where in the file of its own strip; -1: it is the same picture */
};

/* The pictures of the truth, or of a method, one below the other. */
struct report_strip {
	const struct report_variant *variant; /* NULL: the truth */
	uint8_t *pictures;                    /* packed BGRA8; owned, until frames_end() */
	struct report_base bases[REPORT_SHOWN];
	uint32_t differing; /* pictures whose differences are in the file; 0: there is no file */
};

/* Pictures of a work that are kept for the page. */
struct report_gallery {
	const struct report_work *work;
	struct crop crop;
	double time_s, speed;          /* of the crop: when, mean pixels a second */
	uint8_t *truth;                /* seen of the truth, the crop; owned */
	struct contact *sheet;         /* while it is made; owned */
	char contact[3 * REPORT_NAME]; /* file of the contact sheet in DIR/pictures, "": none */
	struct report_shown shown[REPORT_SHOWN];
	uint32_t shown_first, shown_count; /* of the first clip; 0: none */
	struct report_strip *strips;       /* the truth first; owned */
	uint32_t strip_count;
};

#define REPORT_COST_POINTS 12u

/* Times along one axis, and the straight line through them: intercept + slope x. */
struct report_cost {
	struct arg_size size; /* of the picture; 0x0: each point has its own */
	uint32_t count;
	double x[REPORT_COST_POINTS], ms[REPORT_COST_POINTS];
	double slope, intercept, r2;
};

struct report_options {
	const char *scenes, *recordings, *methods, *sizes, *ns, *vary, *settings_list, *tables;
	const char *out, *baseline, *fail_under;
	double fail_worse; /* percent; < 0: not asked for */
	bool full, json;
	uint32_t antialias;
	struct arg_rate refresh;
	struct settings settings;
};

struct report {
	struct report_options options;
	struct report_work *works;
	uint32_t work_count;
	struct report_variant *variants;
	uint32_t variant_count;
	struct report_row *rows;
	uint32_t row_count, row_capacity;
	struct report_gallery *galleries; /* one a work */
	const char *cost_method;          /* NULL: the cost was not measured */
	struct report_cost cost_share, cost_pixels;
	json_t *tables; /* of other programs: [{title, columns, rows}] */
	char started[32];
	double seconds;
	bool interrupted;
	bool plots; /* gnuplot was there */
};

/* "a,b,c": takes the next item; false: none is left, or it is too long. */
bool report_next_item(const char **list, char item[REPORT_NAME]);

/* Reads the lists of the options into works and variants. STATUS_*. */
int report_plan(struct report *report);
int report_start_engines(struct report *report, struct error *error);
/* Those of --tables. 0 or a negative errno with a sentence. */
int report_load_tables(struct report *report, struct error *error);
void report_finish(struct report *report);

/* A new zeroed row; NULL: out of memory. Rows move when one is added. */
struct report_row *report_add_row(struct report *report);
int report_add_time(struct report_row *row, double ms, struct error *error);

/* Plays and scores all; each row is handed to report_write_row() when it is whole. 0 or a negative errno. */
struct report_writer;
int report_run(struct report *report, struct report_writer *writer, struct error *error);

/* Engine times of a clip, turn by turn over the variants; rows[i] for variants[i]. */
int report_time(struct report_row *const *rows, uint32_t count, const struct clip *clip, uint32_t samples,
				struct error *error);

/* ---- what is written ---- */

struct report_writer *report_writer_create(const char *folder, struct error *error);
int report_write_row(struct report_writer *writer, const struct report_row *row, struct error *error);
void report_writer_destroy(struct report_writer **writer);

/* "colonnade, grid, cell=4, N = 2, 640x360" */
void report_row_name(const struct report_row *row, char *text, size_t size);
double report_row_ms(const struct report_row *row, double percentile);
/* All rows and what was measured where; the caller's. */
json_t *report_json(const struct report *report);
int report_write_json(const struct report *report, struct error *error);
/* Contact sheets and pursuit-camera pictures go with the rows; this makes the page from everything. */
int report_write_page(struct report *report, struct error *error);
/* Draws DIR/plots/NAME.svg with gnuplot; false: there is no gnuplot, or it failed (it says why itself). */
bool report_draw_plots(const struct report *report);

/* The overall table, method x measure, for a person. */
void report_print(const struct report *report, FILE *out);

/* ---- what is judged ---- */

/* "psnr=30,perceived_error=4": false with a sentence if it is not of that form. */
bool report_check_limits(const char *limits, struct error *error);
/* Names every row that is beyond a limit, and every limit on what no row has; how many. */
uint32_t report_below_limits(const struct report *report, FILE *out);
/* An earlier report.json; the caller's. Before the run, which may write over it. NULL with a sentence. */
json_t *report_load_baseline(const char *path, struct error *error);
/* Prints what changed since. Rows worse by more than `percent`, all if none can be compared; percent < 0: none. */
uint32_t report_compare(const struct report *report, const json_t *old, double percent, FILE *out);

#endif
