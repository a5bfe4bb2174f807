/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What leaving out costs in quality: the engine against the plain pipeline, which leaves out nothing, in GL. That draws
 * each triangle of the whole grid, with depth and with tears, for each picture anew, over a pyramid made everywhere,
 * and compensates under all of them. Where the engine leaves out the same but merges no cells, equal to the bit; with
 * merged cells PSNR against the truth differs by less than 0.05 dB in each scene. The argument is the context.
 */
#include "daemon/engine/gl/executor_gl.h"
#include "daemon/engine/method.h"
#include "daemon/engine/pass.h"
#include "daemon/engine/warp_triangle.h"
#include "engine-context.h"
#include "scene-frame.h"
#include "shaders/limits.h"
#include "tests/scenes/context.h"
#include "tests/test.h"

#define WIDTH 320u
#define HEIGHT 180u
#define BYTES ((size_t)4 * WIDTH * HEIGHT)
#define INTERVAL 0.025
#define MOMENTS 2u
#define BETWEENS 2u
#define MAX_SCENES 16u

/* A real frame, and the truth at the phases of its in-betweens. */
struct moment {
	struct scene_frame frame, truths[BETWEENS];
};

static struct scene_case {
	const char *name;
	struct moment moments[MOMENTS];
} scenes[MAX_SCENES];
static size_t scene_count;
static struct engine *engine;

static double phase_of(uint32_t between)
{
	return (between + 1.0) / (BETWEENS + 1.0);
}

/* ---- the plain pipeline ---- */

/* Lists of our own instead of the sorted ones. */
static void put_list(struct warp_mesh *mesh, uint32_t *count, const uint32_t *index)
{
	memcpy(mesh->lists + *count, index, 3 * sizeof(*index));
	*count += 3;
}

/* All that are shown at the last phase. */
static void doubt_all(struct warp_mesh *mesh)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < mesh->count; i += 3)
		if (triangle_map(mesh->plan->vertices, mesh->triangles + i, mesh->plan->last_phase).determinant > 0.0f)
			put_list(mesh, &count, mesh->triangles + i);
	mesh->plain = mesh->torn = mesh->folded = mesh->folded_torn = (struct warp_list){0, 0};
	mesh->doubtful = (struct warp_list){0, count};
	tiles_mark_all(&mesh->low);
	mesh->list_count = count;
	mesh->sorted++;
}

/* All, torn ones last as the page says (section 3), or in the order of the quads if depths say nothing. */
static void fold_all(struct warp_mesh *mesh, float phase, bool has_depth)
{
	uint32_t count = 0;
	for (int torn = 0; torn < (has_depth ? 2 : 1); torn++)
		for (uint32_t i = 0; i < mesh->count; i += 3) {
			const struct map map = triangle_map(mesh->plan->vertices, mesh->triangles + i, phase);
			if (!has_depth || stretches(map, 1.0f + (float)TEAR_FROM) == (torn == 1))
				put_list(mesh, &count, mesh->triangles + i);
		}
	tiles_mark_all(&mesh->folds);
	mesh->plain = mesh->torn = (struct warp_list){0, 0};
	/* In their order, and once more as torn ones. */
	memcpy(mesh->lists + count, mesh->lists, count * sizeof(*mesh->lists));
	mesh->folded = (struct warp_list){0, count};
	mesh->folded_torn = (struct warp_list){count, count};
	mesh->keep_order = true;
	mesh->list_count = 2 * count;
	mesh->sorted++;
}

static bool depth_varies(const struct plan *plan)
{
	for (uint32_t i = 1; i < plan->columns * plan->rows; i++)
		if (plan->vertices[i].z != plan->vertices[0].z)
			return true;
	return false;
}

static int plain_begin(struct engine *own, struct error *error)
{
	int result = pass_run(own, PASS_ANALYSE, error);
	own->moves = result == 0 && own->plan.rest == PLAN_MOVES;
	if (!own->moves)
		return result;
	own->boost = method_boost(own);
	own->has_depth = depth_varies(&own->plan);
	result = warp_mesh_begin(&own->mesh, &own->plan, -1.0f, NULL, error);
	if (result == 0)
		result = warp_mesh_sort_doubtful(&own->mesh, own->params.blur_level, error);
	if (result < 0)
		return result;
	doubt_all(&own->mesh);
	own->levels_everywhere = true;
	own->compensated = true;
	result = pass_run(own, PASS_PYRAMID, error);
	return result < 0 ? result : pass_run(own, PASS_COMPENSATE, error);
}

static int plain_show(struct engine *own, enum engine_show what, double phase, enum picture_id *picture,
					  struct error *error)
{
	const bool real = what == ENGINE_SHOW_REAL;
	*picture = !own->moves ? PICTURE_ORIGINAL : real ? PICTURE_REAL : PICTURE_BETWEEN;
	if (!own->moves || real)
		return 0;
	int result = warp_mesh_sort(&own->mesh, (float)phase, true, !own->has_depth, error);
	if (result < 0)
		return result;
	fold_all(&own->mesh, (float)phase, own->has_depth);
	gl_of(own)->shown.number = 0;
	own->job.picture = *picture;
	own->job.phase = phase;
	*picture = PICTURE_SHOWN;
	return pass_run(own, PASS_WARP, error);
}

