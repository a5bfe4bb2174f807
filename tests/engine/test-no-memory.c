/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Memory that runs out at any one moment of taking a frame or showing it: the call says so, and what is shown when
 * there is memory again is to the bit what an engine shows that always had some. The argument is the context: cpu,
 * where the C library has no memory, or surfaceless, where GL has none for what is to go up.
 */
#include "tests/test.h"

#include <errno.h>
#include <stdatomic.h>

#include "daemon/engine/gl/executor_gl.h"
#include "tests/engine/picture.h"

#define WIDTH 150u
#define HEIGHT 100u
#define BYTES ((size_t)4 * WIDTH * HEIGHT)
/* No call needs more pieces of memory. */
#define MOST 500

/* Phases beyond the last one too, for which L has to be made when the picture is. */
static const struct engine_request requests[] = {
	{ENGINE_SHOW_REAL, 0.0},         {ENGINE_SHOW_IN_BETWEEN, 0.625}, {ENGINE_SHOW_IN_BETWEEN, 0.1},
	{ENGINE_SHOW_IN_BETWEEN, -0.75}, {ENGINE_SHOW_REAL, 0.5},         {ENGINE_SHOW_PLAIN, 0.0},
};
#define REQUESTS (sizeof(requests) / sizeof(requests[0]))

static const struct engine_params kinds[] = {
	{.method = "pursuit"},
	{.method = "adaptive-grid", .blur = ENGINE_BLUR_EVERYWHERE, .blur_level = 5},
	{.method = "grid", .motion_model = ENGINE_MOTION_QUADRATIC},
	{.method = "scatter"},
	{.method = "interpolate"},
	{.method = "mcif"},
};
#define KINDS (sizeof(kinds) / sizeof(kinds[0]))

static enum engine_context_kind context = ENGINE_CONTEXT_CPU;

/* Pieces that there are; negative: enough. */
static atomic_int left = -1;
static atomic_bool ran_out;

static bool is_out(void)
{
	if (atomic_load(&left) < 0)
		return false;
	const bool out = atomic_fetch_sub(&left, 1) == 0;
	if (out)
		atomic_store(&ran_out, true);
	return out;
}

/* The linker sends the engine here (--wrap). */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

