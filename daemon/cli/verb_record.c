/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "args.h"
#include "daemon/record/recording.h"
#include "json_out.h"
#include "progress.h"
#include "record_daemon.h"
#include "scene_source.h"
#include "verbs.h"

static const char *const motion_kinds[] = {"backward", "forward", NULL};
static const char *const color_formats[] = {"bgra8", "rgba8", "rgb10a2", "rgba16f", NULL};
static const char *const depth_formats[] = {"f32", "unorm24", "unorm16", NULL};
static const char *const motion_formats[] = {"f16", "f32", NULL};

static const uint32_t color_values[] = {PURSUIT_FORMAT_BGRA8, PURSUIT_FORMAT_RGBA8, PURSUIT_FORMAT_RGB10A2,
										PURSUIT_FORMAT_RGBA16F};
static const uint32_t depth_values[] = {PURSUIT_FORMAT_DEPTH32F, PURSUIT_FORMAT_DEPTH24, PURSUIT_FORMAT_DEPTH16};
static const uint32_t motion_values[] = {PURSUIT_FORMAT_RG16F, PURSUIT_FORMAT_RG32F};

struct record_options {
	const char *path;
	const char *scene;
	const char *socket;
	struct arg_size size;
	struct arg_rate rate;
	double seconds;
	uint32_t motion, color, depth, motion_format;
	bool object_id, json;
};

