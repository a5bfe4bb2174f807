/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Two unfinished pictures for which there are not blocks enough, so that most of the second is asked for later:
 * whatever is drawn or begun before, it is what was there. GL on the CPU, which reads back by way of buffers here.
 */
#include "tests/test.h"

#include "daemon/engine/gl/executor_gl.h"
#include "tests/engine/picture.h"

#define WIDTH 1000u
#define HEIGHT 700u
#define STRIDE (4 * (size_t)WIDTH)
#define BYTES (STRIDE * HEIGHT)

/* What is drawn after the second, and waited for; or that a frame is begun. */
enum next { NEXT_IN_BETWEEN, NEXT_PLAIN, NEXT_FRAME, NEXT_SMALL_FRAME };

struct order {
	enum engine_show second;
	enum next next;
};

static struct engine *make(bool buffered)
{
	struct error error;
	const struct engine_params params = {
		.context = ENGINE_CONTEXT_EGL_SURFACELESS, .blur = ENGINE_BLUR_EVERYWHERE, .buffer_software = buffered};
	struct engine *engine = engine_create(&params, &error);
	if (!engine)
		SKIP(error.text);
	return engine;
}

static void begin(struct engine *engine, const struct picture *picture)
{
	struct error error = {""};
	const struct engine_begin_params how = {.n = 2, .last_phase = -1.0};
	CHECK_INT(engine_begin(engine, &picture->frame, &how, &error), 0);
	CHECK_STRING(error.text, "");
}

static void render(struct engine *engine, enum engine_show show, double phase, uint8_t *data, bool ahead)
{
	struct error error = {""};
	const struct engine_request request = {show, phase};
	struct engine_image image = {.data = data, .stride = STRIDE, .unfinished = ahead};
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	CHECK_STRING(error.text, "");
}

static void render_two(struct engine *engine, const struct order *order, uint8_t *const *out, bool ahead)
{
	const double phase = order->second == ENGINE_SHOW_IN_BETWEEN ? 0.5 : 0.0;
	render(engine, ENGINE_SHOW_IN_BETWEEN, 0.25, out[0], ahead);
	render(engine, order->second, phase, out[1], ahead);
}

static void go_on(struct engine *engine, enum next next, const struct picture *pictures, uint8_t *out)
{
	if (next == NEXT_IN_BETWEEN)
		render(engine, ENGINE_SHOW_IN_BETWEEN, 0.75, out, false);
	else if (next == NEXT_PLAIN)
		render(engine, ENGINE_SHOW_PLAIN, 0.0, out, false);
	else
		begin(engine, &pictures[next == NEXT_FRAME ? 1 : 2]);
}

static void check(const struct order *order, const struct picture *pictures, uint8_t *const *out,
				  uint8_t *const *wanted)
{
	struct engine *engine = make(true), *plain = make(false);
	struct engine_image image;
	struct error error;
	begin(engine, &pictures[0]);
	begin(plain, &pictures[0]);
	render_two(plain, order, wanted, false);
	render_two(engine, order, out, true);
	CHECK(gl_of(engine)->readback.rest.arrival != NULL);
	go_on(engine, order->next, pictures, out[2]);
	for (int i = 0; i < 2; i++) {
		CHECK_INT(engine_take(engine, &image, &error), 0);
		CHECK(memcmp(out[i], wanted[i], BYTES) == 0);
	}
	engine_destroy(&engine);
	engine_destroy(&plain);
}

static void test_orders(void)
{
	struct picture pictures[3];
	uint8_t *out[3], *wanted[2];
	for (uint32_t i = 0; i < 3; i++) {
		picture_init(&pictures[i], WIDTH, i < 2 ? HEIGHT : 100, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
		picture_draw_layers(&pictures[i], i);
		picture_fill_random(&pictures[i], PURSUIT_ROLE_COLOR, 1 + i);
		out[i] = malloc(BYTES);
	}
	for (int i = 0; i < 2; i++)
		wanted[i] = malloc(BYTES);
	for (enum engine_show second = ENGINE_SHOW_REAL; second <= ENGINE_SHOW_PLAIN; second++)
		for (enum next next = NEXT_IN_BETWEEN; next <= NEXT_SMALL_FRAME; next++)
			check(&(struct order){second, next}, pictures, out, wanted);
	for (int i = 0; i < 3; i++) {
		picture_finish(&pictures[i]);
		free(out[i]);
	}
	for (int i = 0; i < 2; i++)
		free(wanted[i]);
}

int main(void)
{
	RUN(test_orders);
	return test_result();
}
