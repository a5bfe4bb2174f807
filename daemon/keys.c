/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/keys.h"

#include <stdio.h>
#include <string.h>

#include "daemon/present/presenter.h"

static const struct {
	uint32_t codes[3]; /* ended by 0 or full */
	enum key_action action;
	const char *keys, *help;
} bindings[] = {
	{{'h', PRESENTER_KEY_F1}, KEY_HELP, "h F1", "this help"},
	{{'m'}, KEY_METHOD, "m", "the next method"},
	{{'s'}, KEY_SPLIT, "s", "right half without in-betweens"},
	{{'i'}, KEY_STATISTICS, "i", "statistics"},
	{{'f'}, KEY_FULLSCREEN, "f", "full screen"},
	{{'q', PRESENTER_KEY_ESCAPE, PRESENTER_KEY_CLOSE}, KEY_QUIT, "q Esc", "quit; twice if the game goes on"},
};

#define BINDINGS (sizeof(bindings) / sizeof(bindings[0]))

enum key_action keys_find(uint32_t code)
{
	for (size_t i = 0; i < BINDINGS && code != 0; i++)
		for (size_t j = 0; j < 3; j++)
			if (bindings[i].codes[j] == code)
				return bindings[i].action;
	return KEY_NOTHING;
}

void keys_describe(char *text, size_t size)
{
	size_t used = 0;
	text[0] = 0;
	for (size_t i = 0; i < BINDINGS && used < size; i++)
		used +=
			(size_t)snprintf(text + used, size - used, "%s%-6s %s", i ? "\n" : "", bindings[i].keys, bindings[i].help);
}

/* One character of UTF-8 and nothing more; 0: it is not. */
static uint32_t parse_character(const char *text)
{
	const unsigned char *bytes = (const unsigned char *)text;
	const unsigned more = bytes[0] >= 0xf0 ? 3 : bytes[0] >= 0xe0 ? 2 : bytes[0] >= 0xc0 ? 1 : 0;
	uint32_t code = more == 0 ? bytes[0] : bytes[0] & (0x3fu >> more);
	if ((bytes[0] >= 0x80 && bytes[0] < 0xc0) || bytes[0] >= 0xf8 || strlen(text) != more + 1)
		return 0;
	for (unsigned i = 1; i <= more; i++) {
		if ((bytes[i] & 0xc0) != 0x80)
			return 0;
		code = code << 6 | (bytes[i] & 0x3f);
	}
	return code > 0x10ffff ? 0 : code;
}

uint32_t keys_parse(const char *text)
{
	if (strcmp(text, "escape") == 0)
		return PRESENTER_KEY_ESCAPE;
	if (strcmp(text, "f1") == 0)
		return PRESENTER_KEY_F1;
	if (strcmp(text, "close") == 0)
		return PRESENTER_KEY_CLOSE;
	return parse_character(text);
}
