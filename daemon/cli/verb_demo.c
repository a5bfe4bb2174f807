/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "args.h"
#include "daemon/clock.h"
#include "demo_client.h"
#include "demo_daemon.h"
#include "demo_scorer.h"
#include "figures.h"
#include "interrupt.h"
#include "json_out.h"
#include "task.h"
#include "timeline.h"
#include "verbs.h"

#define VERB "demo"
/* The burst that is scored: one second, less if the frames are large. */
#define BURST_SECONDS 1.0
#define BURST_LEAST_SECONDS 0.25
#define BURST_BYTES 268435456.0
#define BYTES_PER_PIXEL 16.0
#define DETAIL_ROWS 120u
#define CLIENT_NICENESS 19

/* What two cores keep up with, scene and daemon together; and what any GPU does. */
static const struct arg_size software_size = {640, 360}, gpu_size = {1920, 1080};
static const struct arg_rate software_rate = {40, 1}, gpu_rate = {60, 1};

struct demo_options {
	const char *scene, *out;
	double seconds;
	struct arg_size size;
	struct arg_rate rate;
	const char *methods;
	double method_seconds;
	bool json;
	struct settings settings; /* of the daemon */
};

struct demo {
	struct demo_options options;
	char rings[1024], report[1024], svg[1024], contact[1024], recording[1024], log[1024];
	char title[200];
	struct scene_source *source;
	struct demo_daemon daemon;
	struct demo_scorer scorer;
	struct demo_client *client;
	uint64_t epoch_ns;
	double seconds; /* that the run took */
	bool software;  /* the client renders on a CPU */
	json_t *status; /* the daemon's at the end of the run, before the burst */
	json_t *client_figures;
	struct timeline timeline;
	struct demo_score score;
	struct task *task; /* NULL: the scene has none */
	double task_time;  /* of the score told last: it never goes back */
	unsigned method_turn;
};

