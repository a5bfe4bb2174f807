/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the quadratic motion model takes for the motion of the frame before (docs/method.md, 10). */
#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"
#include "tests/test.h"

#define WIDTH 96u
#define HEIGHT 64u
#define STRIDE (4u * WIDTH)

static struct engine *make_engine(enum engine_motion_model model)
{
	struct error error;
	const struct engine_params params = {.context = ENGINE_CONTEXT_CPU, .motion_model = model, .threads = 1};
	return engine_create(&params, &error);
}

/* Another picture, which moves as a whole. */
static void move(const struct picture *picture, uint32_t seed, float by)
{
	picture_fill_random(picture, PURSUIT_ROLE_COLOR, seed);
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			picture_set_motion(picture, x, y, by, 0.0f);
}

static void begin(struct engine *engine, struct picture *picture, uint64_t frame_id)
{
	struct error error;
	const struct engine_begin_params params = {.n = 2, .last_phase = -1.0};
	picture->frame.stream = 3;
	picture->frame.header.frame_id = frame_id;
	CHECK_INT(engine_begin(engine, &picture->frame, &params, &error), 0);
}

static void draw_between(struct engine *engine, uint8_t *pixels)
{
	struct error error;
	const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, 0.5};
	struct engine_image image = {.data = pixels, .stride = STRIDE};
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
}

/* Does the third of three frames bend, whose second is as the first, its motion plane too, and `said` to be? */
static bool bends_after(bool same, bool said)
{
	static uint8_t bent[STRIDE * HEIGHT], straight[STRIDE * HEIGHT];
	struct engine *quadratic = make_engine(ENGINE_MOTION_QUADRATIC), *linear = make_engine(ENGINE_MOTION_LINEAR);
	struct picture picture;
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION);
	move(&picture, 1, 1.5f);
	begin(quadratic, &picture, 1);
	if (!same)
		move(&picture, 2, 1.5f);
	if (said) {
		picture.frame.header.flags = PURSUIT_FRAME_DAMAGE;
		picture.frame.header.damage_since = 1;
	}
	begin(quadratic, &picture, 2);
	picture.frame.header.flags = 0;
	picture.frame.header.damage_since = 0;
	move(&picture, 3, 2.0f);
	begin(quadratic, &picture, 3);
	begin(linear, &picture, 3);
	draw_between(quadratic, bent);
	draw_between(linear, straight);
	picture_finish(&picture);
	engine_destroy(&quadratic);
	engine_destroy(&linear);
	return memcmp(bent, straight, sizeof(bent)) != 0;
}

static void test_motion_that_changes(void)
{
	CHECK(bends_after(false, false));
}

/* It stood still, whatever its motion plane says still: 2 pixels after none are a jerk. */
static void test_unchanged_frame_stood_still(void)
{
	CHECK(!bends_after(true, true));
}

int main(void)
{
	RUN(test_motion_that_changes);
	RUN(test_unchanged_frame_stood_still);
	return test_result();
}
