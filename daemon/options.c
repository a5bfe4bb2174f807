/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/option_value.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HELP_COLUMNS 120

/* A test holds these two to what engine_methods() and presenter_impls() have. */
static const char *const method_choices[] = {"hold",    "black", "blur-hold",     "mcif",    "interpolate",
											 "scatter", "grid",  "adaptive-grid", "pursuit", NULL};
static const char *const present_choices[] = {"headless", "glfw", "kms", NULL};
/* In the order of enum engine_context_kind. */
static const char *const context_choices[] = {"auto", "egl", "egl-device:INDEX", "osmesa", "cpu", NULL};
static const char *const analysis_choices[] = {"auto", "cpu", "gpu", NULL};
static const char *const motion_model_choices[] = {"linear", "quadratic", NULL};
static const char *const blur_choices[] = {"doubtful", "everywhere", "off", NULL};
static const char *const pattern_choices[] = {"toggle",      "pulse",   "pulse-real", "level-real",
											  "three-lines", "counter", "sequence",   NULL};
static const char *const governor_choices[] = {"auto", "off", NULL};
static const char *const exit_choices[] = {"keep", "black", NULL};
static const char *const level_choices[] = {"low", "high", NULL};
static const char *const edge_choices[] = {"rising", "falling", NULL};
static const char *const final_choices[] = {"low", "high", "keep", NULL};
static const char *const patch_choices[] = {"off", "alternate", "sequence", NULL};
static const char *const corner_choices[] = {"top-left", "top-right", "bottom-left", "bottom-right", NULL};
static const char *const log_choices[] = {"error", "warning", "info", "debug", NULL};

#define FIELD(name) offsetof(struct settings, name)
#define TEXT(field, option, group, value, help)                                                                      \
	{                                                                                                                \
		option, group, OPTION_TEXT, FIELD(field), sizeof(((struct settings *)0)->field), value, 0, 0, "", NULL, help \
	}
#define WORDS(field, option, group, type, value, choices, help)                                                  \
	{                                                                                                            \
		option, group, type, FIELD(field), sizeof(((struct settings *)0)->field), value, 0, 0, "", choices, help \
	}
#define FLAG(field, option, group, value, help)                                  \
	{                                                                            \
		option, group, OPTION_FLAG, FIELD(field), 0, value, 0, 0, "", NULL, help \
	}
#define NUMBER(field, option, group, value, min, max, unit, help)                        \
	{                                                                                    \
		option, group, OPTION_NUMBER, FIELD(field), 0, value, min, max, unit, NULL, help \
	}
#define REAL(field, option, group, value, min, max, unit, help)                        \
	{                                                                                  \
		option, group, OPTION_REAL, FIELD(field), 0, value, min, max, unit, NULL, help \
	}
#define CHOICE(field, option, group, value, choices, help)                            \
	{                                                                                 \
		option, group, OPTION_CHOICE, FIELD(field), 0, value, 0, 0, "", choices, help \
	}
