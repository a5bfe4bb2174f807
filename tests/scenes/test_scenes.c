/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What holds for every scene: same bits for the same request, sizes, finite numbers, ranges, any time. */
#include "client/scenes/scene.h"
#include "context.h"
#include "picture.h"
#include "tests/test.h"

static struct scene *kept[16]; /* as listed; made once, since most of the work is the same for all sizes */

static struct scene *create(const char *name, uint32_t width, uint32_t height)
{
	char error[256] = "";
	struct scene *scene = scene_create(name, width, height, test_context_lookup, error, sizeof(error));
	if (!scene)
		fprintf(stderr, "%s: %s\n", name, error);
	CHECK(scene != NULL);
	return scene;
}

static struct scene *take(const struct scene_info *info, uint32_t width, uint32_t height)
{
	char error[256] = "";
	struct scene **scene = &kept[info - scene_list()];
	if (!*scene)
		*scene = create(info->name, width, height);
	CHECK(scene_resize(*scene, width, height, error, sizeof(error)));
	CHECK_STRING(error, "");
	return *scene;
}

static void check_ranges(const struct picture *picture, const char *name)
{
	size_t bad_motion = 0, bad_depth = 0, bad_background = 0, bad_alpha = 0, bad_ui = 0;
	for (size_t i = 0; i < picture->count; i++) {
		const float *b = picture->pixels.backward + 2 * i, *f = picture->pixels.forward + 2 * i;
		float depth = picture->pixels.depth[i];
		const uint8_t *ui = picture->pixels.ui + 4 * i;
		for (int k = 0; k < 2; k++)
			bad_motion += !(fabsf(b[k]) <= 32768.0f && fabsf(f[k]) <= 32768.0f);
		bad_depth += !(depth >= 0.0f && depth <= 1.0f);
		bad_background += (picture->pixels.object_id[i] == 0) != (depth == 1.0f);
		bad_alpha += picture->pixels.color[4 * i + 3] != 255;
		bad_ui += ui[0] > ui[3] || ui[1] > ui[3] || ui[2] > ui[3];
	}
	if (bad_motion || bad_depth || bad_background || bad_alpha || bad_ui)
		fprintf(stderr, "scene %s, %ux%u\n", name, picture->width, picture->height);
	CHECK_INT(bad_motion, 0);
	CHECK_INT(bad_depth, 0);
	CHECK_INT(bad_background, 0);
	CHECK_INT(bad_alpha, 0);
	CHECK_INT(bad_ui, 0);
	CHECK(!picture->camera.cut);
}

static void same_request_gives_same_bits(void)
{
	for (const struct scene_info *info = scene_list(); info->name; info++) {
		struct scene *scene = take(info, 33, 70), *twin = create(info->name, 160, 90);
		struct picture first, again, elsewhere, small;
		picture_init(&first, 160, 90);
		picture_init(&again, 160, 90);
		picture_init(&elsewhere, 160, 90);
		/* One that has shown this moment in another size, and one that is new. */
		picture_init(&small, 33, 70);
		CHECK(picture_take(&small, scene, 6.99, 7.0, 7.01));
		picture_finish(&small);
		scene = take(info, 160, 90);
		CHECK(picture_take(&first, scene, 6.99, 7.0, 7.01));
		CHECK(picture_take(&again, scene, 31.0, 31.5, 31.6));
		if (strcmp(info->name, "still") != 0)
			CHECK(!picture_equal(&first, &again));
		CHECK(picture_take(&again, scene, 6.99, 7.0, 7.01));
		CHECK(picture_take(&elsewhere, twin, 6.99, 7.0, 7.01));
		CHECK(picture_equal(&first, &again));
		CHECK(picture_equal(&first, &elsewhere));
		picture_finish(&first);
		picture_finish(&again);
		picture_finish(&elsewhere);
		scene_destroy(&twin);
		CHECK(twin == NULL);
	}
}

static void any_size_and_time(void)
{
	static const uint32_t sizes[][2] = {{1, 1}, {7, 5}, {333, 77}, {50, 200}};
	static const double times[][3] = {{-0.1, 0.0, 0.1},       {119.9, 120.0, 120.1},  {-7.3, -7.2, -7.1},
									  {1e9, 1e9 + 0.02, 1e9}, {-1e300, 1e300, 1e308}, {500.0, 3.0, -40.0}};
	for (const struct scene_info *info = scene_list(); info->name; info++) {
		for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++) {
			struct scene *scene = take(info, sizes[s][0], sizes[s][1]);
			struct picture picture;
			picture_init(&picture, sizes[s][0], sizes[s][1]);
			for (size_t t = 0; t < sizeof(times) / sizeof(times[0]) && (s == 2 || t < 1); t++) {
				CHECK(picture_take(&picture, scene, times[t][0], times[t][1], times[t][2]));
				check_ranges(&picture, info->name);
			}
			picture_finish(&picture);
		}
	}
}

/* Points that the camera has passed, or will have, are on or behind its plane at the other moment. */
static void points_behind_the_camera_stay_finite(void)
{
	struct scene *scene = create("colonnade", 333, 77);
	struct picture picture;
	picture_init(&picture, 333, 77);
	for (int i = 0; i < 40; i++) {
		double time = 3.0 + 0.37 * i;
		CHECK(picture_take(&picture, scene, time + 1.0, time, time + 2.0));
		check_ranges(&picture, "colonnade");
	}
	picture_finish(&picture);
	scene_destroy(&scene);
}

