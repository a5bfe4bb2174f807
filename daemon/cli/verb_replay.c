/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "args.h"
#include "daemon/governor.h"
#include "daemon/record/image.h"
#include "daemon/record/pattern.h"
#include "daemon/record/recording.h"
#include "expect.h"
#include "figures.h"
#include "json_out.h"
#include "player.h"
#include "verbs.h"

#define VERB "replay"

struct replay_options {
	const char *path;
	struct settings settings;
	uint32_t every;
	bool predict;
	struct arg_rate refresh; /* numerator 0: as the recording asks for */
	const char *write_frames, *json, *fail_under, *write_expect, *expect, *expect_tolerance;
	double least_psnr, least_ssim; /* of --fail-under, -inf: not asked for */
};

/* Everything that a run owns. */
struct replay {
	const struct replay_options *options;
	struct recording_reader *reader;
	struct recorded_frames frames;
	struct schedule schedule;
	struct engine *engine;
	struct recorded_truth *truth;
	struct figures figures;
	struct expect_writer writer;
	struct expect expect;
};

static bool read_options(struct replay_options *options, int argc, char **argv, int *status)
{
	const struct arg_row rows[] = {
		{"every", ARG_NUMBER, &options->every, 1, 64, NULL, "K",
		 "only every K-th frame is real, the others are the truth that the in-betweens are scored against; motion is "
		 "composed over the K"},
		{"predict", ARG_FLAG, &options->predict, 0, 0, NULL, NULL,
		 "each frame with motion predicts the next one (phase 1, no compensation) and is scored against it"},
		{"refresh", ARG_RATE, &options->refresh, 0, 0, NULL, "HZ",
		 "of the virtual display; by default 120, or with truth in the recording the rate of its frames"},
		{"write-frames", ARG_TEXT, &options->write_frames, 0, 0, NULL, "PATTERN",
		 "each displayed frame as PNG, such as 'f_%05d.png'; numbered from 0, predictions by the frame they predict"},
		{"json", ARG_TEXT, &options->json, 0, 0, NULL, "FILE",
		 "all figures, with a row for each real frame; - is stdout"},
		{"fail-under", ARG_TEXT, &options->fail_under, 0, 0, NULL, "LIMITS",
		 "exit status 1 if the mean quality is lower: psnr=34 or psnr=34,ssim=0.95"},
		{"write-expect", ARG_TEXT, &options->write_expect, 0, 0, NULL, "FILE",
		 "a hash of each displayed frame, for --expect"},
		{"expect", ARG_TEXT, &options->expect, 0, 0, NULL, "FILE",
		 "exit status 1 if a displayed frame is not the one of FILE (of --write-expect), or of images: a folder or a "
		 "pattern as written by --write-frames; or if one of them is not displayed"},
		{"expect-tolerance", ARG_TEXT, &options->expect_tolerance, 0, 0, NULL, "T",
		 "for images: 2 (code values at most) or 45dB (PSNR at least); by default they are equal"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "IN.pursuit [options]",
		.summary = "Plays a recording through the engine, headless, on a virtual clock: the same recording gives the\n"
				   "same pictures, bit for bit, on one renderer. In-betweens that fall on the moment of a recorded\n"
				   "frame that was not fed as a real one are scored against it.",
		.status = "what --fail-under or --expect demands is not there",
		.examples = "  pursuit replay colonnade.pursuit --every 2 --method grid --fail-under psnr=30\n"
					"      hide every second frame, make it from the one before, fail if that got worse\n"
					"  pursuit replay walk.pursuit --predict --write-frames 'p_%04d.png' --json walk.json\n"
					"      predict each frame from the one before it, keep pictures and figures\n"
					"  pursuit replay game.pursuit --write-expect game.hashes\n"
					"  pursuit replay game.pursuit --expect game.hashes\n"
					"      has any displayed frame changed since?\n",
		.rows = rows,
		.settings = &options->settings,
		.groups = 1u << OPTION_ENGINE,
		.positionals = &options->path,
		.positional_min = 1,
		.positional_max = 1,
	};
	return args_parse(&args, argc, argv, status);
}

/* "psnr=34,ssim=.9" */
static bool read_limits(struct replay_options *options)
{
	options->least_psnr = options->least_ssim = -HUGE_VAL;
	for (const char *at = options->fail_under; at && *at;) {
		double *limit = strncmp(at, "psnr=", 5) == 0   ? &options->least_psnr
						: strncmp(at, "ssim=", 5) == 0 ? &options->least_ssim
													   : NULL;
		char *end;
		if (!limit)
			return false;
		*limit = strtod(at + 5, &end);
		if (end == at + 5 || !isfinite(*limit) || (*end && *end != ','))
			return false;
		at = *end ? end + 1 : end;
	}
	return !options->fail_under || *options->fail_under;
}

static int check_options(struct replay_options *options, struct replay *replay)
{
	struct expect tolerance = {{0}};
	struct error error;
	if (options->predict && options->every)
		return args_wrong(VERB, "--every and --predict are two ways to score; use one");
	if (!read_limits(options))
		return args_wrong(VERB, "--fail-under is %s, must be such as psnr=34 or psnr=34,ssim=0.95",
						  options->fail_under);
	if (options->write_frames && pattern_check_written("--write-frames", options->write_frames, ".png", &error) < 0)
		return args_wrong(VERB, "%s", error.text);
	if (options->expect_tolerance && !options->expect)
		return args_wrong(VERB, "--expect-tolerance goes with --expect");
	if (options->expect_tolerance && !expect_read_tolerance(options->expect_tolerance, &tolerance))
		return args_wrong(VERB, "--expect-tolerance is %s, must be such as 2 or 45dB", options->expect_tolerance);
	replay->expect = tolerance;
	return args_check_method(VERB, "--method", options->settings.method);
}

/* ---- what is done with each picture ---- */

static int write_picture(const struct replay *replay, const struct player_picture *picture, struct error *error)
{
	char name[PATTERN_MAX_PATH];
	if (!pattern_name(replay->options->write_frames, picture->showing->number, name))
		return error_set(error, -ENAMETOOLONG, "--write-frames: the name of a file is too long");
	const struct picture *shown = &picture->shown;
	return image_write_png(name, shown->data, shown->stride, shown->width, shown->height, false, error);
}

static int take_picture(void *context, const struct player_picture *picture, struct error *error)
{
	struct replay *replay = context;
	uint64_t number = picture->showing->number, hash = figures_hash(&picture->shown);
	int result = figures_add_picture(&replay->figures, picture, hash, error);
	if (result == 0 && replay->options->write_frames)
		result = write_picture(replay, picture, error);
	if (result == 0 && replay->writer.file)
		result = expect_writer_add(&replay->writer, number, &picture->shown, hash, error);
	if (replay->options->expect)
		expect_compare(&replay->expect, number, &picture->shown, hash);
	return result;
}

static int take_frame(void *context, const struct player_frame *frame, struct error *error)
{
	struct replay *replay = context;
	return figures_add_frame(&replay->figures, frame, &replay->frames, error);
}

/* ---- the run ---- */

static void name_damage(const struct replay *replay)
{
	const struct recording_summary *summary = recording_reader_summary(replay->reader);
	if (summary->damage[0])
		fprintf(stderr, "pursuit replay: %s\n", summary->damage);
	else if (!summary->closed)
		fprintf(stderr, "pursuit replay: %s has no end: its writer was stopped; what is whole is played\n",
				replay->options->path);
}

static bool has_truth(const struct replay *replay)
{
	for (uint32_t i = 0; i < replay->frames.count; i++) {
		if (replay->frames.frames[i].flags & PURSUIT_FRAME_TRUTH_ONLY)
			return true;
	}
	return replay->options->every > 1;
}

/* Frames of an import and of a scene have numbers: id - 1 + number_offset (docs/recording.md). */
static void find_numbering(const struct replay *replay, struct schedule_params *params)
{
	char value[32];
	if (!recording_info_value(recording_reader_info(replay->reader), "number_offset", value, sizeof(value)))
		return;
	params->number_offset = strtoull(value, NULL, 10);
	params->numbered = params->number_offset <= PATTERN_MAX_NUMBER;
}

/* Does the method show a real frame only when the next one is there? */
static bool is_late(const char *method)
{
	for (const struct engine_method_info *info = engine_methods(); info->name; info++)
		if (strcmp(info->name, method) == 0)
			return info->lag > 0;
	return false;
}

static int make_schedule(struct replay *replay, struct error *error)
{
	struct schedule_params params = {
		.every = replay->options->every ? replay->options->every : 1,
		.refresh = replay->options->refresh,
		.level = replay->options->settings.level,
	};
	find_numbering(replay, &params);
	if (replay->options->predict)
		return schedule_predict(&replay->schedule, &replay->frames, &params, error);
	if (!params.refresh.numerator && !(has_truth(replay) && recorded_frames_rate(&replay->frames, &params.refresh)))
		params.refresh = (struct arg_rate){120, 1};
	int result = schedule_play(&replay->schedule, &replay->frames, &params, error);
	if (result == 0 && is_late(replay->options->settings.method))
		schedule_delay(&replay->schedule, &replay->frames, params.refresh);
	return result;
}

static int start_engines(struct replay *replay, struct error *error)
{
	struct engine_params params;
	int result = settings_engine_params(&replay->options->settings, &params, error);
	if (result < 0)
		return result;
	governor_apply(replay->options->settings.level, &params);
	if (replay->options->predict)
		params.no_compensation = true;
	replay->engine = engine_create(&params, error);
	if (!replay->engine)
		return -ENOTSUP;
	for (uint32_t i = 0; i < replay->schedule.showing_count && !replay->truth; i++) {
		const struct showing *showing = &replay->schedule.showings[i];
		if (showing->show == ENGINE_SHOW_IN_BETWEEN && showing->truth >= 0) {
			replay->truth = recorded_truth_create(replay->reader, &replay->frames, &params, error);
			if (!replay->truth)
				return -ENOTSUP;
		}
	}
	return 0;
}

static int open_all(struct replay *replay, struct error *error)
{
	const struct replay_options *options = replay->options;
	const struct recording_reader_params params = {.path = options->path};
	int result = figures_init(&replay->figures, error);
	if (result == 0 && options->expect)
		result = expect_load(&replay->expect, options->expect, error);
	if (result < 0)
		return result;
	replay->reader = recording_reader_create(&params, error);
	if (!replay->reader)
		return -EIO;
	result = recorded_frames_read(&replay->frames, replay->reader, error);
	name_damage(replay);
	if (result == 0)
		result = make_schedule(replay, error);
	if (result == 0)
		result = start_engines(replay, error);
	if (result == 0 && options->write_expect)
		result = expect_writer_open(&replay->writer, options->write_expect, engine_get_info(replay->engine),
									options->settings.method, error);
	return result;
}

static int play(struct replay *replay, struct error *error)
{
	struct player player = {
		.reader = replay->reader,
		.frames = &replay->frames,
		.schedule = &replay->schedule,
		.engine = replay->engine,
		.observer = {replay, take_picture, take_frame},
		.progress = "real frames",
	};
	if (replay->truth)
		player.truth = recorded_truth_source(replay->truth);
	int result = player_run(&player, error);
	replay->figures.lost_real_frames = replay->schedule.lost_real_frames;
	replay->figures.duration_ns = replay->schedule.duration_ns;
	return result == 0 ? expect_writer_close(&replay->writer, error) : result;
}

static json_t *all_figures(struct replay *replay)
{
	const struct engine_info *info = engine_get_info(replay->engine);
	const struct replay_options *options = replay->options;
	const struct recording_summary *summary = recording_reader_summary(replay->reader);
	json_t *json = figures_json(&replay->figures);
	json_object_set_new(json, "recording", json_string(options->path));
	json_object_set_new(json, "damaged_chunks", json_integer((json_int_t)summary->damaged_chunks));
	json_object_set_new(json, "truncated", json_boolean(summary->truncated));
	json_object_set_new(json, "mode",
						json_string(options->predict     ? "predict"
									: options->every > 1 ? "every"
														 : "play"));
	json_object_set_new(json, "every", json_integer(options->every ? options->every : 1));
	json_object_set_new(json, "level", json_integer(options->settings.level));
	json_object_set_new(json, "method", json_string(options->settings.method));
	json_object_set_new(json, "context", json_string(info->context));
	json_object_set_new(json, "renderer", json_string(info->renderer));
	json_object_set_new(json, "version", json_string(info->version));
	json_object_set_new(json, "settings", figures_settings_json(&options->settings));
	json_object_set(json, "frames", replay->figures.frames);
	return json;
}

static int write_json(struct replay *replay, struct error *error)
{
	json_t *json = all_figures(replay);
	int result = 0;
	if (strcmp(replay->options->json, "-") != 0)
		result = json_write(json, replay->options->json, error);
	else if (!json_print(json))
		result = error_set(error, -ENOMEM, "out of memory");
	json_decref(json);
	return result;
}

static void print_summary(struct replay *replay)
{
	const struct engine_info *info = engine_get_info(replay->engine);
	printf("%s: %s on %s (%s)\n", replay->options->path, replay->options->settings.method, info->renderer,
		   info->context);
	figures_print(&replay->figures, stdout);
}

static bool below_limits(const struct replay *replay)
{
	const struct quality *quality = &replay->figures.quality;
	const struct replay_options *options = replay->options;
	if (!options->fail_under)
		return false;
	if (quality->frames == 0) {
		fprintf(stderr, "pursuit replay: --fail-under: nothing could be scored (use --every or --predict)\n");
		return true;
	}
	bool psnr = quality->psnr < options->least_psnr, ssim = quality->ssim < options->least_ssim;
	if (psnr)
		fprintf(stderr, "pursuit replay: PSNR %.2f dB is under %.2f\n", quality->psnr, options->least_psnr);
	if (ssim)
		fprintf(stderr, "pursuit replay: SSIM %.4f is under %.4f\n", quality->ssim, options->least_ssim);
	return psnr || ssim;
}

static int run(struct replay *replay)
{
	struct error error = {{0}};
	int result = open_all(replay, &error);
	if (result == 0)
		result = play(replay, &error);
	if (result == 0 && replay->options->json)
		result = write_json(replay, &error);
	if (result < 0)
		return args_failed(VERB, "%s", error.text);
	if (!replay->options->json || strcmp(replay->options->json, "-") != 0)
		print_summary(replay);
	bool failed = below_limits(replay);
	if (replay->options->expect && !expect_conclude(&replay->expect, engine_get_info(replay->engine)))
		failed = true;
	return failed ? STATUS_FAILED : STATUS_DONE;
}

static void finish(struct replay *replay)
{
	struct error ignored;
	expect_writer_close(&replay->writer, &ignored);
	expect_finish(&replay->expect);
	recorded_truth_destroy(&replay->truth);
	engine_destroy(&replay->engine);
	schedule_finish(&replay->schedule);
	recorded_frames_finish(&replay->frames);
	if (replay->reader)
		recording_reader_destroy(&replay->reader);
	figures_finish(&replay->figures);
}

int verb_replay(int argc, char **argv)
{
	struct replay_options options = {0};
	struct replay replay = {.options = &options};
	int status;
	settings_defaults(&options.settings);
	if (!read_options(&options, argc, argv, &status))
		return status;
	status = check_options(&options, &replay);
	if (status != STATUS_DONE)
		return status;
	status = run(&replay);
	finish(&replay);
	return status;
}
