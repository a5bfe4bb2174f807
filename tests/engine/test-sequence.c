/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Whatever came before a frame, it is shown as an engine shows it that takes all of each frame anew: sequences of
 * frames that change a little, or here and there, or not, or in size and kind, with settings that change among them,
 * engines that are made anew, and two to four images in turn that keep what they hold, are written to by others, and
 * are lost.
 *
 *   engine-sequence [cpu|gl|gpu-analysis [SEEDS]]     40 sequences by default
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/cpu/executor_cpu.h"
#include "daemon/engine/gl/executor_gl.h"
#include "tests/engine/picture.h"
#include "tests/test.h"

#define FRAMES 300u
#define IMAGES 4u

static const char *kind = "cpu";
static uint32_t seeds = 40;

struct sequence {
	uint32_t random;
	struct engine *engine, *anew; /* the second knows nothing of what was before */
	uint32_t width, height, format;
	unsigned planes;
	struct picture picture;
	struct engine_image images[IMAGES];
	uint32_t image_count;
	uint8_t *expected;
	uint64_t frame_id;
	const char *method;
	struct pursuit_rectangle moving; /* where the frame before moves, if in a part; else empty */
	uint32_t found;                  /* frames that were found to be as the one before, though nobody said so */
	uint64_t kept;                   /* bytes of displayed pictures that were there, while others moved */
};

static uint32_t pick(struct sequence *sequence, uint32_t count)
{
	return picture_random(&sequence->random) % count;
}

static struct engine_params some_params(struct sequence *sequence)
{
	static const char *const methods[] = {"pursuit",   "pursuit", "grid",    "hold",
										  "blur-hold", "black",   "scatter", "interpolate"};
	sequence->method = methods[pick(sequence, 8)];
	struct engine_params params = {.context = ENGINE_CONTEXT_CPU,
								   .method = sequence->method,
								   .blur = (enum engine_blur)pick(sequence, 3),
								   .motion_model = (enum engine_motion_model)pick(sequence, 2),
								   .leave_nothing_out = pick(sequence, 5) == 0,
								   .no_compensation = pick(sequence, 5) == 0,
								   .blur_level = pick(sequence, 4),
								   .cell = 4 + pick(sequence, 12),
								   .curve = (enum engine_curve)pick(sequence, 2)};
	if (strcmp(kind, "cpu") != 0)
		params.context = ENGINE_CONTEXT_EGL_SURFACELESS;
	params.buffer_software = pick(sequence, 2);
	if (strcmp(kind, "gpu-analysis") == 0)
		params.analysis = pick(sequence, 2) ? ENGINE_ANALYSIS_GPU : ENGINE_ANALYSIS_CPU;
	return params;
}

static void forget_images(struct sequence *sequence)
{
	for (uint32_t i = 0; i < IMAGES; i++)
		free(sequence->images[i].data);
	free(sequence->expected);
}

/* Another size and format; or nothing but a UI where there was none, or none where there was one. */
static void change_kind(struct sequence *sequence, bool ui_only)
{
	static const uint32_t sizes[][2] = {{64, 48}, {65, 33}, {131, 170}, {17, 90}, {300, 200}, {260, 150}};
	if (!ui_only) {
		const uint32_t *size = sizes[pick(sequence, 6)];
		sequence->width = size[0];
		sequence->height = size[1];
		sequence->format = pick(sequence, 3) ? PURSUIT_FORMAT_BGRA8 : PURSUIT_FORMAT_RGBA16F;
		forget_images(sequence);
		for (uint32_t i = 0; i < IMAGES; i++)
			sequence->images[i] =
				(struct engine_image){.data = calloc(size[1], 4 * (size_t)size[0]), .stride = 4 * (size_t)size[0]};
		sequence->expected = malloc(4 * (size_t)size[0] * size[1]);
	}
	sequence->planes ^= PICTURE_UI;
	picture_finish(&sequence->picture);
	picture_init(&sequence->picture, sequence->width, sequence->height, sequence->format, sequence->planes);
	picture_fill_random(&sequence->picture, PURSUIT_ROLE_COLOR, sequence->width);
	if (sequence->planes & PICTURE_UI)
		picture_fill_random(&sequence->picture, PURSUIT_ROLE_UI, sequence->height);
}

