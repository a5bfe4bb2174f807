/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Configuration files, command lines, and patterns of file names. Input: a byte
 * that says which, then the text; arguments are separated by zero bytes. What
 * was accepted is written and read again, and must be the same.
 */
#include <stdlib.h>
#include <string.h>

#include "daemon/configuration.h"
#include "daemon/record/pattern.h"
#include "tests/fuzz/fuzz.h"

#define MOST_ARGUMENTS 16
#define ALL_GROUPS (1u << OPTION_ENGINE | 1u << OPTION_OUTPUT | 1u << OPTION_LAB | 1u << OPTION_DAEMON)

/* Every setting, as text, gives the same setting again. */
static void check_round_trip(const struct settings *settings)
{
	struct settings again;
	struct engine_params params;
	struct error error = {""};
	settings_defaults(&again);
	for (const struct option_row *row = option_table(); row->name; row++) {
		char value[1024], second[1024];
		FUZZ_EXPECT(settings_get(settings, row->name, value, sizeof(value)) == 0);
		FUZZ_EXPECT(settings_set(&again, row->name, value, &error) == 0);
		FUZZ_EXPECT(settings_get(&again, row->name, second, sizeof(second)) == 0);
		FUZZ_EXPECT(strcmp(value, second) == 0);
	}
	FUZZ_EXPECT(settings_engine_params(settings, &params, &error) == 0);
}

static void load_file(const struct fuzz_input *input)
{
	struct settings settings;
	struct profiles profiles = {NULL, 0};
	struct fuzz_file file;
	struct error error = {""};
	settings_defaults(&settings);
	fuzz_file_init(&file, input->data, input->size);
	FUZZ_EXPECT(configuration_load(&settings, &profiles, file.path, NULL, &error) == 0 || error.text[0]);
	fuzz_file_finish(&file);
	check_round_trip(&settings);
	for (size_t i = 0; i < profiles.count && i < 4; i++)
		check_round_trip(&profiles.list[i].values);
	profiles_finish(&profiles);
}

/* Zero bytes part the text into arguments; gives how many. */
static int split(char *text, size_t size, char *arguments[MOST_ARGUMENTS])
{
	int count = 0;
	for (size_t at = 0; at < size && count < MOST_ARGUMENTS; at += strlen(text + at) + 1)
		arguments[count++] = text + at;
	return count;
}

static void parse_arguments(char *text, size_t size)
{
	char *arguments[MOST_ARGUMENTS + 1] = {NULL};
	struct settings settings;
	struct error error = {""};
	const int count = split(text, size, arguments);
	settings_defaults(&settings);
	for (int i = 0; i < count; i++) {
		const int result = settings_argument(&settings, ALL_GROUPS, count, arguments, &i, &error);
		FUZZ_EXPECT(i < count && (result >= 0 || error.text[0]));
		settings_nearest(arguments[i]);
	}
	check_round_trip(&settings);
}

static void set_one(char *text, size_t size)
{
	char *words[MOST_ARGUMENTS];
	struct settings settings;
	struct error error = {""};
	settings_defaults(&settings);
	if (split(text, size, words) >= 2)
		FUZZ_EXPECT(settings_set(&settings, words[0], words[1], &error) == 0 || error.text[0]);
	check_round_trip(&settings);
}

static void fill_pattern(const char *text)
{
	char name[PATTERN_MAX_PATH];
	struct error error = {""};
	if (pattern_check("--color", text, &error) < 0) {
		FUZZ_EXPECT(error.text[0]);
		return;
	}
	if (pattern_name(text, 7, name))
		FUZZ_EXPECT(strlen(name) < PATTERN_MAX_PATH);
	pattern_name(text, PATTERN_MAX_NUMBER, name);
	pattern_exists(text, 0);
}

int fuzz_one(const uint8_t *data, size_t size)
{
	struct fuzz_input input = {data, size};
	const int open_fds = fuzz_open_fds();
	const uint8_t kind = fuzz_u8(&input);
	char *text = calloc(1, input.size + 1);

	FUZZ_EXPECT(text != NULL);
	memcpy(text, input.data, input.size);
	switch (kind % 4) {
	case 0:
		load_file(&input);
		break;
	case 1:
		parse_arguments(text, input.size);
		break;
	case 2:
		set_one(text, input.size);
		break;
	default:
		fill_pattern(text);
	}
	free(text);
	FUZZ_EXPECT(fuzz_open_fds() == open_fds);
	return 0;
}
