/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/keyboard.h"

#include <string.h>

#include "daemon/keys.h"

static void next_method(struct keyboard *keyboard)
{
	const struct engine_method_info *methods = engine_methods();
	struct output_info info;
	struct error error;
	char change[64];
	size_t i = 0;
	output_get_info(keyboard->output, &info);
	while (methods[i].name && strcmp(methods[i].name, info.method) != 0)
		i++;
	const char *next = methods[i].name && methods[i + 1].name ? methods[i + 1].name : methods[0].name;
	snprintf(change, sizeof(change), "method=%s", next);
	if (live_set(keyboard->live, change, false, &error) < 0)
		log_warning(keyboard->log, "%s", error.text);
}

/* A client that wants keys is asked first, since it may have something to save. */
static void quit(struct keyboard *keyboard, const struct presenter_key *key)
{
	uint64_t client_id = 0, stream_id = 0;
	const bool any = keyboard->server && output_get_shown(keyboard->output, &client_id, &stream_id);
	if (any && keyboard->asked_client != client_id && server_send_key(keyboard->server, key)) {
		keyboard->asked_client = client_id;
		return;
	}
	log_info(keyboard->log, "quit by key: stopping");
	loop_quit(keyboard->loop);
}

void keyboard_press(void *data, const struct presenter_key *key)
{
	struct keyboard *keyboard = data;
	switch (keys_find(key->code)) {
	case KEY_HELP:
		output_toggle_view(keyboard->output, VIEW_HELP);
		break;
	case KEY_STATISTICS:
		output_toggle_view(keyboard->output, VIEW_STATISTICS);
		break;
	case KEY_SPLIT:
		output_toggle_view(keyboard->output, VIEW_SPLIT);
		break;
	case KEY_FULLSCREEN:
		output_toggle_fullscreen(keyboard->output);
		break;
	case KEY_METHOD:
		next_method(keyboard);
		break;
	case KEY_QUIT:
		quit(keyboard, key);
		break;
	case KEY_NOTHING:
		if (keyboard->server)
			server_send_key(keyboard->server, key);
		break;
	}
}