static void nothing_moves_in_still(void)
{
	struct scene *scene = create("still", 320, 180);
	struct picture picture;
	picture_init(&picture, 320, 180);
	CHECK(picture_take(&picture, scene, 1.0, 17.25, 90.0));
	size_t moved = 0;
	for (size_t i = 0; i < picture.count * 2; i++)
		moved += picture.pixels.backward[i] != 0.0f || picture.pixels.forward[i] != 0.0f;
	CHECK_INT(moved, 0);
	picture_finish(&picture);
	scene_destroy(&scene);
}

/* Equal moments: no motion anywhere, to the last bit, whatever moves otherwise. */
static void no_time_no_motion(void)
{
	for (const struct scene_info *info = scene_list(); info->name; info++) {
		struct scene *scene = take(info, 160, 90);
		struct picture picture;
		picture_init(&picture, 160, 90);
		size_t moved = 0;
		for (int k = 0; k < 8; k++) {
			double time = 0.77 + 3.31 * k;
			CHECK(picture_take(&picture, scene, time, time, time));
			for (size_t i = 0; i < picture.count * 2; i++)
				moved += picture.pixels.backward[i] != 0.0f || picture.pixels.forward[i] != 0.0f;
		}
		CHECK_INT(moved, 0);
		picture_finish(&picture);
	}
}

static void ui_only_where_it_belongs(void)
{
	for (const struct scene_info *info = scene_list(); info->name; info++) {
		struct scene *scene = take(info, 320, 180);
		struct picture picture;
		bool wanted = strcmp(info->name, "hud") == 0 || strcmp(info->name, "rings") == 0;
		size_t covered = 0;
		picture_init(&picture, 320, 180);
		CHECK(picture_take(&picture, scene, 1.0, 1.1, 1.2));
		for (size_t i = 0; i < picture.count; i++)
			covered += picture.pixels.ui[4 * i + 3] > 0;
		CHECK_INT(picture.has_ui, wanted);
		CHECK_INT(covered > 0, wanted);
		struct scene_pixels missing = {.ui = picture.pixels.ui};
		CHECK_INT(scene_read(scene, &missing), wanted);
		picture_finish(&picture);
	}
}

static void forward_only_when_asked(void)
{
	struct scene *scene = create("tower", 64, 36);
	struct scene_request request = {.time = 1.0, .time_previous = 0.98};
	struct scene_textures textures;
	float motion[64 * 36 * 2];
	struct scene_pixels pixels = {.forward = motion};
	CHECK(scene_render(scene, &request, &textures, NULL));
	CHECK_INT(textures.forward, 0);
	CHECK(textures.color && textures.depth && textures.backward && textures.object_id);
	CHECK(!scene_read(scene, &pixels));
	scene_destroy(&scene);
}

static void bad_requests_are_refused(void)
{
	char error[256] = "";
	CHECK(!scene_create("nonsense", 10, 10, test_context_lookup, error, sizeof(error)));
	CHECK_STRING(error, "there is no scene \"nonsense\"");
	CHECK(!scene_create("still", 0, 10, test_context_lookup, error, sizeof(error)));
	CHECK_STRING(error, "the size of a scene is 1 to 16384, not 0x10");
	CHECK(!scene_create("still", 10, 16385, test_context_lookup, NULL, 0));
	CHECK(scene_exists("tower") && !scene_exists("towers") && !scene_exists(NULL));
	struct scene *scene = create("still", 8, 8);
	struct scene_request request = {.time = NAN};
	CHECK(!scene_render(scene, &request, NULL, NULL));
	request.time = 0.0;
	CHECK(!scene_resize(scene, 10, 0, error, sizeof(error)));
	CHECK_STRING(error, "the size of a scene is 1 to 16384, not 10x0");
	CHECK(!scene_render(scene, &request, NULL, NULL));
	CHECK(!scene_read(scene, &(struct scene_pixels){0}));
	CHECK(scene_resize(scene, 9, 7, NULL, 0));
	CHECK(scene_render(scene, &request, NULL, NULL));
	request = (struct scene_request){.time_next = INFINITY, .forward = true};
	CHECK(!scene_render(scene, &request, NULL, NULL));
	scene_destroy(&scene);
	scene_destroy(&scene);
}

int main(int argc, char **argv)
{
	struct test_context context;
	if (!test_context_init(&context, argc > 1 && strcmp(argv[1], "es") == 0))
		SKIP("no surfaceless EGL context");
	RUN(same_request_gives_same_bits);
	RUN(any_size_and_time);
	RUN(points_behind_the_camera_stay_finite);
	RUN(nothing_moves_in_still);
	RUN(no_time_no_motion);
	RUN(ui_only_where_it_belongs);
	RUN(forward_only_when_asked);
	RUN(bad_requests_are_refused);
	for (int i = 0; i < 16; i++)
		scene_destroy(&kept[i]);
	test_context_finish(&context);
	return test_result();
}
