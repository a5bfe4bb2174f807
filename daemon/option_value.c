/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/option_value.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(name) offsetof(struct settings, name)

static void *field_of(struct settings *settings, const struct option_row *row)
{
	return (char *)settings + row->offset;
}

static const void *const_field_of(const struct settings *settings, const struct option_row *row)
{
	return (const char *)settings + row->offset;
}

size_t option_value_size(const struct option_row *row)
{
	switch (row->type) {
	case OPTION_TEXT:
	case OPTION_NAME:
	case OPTION_NAMES:
		return row->size;
	case OPTION_FLAG:
		return sizeof(bool);
	case OPTION_NUMBER:
	case OPTION_CHOICE:
		return sizeof(uint32_t);
	case OPTION_REAL:
		return sizeof(double);
	case OPTION_RATE:
		return 2 * sizeof(uint64_t);
	case OPTION_SIZE:
		return 2 * sizeof(uint32_t);
	}
	return 0;
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
	*value = number + 0.0; /* -0 is 0 */
	return 0;
}

void option_choices_join(const char *const *choices, char *text, size_t size)
{
	size_t used = 0;
	text[0] = 0;
	for (size_t i = 0; choices[i] && used < size; i++)
		used += (size_t)snprintf(text + used, size - used, "%s%s", i ? ", " : "", choices[i]);
}

bool option_choices_have(const char *const *choices, const char *text, uint32_t *index)
{
	uint32_t i = 0;
	while (choices[i] && strcmp(choices[i], text) != 0)
		i++;
	if (choices[i] && index)
		*index = i;
	return choices[i] != NULL;
}

static int refuse_choice(const struct option_row *row, const char *text, struct error *error)
{
	char list[160];
	option_choices_join(row->choices, list, sizeof(list));
	return error_set(error, -EINVAL, "%s: \"%.64s\" is none of %s", row->name, text, list);
}

