/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "args.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define NAME_MAX_LENGTH 63

int args_wrong(const char *verb, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	fprintf(stderr, "pursuit %s: ", verb);
	vfprintf(stderr, format, arguments);
	fprintf(stderr, "\nTry `pursuit %s --help`.\n", verb);
	va_end(arguments);
	return STATUS_USAGE;
}

int args_failed(const char *verb, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	fprintf(stderr, "pursuit %s: ", verb);
	vfprintf(stderr, format, arguments);
	fputc('\n', stderr);
	va_end(arguments);
	return STATUS_FAILED;
}

int args_check_method(const char *verb, const char *option, const char *method)
{
	const char *const *names = option_find("method")->choices;
	char list[200];
	option_choices_join(names, list, sizeof(list));
	return option_choices_have(names, method, NULL)
			   ? STATUS_DONE
			   : args_wrong(verb, "%s is %s, must be one of %s", option, method, list);
}

unsigned args_distance(const char *a, const char *b)
{
	unsigned row[NAME_MAX_LENGTH + 1];
	size_t length = strlen(b);
	if (length > NAME_MAX_LENGTH)
		length = NAME_MAX_LENGTH;
	for (size_t j = 0; j <= length; j++)
		row[j] = (unsigned)j;
	for (size_t i = 1; a[i - 1]; i++) {
		unsigned diagonal = row[0];
		row[0] = (unsigned)i;
		for (size_t j = 1; j <= length; j++) {
			unsigned change = diagonal + (a[i - 1] != b[j - 1]);
			unsigned least = row[j] < row[j - 1] ? row[j] + 1 : row[j - 1] + 1;
			diagonal = row[j];
			row[j] = change < least ? change : least;
		}
	}
	return row[length];
}

static bool read_real(const char *text, double *value)
{
	char *end;
	errno = 0;
	*value = strtod(text, &end);
	return end != text && *end == '\0' && errno == 0 && isfinite(*value);
}

static bool read_whole(const char *text, const char *stop, uint64_t *value, const char **end)
{
	if (text[0] < '0' || text[0] > '9')
		return false;
	char *after;
	errno = 0;
	*value = strtoull(text, &after, 10);
	*end = after;
	return errno == 0 && strchr(stop, *after) != NULL;
}

bool args_read_rate(const char *text, struct arg_rate *rate)
{
	const char *end;
	if (read_whole(text, "/", &rate->numerator, &end) && *end == '/' &&
		read_whole(end + 1, "", &rate->denominator, &end) && *end == '\0') {
		return rate->denominator > 0 && rate->denominator < 1000000000 && rate->numerator >= rate->denominator &&
			   rate->numerator / rate->denominator <= 1000;
	}
	double value;
	if (!read_real(text, &value) || value < 1 || value > 1000)
		return false;
	rate->denominator = 1000;
	rate->numerator = (uint64_t)llround(value * 1000);
	if (rate->numerator % 1000 == 0) {
		rate->numerator /= 1000;
		rate->denominator = 1;
	}
	return true;
}

static bool read_size(const char *text, struct arg_size *size)
{
	const char *end;
	uint64_t width, height;
	if (!read_whole(text, "xX", &width, &end) || *end == '\0')
		return false;
	if (!read_whole(end + 1, "", &height, &end) || *end)
		return false;
	if (width < 1 || height < 1 || width > PURSUIT_MAX_SIZE || height > PURSUIT_MAX_SIZE)
		return false;
	size->width = (uint32_t)width;
	size->height = (uint32_t)height;
	return true;
}