static void move(struct sequence *sequence, float most)
{
	const struct picture *picture = &sequence->picture;
	for (uint32_t y = 0; y < picture->height; y++)
		for (uint32_t x = 0; x < picture->width; x++) {
			const uint32_t part = (x / 20 + y / 20) % 3;
			picture_set_motion(picture, x, y, part ? most * (float)part : 0.0f, part == 2 ? -most : 0.0f);
			picture_set_depth(picture, x, y, 0.1f + 0.3f * (float)part);
		}
	if (pick(sequence, 3) == 0)
		picture_set_motion(picture, pick(sequence, picture->width), pick(sequence, picture->height), NAN, INFINITY);
	if (pick(sequence, 3) == 0)
		picture_set_motion(picture, pick(sequence, picture->width), pick(sequence, picture->height), 3e38f, -3e38f);
}

/* One byte of a row of that plane, not the alpha of colour; so that it can be seen. */
static void change_row(struct sequence *sequence, uint32_t role, uint32_t y)
{
	const struct picture *picture = &sequence->picture;
	uint8_t *row = picture_row(picture, role, y);
	if (picture->frame.header.planes[0].format == PURSUIT_FORMAT_RGBA16F && role == PURSUIT_ROLE_COLOR) {
		uint8_t *red = row + 8 * pick(sequence, picture->width);
		red[1] = red[1] == 0x30 ? 0x38 : 0x30; /* half numbers from 0.125, from 0.5 */
		return;
	}
	row[4 * pick(sequence, picture->width) + pick(sequence, role == PURSUIT_ROLE_UI ? 4 : 3)] ^= 0x55;
}

/* A part of the picture, perhaps up to its border, is another, or of one colour, and moves. */
static void disturb(struct sequence *sequence)
{
	const struct picture *picture = &sequence->picture;
	const size_t pixel = picture->frame.header.planes[0].format == PURSUIT_FORMAT_RGBA16F ? 8 : 4;
	const uint32_t left = pick(sequence, picture->width), top = pick(sequence, picture->height);
	const uint32_t width = (picture->width - left) / (1 + pick(sequence, 3));
	const uint32_t height = (picture->height - top) / (1 + pick(sequence, 3));
	const uint32_t noise = pick(sequence, 2), speed = pick(sequence, 9);
	for (uint32_t y = top; y < top + height; y++)
		for (uint32_t x = left; x < left + width; x++) {
			uint8_t *at = picture_row(picture, PURSUIT_ROLE_COLOR, y) + pixel * x;
			for (size_t i = 0; i < pixel; i++)
				at[i] = (uint8_t)(noise ? pick(sequence, 256) : 10 * speed);
			picture_set_motion(picture, x, y, 0.25f * (float)speed - 1.0f, noise ? 0.75f : -1.25f);
			picture_set_depth(picture, x, y, 0.1f * (float)speed);
		}
	sequence->moving = (struct pursuit_rectangle){left, top, width, height};
}

/* The same picture but for a pixel, which is said to move as a whole. */
static void pan(struct sequence *sequence)
{
	const float x = 4.0f * (float)pick(sequence, 3), y = 4.0f * (float)pick(sequence, 3);
	for (uint32_t j = 0; j < sequence->height; j++)
		for (uint32_t i = 0; i < sequence->width; i++)
			picture_set_motion(&sequence->picture, i, j, x, y);
	change_row(sequence, PURSUIT_ROLE_COLOR, pick(sequence, sequence->height));
}

/* What an image shows becomes the picture: the very pixels that the engine has made of another. */
static void feed_back(struct sequence *sequence)
{
	const struct engine_image *image = &sequence->images[pick(sequence, sequence->image_count)];
	if (sequence->format == PURSUIT_FORMAT_BGRA8)
		memcpy(picture_row(&sequence->picture, PURSUIT_ROLE_COLOR, 0), image->data, image->stride * sequence->height);
}

static void stand_still(const struct picture *picture)
{
	for (uint32_t y = 0; y < picture->height; y++)
		for (uint32_t x = 0; x < picture->width; x++)
			picture_set_motion(picture, x, y, 0.0f, 0.0f);
}

