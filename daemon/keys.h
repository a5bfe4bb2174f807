/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The daemon's own keys in a presenter's window. One table: what each does, and the help that is shown. */
#ifndef PURSUIT_KEYS_H
#define PURSUIT_KEYS_H

#include <stddef.h>
#include <stdint.h>

enum key_action {
	KEY_NOTHING = 0, /* not one of ours: the client's */
	KEY_HELP,
	KEY_METHOD,
	KEY_SPLIT,
	KEY_STATISTICS,
	KEY_FULLSCREEN,
	KEY_QUIT,
};

/* What the key with this code (presenter.h) does. */
enum key_action keys_find(uint32_t code);

/* The keys and what they do, a line each. */
void keys_describe(char *text, size_t size);

/* A code from text: one character (UTF-8), or "escape", "f1", "close"; 0: neither. */
uint32_t keys_parse(const char *text);

#endif
