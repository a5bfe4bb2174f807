/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The task scene's score. Which rings are open is read off the pictures (a gap
 * in the ring's pixels shows the background), not off the scene's own numbers.
 */
#include "client/scenes/scene.h"
#include "context.h"
#include "picture.h"
#include "tests/test.h"

enum { WIDTH = 480, HEIGHT = 270, RINGS = 12, CIRCLE = 96 };

/* Ring pixels have the ring's own object ids, far below those of the surroundings. */
static bool is_ring(const struct picture *picture, double x, double y)
{
	if (!(x >= 0.0 && y >= 0.0 && x < WIDTH && y < HEIGHT))
		return false;
	uint32_t id = picture->pixels.object_id[(size_t)y * WIDTH + (size_t)x];
	return id >= 100 && id < 0x40000000u;
}

struct sight {
	bool seen, whole, open;
};

/* Walks around the middle of the ring's bounding box, through the middle of its tube. */
static struct sight look(const struct picture *picture)
{
	double low_x = WIDTH, high_x = -1.0, low_y = HEIGHT, high_y = -1.0;
	for (size_t i = 0; i < picture->count; i++) {
		double x = (double)(i % WIDTH), y = (double)(i / WIDTH);
		if (!is_ring(picture, x, y))
			continue;
		low_x = fmin(low_x, x);
		high_x = fmax(high_x, x);
		low_y = fmin(low_y, y);
		high_y = fmax(high_y, y);
	}
	struct sight sight = {.seen = high_x >= low_x};
	sight.whole = sight.seen && low_x > 4.0 && high_x < WIDTH - 5.0 && low_y > 4.0 && high_y < HEIGHT - 5.0;
	double cx = 0.5 * (low_x + high_x), cy = 0.5 * (low_y + high_y), part = 0.62 / 0.79;
	int gap = 0;
	for (int k = 0; k < CIRCLE && sight.whole; k++) {
		double a = 6.2831853 * k / CIRCLE;
		gap += !is_ring(picture, cx + 0.5 + part * 0.5 * (high_x - low_x) * cos(a),
						cy + 0.5 + part * 0.5 * (high_y - low_y) * sin(a));
	}
	sight.open = gap > 2;
	return sight;
}

struct observed {
	double first, middle, last; /* moments of sight; middle: whole in the picture */
	bool open;
};

/* Rings 0 to RINGS - 1 as seen in pictures 1/50 s apart. */
static void observe(struct scene *scene, struct observed *rings)
{
	struct picture picture;
	bool seen = false;
	int ring = -1;
	picture_init(&picture, WIDTH, HEIGHT);
	for (double time = 0.0; ring < RINGS && time < 60.0; time += 0.02) {
		CHECK(picture_take(&picture, scene, time, time, time));
		struct sight sight = look(&picture);
		if (sight.seen && !seen && ++ring < RINGS)
			rings[ring] = (struct observed){.first = time};
		seen = sight.seen;
		if (!seen || ring >= RINGS)
			continue;
		rings[ring].last = time;
		if (sight.whole) {
			rings[ring].middle = time;
			rings[ring].open |= sight.open;
		}
	}
	CHECK_INT(ring, RINGS);
	picture_finish(&picture);
}

static struct observed rings[RINGS];

static struct scene *create(void)
{
	char error[256] = "";
	struct scene *scene = scene_create("rings", WIDTH, HEIGHT, test_context_lookup, error, sizeof(error));
	CHECK(scene != NULL);
	return scene;
}

static void check_score(struct scene *scene, double time, struct scene_score want)
{
	struct scene_score score;
	CHECK(scene_get_score(scene, time, &score));
	CHECK_INT(score.shown, want.shown);
	CHECK_INT(score.hits, want.hits);
	CHECK_INT(score.misses, want.misses);
	CHECK_INT(score.false_answers, want.false_answers);
}

static void rings_come_open_and_closed(void)
{
	struct scene *scene = create();
	int open = 0;
	observe(scene, rings);
	for (int i = 0; i < RINGS; i++) {
		printf("ring %d: from %.2f to %.2f s, %s\n", i, rings[i].first, rings[i].last,
			   rings[i].open ? "open" : "closed");
		CHECK(rings[i].middle > rings[i].first && rings[i].middle < rings[i].last);
		open += rings[i].open;
	}
	CHECK(open >= 2 && open <= RINGS - 2);
	scene_destroy(&scene);
}

static void right_keys_hit(void)
{
	struct scene *scene = create();
	for (uint32_t i = 0; i < RINGS; i++)
		scene_key(scene, rings[i].middle, rings[i].open ? 'o' : 'c');
	check_score(scene, rings[RINGS - 1].last + 0.1, (struct scene_score){RINGS, RINGS, 0, 0});
	check_score(scene, rings[3].last + 0.1, (struct scene_score){4, 4, 0, 0});
	check_score(scene, -5.0, (struct scene_score){0, 0, 0, 0});
	scene_destroy(&scene);
}

static void wrong_keys_are_false_answers(void)
{
	struct scene *scene = create();
	scene_key(scene, rings[0].middle, rings[0].open ? 'c' : 'o');
	scene_key(scene, rings[0].middle + 0.05, rings[0].open ? 'o' : 'c'); /* too late: the first key counts */
	check_score(scene, rings[0].middle + 0.1, (struct scene_score){0, 0, 0, 1});
	check_score(scene, rings[1].first - 0.01, (struct scene_score){1, 0, 0, 1});
	scene_destroy(&scene);
}

static void no_key_is_a_miss(void)
{
	struct scene *scene = create();
	scene_key(scene, rings[1].middle, rings[1].open ? 'o' : 'c');
	check_score(scene, rings[2].last + 0.1, (struct scene_score){3, 1, 2, 0});
	scene_destroy(&scene);
}

static void keys_without_a_ring_are_ignored(void)
{
	struct scene *scene = create();
	scene_key(scene, 0.01, 'o');
	scene_key(scene, 0.5 * (rings[0].last + rings[1].first), 'c');
	scene_key(scene, rings[0].middle, 'x');
	scene_key(scene, -3.0, 'o');
	scene_key(scene, NAN, 'o');
	check_score(scene, rings[1].first - 0.01, (struct scene_score){1, 0, 1, 0});
	scene_destroy(&scene);
}

static void other_scenes_have_no_score(void)
{
	char error[256];
	struct scene *scene = scene_create("still", 8, 8, test_context_lookup, error, sizeof(error));
	struct scene_score score;
	scene_key(scene, 1.0, 'o');
	CHECK(!scene_get_score(scene, 1.0, &score));
	scene_destroy(&scene);
}

int main(int argc, char **argv)
{
	struct test_context context;
	if (!test_context_init(&context, argc > 1 && strcmp(argv[1], "es") == 0))
		SKIP("no surfaceless EGL context");
	RUN(rings_come_open_and_closed);
	RUN(right_keys_hit);
	RUN(wrong_keys_are_false_answers);
	RUN(no_key_is_a_miss);
	RUN(keys_without_a_ring_are_ignored);
	RUN(other_scenes_have_no_score);
	test_context_finish(&context);
	return test_result();
}