static bool read_options(struct record_options *options, int argc, char **argv, int *status)
{
	const char *scenes[SCENE_SOURCE_NAMES];
	scene_source_names(scenes);
	const struct arg_row rows[] = {
		{"scene", ARG_TEXT, &options->scene, 0, 0, scenes, "NAME",
		 "a built-in scene; without it, what a running daemon receives"},
		{"size", ARG_SIZE, &options->size, 0, 0, NULL, "WxH", "of the scene's pictures (640x360)"},
		{"fps", ARG_RATE, &options->rate, 0, 0, NULL, "F", "the scene's frames a second (60)"},
		{"seconds", ARG_REAL, &options->seconds, 0.001, 86400, NULL, "S",
		 "how long; a scene 2 by default, a daemon until Ctrl-C"},
		{"motion", ARG_CHOICE, &options->motion, 0, 0, motion_kinds, "KIND",
		 "backward (since the frame before, the default) or forward (to the next)"},
		{"color-format", ARG_CHOICE, &options->color, 0, 0, color_formats, "FORMAT",
		 "bgra8 (default), rgba8, rgb10a2 or rgba16f (linear light)"},
		{"depth-format", ARG_CHOICE, &options->depth, 0, 0, depth_formats, "FORMAT",
		 "f32 (default), unorm24 or unorm16"},
		{"motion-format", ARG_CHOICE, &options->motion_format, 0, 0, motion_formats, "FORMAT", "f16 (default) or f32"},
		{"object-id", ARG_FLAG, &options->object_id, 0, 0, NULL, NULL, "a plane of object ids too"},
		{"json", ARG_FLAG, &options->json, 0, 0, NULL, NULL, "print what was recorded as JSON"},
		{"socket", ARG_TEXT, &options->socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = "record",
		.usage = "OUT.pursuit [--scene NAME] [options]",
		.summary = "Writes a recording: real frames with depth and motion, bit-exact, as a file that `pursuit replay`\n"
				   "plays. With --scene a built-in scene is rendered straight into it, without a daemon, at any\n"
				   "rate; without --scene the frames that a running daemon receives are written.",
		.examples = "  pursuit record colonnade.pursuit --scene colonnade --size 1024x1024 --fps 120 --seconds 2\n"
					"      every second frame of it can be hidden and predicted: pursuit replay --every 2\n"
					"  pursuit record game.pursuit --seconds 5\n"
					"      what the clients of the running daemon send, for five seconds\n",
		.rows = rows,
		.positionals = &options->path,
		.positional_min = 1,
		.positional_max = 1,
	};
	return args_parse(&args, argc, argv, status);
}

static void describe(const struct record_options *options, char *info, size_t size)
{
	snprintf(info, size,
			 "program=pursuit record\nscene=%s\nwidth=%u\nheight=%u\nfps=%" PRIu64 "/%" PRIu64 "\nmotion=%s\n"
			 "number_offset=0\nscene_epoch_ns=%" PRIu64 "\n",
			 options->scene, options->size.width, options->size.height, options->rate.numerator,
			 options->rate.denominator, motion_kinds[options->motion], SCENE_SOURCE_EPOCH_NS);
}

static int write_frames(struct scene_source *source, struct recording_writer *writer, uint64_t count,
						struct error *error)
{
	struct progress progress = {.what = "frames"};
	int result = 0;
	for (uint64_t i = 0; i < count && result == 0; i++) {
		struct frame frame;
		if (scene_source_frame(source, i, &frame))
			result = recording_writer_frame(writer, &frame, frame.header.time_ns, error);
		else
			result = error_set(error, -EIO, "GL failed to render frame %" PRIu64, i);
		progress_show(&progress, i + 1, count);
	}
	progress_end(&progress);
	return result;
}

/* The file is complete only if frames and END are written; what is whole before a failure stays readable. */
static int record_scene(const struct record_options *options)
{
	const struct scene_source_params params = {
		.scene = options->scene,
		.size = options->size,
		.rate = options->rate,
		.forward = options->motion == 1,
		.color_format = color_values[options->color],
		.depth_format = depth_values[options->depth],
		.motion_format = motion_values[options->motion_format],
		.object_id = options->object_id,
	};
	struct error error = {{0}}, close_error = {{0}};
	if (!scene_exists(options->scene)) {
		scene_source_unknown(options->scene, &error);
		return args_wrong("record", "%s", error.text);
	}
	struct scene_source *source = scene_source_create(&params, &error);
	if (!source)
		return args_failed("record", "%s", error.text);
	char info[1024];
	describe(options, info, sizeof(info));
	const struct recording_writer_params file = {.path = options->path, .info = info};
	struct recording_writer *writer = recording_writer_create(&file, &error);
	if (!writer) {
		scene_source_destroy(&source);
		return args_failed("record", "%s", error.text);
	}
	double exact = options->seconds * (double)options->rate.numerator / (double)options->rate.denominator;
	uint64_t count = (uint64_t)fmax(1, floor(exact + 1e-6)), bytes, frames;
	int result = write_frames(source, writer, count, &error);
	recording_writer_counts(writer, &bytes, &frames);
	int closed = recording_writer_close(&writer, &close_error);
	scene_source_destroy(&source);
	if (result < 0)
		return args_failed("record", "%s (%" PRIu64 " of %" PRIu64 " frames written)", error.text, frames, count);
	if (closed < 0)
		return args_failed("record", "%s", close_error.text);
	if (options->json)
		return json_out("record",
						json_pack("{s:s, s:s, s:I, s:i, s:i, s:I}", "recording", options->path, "scene", options->scene,
								  "frames", (json_int_t)frames, "width", (int)options->size.width, "height",
								  (int)options->size.height, "bytes", (json_int_t)bytes));
	printf("%s: %" PRIu64 " frames of %s, %ux%u, %.1f MB\n", options->path, frames, options->scene, options->size.width,
		   options->size.height, (double)bytes / 1e6);
	return STATUS_DONE;
}

static int record_received(const struct record_options *options)
{
	json_t *written = NULL;
	const int status = record_daemon("record", ". A scene needs none: --scene NAME", options->path, options->socket,
									 options->seconds, &written);
	if (status != STATUS_DONE)
		return status;
	if (options->json)
		return json_out("record", written);
	const json_int_t dropped = json_integer_value(json_object_get(written, "dropped"));
	printf("%s: %" JSON_INTEGER_FORMAT " frames, %.1f MB", options->path,
		   json_integer_value(json_object_get(written, "frames")),
		   (double)json_integer_value(json_object_get(written, "bytes")) / 1e6);
	if (dropped)
		printf(", %" JSON_INTEGER_FORMAT " frames dropped because the disk was slower", dropped);
	putchar('\n');
	json_decref(written);
	return STATUS_DONE;
}

int verb_record(int argc, char **argv)
{
	struct record_options options = {.size = {640, 360}, .rate = {60, 1}, .seconds = 0};
	int status;
	if (!read_options(&options, argc, argv, &status))
		return status;
	if (!options.scene)
		return record_received(&options);
	if (options.seconds <= 0)
		options.seconds = 2;
	return record_scene(&options);
}