/* Fills the row's target; false with a sentence of what would be right. */
static bool set_row(const struct arg_row *row, const char *text, struct error *error)
{
	double real;
	char choices[200];
	switch (row->type) {
	case ARG_FLAG:
		*(bool *)row->target = true;
		return true;
	case ARG_TEXT:
		*(const char **)row->target = text;
		return true;
	case ARG_NUMBER:
		if (read_real(text, &real) && real >= row->min && real <= row->max && real == floor(real)) {
			*(uint32_t *)row->target = (uint32_t)real;
			return true;
		}
		error_set(error, -EINVAL, "a whole number from %.0f to %.0f", row->min, row->max);
		return false;
	case ARG_REAL:
		if (read_real(text, &real) && real >= row->min && real <= row->max) {
			*(double *)row->target = real;
			return true;
		}
		error_set(error, -EINVAL, "a number from %g to %g", row->min, row->max);
		return false;
	case ARG_SIZE:
		error_set(error, -EINVAL, "WIDTHxHEIGHT, each 1 to %u", PURSUIT_MAX_SIZE);
		return read_size(text, row->target);
	case ARG_RATE:
		error_set(error, -EINVAL, "a rate from 1 to 1000 Hz such as 60, 59.94 or 60000/1001");
		return args_read_rate(text, row->target);
	case ARG_CHOICE:
		option_choices_join(row->choices, choices, sizeof(choices));
		error_set(error, -EINVAL, "one of %s", choices);
		return option_choices_have(row->choices, text, row->target);
	}
	return false;
}

static const struct arg_row *find_row(const struct args *args, const char *name, size_t length)
{
	for (const struct arg_row *row = args->rows; row && row->name; row++) {
		if (strlen(row->name) == length && memcmp(row->name, name, length) == 0)
			return row;
	}
	return NULL;
}

static int unknown_option(const struct args *args, const char *argument)
{
	char name[NAME_MAX_LENGTH + 1];
	snprintf(name, sizeof(name), "%s", argument + strspn(argument, "-"));
	name[strcspn(name, "=")] = '\0';
	const char *nearest = NULL;
	unsigned least = (unsigned)strlen(name) / 3 + 2;
	for (const struct arg_row *row = args->rows; row && row->name; row++) {
		unsigned distance = args_distance(name, row->name);
		if (distance < least) {
			least = distance;
			nearest = row->name;
		}
	}
	for (const struct option_row *row = args->settings ? option_table() : NULL; row && row->name; row++) {
		unsigned distance = args_distance(name, row->name);
		if ((args->groups & 1u << row->group) && distance < least) {
			least = distance;
			nearest = row->name;
		}
	}
	if (nearest)
		return args_wrong(args->verb, "there is no option %s; did you mean --%s?", argument, nearest);
	return args_wrong(args->verb, "there is no option %s", argument);
}

static void print_row(const struct arg_row *row)
{
	char left[64];
	if (row->type == ARG_FLAG)
		snprintf(left, sizeof(left), "--%s", row->name);
	else
		snprintf(left, sizeof(left), "--%s %s", row->name, row->value ? row->value : "VALUE");
	if (strlen(left) > 26)
		printf("  %s\n  %-26s  ", left, "");
	else
		printf("  %-26s  ", left);
	int column = 29;
	for (const char *word = row->help; *word;) {
		int length = (int)strcspn(word, " ");
		bool turn = column + 1 + length > 110, first = word == row->help;
		if (turn)
			printf("\n  %-26s  ", "");
		printf("%s%.*s", first || turn ? "" : " ", length, word);
		column = (turn ? 29 : column) + 1 + length;
		word += length;
		word += strspn(word, " ");
	}
	putchar('\n');
}

static void print_help(const struct args *args)
{
	printf("usage: pursuit %s %s\n\n%s\n", args->verb, args->usage, args->summary);
	printf("\noptions\n");
	for (const struct arg_row *row = args->rows; row && row->name; row++)
		print_row(row);
	static const struct arg_row help = {"help", ARG_FLAG, NULL, 0, 0, NULL, NULL, "show this text"};
	print_row(&help);
	if (args->settings && args->groups) {
		printf("\nsettings shared with pursuitd\n");
		settings_print_help(args->groups, stdout);
	}
	printf("\nexit status: 0 done, 1 failed, 2 used wrongly%s%s\n", args->status ? "; 1 also means: " : "",
		   args->status ? args->status : "");
	if (args->examples)
		printf("\nexamples\n%s", args->examples);
}

