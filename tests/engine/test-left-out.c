/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What is left out costs no quality: each scene by the engine as it is and by one that leaves nothing out, against the
 * truth. PSNR within 0.05 dB; and equal bits in every tile for which nothing was left out, that is which both drew with
 * the same triangles.
 */
#include "tests/test.h"

#include <errno.h>

#include "daemon/cli/scene_source.h"
#include "daemon/engine/cpu/executor_cpu.h"
#include "daemon/measure/measure.h"

#define WIDTH 320u
#define HEIGHT 192u
#define RATE 60u
#define FRAMES 4u
#define FIRST 45u /* index of the first frame: all scenes are in full motion */
#define BYTES (4 * (size_t)WIDTH * HEIGHT)
#define MOST_DB 0.05

struct shown {
	struct engine *engine;
	uint8_t pixels[BYTES];
	struct quality quality;
};

struct tiles_seen {
	uint32_t alike, all; /* drawn with the same triangles, of those that move */
	uint32_t differ;     /* among these: not the same bits */
};

static struct engine *make(const char *method, bool leave_nothing_out)
{
	struct error error;
	const struct engine_params params = {
		.context = ENGINE_CONTEXT_CPU, .method = method, .leave_nothing_out = leave_nothing_out};
	return engine_create(&params, &error);
}

static void show(struct shown *shown, const struct frame *frame)
{
	struct error error;
	const struct engine_begin_params begin = {.n = 2, .last_phase = -1.0};
	const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, 0.5};
	struct engine_image image = {shown->pixels, 4 * (size_t)WIDTH, 0};
	CHECK_INT(engine_begin(shown->engine, frame, &begin, &error), 0);
	CHECK_INT(engine_render(shown->engine, &request, &image, &error), 0);
}

/* A triangle in a tile: its vertices, the smallest first. */
struct corners {
	uint32_t at[3];
};

static int compare(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(struct corners));
}

/* The triangles of a tile, in an order that does not depend on how they were drawn. */
static uint32_t list(const struct engine *engine, uint32_t tile, struct corners *corners)
{
	const struct bins *bins = &cpu_of(engine)->scene.bins;
	const uint32_t first = bins->starts[tile], count = bins->starts[tile + 1] - first;
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t *index = engine->mesh.lists + bins->triangles[first + i];
		uint32_t turn = index[0] < index[1] && index[0] < index[2] ? 0 : index[1] < index[2] ? 1 : 2;
		for (uint32_t k = 0; k < 3; k++)
			corners[i].at[k] = index[(turn + k) % 3];
	}
	qsort(corners, count, sizeof(*corners), compare);
	return count;
}

static bool same_triangles(const struct shown *a, const struct shown *b, uint32_t tile)
{
	const size_t most = a->engine->plan.index_count + b->engine->plan.index_count;
	struct corners *ours = malloc(most * sizeof(*ours)), *theirs = malloc(most * sizeof(*theirs));
	const uint32_t count = list(a->engine, tile, ours);
	const bool same = list(b->engine, tile, theirs) == count && memcmp(ours, theirs, count * sizeof(*ours)) == 0;
	free(ours);
	free(theirs);
	return same;
}

static bool same_pixels(const struct shown *a, const struct shown *b, uint32_t tile, uint32_t columns)
{
	const uint32_t left = tile % columns * TILE_WIDTH, top = tile / columns * TILE_HEIGHT;
	for (uint32_t y = top; y < top + TILE_HEIGHT && y < HEIGHT; y++) {
		const size_t at = 4 * ((size_t)y * WIDTH + left);
		if (memcmp(a->pixels + at, b->pixels + at, 4 * (size_t)TILE_WIDTH) != 0)
			return false;
	}
	return true;
}

static void compare_tiles(const struct shown *ours, const struct shown *plain, struct tiles_seen *seen)
{
	const struct scene *scene = &cpu_of(ours->engine)->scene;
	for (uint32_t tile = 0; tile < scene_tiles(scene); tile++) {
		seen->all++;
		if (!same_triangles(ours, plain, tile))
			continue;
		seen->alike++;
		seen->differ += !same_pixels(ours, plain, tile, scene->bins.columns);
	}
}

static void check_frame(struct scene_source *source, uint32_t i, struct shown *ours, struct shown *plain,
						struct tiles_seen *seen)
{
	static uint8_t truth[BYTES];
	const struct picture expected = {truth, 4 * (size_t)WIDTH, WIDTH, HEIGHT};
	const struct picture a = {ours->pixels, 4 * (size_t)WIDTH, WIDTH, HEIGHT};
	const struct picture b = {plain->pixels, 4 * (size_t)WIDTH, WIDTH, HEIGHT};
	struct frame frame;
	CHECK(scene_source_truth(source, (FIRST + i + 0.5) / RATE, truth));
	CHECK(scene_source_frame(source, FIRST + i, &frame));
	show(ours, &frame);
	show(plain, &frame);
	quality_add(&ours->quality, &a, &expected);
	quality_add(&plain->quality, &b, &expected);
	if (ours->engine->moves)
		compare_tiles(ours, plain, seen);
	else
		CHECK(memcmp(ours->pixels, plain->pixels, BYTES) == 0);
}

static void check_scene(const char *scene, const char *method, struct tiles_seen *sum)
{
	static struct shown ours, plain;
	struct error error;
	const struct scene_source_params params = {.scene = scene, .size = {WIDTH, HEIGHT}, .rate = {RATE, 1}};
	struct scene_source *source = scene_source_create(&params, &error);
	struct tiles_seen seen = {0};
	CHECK(source != NULL);
	ours = (struct shown){.engine = make(method, false)};
	plain = (struct shown){.engine = make(method, true)};
	for (uint32_t i = 0; i < FRAMES && source; i++)
		check_frame(source, i, &ours, &plain, &seen);
	printf("%s, %s: %.3f dB, nothing left out %.3f dB; %u of %u tiles with the same triangles, %u differ\n", scene,
		   method, ours.quality.psnr, plain.quality.psnr, seen.alike, seen.all, seen.differ);
	CHECK(ours.quality.psnr >= plain.quality.psnr - MOST_DB && ours.quality.psnr <= plain.quality.psnr + MOST_DB);
	CHECK_INT(seen.differ, 0);
	sum->alike += seen.alike;
	sum->all += seen.all;
	scene_source_destroy(&source);
	engine_destroy(&ours.engine);
	engine_destroy(&plain.engine);
}

static void check_all(const char *method)
{
	struct tiles_seen sum = {0};
	for (const struct scene_info *info = scene_list(); info->name; info++)
		check_scene(info->name, method, &sum);
	/* Something was left out, and there was something to compare. */
	CHECK(sum.alike > sum.all / 20 && sum.alike < sum.all);
}

static void test_grid(void)
{
	check_all("grid");
}

static void test_pursuit(void)
{
	check_all("pursuit");
}

int main(void)
{
	const struct scene_source_params params = {.scene = "still", .size = {WIDTH, HEIGHT}, .rate = {RATE, 1}};
	struct error error;
	struct scene_source *source = scene_source_create(&params, &error);
	if (!source) {
		printf("no GL to render scenes with: %s\n", error.text);
		return 77;
	}
	scene_source_destroy(&source);
	RUN(test_grid);
	RUN(test_pursuit);
	return test_result();
}
