/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* pursuit profile: settings of applications in the configuration file. */

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "args.h"
#include "control.h"
#include "daemon/setting_check.h"
#include "json_out.h"
#include "profile_file.h"
#include "verbs.h"

#define VERB "profile"
#define WORDS 34u

struct profile_options {
	const char *words[WORDS]; /* what to do, the application, what follows */
	unsigned count;
	const char *config, *socket;
	bool json;
};

/* ---- which file ---- */

/* The one that the running daemon reads last, and so believes most. */
static bool ask_daemon_for_path(const struct profile_options *options, char *path, size_t size)
{
	struct control control;
	struct error error;
	json_t *reply = NULL;
	if (control_open(&control, options->socket, &error) < 0)
		return false;
	const bool answered = control_ask(&control, "status", -1, &reply, &error) == 0;
	control_close(&control);
	const json_t *files = json_object_get(json_object_get(reply, "configuration"), "files");
	const char *last = answered && json_array_size(files) > 0
						   ? json_string_value(json_array_get(files, json_array_size(files) - 1))
						   : NULL;
	if (last)
		snprintf(path, size, "%s", last);
	json_decref(reply);
	return last != NULL;
}

static int find_path(const struct profile_options *options, char *path, size_t size, struct error *error)
{
	const char *folder = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
	if (options->config)
		snprintf(path, size, "%s", options->config);
	else if (ask_daemon_for_path(options, path, size))
		return 0;
	else if (folder && *folder == '/')
		snprintf(path, size, "%s/pursuit/pursuitd.conf", folder);
	else if (home && *home == '/')
		snprintf(path, size, "%s/.config/pursuit/pursuitd.conf", home);
	else
		return error_set(error, -ENOENT, "which file? Neither a daemon nor $HOME tells; name it with --config FILE");
	return 0;
}

/* ---- printing ---- */

static json_t *profile_json(const struct profile *profile)
{
	json_t *object = json_object();
	for (const struct option_row *row = option_table(); row->name; row++) {
		char value[OPTION_VALUE_BYTES];
		if (!profile->has[row - option_table()])
			continue;
		settings_get(&profile->values, row->name, value, sizeof(value));
		json_object_set_new(object, row->name, json_string(value));
	}
	return object;
}

/* Names may be of any bytes, JSON is UTF-8. */
static int list_json(const struct profile_file *file)
{
	json_t *applications = json_object();
	for (size_t i = 0; i < file->profiles.count; i++) {
		const struct profile *profile = &file->profiles.list[i];
		json_t *settings = profile_json(profile);
		if (json_object_set(applications, profile->application, settings) < 0)
			fprintf(stderr, "pursuit " VERB ": the name in line %u is no UTF-8 and is left out\n", profile->line);
		json_decref(settings);
	}
	return json_out(VERB, json_pack("{s:s, s:o}", "file", file->path, "applications", applications));
}

static void print_settings(const struct profile *profile, const char *indent)
{
	for (const struct option_row *row = option_table(); row->name; row++) {
		char value[OPTION_VALUE_BYTES];
		if (!profile->has[row - option_table()])
			continue;
		settings_get(&profile->values, row->name, value, sizeof(value));
		printf("%s%s = %s\n", indent, row->name, value);
	}
}

static int do_list(const struct profile_options *options, struct profile_file *file)
{
	if (options->json)
		return list_json(file);
	for (size_t i = 0; i < file->profiles.count; i++) {
		printf("%s\n", file->profiles.list[i].application);
		print_settings(&file->profiles.list[i], "    ");
	}
	if (file->profiles.count == 0)
		fprintf(stderr, "no application has a profile in %s\n", file->path);
	return STATUS_DONE;
}

static int no_profile(const char *application, const struct profile_file *file)
{
	return args_failed(VERB, "%s has no profile in %s; `pursuit profile list` names those that have", application,
					   file->path);
}

static int do_show(const struct profile_options *options, struct profile_file *file)
{
	const struct profile *profile = profiles_find(&file->profiles, options->words[1]);
	if (!profile)
		return no_profile(options->words[1], file);
	if (options->json)
		return json_out(VERB, profile_json(profile));
	print_settings(profile, "");
	return STATUS_DONE;
}

/* ---- changing ---- */

static int check_setting(const char *name, const char *value)
{
	struct settings settings;
	struct error error;
	char values[160];
	const struct option_row *row = option_find(name);
	settings_defaults(&settings);
	if (row && !option_is_of_picture(row))
		return args_wrong(VERB, "%s is no setting of the picture, which alone an application may have", name);
	if (settings_set(&settings, name, value, &error) == 0 && setting_check(row, &settings, &error) == 0)
		return STATUS_DONE;
	if (!row || row->type == OPTION_TEXT || row->choices)
		return args_wrong(VERB, "%s", error.text);
	settings_describe_values(row, values, sizeof(values));
	return args_wrong(VERB, "%s; it may be %s", error.text, values);
}

static int do_set(const struct profile_options *options, struct profile_file *file)
{
	for (unsigned i = 2; i < options->count; i++) {
		char name[64];
		const size_t length = strcspn(options->words[i], "=");
		if (!options->words[i][length] || length >= sizeof(name))
			return args_wrong(VERB, "%s is not of the form NAME=VALUE", options->words[i]);
		snprintf(name, sizeof(name), "%.*s", (int)length, options->words[i]);
		const char *value = options->words[i] + length + 1;
		const int status = check_setting(name, value);
		if (status != STATUS_DONE)
			return status;
		if (profile_file_set(file, options->words[1], name, value) < 0)
			return args_failed(VERB, "out of memory");
	}
	return STATUS_DONE;
}

