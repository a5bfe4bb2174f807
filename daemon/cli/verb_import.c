/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* pursuit import: sequences of images into a recording. */

#include <errno.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>

#include "args.h"
#include "daemon/record/import.h"
#include "daemon/record/pattern.h"
#include "json_out.h"
#include "proto/frame.h"
#include "verbs.h"

#define NOT_GIVEN UINT32_MAX

static const char *const motion_kinds[] = {"backward", "forward", NULL};
static const char *const motion_units[] = {"pixels", "ndc", NULL};
static const char *const depth_kinds[] = {"device", "device-reversed", "linear", NULL};

struct import_options {
	const char *path;
	struct import_params params;
	struct arg_rate fps;
	uint32_t first, last;
	uint32_t motion_kind, motion_unit, depth_kind;
	double near_distance, far_distance;
	bool json;
};

static bool parse(struct import_options *options, int argc, char **argv, int *status)
{
	struct import_params *params = &options->params;
	const struct arg_row rows[] = {
		{"color", ARG_TEXT, &params->color, 0, 0, NULL, "PATTERN", "colour images, 'c_%04d.png'; needed"},
		{"depth", ARG_TEXT, &params->depth, 0, 0, NULL, "PATTERN", "depth images, in the first channel"},
		{"motion", ARG_TEXT, &params->motion, 0, 0, NULL, "PATTERN",
		 "motion images: x in the first channel (R), y in the second (G), +x right, +y down"},
		{"ui", ARG_TEXT, &params->ui, 0, 0, NULL, "PATTERN", "UI layer with alpha; the alpha of PNG is multiplied in"},
		{"object-id", ARG_TEXT, &params->object_id, 0, 0, NULL, "PATTERN", "object ids: grey codes of PNG, or numbers"},
		{"fps", ARG_RATE, &options->fps, 0, 0, NULL, "F", "frames a second: 30, 29.97 or 30000/1001; needed"},
		{"first", ARG_NUMBER, &options->first, 0, PATTERN_MAX_NUMBER, NULL, "I",
		 "first number; without it the lowest that there is of colour"},
		{"last", ARG_NUMBER, &options->last, 0, PATTERN_MAX_NUMBER, NULL, "J",
		 "last number; without it the highest that there is of colour"},
		{"motion-kind", ARG_CHOICE, &options->motion_kind, 0, 0, motion_kinds, "KIND",
		 "backward (the default): position now minus position in the previous frame; forward: in the next minus now"},
		{"motion-unit", ARG_CHOICE, &options->motion_unit, 0, 0, motion_units, "UNIT",
		 "pixels (the default), or ndc: 2 across the picture, y up"},
		{"motion-span", ARG_NUMBER, &params->motion_span, 1, 1000, NULL, "K", "frames that motion spans (default 1)"},
		{"depth-kind", ARG_CHOICE, &options->depth_kind, 0, 0, depth_kinds, "KIND",
		 "device (the default; 0 near, 1 far), device-reversed, or linear"},
		{"near", ARG_REAL, &options->near_distance, 0, 1e30, NULL, "D", "distance of the near plane"},
		{"far", ARG_REAL, &options->far_distance, 0, 1e30, NULL, "D", "distance of the far plane"},
		{"json", ARG_FLAG, &options->json, 0, 0, NULL, NULL, "print what was imported as JSON"},
		{0},
	};
	const struct args args = {
		.verb = argv[0],
		.usage = "OUT.pursuit --color PATTERN --fps F [--depth PATTERN] [--motion PATTERN] [options]",
		.summary = "Makes a recording out of numbered images: PNG, PFM or OpenEXR, in any mix. A pattern has one\n"
				   "%d or %04d where the number goes. Where only every K-th number has depth and motion, the\n"
				   "other frames are truth only: they score a replay and are never fed to it.",
		.examples =
			"  pursuit import walk.pursuit --color 'c_%04d.png' --depth 'd_%04d.exr' --motion 'm_%04d.exr' --fps 30\n"
			"      backward motion in pixels; the numbers are those of the files that there are\n"
			"  pursuit import walk.pursuit --color 'c_%04d.png' --motion 'm_%04d.pfm' --fps 120 --motion-span 4\n"
			"      truth at 120 Hz, and motion across 4 frames on every fourth: a client of 30 Hz\n"
			"  pursuit import a.pursuit --color 'c_%d.png' --motion 'v_%d.exr' --motion-unit ndc --fps 60 --first 8 "
			"--last 99\n",
		.rows = rows,
		.positionals = &options->path,
		.positional_min = 1,
		.positional_max = 1,
	};
	return args_parse(&args, argc, argv, status);
}

