/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* pursuit check-stream: finds the mistakes that streams are made with, and says how to mend them. */

#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "args.h"
#include "daemon/measure/inspect.h"
#include "daemon/record/recording.h"
#include "json_out.h"
#include "progress.h"
#include "record_daemon.h"
#include "stream_view.h"
#include "verbs.h"

#define VERB "check-stream"

struct check_options {
	const char *path;
	const char *socket;
	double seconds;
	uint32_t pairs;
	bool json;
};

static bool parse(struct check_options *options, int argc, char **argv, int *status)
{
	const struct arg_row rows[] = {
		{"pairs", ARG_NUMBER, &options->pairs, 1, INSPECT_PAIRS, NULL, "N",
		 "pairs of frames to look at, spread over the recording (48)"},
		{"seconds", ARG_REAL, &options->seconds, 0.1, 3600, NULL, "S", "how long to watch a running daemon (2)"},
		{"socket", ARG_TEXT, &options->socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{"json", ARG_FLAG, &options->json, 0, 0, NULL, NULL, "what was found as one JSON object"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[IN.pursuit] [--json]",
		.summary = "Looks for the usual mistakes in a recording, or in what a running daemon receives now: motion of\n"
				   "the wrong sign, unit, scale or kind, depth the wrong way round, jitter that was not taken out,\n"
				   "planes that stand still, intervals that are not those of the times. The\n"
				   "picture must move while it looks; let the camera turn and something pass by.",
		.status = "there is a mistake in the stream",
		.examples = "  pursuit check-stream game.pursuit\n"
					"  pursuit check-stream --seconds 5\n"
					"      what the clients of the running daemon send now\n",
		.rows = rows,
		.positionals = &options->path,
		.positional_max = 1,
	};
	return args_parse(&args, argc, argv, status);
}

/* Two neighbours at a time, so that memory does not grow with the recording. */
struct pair_reader {
	struct recording_reader *reader;
	struct stream_view views[2];
	struct inspect inspect;
	uint32_t damaged;
};

static int read_view(struct pair_reader *pairs, uint64_t index, int slot, struct error *error)
{
	struct frame frame;
	int result = recording_reader_frame(pairs->reader, index, 0, &frame, NULL, error);
	if (result < 0)
		return result;
	if (stream_view_read(&pairs->views[slot], &frame) < 0)
		return error_set(error, -ENOMEM, "out of memory for frame %" PRIu64, index);
	inspect_add_frame(&pairs->inspect, &pairs->views[slot].view);
	return 0;
}

static int check_pairs(struct pair_reader *pairs, uint32_t wanted, struct error *error)
{
	const uint64_t frames = recording_reader_frame_count(pairs->reader), possible = frames > 1 ? frames - 1 : 0;
	const uint64_t count = possible < wanted ? possible : wanted;
	struct progress progress = {.what = "pairs of frames"};
	int64_t held = -1; /* the frame in the newer view */
	int newer = 0;
	for (uint64_t i = 0; i < count; i++) {
		const uint64_t first = i * possible / count;
		int result = 0;
		if (held != (int64_t)first)
			result = read_view(pairs, first, newer, error);
		if (result == 0)
			result = read_view(pairs, first + 1, 1 - newer, error);
		if (result == 0)
			inspect_add_pair(&pairs->inspect, &pairs->views[newer].view, &pairs->views[1 - newer].view);
		if (result == -ENOMEM)
			return result;
		pairs->damaged += result < 0;
		held = result < 0 ? -1 : (int64_t)first + 1;
		newer = 1 - newer;
		progress_show(&progress, i + 1, count);
	}
	progress_end(&progress);
	if (!pairs->inspect.frames)
		return error_set(error, -ENODATA, "there %s %" PRIu64 " whole frame%s, at least two are needed",
						 frames == 1 ? "is" : "are", frames, frames == 1 ? "" : "s");
	return 0;
}

static void print_text(const struct inspect *inspect, const struct inspect_finding *findings, uint32_t count)
{
	const double change = inspect_cost(inspect, INSPECT_ZERO), left = inspect_cost(inspect, INSPECT_RIGHT);
	printf("%u frames, %u pairs compared", inspect->frames, inspect->pairs);
	if (isfinite(change) && change > 0.0)
		printf("; motion explains %.0f %% of the change of the picture", fmax(0.0, 100.0 - 100.0 * left / change));
	printf("\n");
	for (uint32_t i = 0; i < count; i++)
		printf("\n%s: %s\n    %s\n    -> %s\n", inspect_level_name(findings[i].level), findings[i].code,
			   findings[i].text, findings[i].advice);
	if (count == 0)
		printf("no mistake found\n");
}

static int print_json(const struct inspect *inspect, const struct inspect_finding *findings, uint32_t count)
{
	json_t *list = json_array();
	for (uint32_t i = 0; i < count; i++)
		json_array_append_new(list,
							  json_pack("{s:s, s:s, s:s, s:s}", "level", inspect_level_name(findings[i].level), "code",
										findings[i].code, "text", findings[i].text, "advice", findings[i].advice));
	json_t *json =
		json_pack("{s:i, s:i, s:o}", "frames", (int)inspect->frames, "pairs", (int)inspect->pairs, "findings", list);
	const double change = inspect_cost(inspect, INSPECT_ZERO), left = inspect_cost(inspect, INSPECT_RIGHT);
	if (json && isfinite(change)) {
		json_object_set_new(json, "change", json_real(change));
		json_object_set_new(json, "unexplained", json_real(left));
	}
	return json_out(VERB, json);
}

static int check_recording(const char *path, const struct check_options *options)
{
	const struct recording_reader_params params = {.path = path};
	struct pair_reader pairs = {0};
	struct inspect_finding findings[INSPECT_FINDINGS];
	struct error error = {""};
	pairs.reader = recording_reader_create(&params, &error);
	int result = pairs.reader ? check_pairs(&pairs, options->pairs, &error) : -EIO;
	recording_reader_destroy(&pairs.reader);
	stream_view_finish(&pairs.views[0]);
	stream_view_finish(&pairs.views[1]);
	if (result < 0)
		return args_failed(VERB, "%s", error.text);
	if (pairs.damaged)
		fprintf(stderr, "pursuit " VERB ": %u pairs are left out because a frame is damaged\n", pairs.damaged);
	const uint32_t count = inspect_findings(&pairs.inspect, findings);
	if (options->json)
		result = print_json(&pairs.inspect, findings, count);
	else
		print_text(&pairs.inspect, findings, count);
	const bool mistake = count > 0 && findings[0].level == INSPECT_MISTAKE;
	return result != STATUS_DONE || mistake ? STATUS_FAILED : STATUS_DONE;
}

static int check_daemon(const struct check_options *options)
{
	const char *folder = getenv("TMPDIR");
	char path[512];
	if (snprintf(path, sizeof(path), "%s/pursuit-check-XXXXXX", folder && *folder ? folder : "/tmp") >=
		(int)sizeof(path))
		return args_failed(VERB, "TMPDIR is too long");
	int fd = mkstemp(path);
	if (fd < 0)
		return args_failed(VERB, "%s: %s", path, strerror(errno));
	close(fd);
	json_t *written = NULL;
	int status = record_daemon(VERB, ". A recording needs none: pursuit check-stream IN.pursuit", path, options->socket,
							   options->seconds, &written);
	if (status == STATUS_DONE)
		status =
			json_integer_value(json_object_get(written, "frames")) > 0 ? check_recording(path, options) : STATUS_FAILED;
	json_decref(written);
	unlink(path);
	return status;
}

int verb_check_stream(int argc, char **argv)
{
	struct check_options options = {.seconds = 2, .pairs = 48};
	int status = STATUS_DONE;
	if (!parse(&options, argc, argv, &status))
		return status;
	return options.path ? check_recording(options.path, &options) : check_daemon(&options);
}
