/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A clock that does not get on, as coarse ones do between two frames: no picture is taken for another all the same. */
#include <string.h>
#include <time.h>

#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"
#include "tests/test.h"

#define WIDTH 130u
#define HEIGHT 70u
#define STRIDE (4u * WIDTH)
#define IMAGES 2u

/* clock_gettime() of all that is linked here. */
int __wrap_clock_gettime(clockid_t clock, struct timespec *now);

int __wrap_clock_gettime(clockid_t clock, struct timespec *now)
{
	*now = (struct timespec){.tv_sec = 5};
	return 0;
}

static bool shows(const struct engine_image *image, const struct picture *picture)
{
	for (uint32_t y = 0; y < HEIGHT; y++) {
		const uint8_t *row = picture_row(picture, PURSUIT_ROLE_COLOR, y);
		for (uint32_t x = 0; x < WIDTH; x++)
			if (memcmp(image->data + y * image->stride + 4 * (size_t)x, row + 4 * (size_t)x, 3) != 0)
				return false;
	}
	return true;
}

/* Only a part changes, so that tiles stay. */
static void change(const struct picture *picture, uint32_t frame)
{
	uint8_t *row = picture_row(picture, PURSUIT_ROLE_COLOR, frame * 31 % HEIGHT);
	memset(row, (int)(frame * 50 + 20), STRIDE);
}

static void test_standing_clock(void)
{
	static uint8_t pixels[IMAGES][STRIDE * HEIGHT];
	struct engine_image images[IMAGES] = {{.data = pixels[0], .stride = STRIDE}, {.data = pixels[1], .stride = STRIDE}};
	const struct engine_params params = {.context = ENGINE_CONTEXT_CPU, .method = "black", .threads = 1};
	const struct engine_begin_params begin = {.n = 2, .last_phase = -1.0};
	const struct engine_request real = {ENGINE_SHOW_REAL, 0.0}, between = {ENGINE_SHOW_IN_BETWEEN, 0.5};
	struct error error;
	struct picture picture;
	struct engine *engine = engine_create(&params, &error);
	CHECK(engine != NULL);
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, 0);
	picture.frame.stream = 1;
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 1);
	for (uint32_t i = 0; engine && i < 24; i++) {
		struct engine_image *image = &images[i / 2 % IMAGES];
		change(&picture, i);
		picture.frame.header.frame_id = i + 1;
		CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
		CHECK_INT(engine_render(engine, &real, image, &error), 0);
		CHECK(shows(image, &picture));
		if (i % 3 == 0)
			CHECK_INT(engine_render(engine, &between, &images[i % IMAGES], &error), 0);
	}
	picture_finish(&picture);
	engine_destroy(&engine);
}

int main(void)
{
	RUN(test_standing_clock);
	return test_result();
}