static bool read_options(struct demo_options *options, int argc, char **argv, int *status)
{
	const char *scenes[SCENE_SOURCE_NAMES];
	scene_source_names(scenes);
	const struct arg_row rows[] = {
		{"scene", ARG_TEXT, &options->scene, 0, 0, scenes, "NAME", "what the client renders (colonnade)"},
		{"seconds", ARG_REAL, &options->seconds, 0.5, 86400, NULL, "S", "how long (60); Ctrl-C ends it early"},
		{"size", ARG_SIZE, &options->size, 0, 0, NULL, "WxH", "of the picture; 640x360 on a CPU, 1920x1080 on a GPU"},
		{"fps", ARG_RATE, &options->rate, 0, 0, NULL, "F",
		 "frames that the client renders a second; 40 on a CPU, 60 on a GPU"},
		{"out", ARG_TEXT, &options->out, 0, 0, NULL, "DIR", "where report, time line and contact sheet go (out-demo)"},
		{"methods", ARG_TEXT, &options->methods, 0, 0, option_find("method")->choices, "LIST",
		 "methods to show in turn, divided by commas, for the task of the scene rings"},
		{"method-seconds", ARG_REAL, &options->method_seconds, 0.5, 86400, NULL, "S", "how long each of them (60)"},
		{"json", ARG_FLAG, &options->json, 0, 0, NULL, NULL, "print report.json on stdout instead of the summary"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[options]",
		.summary = "Starts a daemon of its own and a client that renders a built-in scene in real time over shared\n"
				   "memory, then leaves in DIR report.json, timeline.svg (what each vblank showed, and how early it\n"
				   "was ready), contact.png (real frame, in-between, truth and error side by side) and burst.pursuit,\n"
				   "the recording that was scored. Settings given here are the daemon's.",
		.examples = "  pursuit demo\n"
					"  pursuit demo --scene tower --seconds 10 --size 640x360 --fps 40 --method hold --out out-hold\n"
					"      40 frames a second become 120 pictures, none of them extrapolated: the yardstick\n",
		.rows = rows,
		.settings = &options->settings,
		.groups = 1u << OPTION_ENGINE | 1u << OPTION_OUTPUT | 1u << OPTION_LAB,
	};
	return args_parse(&args, argc, argv, status);
}

/* ---- start ---- */

static int make_paths(struct demo *demo, struct error *error)
{
	static const char *const names[] = {"report.json",   "timeline.svg", "contact.png",
										"burst.pursuit", "pursuitd.log", "rings.csv"};
	char *const paths[] = {demo->report, demo->svg, demo->contact, demo->recording, demo->log, demo->rings};
	const char *out = demo->options.out;
	if (mkdir(out, 0777) < 0 && errno != EEXIST)
		return error_set(error, -errno, "%s: %s", out, strerror(errno));
	for (size_t i = 0; i < sizeof(names) / sizeof(*names); i++) {
		if ((size_t)snprintf(paths[i], sizeof(demo->report), "%s/%s", out, names[i]) >= sizeof(demo->report))
			return error_set(error, -ENAMETOOLONG, "--out: the path is too long");
	}
	return 0;
}

/* Size and rate are chosen once the renderer is known, so on a GPU the source is made twice. */
static int make_source(struct demo *demo, struct error *error)
{
	struct demo_options *options = &demo->options;
	const bool sized = options->size.width != 0, rated = options->rate.numerator != 0;
	bool *const software = &demo->software;
	*software = true;
	if (!sized)
		options->size = software_size;
	if (!rated)
		options->rate = software_rate;
	struct scene_source_params params = {.scene = options->scene, .size = options->size, .rate = options->rate};
	demo->source = scene_source_create(&params, error);
	if (demo->source)
		scene_source_renderer(demo->source, software);
	if (*software)
		return demo->source ? 0 : -ENOTSUP;
	params.rate = options->rate = rated ? options->rate : gpu_rate;
	if (!sized) {
		params.size = options->size = gpu_size;
		scene_source_destroy(&demo->source);
		demo->source = scene_source_create(&params, error);
	}
	return demo->source ? 0 : -ENOTSUP;
}

static int start_daemon(struct demo *demo, struct error *error)
{
	char texts[OPTION_ROWS][OPTION_VALUE_BYTES + 64];
	const char *passed[OPTION_ROWS + 1] = {NULL};
	unsigned count = 0;
	for (const struct option_row *row = option_table(); row->name; row++) {
		char value[OPTION_VALUE_BYTES];
		if (row->group == OPTION_DAEMON || settings_get(&demo->options.settings, row->name, value, sizeof(value)) < 0)
			continue;
		snprintf(texts[count], sizeof(texts[count]), "--%s=%s", row->name, value);
		passed[count] = texts[count];
		count++;
	}
	return demo_daemon_start(&demo->daemon, passed, demo->log, error);
}

/*
 * On a CPU renderer scene and daemon want the same cores, and of the two the
 * daemon has the deadlines. Threads that are made later (Mesa's) take it over.
 */
static void give_way(void)
{
	setpriority(PRIO_PROCESS, 0, CLIENT_NICENESS);
}

/* ---- the task ---- */

static double clock_seconds(void)
{
	return (double)clock_monotonic_ns() / 1e9;
}

/* What the daemon shows now; a key in the window may have changed it. */
static void ask_method(struct demo *demo, char *method, size_t size)
{
	struct error error;
	json_t *status = NULL;
	if (control_ask(&demo->daemon.control, "status", -1, &status, &error) == 0)
		snprintf(method, size, "%s", json_string_value(json_object_get(status, "method")));
	json_decref(status);
}

static void note(void *context, double time, uint32_t key)
{
	struct demo *demo = context;
	struct scene_score now;
	char method[32] = "", text[128];
	if (key != 0)
		scene_source_key(demo->source, time, (int)key);
	demo->task_time = fmax(demo->task_time, time);
	scene_source_get_score(demo->source, demo->task_time, &now);
	const struct task_score score = {now.shown, now.hits, now.misses, now.false_answers};
	if (!task_changed(demo->task, &score))
		return;
	ask_method(demo, method, sizeof(method));
	task_note(demo->task, time, &score, key, method);
	task_describe(demo->task, text, sizeof(text));
	if (isatty(STDERR_FILENO))
		fprintf(stderr, "\r%s, %s   ", text, method);
}

/* The next of --methods when its time has come. */
static void take_turns(struct demo *demo)
{
	char request[80];
	struct error error;
	const char *name = demo->options.methods;
	const uint64_t epoch_ns = demo_client_epoch(demo->client);
	if (!name || epoch_ns == 0 || clock_seconds() < (double)epoch_ns / 1e9)
		return;
	const unsigned turn = (unsigned)((clock_seconds() - (double)epoch_ns / 1e9) / demo->options.method_seconds) + 1;
	if (turn == demo->method_turn)
		return;
	demo->method_turn = turn;
	unsigned count = 1;
	for (const char *c = name; *c; c++)
		count += *c == ',';
	for (unsigned i = 0; i < (turn - 1) % count; i++)
		name = strchr(name, ',') + 1;
	snprintf(request, sizeof(request), "set method=%.*s", (int)strcspn(name, ","), name);
	if (control_ask(&demo->daemon.control, request, -1, NULL, &error) < 0)
		args_failed(VERB, "%s", error.text);
}

static int start(struct demo *demo, struct error *error)
{
	const struct demo_options *options = &demo->options;
	int result = make_paths(demo, error);
	if (result == 0)
		result =
			demo_scorer_start(&demo->scorer, options->scene, &options->settings, demo->recording, demo->contact, error);
	if (result == 0)
		result = start_daemon(demo, error);
	if (result == 0) {
		give_way();
		result = make_source(demo, error);
	}
	if (result < 0)
		return result;
	struct scene_score score;
	if (scene_source_get_score(demo->source, 0, &score))
		demo->task = task_create();
	const struct demo_client_params params = {
		.source = demo->source,
		.size = demo->options.size,
		.rate = demo->options.rate,
		.socket = demo->daemon.socket,
		.note = demo->task ? note : NULL,
		.context = demo,
	};
	demo->client = demo_client_create(&params, error);
	return demo->client ? 0 : -EIO;
}

/* ---- the run ---- */

static bool over(void *context)
{
	struct demo *demo = context;
	take_turns(demo);
	return interrupt_seen() || demo_client_was_quit(demo->client) || !demo_daemon_lives(&demo->daemon);
}

/* After Ctrl-C the burst is still wanted. */
static bool daemon_is_gone(void *context)
{
	struct demo *demo = context;
	return !demo_daemon_lives(&demo->daemon);
}

static double burst_seconds(const struct demo *demo)
{
	double rate = (double)demo->options.rate.numerator / (double)demo->options.rate.denominator;
	double pixels = (double)demo->options.size.width * demo->options.size.height;
	return fmax(BURST_LEAST_SECONDS, fmin(BURST_SECONDS, BURST_BYTES / (pixels * BYTES_PER_PIXEL * rate)));
}

/* The figures are taken before it, so recording has no part in them. */
static int record_burst(struct demo *demo, struct error *error)
{
	int fd = open(demo->recording, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (fd < 0)
		return error_set(error, -errno, "%s: %s", demo->recording, strerror(errno));
	int result = control_ask(&demo->daemon.control, "record", fd, NULL, error);
	close(fd);
	if (result == 0)
		result = demo_client_run(demo->client, burst_seconds(demo), daemon_is_gone, demo, error);
	if (result == 0)
		result = timeline_fetch(&demo->timeline, &demo->daemon.control, error);
	if (result == 0)
		result = control_end_recording(&demo->daemon.control, NULL, error);
	return result;
}

static int run(struct demo *demo, struct error *error)
{
	if (isatty(STDERR_FILENO))
		fprintf(stderr, "%s for %.0f s; Ctrl-C ends it early\n", demo->title, demo->options.seconds);
	int result = demo_client_run(demo->client, demo->options.seconds, over, demo, error);
	demo->epoch_ns = demo_client_epoch(demo->client);
	if (result == 0 && !demo_daemon_lives(&demo->daemon))
		return error_set(error, -ECHILD, "pursuitd died; see %s", demo->log);
	if (result == 0)
		result = control_ask(&demo->daemon.control, "status", -1, &demo->status, error);
	demo->seconds = clock_seconds() - (double)demo->epoch_ns / 1e9;
	demo->client_figures = demo_client_json(demo->client);
	return result == 0 ? record_burst(demo, error) : result;
}

/* ---- what is left behind ---- */

static int score(struct demo *demo, struct error *error)
{
	struct demo_scorer_request request = {
		.size = demo->options.size,
		.rate = demo->options.rate,
		.epoch_ns = demo->epoch_ns,
	};
	snprintf(request.title, sizeof(request.title), "%s", demo->title);
	return demo_scorer_ask(&demo->scorer, &request, &demo->timeline, &demo->score, error);
}

static int draw_timeline(const struct demo *demo, struct error *error)
{
	struct timeline_drawing drawing = {
		.title = demo->title,
		.refresh_hz = json_number_value(json_object_get(demo->status, "refresh")),
		.detail_first = demo->score.first_row,
		.detail_count = demo->score.row_count,
	};
	if (drawing.detail_count == 0 || drawing.detail_count > DETAIL_ROWS)
		drawing.detail_count = demo->timeline.count < DETAIL_ROWS ? demo->timeline.count : DETAIL_ROWS;
	if (drawing.detail_first + drawing.detail_count > demo->timeline.count)
		drawing.detail_first = demo->timeline.count - drawing.detail_count;
	return timeline_write_svg(&demo->timeline, &drawing, demo->svg, error);
}

static json_t *make_report(const struct demo *demo)
{
	const struct demo_options *options = &demo->options;
	json_t *report = json_deep_copy(demo->status);
	json_object_set_new(report, "quality", figures_quality_json(&demo->score.quality));
	json_object_set_new(report, "scene", json_string(options->scene));
	json_object_set_new(report, "width", json_integer(options->size.width));
	json_object_set_new(report, "height", json_integer(options->size.height));
	json_object_set_new(report, "fps", json_real((double)options->rate.numerator / (double)options->rate.denominator));
	json_object_set_new(report, "settings", figures_settings_json(&options->settings));
	json_object_set(report, "client", demo->client_figures);
	json_object_set(report, "scored", demo->score.scored);
	if (demo->task)
		json_object_set_new(report, "task", task_json(demo->task));
	return report;
}

static double figure(const json_t *report, const char *name, const char *inner)
{
	const json_t *value = json_object_get(report, name);
	return json_number_value(inner ? json_object_get(value, inner) : value);
}

static void print_summary(const struct demo *demo, const json_t *report)
{
	double refresh = figure(report, "refresh", NULL), vblanks = figure(report, "vblanks", NULL);
	printf("%s\n", demo->title);
	const double shown = refresh > 0 ? vblanks / refresh : 0;
	printf("  %.1f Hz displayed for %.1f s%s, %.2f%% of the vblanks on time", figure(report, "displayed_hz", NULL),
		   shown, shown < 0.95 * demo->seconds ? " (without the pauses that the client made)" : "",
		   100 * figure(report, "on_time", NULL));
	if (demo->score.quality.frames)
		printf(", PSNR %.2f dB, SSIM %.4f", demo->score.quality.psnr, demo->score.quality.ssim);
	printf("\n  %.0f real and %.0f in-between frames; %.0f in-betweens late, %.0f real frames lost\n",
		   figure(report, "real_frames", NULL), figure(report, "in_between_frames", NULL),
		   figure(report, "late_in_betweens", NULL), figure(report, "lost_real_frames", NULL));
	printf("  engine %.1f ms median, %.1f ms at 99%% for each real frame; submit to flip %.1f ms, %.1f ms at 99%%\n",
		   figure(report, "engine_ms", "p50"), figure(report, "engine_ms", "p99"),
		   figure(report, "submit_to_flip_ms", "p50"), figure(report, "submit_to_flip_ms", "p99"));
	const json_t *client = json_object_get(report, "client");
	const double skipped = figure(client, "skipped_frames", NULL);
	printf(
		"  client: %.1f ms to issue a frame, %.1f ms to submit it, which %s (medians); %.0f of %.0f frames skipped\n",
		figure(client, "render_ms", "p50"), figure(client, "submit_us", "p50") / 1e3,
		demo->software ? "draws it on the CPU and reads it back" : "begins to read it back", skipped,
		skipped + figure(client, "submitted_frames", NULL));
	if (demo->task) {
		char text[128];
		task_describe(demo->task, text, sizeof(text));
		printf("  %s; %s\n", text, demo->rings);
	}
	printf("  %s, %s, %s, %s\n", demo->report, demo->svg, demo->contact, demo->recording);
}

static int leave_results(struct demo *demo, struct error *error)
{
	int result = score(demo, error);
	if (result == -ENODATA) {
		fprintf(stderr, "pursuit demo: nothing is scored: no frame was recorded in time\n");
		result = 0;
	}
	if (result == 0)
		result = draw_timeline(demo, error);
	if (result == 0 && demo->task)
		result = task_write_csv(demo->task, demo->rings, error);
	json_t *report = make_report(demo);
	if (!report)
		return error_set(error, -ENOMEM, "out of memory");
	if (result == 0)
		result = json_write(report, demo->report, error);
	if (result == 0 && !demo->options.json)
		print_summary(demo, report);
	else if (result == 0 && !json_print(report))
		result = error_set(error, -ENOMEM, "out of memory");
	if (result == 0 && figure(report, "displayed_frames", NULL) < 1)
		result = error_set(error, -ENODATA, "nothing was displayed; see %s", demo->log);
	json_decref(report);
	return result;
}

static void finish(struct demo *demo)
{
	demo_client_destroy(&demo->client);
	demo_scorer_finish(&demo->scorer);
	scene_source_destroy(&demo->source);
	timeline_finish(&demo->timeline);
	task_destroy(&demo->task);
	json_decref(demo->status);
	json_decref(demo->client_figures);
	json_decref(demo->score.scored);
}

static int run_demo(struct demo *demo)
{
	struct error error = {{0}}, ending = {{0}};
	interrupt_watch();
	int result = start(demo, &error);
	if (result == 0) {
		char refresh[40] = "";
		settings_get(&demo->options.settings, "refresh", refresh, sizeof(refresh));
		snprintf(demo->title, sizeof(demo->title), "%s %ux%u, %.4g frames a second to %s Hz, method %s",
				 demo->options.scene, demo->options.size.width, demo->options.size.height,
				 (double)demo->options.rate.numerator / (double)demo->options.rate.denominator, refresh,
				 demo->options.settings.method);
		result = run(demo, &error);
	}
	demo_client_destroy(&demo->client);
	int ended = demo_daemon_stop(&demo->daemon, &ending);
	if (result == 0)
		result = leave_results(demo, &error);
	if (result < 0)
		args_failed(VERB, "%s", error.text);
	if (ended < 0)
		args_failed(VERB, "%s", ending.text);
	return result < 0 || ended < 0 ? STATUS_FAILED : STATUS_DONE;
}

static int check_methods(const struct demo_options *options)
{
	int status = args_check_method(VERB, "--method", options->settings.method);
	const char *rest = options->methods;
	while (status == STATUS_DONE && rest) {
		char name[64];
		const size_t length = strcspn(rest, ",");
		snprintf(name, sizeof(name), "%.*s", (int)(length < sizeof(name) ? length : sizeof(name) - 1), rest);
		status = args_check_method(VERB, "--methods", name);
		rest = rest[length] ? rest + length + 1 : NULL;
	}
	return status;
}

int verb_demo(int argc, char **argv)
{
	struct demo demo = {.options = {.scene = "colonnade", .out = "out-demo", .seconds = 60, .method_seconds = 60}};
	struct error error;
	int status;
	settings_defaults(&demo.options.settings);
	if (!read_options(&demo.options, argc, argv, &status))
		return status;
	if (!scene_exists(demo.options.scene)) {
		scene_source_unknown(demo.options.scene, &error);
		return args_wrong(VERB, "%s", error.text);
	}
	status = check_methods(&demo.options);
	if (status != STATUS_DONE)
		return status;
	status = run_demo(&demo);
	finish(&demo);
	return status;
}
