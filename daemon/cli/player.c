/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "player.h"

#include <errno.h>
#include <stdlib.h>

#include "ahead.h"
#include "daemon/clock.h"
#include "progress.h"

#define PLAN_TEXT_BYTES 4096u

/* Pictures that are made one after the other before they are looked at; few frames have more. */
#define BATCH 4u

/* Room for a picture. */
struct canvas {
	uint8_t *data;
	size_t capacity;
	struct picture picture;
};

static int canvas_fit(struct canvas *canvas, const struct engine *engine, struct error *error)
{
	uint32_t width, height;
	engine_get_size(engine, &width, &height);
	size_t bytes = 4 * (size_t)width * height;
	if (bytes > canvas->capacity) {
		free(canvas->data);
		canvas->data = malloc(bytes);
		canvas->capacity = canvas->data ? bytes : 0;
		if (!canvas->data)
			return error_set(error, -ENOMEM, "out of memory for a picture of %ux%u", width, height);
	}
	canvas->picture = (struct picture){canvas->data, 4 * (size_t)width, width, height};
	return 0;
}

static double now_ms(void)
{
	return (double)clock_monotonic_ns() / 1e6;
}

static int show_picture(struct player *player, const struct canvas *canvas, const struct beginning *beginning,
						const struct showing *showing, struct error *error)
{
	struct player_picture picture = {.beginning = beginning, .showing = showing, .shown = canvas->picture};
	if (player->truth.get && showing->show == ENGINE_SHOW_IN_BETWEEN && !showing->repeat)
		picture.truth = player->truth.get(player->truth.context, beginning, showing);
	return player->observer.picture(player->observer.context, &picture, error);
}

/*
 * Makes the pictures of some showings and tells how many showings these are: a canvas for each that is not the picture
 * of the one before.
 */
static int make_pictures(struct player *player, struct canvas canvases[BATCH], const struct showing *showings,
						 uint32_t most, uint32_t *count, struct error *error)
{
	struct ahead ahead = {.engine = player->engine};
	struct canvas *canvas = canvases;
	int result = 0;
	for (*count = 0; *count < most && result == 0; ++*count) {
		const struct engine_request request = {showings[*count].show, showings[*count].phase};
		if (showings[*count].repeat)
			continue;
		if (canvas == canvases + BATCH)
			break;
		result = canvas_fit(canvas, player->engine, error);
		if (result == 0)
			result = ahead_render(&ahead, &request, canvas->data, canvas->picture.stride, error);
		canvas++;
	}
	return ahead_finish(&ahead, result, error);
}

/* The same showings: who looks. */
static int show_pictures(struct player *player, const struct canvas *canvas, const struct beginning *beginning,
						 const struct showing *showings, uint32_t count, struct error *error)
{
	int result = 0;
	for (uint32_t i = 0; i < count && result == 0; i++) {
		canvas += i > 0 && !showings[i].repeat;
		result = show_picture(player, canvas, beginning, &showings[i], error);
	}
	return result;
}

static int play_beginning(struct player *player, struct canvas canvases[BATCH], const struct beginning *beginning,
						  const struct frame *frame, struct error *error)
{
	const struct showing *showings = &player->schedule->showings[beginning->first_showing];
	double start = now_ms();
	int result = engine_begin(player->engine, frame, &beginning->params, error);
	double spent = now_ms() - start;
	for (uint32_t i = 0, count; i < beginning->showing_count && result == 0; i += count) {
		start = now_ms();
		result = make_pictures(player, canvases, &showings[i], beginning->showing_count - i, &count, error);
		spent += now_ms() - start;
		if (result == 0)
			result = show_pictures(player, canvases, beginning, &showings[i], count, error);
	}
	if (result < 0 || !player->observer.frame)
		return result;
	char plan[PLAN_TEXT_BYTES];
	engine_print_plan(player->engine, plan, sizeof(plan));
	const struct player_frame done = {beginning, spent, engine_get_report(player->engine), plan};
	return player->observer.frame(player->observer.context, &done, error);
}

int player_run(struct player *player, struct error *error)
{
	struct real_frames real = {.reader = player->reader, .frames = player->frames};
	struct progress progress = {.what = "real frames"};
	struct canvas canvases[BATCH] = {{0}};
	int result = 0;
	for (uint32_t i = 0; i < player->schedule->beginning_count && result == 0; i++) {
		const struct beginning *beginning = &player->schedule->beginnings[i];
		struct frame frame;
		result = real_frames_load(&real, beginning, &frame, error);
		if (result == 0)
			result = play_beginning(player, canvases, beginning, &frame, error);
		if (player->progress)
			progress_show(&progress, i + 1, player->schedule->beginning_count);
	}
	progress_end(&progress);
	real_frames_finish(&real);
	for (uint32_t i = 0; i < BATCH; i++)
		free(canvases[i].data);
	return result;
}

/* ---- truth out of the recording ---- */

struct recorded_truth {
	struct recording_reader *reader;
	const struct recorded_frames *frames;
	struct engine *engine;
	struct canvas canvas;
	int64_t made; /* the recorded frame that the canvas holds, -1: none */
};

struct recorded_truth *recorded_truth_create(struct recording_reader *reader, const struct recorded_frames *frames,
											 const struct engine_params *params, struct error *error)
{
	struct recorded_truth *truth = calloc(1, sizeof(*truth));
	if (!truth) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	struct engine_params plain = *params;
	plain.method = "hold";
	*truth = (struct recorded_truth){.reader = reader, .frames = frames, .made = -1};
	truth->engine = engine_create(&plain, error);
	if (!truth->engine)
		recorded_truth_destroy(&truth);
	return truth;
}

void recorded_truth_destroy(struct recorded_truth **truth)
{
	if (!truth || !*truth)
		return;
	engine_destroy(&(*truth)->engine);
	free((*truth)->canvas.data);
	free(*truth);
	*truth = NULL;
}

static int make_truth(struct recorded_truth *truth, int64_t index, struct error *error)
{
	static const struct engine_request plain = {.show = ENGINE_SHOW_PLAIN};
	struct canvas *canvas = &truth->canvas;
	struct frame frame;
	uint64_t place = truth->frames->frames[index].index;
	int result = recording_reader_frame(truth->reader, place, 2, &frame, NULL, error);
	if (result == 0)
		result = engine_begin(truth->engine, &frame, &(struct engine_begin_params){.n = 1}, error);
	if (result == 0)
		result = canvas_fit(canvas, truth->engine, error);
	struct engine_image image = {.data = canvas->data, .stride = canvas->picture.stride};
	return result == 0 ? engine_render(truth->engine, &plain, &image, error) : result;
}

static const struct picture *get_recorded(void *context, const struct beginning *beginning,
										  const struct showing *showing)
{
	struct recorded_truth *truth = context;
	struct error error;
	if (showing->truth < 0)
		return NULL;
	const struct recorded_frame *real = &truth->frames->frames[beginning->frame];
	const struct recorded_frame *there = &truth->frames->frames[showing->truth];
	if (real->width != there->width || real->height != there->height)
		return NULL;
	if (truth->made != showing->truth) {
		truth->made = -1;
		if (make_truth(truth, showing->truth, &error) < 0) {
			fprintf(stderr, "pursuit: no truth for a displayed frame: %s\n", error.text);
			return NULL;
		}
		truth->made = showing->truth;
	}
	return &truth->canvas.picture;
}

struct player_truth recorded_truth_source(struct recorded_truth *truth)
{
	return (struct player_truth){truth, get_recorded};
}
