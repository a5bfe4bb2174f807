/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The engine against the reference on all built-in scenes: two moments each,
 * backward motion, depth and UI as a game would hand them in. The same bounds
 * as in test-engine.c: no pixel outside, and the same shares.
 */
#include "engine-case.h"
#include "input.h"
#include "scene-frame.h"
#include "tests/scenes/context.h"
#include "tests/test.h"

#define WIDTH 320u
#define HEIGHT 180u
#define INTERVAL 0.025
#define MAX_FRAMES 64

struct scene_case {
	const char *scene;
	double time;
	struct scene_frame read;
};

static struct scene_case frames[MAX_FRAMES];
static size_t frame_count;
static struct engine *engine;
static struct case_totals totals;

static bool read_frame(struct scene *scene, const char *name, double time)
{
	const struct scene_moment moment = {WIDTH, HEIGHT, time, INTERVAL, true};
	struct scene_case *out = &frames[frame_count];
	out->scene = name;
	out->time = time;
	if (scene_frame_read(&out->read, scene, &moment)) {
		frame_count++;
		return true;
	}
	scene_frame_finish(&out->read);
	return false;
}

/* All frames are rendered, and the scenes' context is gone, before the engine makes its own. */
static bool render_scenes(void)
{
	static const double times[] = {0.7, 2.35};
	struct test_context context;
	if (!test_context_init(&context, false))
		return false;
	for (const struct scene_info *info = scene_list(); info->name && frame_count + 2 <= MAX_FRAMES; info++) {
		char text[256] = "";
		struct scene *scene = scene_create(info->name, WIDTH, HEIGHT, test_context_lookup, text, sizeof(text));
		CHECK_STRING(text, "");
		CHECK(scene != NULL);
		for (size_t t = 0; t < 2 && scene; t++)
			CHECK(read_frame(scene, info->name, times[t]));
		scene_destroy(&scene);
	}
	test_context_finish(&context);
	return true;
}

static void run(const struct scene_case *frame, size_t variant)
{
	static const struct engine_request thirds[] = {
		{ENGINE_SHOW_REAL, 0.0}, {ENGINE_SHOW_IN_BETWEEN, 1.0 / 3}, {ENGINE_SHOW_IN_BETWEEN, 2.0 / 3}};
	static const struct engine_request shifted[] = {
		{ENGINE_SHOW_REAL, 0.25}, {ENGINE_SHOW_IN_BETWEEN, 0.5}, {ENGINE_SHOW_PLAIN, 0.5}};
	static const enum engine_blur blurs[] = {ENGINE_BLUR_DOUBTFUL, ENGINE_BLUR_EVERYWHERE, ENGINE_BLUR_OFF};
	char name[96];
	const struct engine_case what = {
		.name = name,
		.params = {.method = "grid",
				   .blur = blurs[variant],
				   /* With pixels of 0.27 mm nothing is damped; on the default display fast things are. */
				   .display_width_mm = variant == 0 ? input_display_mm(WIDTH) : 0.0f},
		.begin = {.n = variant == 1 ? 2 : 3, .last_phase = -1.0},
		.requests = variant == 1 ? shifted : thirds,
		.request_count = 3};
	snprintf(name, sizeof(name), "%s at %g s, blur %d", frame->scene, frame->time, blurs[variant]);
	CHECK(engine_case_run(engine, &frame->read.frame, &what, &totals));
}

static void test_scenes(void)
{
	for (size_t i = 0; i < frame_count; i++)
		for (size_t variant = 0; variant < 2; variant++)
			run(&frames[i], variant ? 1 + i % 2 : 0);
	case_totals_print(&totals);
	CHECK(frame_count >= 16);
}

static void test_shares(void)
{
	for (int show = 0; show < 3; show++) {
		const struct bounds_report *report = &totals.reports[show];
		const double pixels = (double)report->pixels;
		CHECK((double)report->plain_within_one >= CASE_PLAIN_WITHIN_ONE * (double)report->plain);
		CHECK((double)report->other <= 0.01 * pixels);
		CHECK((double)report->excused <= 0.005 * pixels);
		CHECK((double)report->sharp >= 0.3 * pixels);
	}
}

int main(int argc, char **argv)
{
	const bool cpu = argc > 1 && strcmp(argv[1], "cpu") == 0;
	struct engine_params params = {.method = "grid",
								   .context = cpu ? ENGINE_CONTEXT_CPU : ENGINE_CONTEXT_EGL_SURFACELESS};
	struct error error = {""};
	if (!render_scenes())
		SKIP("no EGL surfaceless context to render scenes in");
	engine = engine_create(&params, &error);
	if (!engine)
		SKIP(error.text);
	RUN(test_scenes);
	RUN(test_shares);
	engine_destroy(&engine);
	for (size_t i = 0; i < frame_count; i++)
		scene_frame_finish(&frames[i].read);
	return test_result();
}