/* The picture as a whole, or as much as one row of it at y; true for the second. */
static bool change_picture(struct sequence *sequence, uint32_t what, uint32_t y)
{
	struct picture *picture = &sequence->picture;
	switch (what) {
	case 0:
		change_kind(sequence, pick(sequence, 2));
		return false;
	case 1:
	case 2:
		picture_fill_random(picture, PURSUIT_ROLE_COLOR, pick(sequence, 1000));
		if (what == 2)
			move(sequence, 0.5f * (float)(1 + pick(sequence, 40)));
		return false;
	case 3:
	case 4:
		change_row(sequence, PURSUIT_ROLE_COLOR, y);
		return true;
	case 5:
		if (picture_row(picture, PURSUIT_ROLE_UI, 0))
			change_row(sequence, PURSUIT_ROLE_UI, y);
		return true;
	case 6:
	case 7:
	case 8:
		disturb(sequence);
		return false;
	case 9:
		pan(sequence);
		return false;
	case 10:
		feed_back(sequence);
		return false;
	case 11: /* the same picture is about to move */
		picture->frame.header.motion_kind = PURSUIT_MOTION_FORWARD;
		move(sequence, 0.5f * (float)(1 + pick(sequence, 40)));
		return false;
	default:
		return true;
	}
}

/* The rectangle that may have changed at all, and the one that moves no more. */
static void tell(struct sequence *sequence, const struct pursuit_rectangle *now, const struct pursuit_rectangle *before)
{
	struct pursuit_frame_header *header = &sequence->picture.frame.header;
	header->flags = PURSUIT_FRAME_DAMAGE;
	header->damage_since = sequence->frame_id;
	header->damage_count = 0;
	if (now->width && now->height)
		header->damage[header->damage_count++] = *now;
	if (before->width && before->height)
		header->damage[header->damage_count++] = *before;
}

/* For a while much changes, then so little that the engine looks for what is as it was; some frames say what. */
static void change(struct sequence *sequence)
{
	struct pursuit_frame_header *header = &sequence->picture.frame.header;
	const uint32_t what = pick(sequence, sequence->frame_id / 50 % 2 ? 80 : 15);
	const uint32_t y = pick(sequence, sequence->height);
	const struct pursuit_rectangle before = sequence->moving;
	sequence->moving = (struct pursuit_rectangle){0};
	header->flags = header->damage_count = 0;
	header->motion_kind = pick(sequence, 2) ? PURSUIT_MOTION_BACKWARD : PURSUIT_MOTION_FORWARD;
	stand_still(&sequence->picture);
	const bool one_row = change_picture(sequence, what, y);
	const struct pursuit_rectangle row = {0, y, what <= 5 ? sequence->width : 0, 1};
	if (one_row && pick(sequence, 3) == 0)
		tell(sequence, &row, &before);
	else if (what >= 6 && what <= 8 && pick(sequence, 2))
		tell(sequence, &sequence->moving, &before);
}

/* Whether the engine left the upload out though nobody had said that nothing changed. */
static bool was_found(struct sequence *sequence)
{
	const struct engine_report *report = engine_get_report(sequence->engine);
	if (sequence->picture.frame.header.flags)
		return false;
	for (uint32_t i = 0; i < report->left_out_count; i++)
		if (strcmp(report->left_out[i].name, "upload") == 0)
			return true;
	return false;
}

/* Of a frame that told what changed; methods without a grid leave the plan as it was. */
static bool is_planned_alike(const struct sequence *sequence)
{
	char plan[1024], anew[1024];
	const bool grid = strcmp(sequence->method, "pursuit") == 0 || strcmp(sequence->method, "grid") == 0;
	engine_print_plan(sequence->engine, plan, sizeof(plan));
	engine_print_plan(sequence->anew, anew, sizeof(anew));
	return !grid || !sequence->picture.frame.header.damage_count || strcmp(plan, anew) == 0;
}

static void forget_shown(const struct engine *engine)
{
	if (strcmp(kind, "cpu") != 0)
		gl_of(engine)->shown.number = 0;
}

/* What the second engine might know of what was before. */
static void forget(const struct engine *engine)
{
	if (strcmp(kind, "cpu") == 0) {
		cpu_of(engine)->contents.known = false;
		return;
	}
	gl_of(engine)->contents.known = false;
	gl_of(engine)->intake.hashed[0] = gl_of(engine)->intake.hashed[1] = false;
}

static void begin(struct sequence *sequence)
{
	struct error error;
	struct frame frame = sequence->picture.frame;
	const struct engine_begin_params params = {1 + pick(sequence, 4), pick(sequence, 2) ? -1.0 : 0.75, 0};
	frame.header.frame_id = ++sequence->frame_id;
	frame.stream = 7;
	CHECK_INT(engine_begin(sequence->engine, &frame, &params, &error), 0);
	sequence->found += was_found(sequence);
	frame.stream = 0;
	frame.header.flags = 0;
	forget(sequence->anew);
	CHECK_INT(engine_begin(sequence->anew, &frame, &params, &error), 0);
	CHECK(is_planned_alike(sequence));
}

