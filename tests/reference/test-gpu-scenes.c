/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The analysis on the GPU against that on the CPU, on all built-in scenes. The argument is the context. */
#include "scene-frame.h"
#include "tests/plan/on-gpu.h"
#include "tests/scenes/context.h"
#include "tests/test.h"

#define MAX_FRAMES 64

static struct scene_case {
	char what[64];
	struct scene_frame read;
} frames[MAX_FRAMES];
static size_t frame_count;
static struct engine *engine;

static void read_frames(const char *name)
{
	static const struct scene_moment moments[] = {{320, 180, 0.7, 0.025, false}, {336, 203, 2.35, 0.1, false}};
	char text[256] = "";
	struct scene *scene = scene_create(name, 1, 1, test_context_lookup, text, sizeof(text));
	for (size_t i = 0; i < 2 && frame_count < MAX_FRAMES && scene; i++) {
		const struct scene_moment *moment = &moments[i];
		struct scene_case *frame = &frames[frame_count++];
		snprintf(frame->what, sizeof(frame->what), "%s at %g s", name, moment->time);
		CHECK(scene_resize(scene, moment->width, moment->height, text, sizeof(text)));
		CHECK(scene_frame_read(&frame->read, scene, moment));
	}
	CHECK_STRING(text, "");
	scene_destroy(&scene);
}

/* All frames are rendered, and the scenes' context is gone, before the engine makes its own. */
static bool render_scenes(void)
{
	struct test_context context;
	if (!test_context_init(&context, false))
		return false;
	for (const struct scene_info *info = scene_list(); info->name; info++)
		read_frames(info->name);
	test_context_finish(&context);
	return true;
}

static void test_scenes(void)
{
	static const uint32_t cells[] = {8, 4, 16};
	struct on_gpu_totals totals = {0};
	for (size_t i = 0; i < frame_count; i++)
		for (size_t k = 0; k < 3; k++) {
			const struct plan_params params = {.cell = cells[k], .last_phase = 2.0f / 3};
			CHECK(on_gpu_alike(engine, &frames[i].read.frame, &params, frames[i].what, &totals));
		}
	CHECK(frame_count >= 16);
	printf("%llu plans, %llu of %llu vertices equal to the bit\n", (unsigned long long)totals.plans,
		   (unsigned long long)totals.equal, (unsigned long long)totals.vertices);
}

int main(int argc, char **argv)
{
	struct error error = {""};
	if (!render_scenes())
		SKIP("no EGL surfaceless context to render scenes in");
	engine = on_gpu_open(argc > 1 ? argv[1] : "surfaceless", &error);
	if (!engine)
		SKIP(error.text);
	RUN(test_scenes);
	engine_destroy(&engine);
	for (size_t i = 0; i < frame_count; i++)
		scene_frame_finish(&frames[i].read);
	return test_result();
}
