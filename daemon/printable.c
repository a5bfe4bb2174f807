/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/printable.h"

#include <jansson.h>
#include <string.h>

void printable_clean(char *name)
{
	json_t *string = json_string(name);
	for (char *c = name; *c; c++)
		if ((unsigned char)*c < ' ' || *c == '\x7f' || (!string && (unsigned char)*c >= 0x80))
			*c = '?';
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