static bool is_same(const struct sequence *sequence, const struct engine_image *image)
{
	return memcmp(image->data, sequence->expected, image->stride * sequence->picture.height) == 0;
}

/* What others do with an image between two pictures: they write to it, or lose it. */
static void disturb_image(struct sequence *sequence, struct engine_image *image)
{
	const uint32_t what = pick(sequence, 16), height = sequence->picture.height;
	if (what == 0) {
		free(image->data);
		image->data = calloc(height, image->stride);
	} else if (what <= 2) {
		memset(image->data + pick(sequence, height) * image->stride, (int)pick(sequence, 256), image->stride);
	}
	if (what <= 2)
		image->holds = 0;
}

static void show(struct sequence *sequence, uint32_t seed)
{
	struct error error;
	struct engine_image *image = &sequence->images[pick(sequence, sequence->image_count)];
	struct engine_image expected = {.data = sequence->expected, .stride = image->stride};
	const struct engine_request request = {(enum engine_show)pick(sequence, 3), 0.25 * pick(sequence, 5)};
	disturb_image(sequence, image);
	const uint64_t kept = engine_get_report(sequence->engine)->bytes_kept;
	CHECK_INT(engine_render(sequence->engine, &request, image, &error), 0);
	forget_shown(sequence->anew);
	CHECK_INT(engine_render(sequence->anew, &request, &expected, &error), 0);
	const uint64_t more = engine_get_report(sequence->engine)->bytes_kept - kept;
	sequence->kept += more < image->stride * sequence->picture.height ? more : 0;
	const bool same = is_same(sequence, image);
	CHECK(same);
	if (!same)
		fprintf(stderr, "%s, %s, seed %u: frame %u shows something else\n", kind, sequence->method, seed,
				(unsigned)sequence->frame_id);
}

static struct engine *make_engine(const struct engine_params *params, uint32_t threads)
{
	struct error error;
	struct engine_params own = *params;
	own.threads = threads;
	struct engine *engine = engine_create(&own, &error);
	if (engine)
		return engine;
	fprintf(stderr, "%s\n", error.text);
	exit(77);
}

static void make_engines(struct sequence *sequence, const struct engine_params *params)
{
	engine_destroy(&sequence->engine);
	engine_destroy(&sequence->anew);
	sequence->engine = make_engine(params, 3);
	sequence->anew = make_engine(params, 1);
}

static void change_engines(struct sequence *sequence, struct engine_params *params, uint32_t seed)
{
	struct error error;
	if (pick(sequence, 40) == 0) {
		*params = some_params(sequence);
		CHECK_INT(engine_set_params(sequence->engine, params, &error), 0);
		/* Settings are of the next frame. */
		if (sequence->frame_id)
			show(sequence, seed);
		CHECK_INT(engine_set_params(sequence->anew, params, &error), 0);
	}
	/* Lost, as a GL context may be; the images stay. */
	if (pick(sequence, strcmp(kind, "cpu") == 0 ? 40 : 200) == 0)
		make_engines(sequence, params);
}

static uint64_t run_seed(uint32_t seed)
{
	struct sequence sequence = {
		.random = seed, .image_count = 2 + seed % (IMAGES - 1), .planes = PICTURE_MOTION | PICTURE_DEPTH};
	struct engine_params params = some_params(&sequence);
	make_engines(&sequence, &params);
	change_kind(&sequence, false);
	for (uint32_t i = 0; i < FRAMES; i++) {
		change_engines(&sequence, &params, seed);
		change(&sequence);
		begin(&sequence);
		for (uint32_t shown = pick(&sequence, 4); shown > 0; shown--)
			show(&sequence, seed);
	}
	CHECK(sequence.found > 0);
	engine_destroy(&sequence.engine);
	engine_destroy(&sequence.anew);
	forget_images(&sequence);
	picture_finish(&sequence.picture);
	return sequence.kept;
}

static void test_sequences(void)
{
	uint64_t kept = 0;
	for (uint32_t seed = 1; seed <= seeds; seed++)
		kept += run_seed(seed);
	CHECK(kept > 0);
}

int main(int argc, char **argv)
{
	kind = argc > 1 ? argv[1] : "cpu";
	seeds = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : seeds;
	RUN(test_sequences);
	return test_result();
}