static int parse_choice(const struct option_row *row, const char *text, uint32_t *value, struct error *error)
{
	return option_choices_have(row->choices, text, value) ? 0 : refuse_choice(row, text, error);
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

/* "1280x720"; "auto" is 0x0 */
static int parse_size(const struct option_row *row, const char *text, uint32_t value[2], struct error *error)
{
	unsigned width = 0, height = 0;
	int end = 0;
	if (strcmp(text, "auto") != 0) {
		if (strspn(text, "0123456789x") != strlen(text) || sscanf(text, "%5ux%5u%n", &width, &height, &end) != 2 ||
			text[end])
			return error_set(error, -EINVAL, "%s: \"%.64s\" is neither auto nor a size like 1280x720", row->name, text);
		if (width < row->min || height < row->min || width > row->max || height > row->max)
			return error_set(error, -EINVAL, "%s: %.64s is not within %g to %g px", row->name, text, row->min,
							 row->max);
	}
	value[0] = width;
	value[1] = height;
	return 0;
}

int option_value_context(const char *text, enum engine_context_kind *kind, uint32_t *device, struct error *error)
{
	const struct option_row *row = option_find("context");
	const char *indexed = row->choices[ENGINE_CONTEXT_EGL_DEVICE];
	const size_t prefix = strcspn(indexed, ":") + 1;
	uint32_t index = 0;
	*device = 0;
	if (strncmp(text, indexed, prefix) == 0 && strcmp(text, indexed) != 0) {
		char *end;
		const unsigned long number = strtoul(text + prefix, &end, 10);
		if (!isdigit((unsigned char)text[prefix]) || *end || number > 255)
			return error_set(error, -EINVAL, "context: \"%.64s\": the index of the device must be 0 to 255", text);
		*kind = ENGINE_CONTEXT_EGL_DEVICE;
		*device = (uint32_t)number;
		return 0;
	}
	if (!option_choices_have(row->choices, text, &index) || index == ENGINE_CONTEXT_EGL_DEVICE)
		return refuse_choice(row, text, error);
	*kind = (enum engine_context_kind)index;
	return 0;
}

/* "kms,headless": each of them is a choice. */
static int check_names(const struct option_row *row, const char *text, struct error *error)
{
	bool any = false;
	for (text += strspn(text, ", "); *text; text += strspn(text, ", ")) {
		char name[65];
		const size_t length = strcspn(text, ", ");
		snprintf(name, sizeof(name), "%.*s", (int)(length < 64 ? length : 64), text);
		if (!option_choices_have(row->choices, name, NULL))
			return refuse_choice(row, name, error);
		text += length;
		any = true;
	}
	return any ? 0 : refuse_choice(row, "", error);
}

/* Of what is text, but not any. */
static int check_words(const struct option_row *row, const char *text, struct error *error)
{
	enum engine_context_kind kind;
	uint32_t device;
	if (row->offset == FIELD(context))
		return option_value_context(text, &kind, &device, error);
	if (row->type == OPTION_NAMES)
		return check_names(row, text, error);
	if (row->type == OPTION_NAME && !option_choices_have(row->choices, text, NULL))
		return refuse_choice(row, text, error);
	return 0;
}

/* How many bytes the UTF-8 character there has; 0: it is none (RFC 3629: shortest form, no surrogates). */
static size_t character_bytes(const unsigned char *c)
{
	static const struct {
		unsigned char first, last, least, most; /* of the first byte; of the second */
		size_t bytes;
	} forms[] = {
		{0x00, 0x7f, 0x00, 0xff, 1}, {0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
		{0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3}, {0xee, 0xef, 0x80, 0xbf, 3},
		{0xf0, 0xf0, 0x90, 0xbf, 4}, {0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4},
	};
	size_t i = 0;
	while (i < sizeof(forms) / sizeof(forms[0]) && (c[0] < forms[i].first || c[0] > forms[i].last))
		i++;
	if (i == sizeof(forms) / sizeof(forms[0]) || c[1] < forms[i].least || c[1] > forms[i].most)
		return 0;
	for (size_t k = 2; k < forms[i].bytes; k++)
		if ((c[k] & 0xc0) != 0x80)
			return 0;
	return forms[i].bytes;
}

/* What JSON and a terminal take. */
static int check_characters(const struct option_row *row, const char *text, struct error *error)
{
	const unsigned char *c = (const unsigned char *)text;
	for (size_t bytes; *c; c += bytes) {
		bytes = character_bytes(c);
		if (bytes == 0)
			return error_set(error, -EINVAL, "%s: is no UTF-8 text (byte 0x%02x)", row->name, *c);
		const unsigned code = bytes == 2 ? (c[0] & 0x1fu) << 6 | (c[1] & 0x3fu) : *c;
		if (bytes <= 2 && (code < 0x20 || (code >= 0x7f && code < 0xa0)))
			return error_set(error, -EINVAL, "%s: holds a control character (%u)", row->name, code);
	}
	return 0;
}

static int parse_text(struct settings *settings, const struct option_row *row, const char *text, struct error *error)
{
	if (strlen(text) >= row->size)
		return error_set(error, -EINVAL, "%s: \"%.32s...\" is longer than %zu bytes", row->name, text, row->size - 1);
	int result = check_characters(row, text, error);
	if (result == 0)
		result = check_words(row, text, error);
	if (result < 0)
		return result;
	memset(field_of(settings, row), 0, row->size);
	memcpy(field_of(settings, row), text, strlen(text));
	return 0;
}

int option_value_set(struct settings *settings, const struct option_row *row, const char *value, struct error *error)
{
	switch (row->type) {
	case OPTION_TEXT:
	case OPTION_NAME:
	case OPTION_NAMES:
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
	case OPTION_SIZE:
		return parse_size(row, value, field_of(settings, row), error);
	}
	return error_set(error, -EINVAL, "%s: has no type", row->name);
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

static void print_size(const uint32_t size_px[2], char *value, size_t size)
{
	if (size_px[0] == 0)
		snprintf(value, size, "auto");
	else
		snprintf(value, size, "%" PRIu32 "x%" PRIu32, size_px[0], size_px[1]);
}

/* As short as it can be read again. */
static void print_real(double number, char *value, size_t size)
{
	for (int digits = 10; digits <= 17; digits++) {
		snprintf(value, size, "%.*g", digits, number);
		if (strtod(value, NULL) == number)
			return;
	}
}

void option_value_print(const struct settings *settings, const struct option_row *row, char *value, size_t size)
{
	const void *field = const_field_of(settings, row);
	switch (row->type) {
	case OPTION_TEXT:
	case OPTION_NAME:
	case OPTION_NAMES:
		snprintf(value, size, "%s", (const char *)field);
		break;
	case OPTION_FLAG:
		snprintf(value, size, "%s", *(const bool *)field ? "yes" : "no");
		break;
	case OPTION_NUMBER:
		snprintf(value, size, "%" PRIu32, *(const uint32_t *)field);
		break;
	case OPTION_REAL:
		print_real(*(const double *)field, value, size);
		break;
	case OPTION_CHOICE:
		snprintf(value, size, "%s", row->choices[*(const uint32_t *)field]);
		break;
	case OPTION_RATE:
		print_rate(field, value, size);
		break;
	case OPTION_SIZE:
		print_size(field, value, size);
		break;
	}
}