static const struct method plain = {.name = "plain", .begin = plain_begin, .show = plain_show};
static const struct method unmerged = {.name = "unmerged", .tolerance = -1.0f, .begin = grid_begin, .show = grid_show};

/* ---- pictures ---- */

/* The real frame and its in-betweens, one after another. */
static uint8_t *show_all(const struct method *method, const struct frame *frame)
{
	uint8_t *out = malloc(BYTES * (BETWEENS + 1));
	struct error error = {""};
	const struct engine_begin_params begin = {.n = BETWEENS + 1, .last_phase = -1.0};
	engine->method = method;
	CHECK_INT(engine_begin(engine, frame, &begin, &error), 0);
	for (uint32_t i = 0; i <= BETWEENS; i++) {
		struct engine_image image = {.data = out + i * BYTES, .stride = (size_t)4 * WIDTH};
		const struct engine_request request = {i ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL,
											   i ? phase_of(i - 1) : 0.0};
		CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	}
	if (error.text[0])
		fprintf(stderr, "%s\n", error.text);
	return out;
}

static double squares(const uint8_t *a, const uint8_t *b)
{
	double sum = 0.0;
	for (size_t i = 0; i < BYTES; i++)
		sum += i % 4 == 3 ? 0.0 : (a[i] - b[i]) * (double)(a[i] - b[i]);
	return sum;
}

static double psnr(double sum)
{
	const double mean = sum / (3.0 * WIDTH * HEIGHT);
	return mean > 0.0 ? fmin(10.0 * log10(255.0 * 255.0 / mean), 100.0) : 100.0;
}

static double score(const uint8_t *pictures, const struct moment *moment)
{
	double sum = 0.0;
	for (uint32_t i = 0; i < BETWEENS; i++)
		sum += psnr(squares(pictures + (i + 1) * BYTES, moment->truths[i].frame.planes[0])) / BETWEENS;
	return sum;
}

static void check_scene(const struct scene_case *scene)
{
	double with = 0.0, without = 0.0;
	for (uint32_t m = 0; m < MOMENTS; m++) {
		const struct frame *frame = &scene->moments[m].frame.frame;
		uint8_t *want = show_all(&plain, frame), *same = show_all(&unmerged, frame);
		uint8_t *got = show_all(&method_pursuit, frame);
		size_t different = 0;
		for (size_t i = 0; i < BYTES * (BETWEENS + 1); i++)
			different += want[i] != same[i];
		CHECK_INT(different, 0);
		without += score(want, &scene->moments[m]) / MOMENTS;
		with += score(got, &scene->moments[m]) / MOMENTS;
		free(want);
		free(same);
		free(got);
	}
	printf("%-10s plain %.3f dB, pursuit %.3f dB, %+.4f\n", scene->name, without, with, with - without);
	CHECK_NEAR(with, without, 0.05);
}

static void test_scenes(void)
{
	for (size_t i = 0; i < scene_count; i++)
		check_scene(&scenes[i]);
	CHECK(scene_count >= 8);
}

/* ---- scenes ---- */

static void read_moment(struct scene *scene, struct moment *moment, double time)
{
	const struct scene_moment at = {WIDTH, HEIGHT, time, INTERVAL, false};
	CHECK(scene_frame_read(&moment->frame, scene, &at));
	for (uint32_t i = 0; i < BETWEENS; i++) {
		const struct scene_moment later = {WIDTH, HEIGHT, time + phase_of(i) * INTERVAL, INTERVAL, false};
		CHECK(scene_frame_read(&moment->truths[i], scene, &later));
	}
}

static void read_scene(const char *name)
{
	static const double times[MOMENTS] = {0.7, 2.35};
	char text[256] = "";
	struct scene *scene = scene_create(name, WIDTH, HEIGHT, test_context_lookup, text, sizeof(text));
	CHECK_STRING(text, "");
	if (!scene)
		return;
	scenes[scene_count].name = name;
	for (uint32_t i = 0; i < MOMENTS; i++)
		read_moment(scene, &scenes[scene_count].moments[i], times[i]);
	scene_count++;
	scene_destroy(&scene);
}

static void finish_scenes(void)
{
	for (size_t i = 0; i < scene_count; i++)
		for (uint32_t m = 0; m < MOMENTS; m++) {
			scene_frame_finish(&scenes[i].moments[m].frame);
			for (uint32_t k = 0; k < BETWEENS; k++)
				scene_frame_finish(&scenes[i].moments[m].truths[k]);
		}
}

int main(int argc, char **argv)
{
	struct test_context context;
	if (!test_context_init(&context, false))
		SKIP("no EGL surfaceless context to render scenes in");
	for (const struct scene_info *info = scene_list(); info->name && scene_count < MAX_SCENES; info++)
		read_scene(info->name);
	test_context_finish(&context);
	engine = engine_context_open(argc > 1 ? argv[1] : "surfaceless-gl", "pursuit");
	RUN(test_scenes);
	engine_destroy(&engine);
	finish_scenes();
	return test_result();
}
