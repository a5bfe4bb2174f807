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

/* "auto", "egl", "egl-device:INDEX", "osmesa", "cpu" */
int option_value_context(const char *text, enum engine_context_kind *kind, uint32_t *device, struct error *error)
{
	static const char *const names[] = {"auto", "egl", "egl-device:", "osmesa", "cpu"};
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
	for (unsigned i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		if (i != ENGINE_CONTEXT_EGL_DEVICE && strcmp(text, names[i]) == 0) {
			*kind = (enum engine_context_kind)i;
			return 0;
		}
	}
	return error_set(error, -EINVAL, "context: \"%.64s\" is none of auto, egl, egl-device:INDEX, osmesa, cpu", text);
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
	if (row->offset == FIELD(context) && option_value_context(text, &kind, &device, error) < 0)
		return -EINVAL;
	if ((row->offset == FIELD(method) || row->offset == FIELD(present)) && !*text)
		return error_set(error, -EINVAL, "%s: is empty", row->name);
	memset(field_of(settings, row), 0, row->size);
	memcpy(field_of(settings, row), text, strlen(text));
	return 0;
}

int option_value_set(struct settings *settings, const struct option_row *row, const char *value, struct error *error)
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
