/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/printable.h"

#include <jansson.h>
#include <stdbool.h>
#include <string.h>

static bool is_control(unsigned char byte)
{
	return byte < ' ' || byte == 0x7f;
}

/* U+0080 to U+009F: to a terminal they are the sequences that begin with ESC, in one character. */
static bool is_long_control(const char *c)
{
	return (unsigned char)c[0] == 0xc2 && (unsigned char)c[1] >= 0x80 && (unsigned char)c[1] < 0xa0;
}

void printable_clean(char *name)
{
	json_t *string = json_string(name);
	for (char *c = name; *c; c++) {
		if (is_control((unsigned char)*c) || (!string && (unsigned char)*c >= 0x80))
			*c = '?';
		else if (is_long_control(c))
			c[0] = c[1] = '?';
	}
	json_decref(string);
}

static int continues(char byte)
{
	return ((unsigned char)byte & 0xc0) == 0x80;
}

void printable_copy(char *out, size_t bytes, const char *name)
{
	size_t length = strnlen(name, bytes);
	if (length == bytes) {
		length--;
		while (length > 0 && continues(name[length]))
			length--;
	}
	memcpy(out, name, length);
	out[length] = '\0';
	printable_clean(out);
}