static void print_lines(const char *what, const char *text)
{
	while (text && *text) {
		const int length = (int)strcspn(text, "\n");
		printf("%s\t%.*s\n", what, length, text);
		text += length + (text[length] == '\n');
	}
}

/* For the programs that make man pages and shell completions: lines of what settings_print_options() says. */
static void print_options(const struct args *args)
{
	print_lines("usage", args->usage);
	print_lines("summary", args->summary);
	for (const struct arg_row *row = args->rows; row && row->name; row++) {
		const char *value = row->type == ARG_FLAG ? "" : row->value ? row->value : "VALUE";
		printf("option\t%s\t%s\t", row->name, value);
		for (size_t i = 0; row->choices && row->choices[i]; i++)
			printf("%s%s", i ? "," : "", row->choices[i]);
		printf("\t%s\t\t\n", row->help);
	}
	if (args->settings && args->groups)
		settings_print_options(args->groups, stdout);
	if (args->status)
		printf("status\t1 also means: %s.\n", args->status);
	print_lines("example", args->examples);
}

/* 1 taken, 0 not a row of the verb's own, -1 wrong (said so). */
static int take_row(const struct args *args, int argc, char **argv, int *index)
{
	const char *name = argv[*index] + 2;
	size_t length = strcspn(name, "=");
	const struct arg_row *row = find_row(args, name, length);
	if (!row)
		return 0;
	const char *value = name[length] == '=' ? name + length + 1 : NULL;
	if (row->type == ARG_FLAG && value) {
		args_wrong(args->verb, "--%s takes no value", row->name);
		return -1;
	}
	if (row->type != ARG_FLAG && !value) {
		if (*index + 1 >= argc) {
			args_wrong(args->verb, "--%s needs a value", row->name);
			return -1;
		}
		value = argv[++*index];
	}
	struct error error;
	if (!set_row(row, value, &error)) {
		args_wrong(args->verb, "--%s is %s, must be %s", row->name, value, error.text);
		return -1;
	}
	return 1;
}

static int take_option(const struct args *args, int argc, char **argv, int *index)
{
	if (strncmp(argv[*index], "--", 2) == 0) {
		int taken = take_row(args, argc, argv, index);
		if (taken)
			return taken;
		struct error error = {{0}};
		if (args->settings)
			taken = settings_argument(args->settings, args->groups, argc, argv, index, &error);
		if (taken > 0)
			return 1;
		if (taken < 0) {
			args_wrong(args->verb, "%s", error.text);
			return -1;
		}
	}
	unknown_option(args, argv[*index]);
	return -1;
}

bool args_parse(const struct args *args, int argc, char **argv, int *status)
{
	unsigned positionals = 0;
	bool only_positionals = false;
	*status = STATUS_USAGE;
	for (int i = 1; i < argc; i++) {
		if (!only_positionals && (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)) {
			print_help(args);
			*status = STATUS_DONE;
			return false;
		}
		if (!only_positionals && strcmp(argv[i], "--print-options") == 0) {
			print_options(args);
			*status = STATUS_DONE;
			return false;
		}
	}
	for (int i = 1; i < argc; i++) {
		if (!only_positionals && strcmp(argv[i], "--") == 0) {
			only_positionals = true;
		} else if (!only_positionals && argv[i][0] == '-' && argv[i][1]) {
			if (take_option(args, argc, argv, &i) < 0)
				return false;
		} else if (positionals >= args->positional_max) {
			args_wrong(args->verb, "%s is one argument too many", argv[i]);
			return false;
		} else {
			args->positionals[positionals++] = argv[i];
		}
	}
	if (positionals < args->positional_min) {
		args_wrong(args->verb, "an argument is missing: pursuit %s %s", args->verb, args->usage);
		return false;
	}
	if (args->positional_count)
		*args->positional_count = positionals;
	*status = STATUS_DONE;
	return true;
}