void *__wrap_malloc(size_t size)
{
	return context == ENGINE_CONTEXT_CPU && is_out() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
	return context == ENGINE_CONTEXT_CPU && is_out() ? NULL : __real_calloc(count, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
	return context == ENGINE_CONTEXT_CPU && is_out() ? NULL : __real_aligned_alloc(alignment, size);
}

static PFNGLMAPBUFFERRANGEPROC map_buffer_range;

static void *APIENTRY map(GLenum target, GLintptr offset, GLsizeiptr length, GLbitfield access)
{
	return is_out() ? NULL : map_buffer_range(target, offset, length, access);
}

static struct engine *make(const struct engine_params *kind)
{
	struct engine_params params = *kind;
	struct error error;
	params.context = context;
	params.threads = 1;
	struct engine *engine = engine_create(&params, &error);
	if (!engine)
		SKIP(error.text);
	if (context == ENGINE_CONTEXT_CPU)
		return engine;
	map_buffer_range = table_of(engine)->MapBufferRange;
	gl_of(engine)->context->gl.MapBufferRange = map;
	return engine;
}

/* A picture whose parts go different ways, so that it tears; elsewhere in each frame. */
static void draw(struct picture *picture, uint32_t frame)
{
	picture_init(picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
	picture_fill_random(picture, PURSUIT_ROLE_COLOR, 7 + frame);
	picture->frame.header.frame_id = frame;
	memset(picture_row(picture, PURSUIT_ROLE_UI, 70), 0x60, (size_t)2 * WIDTH);
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			const uint32_t part = ((x + 5 * frame) / 60 + y / 50) % 3;
			picture_set_motion(picture, x, y, 16.0f * (float)part - 12.0f, part == 2 ? -8.0f : 2.0f);
			picture_set_depth(picture, x, y, 0.2f + 0.3f * (float)part);
		}
}

static struct picture pictures[2];

/* Number 1, or the one that follows it. */
static int take_frame(struct engine *engine, uint32_t frame)
{
	const struct engine_begin_params how = {.n = 3, .last_phase = 0.125};
	struct error error;
	return engine_begin(engine, &pictures[frame - 1].frame, &how, &error);
}

static int show(struct engine *engine, size_t request, uint8_t *out)
{
	struct engine_image image = {.data = out, .stride = (size_t)4 * WIDTH};
	struct error error;
	const int result = engine_render(engine, &requests[request], &image, &error);
	CHECK(result == 0 || image.holds == 0);
	return result;
}

static void check_all(struct engine *engine, uint8_t expected[REQUESTS][BYTES])
{
	static uint8_t shown[BYTES];
	for (size_t i = 0; i < REQUESTS; i++) {
		CHECK_INT(show(engine, i, shown), 0);
		CHECK(memcmp(shown, expected[i], BYTES) == 0);
	}
}

/* With so many pieces of memory: the call's result, and whether that was too few. */
static int with(int pieces, struct engine *engine, const size_t *request, bool *too_few)
{
	static uint8_t shown[BYTES];
	atomic_store(&ran_out, false);
	atomic_store(&left, pieces);
	const int result = request ? show(engine, *request, shown) : take_frame(engine, 2);
	atomic_store(&left, -1);
	*too_few = atomic_load(&ran_out);
	CHECK(result == 0 || *too_few);
	CHECK(result == 0 || result == -ENOMEM);
	return result;
}

/* GL's has what it takes with the first frame only once: an engine is enough. */
static struct engine *renew(struct engine *engine, const struct engine_params *kind)
{
	if (engine && context != ENGINE_CONTEXT_CPU)
		return engine;
	engine_destroy(&engine);
	return make(kind);
}

static void check_begin(const struct engine_params *kind, uint8_t expected[REQUESTS][BYTES])
{
	static uint8_t shown[BYTES];
	struct engine *engine = NULL;
	bool too_few = true;
	for (int pieces = 0; too_few && pieces < MOST; pieces++) {
		engine = renew(engine, kind);
		CHECK_INT(take_frame(engine, 1), 0);
		if (with(pieces, engine, NULL, &too_few) < 0) {
			CHECK_INT(show(engine, 0, shown), -EINVAL);
			CHECK_INT(take_frame(engine, 1), 0);
			CHECK_INT(take_frame(engine, 2), 0);
		}
		check_all(engine, expected);
	}
	CHECK(!too_few);
	engine_destroy(&engine);
}

static void check_show(const struct engine_params *kind, size_t request, uint8_t expected[REQUESTS][BYTES])
{
	struct engine *engine = NULL;
	bool too_few = true;
	for (int pieces = 0; too_few && pieces < MOST; pieces++) {
		engine = renew(engine, kind);
		CHECK_INT(take_frame(engine, 1), 0);
		CHECK_INT(take_frame(engine, 2), 0);
		with(pieces, engine, &request, &too_few);
		check_all(engine, expected);
	}
	CHECK(!too_few);
	engine_destroy(&engine);
}

static void test_out_of_memory(void)
{
	static uint8_t expected[REQUESTS][BYTES];
	for (size_t i = 0; i < KINDS; i++) {
		struct engine *engine = make(&kinds[i]);
		CHECK_INT(take_frame(engine, 1), 0);
		CHECK_INT(take_frame(engine, 2), 0);
		for (size_t k = 0; k < REQUESTS; k++)
			CHECK_INT(show(engine, k, expected[k]), 0);
		engine_destroy(&engine);
		check_begin(&kinds[i], expected);
		for (size_t k = 0; k < REQUESTS; k++)
			check_show(&kinds[i], k, expected);
	}
}

int main(int argc, char **argv)
{
	context = argc > 1 && strcmp(argv[1], "surfaceless") == 0 ? ENGINE_CONTEXT_EGL_SURFACELESS : ENGINE_CONTEXT_CPU;
	draw(&pictures[0], 1);
	draw(&pictures[1], 2);
	RUN(test_out_of_memory);
	picture_finish(&pictures[0]);
	picture_finish(&pictures[1]);
	return test_result();
}
