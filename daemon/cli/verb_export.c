/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* pursuit export: the frames of a recording as images and video. */

#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "args.h"
#include "daemon/record/export.h"
#include "daemon/record/pattern.h"
#include "json_out.h"
#include "verbs.h"

#define NOT_GIVEN UINT32_MAX

static const char *const chromas[] = {"420", "444", NULL};

struct export_options {
	struct export_params params;
	uint32_t first, last, chroma;
	bool json;
};

static bool parse(struct export_options *options, int argc, char **argv, int *status)
{
	struct export_params *params = &options->params;
	const struct arg_row rows[] = {
		{"color", ARG_TEXT, &params->color, 0, 0, NULL, "PATTERN", "colour as PNG, 'c_%04d.png'"},
		{"ui", ARG_TEXT, &params->ui, 0, 0, NULL, "PATTERN", "the UI layer as PNG, as it was recorded (premultiplied)"},
		{"depth", ARG_TEXT, &params->depth, 0, 0, NULL, "PATTERN", "depth as PFM, 'd_%04d.pfm'"},
		{"motion", ARG_TEXT, &params->motion, 0, 0, NULL, "PATTERN", "motion as PFM: x, y, 0; in pixels, +y down"},
		{"y4m", ARG_TEXT, &params->video, 0, 0, NULL, "FILE", "video into a file, or to a pipe with -"},
		{"chroma", ARG_CHOICE, &options->chroma, 0, 0, chromas, "C", "of the video: 420 (the default) or 444"},
		{"first", ARG_NUMBER, &options->first, 0, PATTERN_MAX_NUMBER, NULL, "I", "first number"},
		{"last", ARG_NUMBER, &options->last, 0, PATTERN_MAX_NUMBER, NULL, "J", "last number"},
		{"json", ARG_FLAG, &options->json, 0, 0, NULL, NULL, "print what was exported as JSON"},
		{0},
	};
	const struct args args = {
		.verb = argv[0],
		.usage = "IN.pursuit [--color PATTERN] [--depth PATTERN] [--motion PATTERN] [--ui PATTERN] [--y4m FILE|-]",
		.summary = "Writes the frames of a recording as images and video. Frames have the numbers that their images\n"
				   "had at import, else 0, 1, 2 and so on. What is damaged is named and left out.",
		.status = "a frame was damaged",
		.examples = "  pursuit export walk.pursuit --color 'c_%04d.png' --depth 'd_%04d.pfm' --motion 'm_%04d.pfm'\n"
					"  pursuit export walk.pursuit --y4m - | ffmpeg -i - walk.mp4\n"
					"  pursuit export walk.pursuit --y4m walk.y4m --chroma 444 --first 10 --last 40\n",
		.rows = rows,
		.positionals = &params->path,
		.positional_min = 1,
		.positional_max = 1,
	};
	return args_parse(&args, argc, argv, status);
}

static bool check(const char *verb, const struct export_options *options)
{
	const struct export_params *params = &options->params;
	const char *const patterns[] = {params->color, params->ui, params->depth, params->motion};
	static const char *const names[] = {"--color", "--ui", "--depth", "--motion"};
	static const char *const endings[] = {".png", ".png", ".pfm", ".pfm"};
	struct error error;
	bool any = params->video != NULL;
	for (size_t i = 0; i < sizeof(patterns) / sizeof(patterns[0]); i++) {
		any |= patterns[i] != NULL;
		if (patterns[i] && pattern_check_written(names[i], patterns[i], endings[i], &error) < 0)
			return args_wrong(verb, "%s", error.text), false;
	}
	if (!any)
		return args_wrong(verb, "nothing to write: give --color, --depth, --motion, --ui or --y4m"), false;
	if (options->json && params->video && strcmp(params->video, "-") == 0)
		return args_wrong(verb, "--json and --y4m - both want standard output: write the video into a file"), false;
	if (options->first != NOT_GIVEN && options->last < options->first)
		return args_wrong(verb, "--last is %u, must be at least %u (--first)", options->last, options->first), false;
	return true;
}

static void print_damage(void *data, const char *sentence)
{
	fprintf(stderr, "pursuit %s: %s\n", (const char *)data, sentence);
}

static int print_json(const char *path, const struct export_summary *s)
{
	json_t *json = json_pack("{s:s, s:I, s:I, s:I}", "recording", path, "frames", (json_int_t)s->frames,
							 "damaged_chunks", (json_int_t)s->damaged, "files", (json_int_t)s->files);
	return json_out("export", json);
}

int verb_export(int argc, char **argv)
{
	struct export_options options = {.first = NOT_GIVEN, .last = NOT_GIVEN};
	struct export_params *params = &options.params;
	struct export_summary summary;
	struct error error = {""};
	int status = STATUS_DONE;
	if (!parse(&options, argc, argv, &status))
		return status;
	if (!check(argv[0], &options))
		return STATUS_USAGE;
	params->chroma = options.chroma == 1 ? 444 : 420;
	params->has_first = options.first != NOT_GIVEN;
	params->has_last = options.last != NOT_GIVEN;
	params->first = options.first;
	params->last = options.last;
	params->on_damage = print_damage;
	params->data = argv[0];
	signal(SIGPIPE, SIG_IGN); /* a reader of the video that went away is told, not died of */
	signal(SIGXFSZ, SIG_IGN);
	if (export_run(params, &summary, &error) < 0)
		return args_failed(argv[0], "%s", error.text);
	status = summary.damaged ? STATUS_FAILED : STATUS_DONE;
	if (options.json)
		return print_json(params->path, &summary) == STATUS_DONE ? status : STATUS_FAILED;
	fprintf(params->video ? stderr : stdout, "%s: %llu frames, %llu image files, %llu damaged chunks\n", params->path,
			(unsigned long long)summary.frames, (unsigned long long)summary.files, (unsigned long long)summary.damaged);
	return status;
}
