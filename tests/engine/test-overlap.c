/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Nothing is drawn over pixels of an unfinished picture, wherever it lies in memory. The argument is the context: cpu,
 * surfaceless; GL on the CPU reads back by way of buffers here.
 */
#include "tests/test.h"

#include <errno.h>

#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"

/* A picture of SIDE x SIDE pixels is unfinished in the middle of memory; another may be drawn beside it. */
#define SIDE 16u
#define MIDDLE 1024

static struct engine_params params = {.context = ENGINE_CONTEXT_EGL_SURFACELESS, .buffer_software = true};

static void begin(struct engine *engine, const struct picture *picture)
{
	struct error error;
	const struct engine_begin_params how = {.n = 2, .last_phase = -1.0};
	CHECK_INT(engine_begin(engine, &picture->frame, &how, &error), 0);
}

struct beside {
	uint32_t row, other_row; /* pixels from row to row of the unfinished one, of the other */
	int first;               /* pixel of the other, from the first of the unfinished one on */
	bool free;
};

static int show_at(struct engine *engine, uint8_t *memory, int pixel, uint32_t row, bool ahead)
{
	const struct engine_request request = {ENGINE_SHOW_PLAIN, 0.0};
	struct engine_image image = {.data = memory + 4 * pixel, .stride = 4 * (size_t)row, .unfinished = ahead};
	struct error error = {""};
	const int result = engine_render(engine, &request, &image, &error);
	CHECK((result < 0) == (strstr(error.text, "memory is in part that of an unfinished picture") != NULL));
	return result;
}

static void check_beside(struct engine *engine, uint8_t *memory, const struct beside *beside)
{
	const int expected = beside->free ? 0 : -EBUSY;
	CHECK_INT(show_at(engine, memory, MIDDLE, beside->row, true), 0);
	for (int ahead = 0; ahead < 2; ahead++)
		CHECK_INT(show_at(engine, memory, MIDDLE + beside->first, beside->other_row, ahead), expected);
	engine_drop(engine);
}

static void test_overlaps(void)
{
	static const struct beside cases[] = {
		{16, 16, 0, false},
		{16, 16, 1, false},
		{16, 16, -1, false},
		{16, 16, 255, false},
		{16, 16, 256, true},
		{16, 16, -255, false},
		{16, 16, -256, true},
		/* Side by side, rows of one between those of the other. */
		{32, 32, 16, true},
		{32, 32, -16, true},
		{32, 32, 15, false},
		{32, 32, 17, false},
		{48, 48, 32, true},
		/* Some of the rows meet. */
		{32, 16, 16, false},
		{48, 32, 16, false},
		{48, 32, 48 * 15, false},
		{48, 32, 48 * 15 + 16, true},
		{16, 32, -32 * 15 - 15, false},
		{16, 32, -32 * 15 - 16, true},
	};
	struct error error;
	struct engine *engine = engine_create(&params, &error);
	if (!engine)
		SKIP(error.text);
	struct picture picture, smaller;
	uint8_t *memory = malloc((size_t)4 * 3 * MIDDLE);
	picture_init(&picture, SIDE, SIDE, PURSUIT_FORMAT_BGRA8, 0);
	picture_init(&smaller, SIDE / 2, SIDE / 2, PURSUIT_FORMAT_BGRA8, 0);
	begin(engine, &picture);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
		check_beside(engine, memory, &cases[i]);
	/* Each is as large as the frame that it was made of. */
	CHECK_INT(show_at(engine, memory, MIDDLE, SIDE, true), 0);
	begin(engine, &smaller);
	CHECK_INT(show_at(engine, memory, MIDDLE + 255, SIDE, false), -EBUSY);
	CHECK_INT(show_at(engine, memory, MIDDLE + 256, SIDE, false), 0);
	CHECK_INT(show_at(engine, memory, MIDDLE - 16 * 7 - 8, SIDE, false), 0);
	engine_drop(engine);
	picture_finish(&picture);
	picture_finish(&smaller);
	free(memory);
	engine_destroy(&engine);
}

int main(int argc, char **argv)
{
	if (argc > 1 && strcmp(argv[1], "cpu") == 0)
		params.context = ENGINE_CONTEXT_CPU;
	RUN(test_overlaps);
	return test_result();
}