#define RATE(field, option, group, value, min, max, help)                                          \
	{                                                                                              \
		option, group, OPTION_RATE, FIELD(field##_numerator), 0, value, min, max, "Hz", NULL, help \
	}

#define SIZE(field, option, group, value, min, max, help)                                      \
	{                                                                                          \
		option, group, OPTION_SIZE, FIELD(field##_width), 0, value, min, max, "px", NULL, help \
	}

static const struct option_row rows[] = {
	WORDS(method, "method", OPTION_ENGINE, OPTION_NAME, "pursuit", method_choices,
		  "How displayed frames are made from real ones."),
	WORDS(context, "context", OPTION_ENGINE, OPTION_NAME, "auto", context_choices, "Where the engine runs."),
	FLAG(gles, "gles", OPTION_ENGINE, "no", "Use OpenGL ES 3.1 instead of OpenGL 4.3 core."),
	NUMBER(threads, "threads", OPTION_ENGINE, "0", 0, 8, "",
		   "Threads that the engine works with on the CPU, besides those of GL; 0: one for each processor that it may "
		   "run on, at "
		   "most 8."),
	CHOICE(
		analysis, "analysis", OPTION_ENGINE, "auto", analysis_choices,
		"Who looks at motion and depth: the CPU, or the GPU where the engine draws with one; auto: the CPU, as long as "
		"frames come in its memory."),
	CHOICE(motion_model, "motion-model", OPTION_ENGINE, "linear", motion_model_choices,
		   "How the methods with a grid continue motion: straight on, or with its change since the frame before."),
	CHOICE(blur, "blur", OPTION_ENGINE, "doubtful", blur_choices,
		   "Where in-between frames are blurred: where the warp is doubtful, everywhere (the paper), or nowhere."),
	FLAG(compensation, "compensation", OPTION_ENGINE, "yes",
		 "Give real frames the detail back that blurred in-between frames lack."),
	NUMBER(cell, "cell", OPTION_ENGINE, "8", 4, 64, "px", "Size of a grid cell."),
	NUMBER(blur_level, "blur-level", OPTION_ENGINE, "2", 1, 6, "", "Pyramid level of the blurred picture."),
	REAL(snap_threshold, "snap-threshold", OPTION_ENGINE, "0.5", 0.25, 15.75, "px",
		 "Jump of the motion that a grid vertex snaps to, in steps of a quarter."),
	REAL(display_width_mm, "display-width-mm", OPTION_ENGINE, "531", 10, 20000, "mm",
		 "Width of the picture on the display; with the viewing distance it gives visual angles."),
	REAL(viewing_distance_mm, "viewing-distance-mm", OPTION_ENGINE, "600", 10, 50000, "mm",
		 "From the eye to the display."),
	REAL(gamma, "gamma", OPTION_ENGINE, "0", 0, 5, "", "Gamma of the display, 1 to 5; 0 is the sRGB curve."),
	NUMBER(level, "level", OPTION_ENGINE, "0", 0, 4, "",
		   "What is left out to save time: 0 nothing, 1 fine cells, 2 blur and boost too, 3 every second in-between, 4 "
		   "all "
		   "of them. With the governor the level that it never goes below, else fixed."),
	CHOICE(governor, "governor", OPTION_OUTPUT, "auto", governor_choices,
		   "Raise the level when the work for a real frame does not fit into its vblanks, and lower it again."),
	WORDS(present, "present", OPTION_OUTPUT, OPTION_NAMES, "headless", present_choices,
		  "Presenters; the first one that works is used. When a display is lost, the list is tried again."),
	RATE(refresh, "refresh", OPTION_OUTPUT, "120", 1, 1000,
		 "Display rate as 120, 119.88 or 120000/1001; a presenter with a display of its own may have another."),
	NUMBER(spin_us, "spin-us", OPTION_OUTPUT, "0", 0, 500, "us",
		   "headless, and glfw: look at the clock for so long before each vblank instead of sleeping up to it, so that "
		   "flips are nearer to their time; costs as much of a core. 100 is a good value where it matters."),
	CHOICE(on_client_exit, "on-client-exit", OPTION_OUTPUT, "keep", exit_choices,
		   "When the client that is shown closes its stream, ends or is killed: its last picture stays, or black."),
	TEXT(tee, "tee", OPTION_OUTPUT, "",
		 "Record what is shown, each vblank once, into this YUV4MPEG2 file (.y4m), and the times beside it in "
		 "FILE.csv; or, "
		 "with a name like 'out/%06d.png', into an image each, numbered on from those that are there, and the times in "
		 "out/times.csv."),
	TEXT(monitor, "monitor", OPTION_OUTPUT, "",
		 "glfw: name of the monitor, or its number from 0, for full screen and for the rate; empty: the primary one."),
	FLAG(fullscreen, "fullscreen", OPTION_OUTPUT, "no",
		 "glfw: full screen, in the mode of the monitor that is nearest to the refresh rate wished for."),
	SIZE(window, "window-size", OPTION_OUTPUT, "auto", 16, 16384,
		 "glfw: size of the window; auto: that of the first picture."),
	TEXT(connector, "connector", OPTION_OUTPUT, "",
		 "kms: connector like HDMI-A-1 or DP-2; empty: the first one that a display is plugged into."),
	TEXT(mode, "mode", OPTION_OUTPUT, "",
		 "kms: mode like 1920x1080@120; empty: the rate nearest to --refresh, then the preferred size."),
	TEXT(kms_device, "kms-device", OPTION_OUTPUT, "",
		 "kms: device like /dev/dri/card1; empty: the first one that has a display."),
	FLAG(lab.latency, "latency", OPTION_LAB, "no", "Keep all time points of each displayed frame for pursuit latency."),
	TEXT(lab.latency_log, "latency-log", OPTION_LAB, "",
		 "Write the time points of each displayed frame into this file: text for .csv, compact for .bin. One that is "
		 "there "
		 "is kept as FILE.1, FILE.2 and so on."),
	NUMBER(lab.priority, "lab-priority", OPTION_LAB, "20", 0, 99, "",
		   "Real-time priority (SCHED_FIFO) of the thread that sets lines, where permitted; 0: none."),
	TEXT(lab.gpio_chip, "gpio-chip", OPTION_LAB, "",
		 "GPIO chip by path, name or label; empty: the first that has all lines that are given by name."),
	TEXT(lab.gpio_line, "gpio-line", OPTION_LAB, "",
		 "Marker lines by name, or by offset with gpio-chip, separated by commas, the lowest first; empty: no marker."),
	CHOICE(lab.pattern, "gpio-pattern", OPTION_LAB, "toggle", pattern_choices,
		   "At each flip: toggle, pulse; pulse-real at real frames; level-real high while a real frame is shown; "
		   "three-lines pulses flip, real, in-between; counter the vblank in binary; sequence as the patch."),
	NUMBER(lab.pulse_us, "gpio-pulse-us", OPTION_LAB, "1000", 1, 1000000, "us",
		   "Width of pulses; at most half a refresh is used."),
	NUMBER(lab.offset_us, "gpio-offset-us", OPTION_LAB, "0", 0, 1000000, "us",
		   "Edge so long after the flip, for scan-out delay or the middle of the screen."),
	FLAG(lab.active_low, "gpio-active-low", OPTION_LAB, "no", "High means a low voltage on the marker lines."),
	CHOICE(lab.initial_level, "gpio-initial", OPTION_LAB, "low", level_choices, "Level before the first flip."),
	CHOICE(lab.final_level, "gpio-final", OPTION_LAB, "low", final_choices, "Level that is left at the end."),
	TEXT(lab.strobe_line, "strobe-line", OPTION_LAB, "",
		 "Line that flashes a backlight once in each refresh, low otherwise; empty: none. Read docs/lab.md first."),
	REAL(lab.strobe_phase, "strobe-phase", OPTION_LAB, "0.5", 0, 1, "",
		 "When in the refresh the flash begins, 0 to 1 after the flip."),
	REAL(lab.strobe_duty, "strobe-duty", OPTION_LAB, "0.1", 0, 0.5, "", "Share of the refresh that the flash lasts."),
	REAL(lab.strobe_limit, "strobe-limit", OPTION_LAB, "0.25", 0, 0.5, "",
		 "Hard limit on the share of light over time, whatever flips and wake-ups do."),
	FLAG(lab.strobe_active_low, "strobe-active-low", OPTION_LAB, "no", "Light means a low voltage on the strobe line."),
	TEXT(lab.photodiode_line, "photodiode-line", OPTION_LAB, "",
		 "Input line whose edges are light; they are matched to flips. Empty: none."),
	FLAG(lab.photodiode_active_low, "photodiode-active-low", OPTION_LAB, "no", "Light means a low voltage."),
	TEXT(lab.trigger_line, "trigger-line", OPTION_LAB, "",
		 "Input line of a button or a stimulus computer; its rising edge is noted with the next flip. Empty: none."),
	FLAG(lab.trigger_active_low, "trigger-active-low", OPTION_LAB, "no", "A trigger is a falling voltage."),
	TEXT(
		lab.vsync_line, "vsync-line", OPTION_LAB, "",
		"Input line on which the display, or a sensor, gives an edge at each vblank: vblanks and flips follow it where "
		"the display stamps none. Empty: none."),
	CHOICE(lab.vsync_edge, "vsync-edge", OPTION_LAB, "rising", edge_choices, "The edge of the vsync line that counts."),
	REAL(lab.vsync_offset_us, "vsync-offset-us", OPTION_LAB, "0", -100000, 100000, "us",
		 "A vblank is so long after its edge."),
	NUMBER(lab.debounce_us, "debounce-us", OPTION_LAB, "0", 0, 1000000, "us",
		   "Edges of the photodiode so soon after one that counted are bounce."),
	NUMBER(lab.photon_least_us, "photon-least-us", OPTION_LAB, "0", 0, 800000, "us",
		   "Light comes no sooner after its flip."),
	NUMBER(lab.photon_most_us, "photon-most-us", OPTION_LAB, "0", 0, 900000, "us",
		   "Light comes sooner than this after its flip; 0: a refresh after photon-least-us, two with a patch."),
	CHOICE(
		lab.patch, "patch", OPTION_LAB, "off", patch_choices,
		"Square for a photodiode in the picture: alternates black and white, or follows the sequence that identifies "
		"each frame."),
	CHOICE(lab.patch_corner, "patch-corner", OPTION_LAB, "bottom-left", corner_choices, "Corner of the patch."),
	NUMBER(lab.patch_size, "patch-size", OPTION_LAB, "48", 4, 4096, "px", "Edge of the patch."),
	TEXT(socket, "socket", OPTION_DAEMON, "",
		 "Path of the socket; empty: $PURSUIT_SOCKET, else $XDG_RUNTIME_DIR/pursuit/socket, else /run/pursuit/socket."),
	TEXT(record, "record", OPTION_DAEMON, "",
		 "Record the frames received into this regular file, from the start. One that is there is kept as FILE.1, "
		 "FILE.2 and so on."),
	TEXT(stats, "stats", OPTION_DAEMON, "", "Write the statistics into this file at the end, as JSON."),
	NUMBER(max_clients, "max-clients", OPTION_DAEMON, "16", 1, 256, "", "Clients that may be connected at once."),
	NUMBER(max_frame_mb, "max-frame-mb", OPTION_DAEMON, "1024", 1, 1024, "MiB",
		   "Largest frame (all its planes) that a client may offer."),
	NUMBER(max_streams, "max-streams", OPTION_DAEMON, "4", 1, 4, "", "Streams that one client may have open."),
	NUMBER(max_client_mb, "max-client-mb", OPTION_DAEMON, "8192", 1, 65536, "MiB",
		   "Shared memory that one client may offer, all its streams together."),
	NUMBER(max_messages, "max-messages", OPTION_DAEMON, "2000", 10, 1000000, "",
		   "Messages that one client may send in a second; frames are none."),
	TEXT(allow_users, "allow-users", OPTION_DAEMON, "",
		 "Users that may be clients, by name or number, separated by commas; empty, as allow-groups: everybody who can "
		 "reach the socket. Names are looked up when they are set, not for each client."),
	TEXT(allow_groups, "allow-groups", OPTION_DAEMON, "", "Groups whose members may be clients."),
	FLAG(seccomp, "seccomp", OPTION_DAEMON, "no",
		 "After start-up let the kernel refuse what only a daemon that was taken over would need: other programs, "
		 "processes, namespaces, network."),
	CHOICE(log_level, "log-level", OPTION_DAEMON, "info", log_choices, "Least important messages that are logged."),
	{0},
};

_Static_assert(sizeof(rows) / sizeof(rows[0]) <= OPTION_ROWS, "sets of rows have a place for each");

const struct option_row *option_table(void)
{
	return rows;
}

const struct option_row *option_find(const char *name)
{
	const struct option_row *row = rows;
	while (row->name && strcmp(row->name, name) != 0)
		row++;
	return row->name ? row : NULL;
}

bool option_is_of_picture(const struct option_row *row)
{
	if (strcmp(row->name, "context") == 0 || strcmp(row->name, "gles") == 0 || strcmp(row->name, "threads") == 0)
		return false;
	return row->group == OPTION_ENGINE || strcmp(row->name, "governor") == 0;
}

static const struct option_row *find_row(const char *name, size_t length)
{
	for (const struct option_row *row = rows; row->name; row++)
		if (strlen(row->name) == length && strncmp(row->name, name, length) == 0)
			return row;
	return NULL;
}

/* ---- unknown names ---- */

/* Letters to insert, delete or replace; 99 for names too long to be worth it. */
static unsigned edit_distance(const char *a, const char *b)
{
	const size_t la = strlen(a), lb = strlen(b);
	unsigned row[32];
	if (la >= 32 || lb >= 32)
		return 99;
	for (size_t j = 0; j <= lb; j++)
		row[j] = (unsigned)j;
	for (size_t i = 1; i <= la; i++) {
		unsigned diagonal = row[0];
		row[0] = (unsigned)i;
		for (size_t j = 1; j <= lb; j++) {
			unsigned best = diagonal + (a[i - 1] != b[j - 1]);
			diagonal = row[j];
			if (row[j] + 1 < best)
				best = row[j] + 1;
			if (row[j - 1] + 1 < best)
				best = row[j - 1] + 1;
			row[j] = best;
		}
	}
	return row[lb];
}

const char *settings_nearest(const char *name)
{
	const char *nearest = NULL;
	unsigned least = 3;
	for (const struct option_row *row = rows; row->name; row++) {
		const unsigned distance = edit_distance(name, row->name);
		if (distance < least) {
			least = distance;
			nearest = row->name;
		}
	}
	return nearest;
}

static int refuse_unknown(const char *name, struct error *error)
{
	const char *nearest = settings_nearest(name);
	if (nearest)
		return error_set(error, -EINVAL, "%s: there is no such setting; did you mean %s?", name, nearest);
	return error_set(error, -EINVAL, "%s: there is no such setting", name);
}

int settings_set(struct settings *settings, const char *name, const char *value, struct error *error)
{
	const struct option_row *row = option_find(name);
	return row ? option_value_set(settings, row, value, error) : refuse_unknown(name, error);
}

void settings_defaults(struct settings *settings)
{
	memset(settings, 0, sizeof(*settings));
	for (const struct option_row *row = rows; row->name; row++) {
		struct error error;
		if (option_value_set(settings, row, row->default_value, &error) < 0) {
			fprintf(stderr, "bug: %s\n", error.text);
			abort();
		}
	}
}

int settings_get(const struct settings *settings, const char *name, char *value, size_t size)
{
	const struct option_row *row = option_find(name);
	if (!row)
		return -ENOENT;
	option_value_print(settings, row, value, size);
	return 0;
}

bool settings_agree(const struct settings *a, const struct settings *b, const struct option_row *row)
{
	const char *one = (const char *)a + row->offset, *other = (const char *)b + row->offset;
	return memcmp(one, other, option_value_size(row)) == 0;
}

void settings_copy(struct settings *to, const struct settings *from, const struct option_row *row)
{
	memcpy((char *)to + row->offset, (const char *)from + row->offset, option_value_size(row));
}

/* ---- command line ---- */

/* The row that "name" or, for a flag, "no-name" means. */
static const struct option_row *argument_row(const char *name, size_t length, unsigned group_mask, bool *negated)
{
	const struct option_row *row = find_row(name, length);
	*negated = false;
	if (!row && length > 3 && strncmp(name, "no-", 3) == 0) {
		row = find_row(name + 3, length - 3);
		if (row && row->type != OPTION_FLAG)
			row = NULL;
		*negated = row != NULL;
	}
	return row && (group_mask & (1u << row->group)) ? row : NULL;
}

const struct option_row *settings_argument_row(const char *argument)
{
	bool negated;
	if (strncmp(argument, "--", 2) != 0)
		return NULL;
	return argument_row(argument + 2, strcspn(argument + 2, "="), ~0u, &negated);
}

int settings_argument(struct settings *settings, unsigned group_mask, int argc, char **argv, int *index,
					  struct error *error)
{
	const char *argument = argv[*index];
	bool negated;
	if (strncmp(argument, "--", 2) != 0)
		return 0;
	const char *name = argument + 2;
	const size_t length = strcspn(name, "=");
	const char *value = name[length] ? name + length + 1 : NULL;
	const struct option_row *row = argument_row(name, length, group_mask, &negated);
	if (!row)
		return 0;
	if (negated && value)
		return error_set(error, -EINVAL, "--no-%s takes no value", row->name);
	if (row->type == OPTION_FLAG && !value) {
		value = negated ? "no" : "yes";
	} else if (!value) {
		if (*index + 1 >= argc)
			return error_set(error, -EINVAL, "--%s needs a value", row->name);
		value = argv[++*index];
	}
	const int result = option_value_set(settings, row, value, error);
	return result < 0 ? result : 1;
}

/* ---- help ---- */

void settings_describe_values(const struct option_row *row, char *text, size_t size)
{
	char list[128];
	switch (row->type) {
	case OPTION_TEXT:
		snprintf(text, size, "text");
		return;
	case OPTION_NAMES:
		option_choices_join(row->choices, list, sizeof(list));
		snprintf(text, size, "of %s, separated by commas", list);
		return;
	case OPTION_FLAG:
		snprintf(text, size, "yes or no");
		return;
	case OPTION_CHOICE:
	case OPTION_NAME:
		option_choices_join(row->choices, text, size);
		return;
	case OPTION_SIZE:
		snprintf(text, size, "auto, or %g to %g px each", row->min, row->max);
		return;
	case OPTION_NUMBER:
	case OPTION_REAL:
	case OPTION_RATE:
		snprintf(text, size, "%g to %g%s%s", row->min, row->max, *row->unit ? " " : "", row->unit);
		return;
	}
}

void settings_print(const struct settings *settings, const char *before, const char *equals, FILE *out)
{
	for (const struct option_row *row = rows; row->name; row++) {
		char value[OPTION_VALUE_BYTES];
		settings_get(settings, row->name, value, sizeof(value));
		fprintf(out, "%s%s%s%s\n", before, row->name, equals, value);
	}
}

/* Words in lines of a readable length, all but the first indented. */
static void print_wrapped(const char *text, int indent, FILE *out)
{
	int column = indent;
	for (const char *word = text; *word; word += strspn(word, " ")) {
		const int length = (int)strcspn(word, " ");
		if (column > indent && column + 1 + length > HELP_COLUMNS) {
			fprintf(out, "\n%*s", indent, "");
			column = indent;
		}
		column += fprintf(out, "%s%.*s", column > indent ? " " : "", length, word);
		word += length;
	}
	fputc('\n', out);
}

/* What a value is called, by type. */
static const char *const value_names[] = {"TEXT", "", "NUMBER", "NUMBER", "NAME", "NAME", "LIST", "RATE", "WxH"};

void settings_print_options(unsigned group_mask, FILE *out)
{
	for (const struct option_row *row = rows; row->name; row++) {
		char range[160];
		if (!(group_mask & (1u << row->group)))
			continue;
		settings_describe_values(row, range, sizeof(range));
		fprintf(out, "option\t%s%s\t%s\t", row->type == OPTION_FLAG ? "[no-]" : "", row->name, value_names[row->type]);
		for (size_t i = 0; row->choices && row->choices[i]; i++)
			if (!strchr(row->choices[i], ':')) /* of those, only what may be written as it stands */
				fprintf(out, "%s%s", i ? "," : "", row->choices[i]);
		fprintf(out, "\t%s\t%s\t%s\n", row->help, range, *row->default_value ? row->default_value : "empty");
	}
}

void settings_print_help(unsigned group_mask, FILE *out)
{
	for (const struct option_row *row = rows; row->name; row++) {
		char range[160], values[256], usage[64];
		if (!(group_mask & (1u << row->group)))
			continue;
		settings_describe_values(row, range, sizeof(range));
		if (row->type == OPTION_FLAG)
			snprintf(usage, sizeof(usage), "--[no-]%s", row->name);
		else
			snprintf(usage, sizeof(usage), "--%s %s", row->name, value_names[row->type]);
		fprintf(out, "  %-30s ", usage);
		print_wrapped(row->help, 33, out);
		snprintf(values, sizeof(values), "(%s; default %s)", range, *row->default_value ? row->default_value : "empty");
		fprintf(out, "  %-30s ", "");
		print_wrapped(values, 33, out);
	}
}

/* ---- the engine's part ---- */

int settings_engine_params(const struct settings *settings, struct engine_params *params, struct error *error)
{
	*params = (struct engine_params){
		.gles = settings->gles,
		.threads = settings->threads,
		.method = settings->method,
		.analysis = (enum engine_analysis)settings->analysis,
		.motion_model = (enum engine_motion_model)settings->motion_model,
		.blur = (enum engine_blur)settings->blur,
		.no_compensation = !settings->compensation,
		.cell = settings->cell,
		.blur_level = settings->blur_level,
		.threshold_quarter = (uint32_t)lrint(settings->snap_threshold * 4.0),
		.display_width_mm = (float)settings->display_width_mm,
		.viewing_distance_mm = (float)settings->viewing_distance_mm,
		.curve = settings->gamma > 0.0 ? ENGINE_CURVE_GAMMA : ENGINE_CURVE_SRGB,
		.gamma = (float)settings->gamma,
	};
	return option_value_context(settings->context, &params->context, &params->device, error);
}