/* What the parser cannot know: options that need each other. False: a usage error was printed. */
static bool check(const char *verb, struct import_options *options)
{
	struct import_params *params = &options->params;
	const char *const patterns[] = {params->color, params->depth, params->motion, params->ui, params->object_id};
	static const char *const names[] = {"--color", "--depth", "--motion", "--ui", "--object-id"};
	struct error error;
	if (!params->color)
		return args_wrong(verb, "--color is missing: it names the images, as in --color 'c_%%04d.png'"), false;
	if (!options->fps.numerator)
		return args_wrong(verb, "--fps is missing: how many of these images make a second, as in --fps 30"), false;
	if ((options->first == NOT_GIVEN) != (options->last == NOT_GIVEN))
		return args_wrong(verb, "--first and --last: give both or none"), false;
	if (options->first != NOT_GIVEN && options->last < options->first)
		return args_wrong(verb, "--last is %u, must be at least %u (--first)", options->last, options->first), false;
	if (options->far_distance > 0 && options->far_distance <= options->near_distance)
		return args_wrong(verb, "--far is %g, must be above --near", options->far_distance), false;
	for (size_t i = 0; i < sizeof(patterns) / sizeof(patterns[0]); i++)
		if (patterns[i] && pattern_check(names[i], patterns[i], &error) < 0)
			return args_wrong(verb, "%s", error.text), false;
	return true;
}

static void fill_params(struct import_options *options)
{
	struct import_params *params = &options->params;
	params->path = options->path;
	params->rate = (struct rate){options->fps.numerator, options->fps.denominator};
	params->has_range = options->first != NOT_GIVEN;
	params->first = options->first;
	params->last = options->last;
	params->motion_kind = options->motion_kind + PURSUIT_MOTION_BACKWARD;
	params->motion_in_ndc = options->motion_unit == 1;
	params->depth_kind = options->depth_kind + PURSUIT_DEPTH_DEVICE;
	params->near_distance = (float)options->near_distance;
	params->far_distance = (float)options->far_distance;
}

static int print_json(const char *path, const struct import_summary *s)
{
	json_t *json =
		json_pack("{s:s, s:I, s:I, s:I, s:I, s:i, s:i, s:I, s:I}", "recording", path, "frames", (json_int_t)s->frames,
				  "truth_only_frames", (json_int_t)s->truth_only, "first", (json_int_t)s->first, "last",
				  (json_int_t)s->last, "width", (int)s->width, "height", (int)s->height, "half_motion_frames",
				  (json_int_t)s->half_motion, "bytes", (json_int_t)s->bytes);
	return json_out("import", json);
}

int verb_import(int argc, char **argv)
{
	struct import_options options = {.first = NOT_GIVEN, .last = NOT_GIVEN};
	struct import_summary summary;
	struct error error = {""};
	int status = STATUS_DONE;
	if (!parse(&options, argc, argv, &status))
		return status;
	if (!check(argv[0], &options))
		return STATUS_USAGE;
	fill_params(&options);
	signal(SIGXFSZ, SIG_IGN); /* a file size limit is then told like a full disk */
	if (import_run(&options.params, &summary, &error) < 0)
		return args_failed(argv[0], "%s", error.text);
	if (options.json)
		return print_json(options.path, &summary);
	printf("%s: %llu frames of %ux%u, numbered %llu to %llu", options.path, (unsigned long long)summary.frames,
		   summary.width, summary.height, (unsigned long long)summary.first, (unsigned long long)summary.last);
	if (summary.truth_only)
		printf(", %llu of them truth only", (unsigned long long)summary.truth_only);
	printf("; %.1f MB\n", (double)summary.bytes / 1e6);
	return STATUS_DONE;
}
