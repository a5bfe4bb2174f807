/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Every setting once: one row carries name, type, default, range, unit and
 * prose, and help text, configuration file (configuration.h), command line, man
 * page and live settings come from it. pursuitd uses all rows; verbs of the command
 * that run an engine themselves (replay, report) use those of OPTION_ENGINE.
 */
#ifndef PURSUIT_OPTIONS_H
#define PURSUIT_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "daemon/engine/engine.h"
#include "daemon/error.h"
#include "daemon/lab/settings.h"

struct settings {
	/* engine */
	char method[32];
	char context[32]; /* auto, egl, egl-device:I, osmesa, cpu */
	bool gles;
	uint32_t threads;      /* of the CPU executor; 0: as many as we may run on, at most 8 */
	uint32_t analysis;     /* enum engine_analysis */
	uint32_t motion_model; /* enum engine_motion_model */
	uint32_t blur;         /* enum engine_blur */
	bool compensation;     /* default true */
	uint32_t cell;
	uint32_t blur_level;
	double snap_threshold; /* pixels, a multiple of 1/4 */
	double display_width_mm;
	double viewing_distance_mm;
	double gamma;   /* 0: sRGB */
	uint32_t level; /* of the governor (governor.h): fixed, or the least */
	/* output */
	uint32_t governor;          /* 0 auto, 1 off */
	char present[128];          /* comma-separated list of presenters, tried in turn */
	uint64_t refresh_numerator; /* --refresh 120, 119.88, 120000/1001 */
	uint64_t refresh_denominator;
	uint32_t spin_us;        /* of a presenter's waits, the last; 0: none */
	uint32_t on_client_exit; /* enum on_client_exit */
	char monitor[64];        /* "": the primary one */
	bool fullscreen;
	uint32_t window_width; /* 0: as the first picture */
	uint32_t window_height;
	char connector[32];   /* "": the first that is connected */
	char mode[32];        /* WxH@R; "": chosen by the refresh rate */
	char tee[512];        /* "": what is shown is not recorded */
	char kms_device[104]; /* "": the first with a display */
	struct lab_settings lab;
	/* daemon */
	char socket[104]; /* "": the default path */
	char record[512]; /* "": do not record */
	char stats[512];  /* "": no statistics file at the end */
	uint32_t max_clients;
	uint32_t max_frame_mb;  /* largest slot that a client may offer */
	uint32_t max_streams;   /* of one client */
	uint32_t max_client_mb; /* shared memory of one client, all its streams together */
	uint32_t max_messages;  /* of one client in a second */
	char allow_users[256];  /* peer.h; both empty: everybody */
	char allow_groups[256];
	bool seccomp;
	uint32_t log_level; /* 0 error, 1 warning, 2 info, 3 debug */
};

/* What stays when the client that is shown has gone. */
enum on_client_exit {
	ON_CLIENT_EXIT_KEEP, /* its last picture */
	ON_CLIENT_EXIT_BLACK,
};

enum option_type {
	OPTION_TEXT,
	OPTION_FLAG,   /* yes or no; on the command line --name, --no-name, --name=yes */
	OPTION_NUMBER, /* uint32_t within min, max */
	OPTION_REAL,   /* double within min, max */
	OPTION_CHOICE, /* uint32_t index into choices */
	OPTION_NAME,   /* text, one of choices */
	OPTION_NAMES,  /* text, some of choices in any order, separated by commas */
	OPTION_RATE,   /* two uint64_t: "120", "119.88", "120000/1001" */
	OPTION_SIZE,   /* two uint32_t within min, max: "1280x720"; "auto" is 0x0 */
};

enum option_group {
	OPTION_ENGINE,
	OPTION_OUTPUT,
	OPTION_LAB,
	OPTION_DAEMON,
};

struct option_row {
	const char *name; /* with dashes, as on the command line */
	enum option_group group;
	enum option_type type;
	size_t offset;             /* in struct settings */
	size_t size;               /* of the text field */
	const char *default_value; /* as it would be written */
	double min, max;
	const char *unit;           /* "mm", "px", "Hz", "" */
	const char *const *choices; /* NULL-terminated */
	const char *help;           /* one or two sentences */
};

/* A value as text, with its end: no row's is longer, so that none is ever cut. Texts that are longer are refused. */
#define OPTION_VALUE_BYTES 512u

/* The table has at most so many rows: a set of them is an array of flags, by their place. */
#define OPTION_ROWS 128u

/* The table, ended by a row without name. Static. */
const struct option_row *option_table(void);

/* NULL: there is no such row. Static. */
const struct option_row *option_find(const char *name);

/* Does the picture alone depend on it, so that it may change from one real frame to the next? */
bool option_is_of_picture(const struct option_row *row);

void settings_defaults(struct settings *settings);

/* Sets one by name. 0 or -EINVAL (with "cell: 3 is below 4", unknown names get the nearest one suggested). */
int settings_set(struct settings *settings, const char *name, const char *value, struct error *error);

/* The row name nearest to an unknown one (two letters apart at most), NULL if none is near. Static. */
const char *settings_nearest(const char *name);

/*
 * Writes the present value of a setting as text, which settings_set() takes for the same; OPTION_VALUE_BYTES hold it.
 * -ENOENT for an unknown name.
 */
int settings_get(const struct settings *settings, const char *name, char *value, size_t size);

/* Have both the same value? */
bool settings_agree(const struct settings *a, const struct settings *b, const struct option_row *row);

/* Takes this one over as it is. */
void settings_copy(struct settings *to, const struct settings *from, const struct option_row *row);

/* "a, b, c": a list of choices for a person. Truncates. */
void option_choices_join(const char *const *choices, char *text, size_t size);

/* Is it one of them, and which? `index` may be NULL. */
bool option_choices_have(const char *const *choices, const char *text, uint32_t *index);

/* What may be written, for a person: "yes or no", "4 to 64 px". Truncates. */
void settings_describe_values(const struct option_row *row, char *text, size_t size);

/*
 * Takes "--name value" or "--name=value" at argv[*index] if `name` is a row of
 * one of the groups in the mask (1 << group): 1 taken (*index now at the last
 * argument used), 0 not ours, negative errno with a sentence.
 */
int settings_argument(struct settings *settings, unsigned group_mask, int argc, char **argv, int *index,
					  struct error *error);

/* The row that an argument like "--name", "--name=value" or "--no-name" is about, NULL none. Static. */
const struct option_row *settings_argument_row(const char *argument);

/* All rows and what these settings have, a line each: `before`, the name, `equals`, the value. */
void settings_print(const struct settings *settings, const char *before, const char *equals, FILE *out);

/* Help lines of the rows of these groups. */
void settings_print_help(unsigned group_mask, FILE *out);

/*
 * The rows of these groups for programs, from which man pages and shell completions are made: a line each,
 * "option", name, what the value is called ("" for a flag), choices separated by commas, a sentence, what may be
 * written, the default; separated by tabs.
 */
void settings_print_options(unsigned group_mask, FILE *out);

/* The engine's part, as engine_create() wants it. Points into settings (method). */
int settings_engine_params(const struct settings *settings, struct engine_params *params, struct error *error);

#endif