static int do_unset(const struct profile_options *options, struct profile_file *file)
{
	if (!profiles_find(&file->profiles, options->words[1]))
		return no_profile(options->words[1], file);
	for (unsigned i = 2; i < options->count; i++)
		if (!profile_file_unset(file, options->words[1], options->words[i]))
			return args_failed(VERB, "%s has no %s in its profile", options->words[1], options->words[i]);
	return STATUS_DONE;
}

static int do_remove(const struct profile_options *options, struct profile_file *file)
{
	return profile_file_remove(file, options->words[1]) ? STATUS_DONE : no_profile(options->words[1], file);
}

/* A daemon that reads this file does so now; it would notice by itself a moment later, where it may watch. */
static void tell_daemon(const struct profile_options *options, const struct profile_file *file)
{
	struct control control;
	struct error error;
	json_t *reply = NULL;
	size_t index;
	json_t *path;
	bool reads = false;
	if (control_open(&control, options->socket, &error) < 0)
		return;
	if (control_ask(&control, "status", -1, &reply, &error) == 0) {
		json_array_foreach(json_object_get(json_object_get(reply, "configuration"), "files"), index, path) reads |=
			json_is_string(path) && strcmp(json_string_value(path), file->path) == 0;
		if (!reads)
			fprintf(stderr, "the running daemon does not read %s; start it with --config %s\n", file->path, file->path);
		else if (control_ask(&control, "reload", -1, NULL, &error) < 0)
			fprintf(stderr, "%s\n", error.text);
	}
	json_decref(reply);
	control_close(&control);
}

/* ---- the verb ---- */

static const struct action {
	const char *name;
	bool changes;
	unsigned least, most; /* words, itself among them */
	int (*run)(const struct profile_options *options, struct profile_file *file);
	const char *usage;
} actions[] = {
	{"list", false, 1, 1, do_list, "list"},
	{"show", false, 2, 2, do_show, "show APPLICATION"},
	{"set", true, 3, WORDS, do_set, "set APPLICATION NAME=VALUE..."},
	{"unset", true, 3, WORDS, do_unset, "unset APPLICATION NAME..."},
	{"remove", true, 2, 2, do_remove, "remove APPLICATION"},
};

static int run(const struct profile_options *options, const struct action *action)
{
	struct profile_file file;
	struct error error = {""};
	char path[PATH_MAX];
	if (find_path(options, path, sizeof(path), &error) < 0)
		return args_failed(VERB, "%s", error.text);
	int status = profile_file_open(&file, path, action->changes, &error) < 0 ? args_failed(VERB, "%s", error.text)
																			 : action->run(options, &file);
	if (status == STATUS_DONE && action->changes && profile_file_save(&file, &error) < 0)
		status = args_failed(VERB, "%s", error.text);
	if (status == STATUS_DONE && action->changes) {
		tell_daemon(options, &file);
		if (options->json)
			status = json_out(VERB, json_pack("{s:s, s:s}", "file", file.path, "done", action->name));
	}
	profile_file_close(&file);
	return status;
}

static int find_action(const struct profile_options *options, const struct action **found)
{
	const char *wanted = options->count ? options->words[0] : "list";
	struct error error;
	*found = NULL;
	for (size_t i = 0; i < sizeof(actions) / sizeof(actions[0]) && !*found; i++)
		if (strcmp(actions[i].name, wanted) == 0)
			*found = &actions[i];
	if (!*found)
		return args_wrong(VERB, "there is no %s; there are list, show, set, unset and remove", wanted);
	if (options->count && (options->count < (*found)->least || options->count > (*found)->most))
		return args_wrong(VERB, "it is: pursuit profile %s", (*found)->usage);
	if ((*found)->changes && profile_check_name(options->words[1], &error) < 0)
		return args_wrong(VERB, "%s", error.text);
	return STATUS_DONE;
}

int verb_profile(int argc, char **argv)
{
	struct profile_options options = {0};
	const struct arg_row rows[] = {
		{"config", ARG_TEXT, &options.config, 0, 0, NULL, "FILE",
		 "the configuration file; default: the one that the running daemon reads, else "
		 "$XDG_CONFIG_HOME/pursuit/pursuitd.conf"},
		{"json", ARG_FLAG, &options.json, 0, 0, NULL, NULL, "as one JSON object"},
		{"socket", ARG_TEXT, &options.socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[list | show APPLICATION | set APPLICATION NAME=VALUE... | unset APPLICATION NAME... | remove "
				 "APPLICATION]",
		.summary =
			"Settings of the picture for one application: they hold while a client of this executable is shown.\n"
			"The name is that of the file (as `pursuit status` says it), without folders; it is the kernel's\n"
			"word, so no client can claim another's. Changes the configuration file, all or nothing, and leaves\n"
			"its comments alone; a running daemon takes it over at once. What `pursuit set` asked for goes first.",
		.examples = "  pursuit profile\n"
					"      all applications that have one\n"
					"  pursuit profile set supertux2 method=grid blur=everywhere\n"
					"  pursuit profile unset supertux2 blur\n"
					"  pursuit profile show supertux2 --json\n"
					"  pursuit profile remove supertux2\n",
		.rows = rows,
		.positionals = options.words,
		.positional_max = WORDS,
		.positional_count = &options.count,
	};
	const struct action *action;
	int status;
	if (!args_parse(&args, argc, argv, &status))
		return status;
	status = find_action(&options, &action);
	return status == STATUS_DONE ? run(&options, action) : status;
}
