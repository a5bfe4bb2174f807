/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/options.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const blur_choices[] = {"doubtful", "everywhere", "off", NULL};
static const char *const log_choices[] = {"error", "warning", "info", "debug", NULL};

#define FIELD(name) offsetof(struct settings, name)
#define TEXT(field, option, group, value, help)                                                                      \
	{                                                                                                                \
		option, group, OPTION_TEXT, FIELD(field), sizeof(((struct settings *)0)->field), value, 0, 0, "", NULL, help \
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

static const struct option_row rows[] = {
	TEXT(method, "method", OPTION_ENGINE, "pursuit",
		 "How displayed frames are made from real ones. An unknown name is answered with the list."),
	TEXT(context, "context", OPTION_ENGINE, "auto", "Where the engine runs: auto, egl, egl-device:INDEX or osmesa."),
	FLAG(gles, "gles", OPTION_ENGINE, "no", "Use OpenGL ES 3.1 instead of OpenGL 4.3 core."),
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
	TEXT(present, "present", OPTION_OUTPUT, "headless",
		 "Presenters, separated by commas; the first one that works is used: headless, glfw, kms."),
	RATE(refresh, "refresh", OPTION_OUTPUT, "120", 1, 1000,
		 "Display rate as 120, 119.88 or 120000/1001; a presenter with a display of its own may have another."),
	TEXT(socket, "socket", OPTION_DAEMON, "",
		 "Path of the socket; empty: $PURSUIT_SOCKET, else $XDG_RUNTIME_DIR/pursuit/socket, else /run/pursuit/socket."),
	TEXT(record, "record", OPTION_DAEMON, "", "Record the frames received into this file, from the start."),
	TEXT(stats, "stats", OPTION_DAEMON, "", "Write the statistics into this file at the end, as JSON."),
	NUMBER(max_clients, "max-clients", OPTION_DAEMON, "16", 1, 256, "", "Clients that may be connected at once."),
	NUMBER(max_frame_mb, "max-frame-mb", OPTION_DAEMON, "1024", 1, 1024, "MiB",
		   "Largest frame (all its planes) that a client may offer."),
	CHOICE(log_level, "log-level", OPTION_DAEMON, "info", log_choices, "Least important messages that are logged."),
	{0},
};

const struct option_row *option_table(void)
{
	return rows;
}

static const struct option_row *find_row(const char *name, size_t length)
{
	for (const struct option_row *row = rows; row->name; row++)
		if (strlen(row->name) == length && strncmp(row->name, name, length) == 0)
			return row;
	return NULL;
}

static void *field_of(struct settings *settings, const struct option_row *row)
{
	return (char *)settings + row->offset;
}

static const void *const_field_of(const struct settings *settings, const struct option_row *row)
{
	return (const char *)settings + row->offset;
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

/* ---- values from text ---- */

static int parse_flag(const struct option_row *row, const char *text, bool *value, struct error *error)
{
	static const char *const yes[] = {"yes", "true", "on", "1"}, *const no[] = {"no", "false", "off", "0"};
	for (size_t i = 0; i < 4; i++) {
		if (strcmp(text, yes[i]) == 0 || strcmp(text, no[i]) == 0) {
			*value = strcmp(text, yes[i]) == 0;
			return 0;
		}
	}
	return error_set(error, -EINVAL, "%s: \"%.64s\" is neither yes nor no", row->name, text);
}

static int check_range(const struct option_row *row, const char *text, double value, struct error *error)
{
	const char *space = *row->unit ? " " : "";
	if (value < row->min)
		return error_set(error, -EINVAL, "%s: %.64s is below %g%s%s", row->name, text, row->min, space, row->unit);
	if (value > row->max)
		return error_set(error, -EINVAL, "%s: %.64s is above %g%s%s", row->name, text, row->max, space, row->unit);
	return 0;
}

static int parse_number(const struct option_row *row, const char *text, uint32_t *value, struct error *error)
{
	char *end;
	errno = 0;
	const long long number = strtoll(text, &end, 10);
	if (end == text || *end || isspace((unsigned char)*text))
		return error_set(error, -EINVAL, "%s: \"%.64s\" is not a whole number", row->name, text);
	const int result = check_range(row, text, (double)number, error);
	if (result == 0)
		*value = (uint32_t)number;
	return result;
}

static int parse_real(const struct option_row *row, const char *text, double *value, struct error *error)
{
	char *end;
	const double number = strtod(text, &end);
	if (end == text || *end || isspace((unsigned char)*text) || !isfinite(number))
		return error_set(error, -EINVAL, "%s: \"%.64s\" is not a number", row->name, text);
	const int result = check_range(row, text, number, error);
	if (result < 0)
		return result;
	if (row->offset == FIELD(gamma) && number > 0.0 && number < 1.0)
		return error_set(error, -EINVAL, "gamma: %.64s is neither 0 (sRGB) nor 1 to 5", text);
	if (row->offset == FIELD(snap_threshold) && number * 4.0 != floor(number * 4.0))
		return error_set(error, -EINVAL, "snap-threshold: %.64s is not a multiple of 0.25", text);
	*value = number;
	return 0;
}

static int parse_choice(const struct option_row *row, const char *text, uint32_t *value, struct error *error)
{
	char list[128] = "";
	for (uint32_t i = 0; row->choices[i]; i++) {
		const size_t used = strlen(list);
		if (strcmp(text, row->choices[i]) == 0) {
			*value = i;
			return 0;
		}
		snprintf(list + used, sizeof(list) - used, "%s%s", i ? ", " : "", row->choices[i]);
	}
	return error_set(error, -EINVAL, "%s: \"%.64s\" is none of %s", row->name, text, list);
}

/* Digits with an optional fraction, exactly: 119.88 is 11988 / 100. */
static const char *parse_decimal(const char *text, uint64_t *numerator, uint64_t *denominator)
{
	bool fraction = false, digits = false;
	*numerator = 0;
	*denominator = 1;
	for (; isdigit((unsigned char)*text) || (*text == '.' && !fraction); text++) {
		if (*text == '.') {
			fraction = true;
			continue;
		}
		digits = true;
		if (*numerator >= UINT64_C(1000000000) || *denominator >= UINT64_C(1000000000))
			return NULL;
		*numerator = *numerator * 10 + (uint64_t)(*text - '0');
		if (fraction)
			*denominator *= 10;
	}
	return digits ? text : NULL;
}

static uint64_t greatest_common_divisor(uint64_t a, uint64_t b)
{
	while (b) {
		const uint64_t rest = a % b;
		a = b;
		b = rest;
	}
	return a;
}

static int parse_rate(const struct option_row *row, const char *text, uint64_t value[2], struct error *error)
{
	uint64_t numerator, denominator, divisor = 1, one = 1;
	const char *end = parse_decimal(text, &numerator, &denominator);
	if (end && *end == '/')
		end = denominator == 1 ? parse_decimal(end + 1, &divisor, &one) : NULL;
	if (!end || *end || one != 1 || divisor == 0)
		return error_set(error, -EINVAL, "%s: \"%.64s\" is not a rate like 120, 119.88 or 120000/1001", row->name,
						 text);
	denominator *= divisor;
	const int result = check_range(row, text, (double)numerator / (double)denominator, error);
	if (result < 0)
		return result;
	const uint64_t common = greatest_common_divisor(numerator, denominator);
	value[0] = numerator / common;
	value[1] = denominator / common;
	return 0;
}

/* "auto", "egl", "egl-device:INDEX", "osmesa" */
static int parse_context(const char *text, enum engine_context_kind *kind, uint32_t *device, struct error *error)
{
	static const char *const names[] = {"auto", "egl", "egl-device:", "osmesa"};
	const size_t prefix = strlen(names[ENGINE_CONTEXT_EGL_DEVICE]);
	*device = 0;
	if (strncmp(text, names[ENGINE_CONTEXT_EGL_DEVICE], prefix) == 0) {
		char *end;
		const unsigned long index = strtoul(text + prefix, &end, 10);
		if (!isdigit((unsigned char)text[prefix]) || *end || index > 255)
			return error_set(error, -EINVAL, "context: \"%.64s\": the index of the device must be 0 to 255", text);
		*kind = ENGINE_CONTEXT_EGL_DEVICE;
		*device = (uint32_t)index;
		return 0;
	}
	for (unsigned i = 0; i < 4; i++) {
		if (i != ENGINE_CONTEXT_EGL_DEVICE && strcmp(text, names[i]) == 0) {
			*kind = (enum engine_context_kind)i;
			return 0;
		}
	}
	return error_set(error, -EINVAL, "context: \"%.64s\" is none of auto, egl, egl-device:INDEX, osmesa", text);
}

static int parse_text(struct settings *settings, const struct option_row *row, const char *text, struct error *error)
{
	enum engine_context_kind kind;
	uint32_t device;
	if (strlen(text) >= row->size)
		return error_set(error, -EINVAL, "%s: \"%.32s...\" is longer than %zu bytes", row->name, text, row->size - 1);
	for (const char *c = text; *c; c++)
		if (iscntrl((unsigned char)*c))
			return error_set(error, -EINVAL, "%s: holds a control character (%d)", row->name, *c);
	if (row->offset == FIELD(context) && parse_context(text, &kind, &device, error) < 0)
		return -EINVAL;
	if ((row->offset == FIELD(method) || row->offset == FIELD(present)) && !*text)
		return error_set(error, -EINVAL, "%s: is empty", row->name);
	memset(field_of(settings, row), 0, row->size);
	memcpy(field_of(settings, row), text, strlen(text));
	return 0;
}

static int set_row(struct settings *settings, const struct option_row *row, const char *value, struct error *error)
{
	switch (row->type) {
	case OPTION_TEXT:
		return parse_text(settings, row, value, error);
	case OPTION_FLAG:
		return parse_flag(row, value, field_of(settings, row), error);
	case OPTION_NUMBER:
		return parse_number(row, value, field_of(settings, row), error);
	case OPTION_REAL:
		return parse_real(row, value, field_of(settings, row), error);
	case OPTION_CHOICE:
		return parse_choice(row, value, field_of(settings, row), error);
	case OPTION_RATE:
		return parse_rate(row, value, field_of(settings, row), error);
	}
	return error_set(error, -EINVAL, "%s: has no type", row->name);
}

int settings_set(struct settings *settings, const char *name, const char *value, struct error *error)
{
	const struct option_row *row = find_row(name, strlen(name));
	return row ? set_row(settings, row, value, error) : refuse_unknown(name, error);
}

void settings_defaults(struct settings *settings)
{
	memset(settings, 0, sizeof(*settings));
	for (const struct option_row *row = rows; row->name; row++) {
		struct error error;
		if (set_row(settings, row, row->default_value, &error) < 0) {
			fprintf(stderr, "bug: %s\n", error.text);
			abort();
		}
	}
}

/* ---- values to text ---- */

static void print_rate(const uint64_t rate[2], char *value, size_t size)
{
	const uint64_t million = rate[1] ? 1000000 / rate[1] : 0;
	if (rate[1] == 1)
		snprintf(value, size, "%" PRIu64, rate[0]);
	else if (rate[1] == 100)
		snprintf(value, size, "%" PRIu64 ".%02" PRIu64, rate[0] / 100, rate[0] % 100);
	else if (rate[1] && 1000000 % rate[1] == 0)
		snprintf(value, size, "%" PRIu64 ".%06" PRIu64, rate[0] / rate[1], rate[0] % rate[1] * million);
	else
		snprintf(value, size, "%" PRIu64 "/%" PRIu64, rate[0], rate[1]);
}

int settings_get(const struct settings *settings, const char *name, char *value, size_t size)
{
	const struct option_row *row = find_row(name, strlen(name));
	if (!row)
		return -ENOENT;
	const void *field = const_field_of(settings, row);
	switch (row->type) {
	case OPTION_TEXT:
		snprintf(value, size, "%s", (const char *)field);
		break;
	case OPTION_FLAG:
		snprintf(value, size, "%s", *(const bool *)field ? "yes" : "no");
		break;
	case OPTION_NUMBER:
		snprintf(value, size, "%" PRIu32, *(const uint32_t *)field);
		break;
	case OPTION_REAL:
		snprintf(value, size, "%.10g", *(const double *)field);
		break;
	case OPTION_CHOICE:
		snprintf(value, size, "%s", row->choices[*(const uint32_t *)field]);
		break;
	case OPTION_RATE:
		print_rate(field, value, size);
		break;
	}
	return 0;
}

/* ---- configuration file ---- */

static char *trim(char *text)
{
	char *end = text + strlen(text);
	while (isspace((unsigned char)*text))
		text++;
	while (end > text && isspace((unsigned char)end[-1]))
		*--end = 0;
	return text;
}

static int load_line(struct settings *settings, char *line, struct error *error)
{
	char *name = trim(line), *equals;
	if (!*name || *name == '#')
		return 0;
	equals = strchr(name, '=');
	if (!equals)
		return error_set(error, -EINVAL, "\"%.64s\" is not of the form name = value", name);
	*equals = 0;
	return settings_set(settings, trim(name), trim(equals + 1), error);
}

int settings_load(struct settings *settings, const char *path, struct error *error)
{
	FILE *file = fopen(path, "re");
	char *line = NULL;
	size_t size = 0;
	ssize_t length;
	int result = 0;
	if (!file)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	errno = 0;
	for (unsigned number = 1; result == 0 && (length = getline(&line, &size, file)) >= 0; number++) {
		struct error inner;
		if (strlen(line) != (size_t)length)
			result = error_set(error, -EINVAL, "%s:%u: holds a zero byte; is it a text file?", path, number);
		else if ((result = load_line(settings, line, &inner)) < 0)
			error_set(error, result, "%s:%u: %.400s", path, number, inner.text);
	}
	if (result == 0 && ferror(file))
		result = error_set(error, errno ? -errno : -EIO, "%s: %s", path, strerror(errno ? errno : EIO));
	free(line);
	fclose(file);
	return result;
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
	const int result = set_row(settings, row, value, error);
	return result < 0 ? result : 1;
}

/* ---- help ---- */

/* What may be written, for a person: "yes or no", "4 to 64 px". */
static void describe_values(const struct option_row *row, char *text, size_t size)
{
	size_t used = 0;
	switch (row->type) {
	case OPTION_TEXT:
		snprintf(text, size, "text");
		return;
	case OPTION_FLAG:
		snprintf(text, size, "yes or no");
		return;
	case OPTION_CHOICE:
		text[0] = 0;
		for (size_t i = 0; row->choices[i] && used < size; i++)
			used += (size_t)snprintf(text + used, size - used, "%s%s", i ? ", " : "", row->choices[i]);
		return;
	case OPTION_NUMBER:
	case OPTION_REAL:
	case OPTION_RATE:
		snprintf(text, size, "%g to %g%s%s", row->min, row->max, *row->unit ? " " : "", row->unit);
		return;
	}
}

void settings_print_help(unsigned group_mask, FILE *out)
{
	static const char *const values[] = {"TEXT", NULL, "NUMBER", "NUMBER", "NAME", "RATE"};
	for (const struct option_row *row = rows; row->name; row++) {
		char range[128], usage[64];
		if (!(group_mask & (1u << row->group)))
			continue;
		describe_values(row, range, sizeof(range));
		if (row->type == OPTION_FLAG)
			snprintf(usage, sizeof(usage), "--[no-]%s", row->name);
		else
			snprintf(usage, sizeof(usage), "--%s %s", row->name, values[row->type]);
		fprintf(out, "  %-30s %s\n  %-30s (%s; default %s)\n", usage, row->help, "", range,
				*row->default_value ? row->default_value : "empty");
	}
}

void settings_print_config(FILE *out)
{
	static const char *const titles[] = {"Engine", "Output", "Daemon"};
	int group = -1;
	fprintf(out, "# Settings of pursuitd, one `name = value` a line; these are the defaults.\n");
	for (const struct option_row *row = rows; row->name; row++) {
		char range[128];
		if ((int)row->group != group) {
			group = (int)row->group;
			fprintf(out, "\n# ---- %s ----\n", titles[group]);
		}
		describe_values(row, range, sizeof(range));
		fprintf(out, "\n# %s\n# (%s)\n#%s = %s\n", row->help, range, row->name, row->default_value);
	}
}

/* ---- the engine's part ---- */

int settings_engine_params(const struct settings *settings, struct engine_params *params, struct error *error)
{
	*params = (struct engine_params){
		.gles = settings->gles,
		.method = settings->method,
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
	return parse_context(settings->context, &params->context, &params->device, error);
}
