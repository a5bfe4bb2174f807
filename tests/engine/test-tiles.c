/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The CPU executor: its threads, every pixel of a displaced grid covered by some triangle however wild the grid, and
 * equal bits from every instruction set and every number of threads. And what both executors know of tiles.
 */
#include "tests/test.h"

#include <stdatomic.h>

#include "daemon/engine/cpu/executor_cpu.h"
#include "daemon/engine/gl/tile_hash.h"
#include "tests/engine/picture.h"

static atomic_uint allocations;

/* The linker sends the engine here (--wrap). */
void *__real_malloc(size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

void *__wrap_malloc(size_t size)
{
	atomic_fetch_add(&allocations, 1);
	return __real_malloc(size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
	atomic_fetch_add(&allocations, 1);
	return __real_aligned_alloc(alignment, size);
}

struct counter {
	atomic_uint items[1000];
	atomic_uint threads[POOL_MAX_THREADS];
};

static void count(void *context, uint32_t item, uint32_t thread)
{
	struct counter *counter = context;
	atomic_fetch_add(&counter->items[item], 1);
	atomic_fetch_add(&counter->threads[thread], 1);
}

static void test_pool(void)
{
	for (uint32_t threads = 0; threads <= POOL_MAX_THREADS + 1; threads++) {
		struct pool *pool = pool_create(threads);
		CHECK(pool_threads(pool) >= 1 && pool_threads(pool) <= POOL_MAX_THREADS);
		for (uint32_t items = 0; items <= 1000; items += 125) {
			struct counter counter = {0};
			long wrong = 0;
			for (int i = 0; i < 20; i++)
				pool_run(pool, count, &counter, items);
			for (uint32_t i = 0; i < 1000; i++)
				wrong += counter.items[i] != (i < items ? 20 : 0);
			for (uint32_t i = pool_threads(pool); i < POOL_MAX_THREADS; i++)
				wrong += counter.threads[i] != 0;
			CHECK_INT(wrong, 0);
		}
		pool_finish(pool);
		pool_destroy(&pool);
	}
}

struct outer {
	struct pool *pool;
	struct counter inner;
	atomic_uint items;
};

static void count_outer(void *context, uint32_t item, uint32_t thread)
{
	struct outer *outer = context;
	atomic_fetch_add(&outer->items, 1);
}

/* Tasks that the caller runs while another one goes on. */
static void test_pool_nests(void)
{
	for (uint32_t threads = 1; threads <= 4; threads++) {
		struct outer outer = {.pool = pool_create(threads)};
		long wrong = 0;
		for (int round = 0; round < 200; round++) {
			pool_start(outer.pool, count_outer, &outer, 100);
			pool_run(outer.pool, count, &outer.inner, 50);
			for (uint32_t i = 0; i < 50; i++)
				wrong += outer.inner.items[i] != 2 * (uint32_t)round + 1;
			pool_run(outer.pool, count, &outer.inner, 50);
			pool_finish(outer.pool);
			wrong += outer.items != 100 * ((uint32_t)round + 1);
		}
		CHECK_INT(wrong, 0);
		pool_destroy(&outer.pool);
	}
	struct counter alone = {0};
	pool_run(NULL, count, &alone, 10);
	CHECK_INT(alone.threads[0], 10);
	CHECK_INT(pool_threads(NULL), 1);
}

/* Random motion by patches, as far as `range` pixels; a depth for each pixel. */
static void scatter(const struct picture *picture, uint32_t seed, float range, uint32_t patch)
{
	for (uint32_t y = 0; y < picture->height; y++)
		for (uint32_t x = 0; x < picture->width; x++) {
			uint32_t state = seed + x / patch * 7919u + y / patch * 104729u;
			picture_random(&state);
			float mx = (float)(picture_random(&state) & 0xffff) / 32768.0f - 1.0f;
			float my = (float)(picture_random(&state) & 0xffff) / 32768.0f - 1.0f;
			picture_set_motion(picture, x, y, range * mx, range * my);
			picture_set_depth(picture, x, y, (float)(picture_random(&state) & 0xff) / 255.0f);
		}
}

static struct engine *make(const char *level, uint32_t threads)
{
	struct error error;
	/* So small and far that nothing is too fast to follow. */
	const struct engine_params params = {.context = ENGINE_CONTEXT_CPU,
										 .level = level,
										 .threads = threads,
										 .display_width_mm = 10.0f,
										 .viewing_distance_mm = 10000.0f};
	return engine_create(&params, &error);
}

static const struct {
	float range;
	uint32_t patch;
	bool depth;
} wilds[] = {{3.0f, 1, true},     {40.0f, 1, true},     {40.0f, 1, false}, {60.0f, 24, true},
			 {500.0f, 24, false}, {60000.0f, 24, true}, {1e30f, 3, true},  {0.01f, 1, true},
			 {9.0f, 64, true},    {30000.0f, 1, false}, {0.4f, 17, false}, {7.25f, 8, true}};
#define WILDS (sizeof(wilds) / sizeof(wilds[0]))

static void draw_wild(struct picture *picture, size_t i)
{
	picture_init(picture, 157 - 13 * (uint32_t)(i % 3), 101, PURSUIT_FORMAT_BGRA8,
				 PICTURE_MOTION | PICTURE_UI | (wilds[i].depth ? PICTURE_DEPTH : 0u));
	picture_fill_random(picture, PURSUIT_ROLE_COLOR, 3);
	scatter(picture, 11 * (uint32_t)i, wilds[i].range, wilds[i].patch);
	for (uint32_t y = 40; y < 60; y++)
		memset(picture_row(picture, PURSUIT_ROLE_UI, y), (int)y, 400);
}

static void check_covered(struct engine *engine, double phase)
{
	struct executor_cpu *executor = (struct executor_cpu *)engine->executor;
	struct error error;
	struct engine_image image = {NULL, 0};
	struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, phase};
	uint64_t uncovered = 0;
	executor->scene.check = true;
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	for (uint32_t i = 0; i < pool_threads(executor->base.pool); i++)
		uncovered += executor->scratch[i].uncovered;
	CHECK_INT((long)uncovered, 0);
}

static void test_covered(void)
{
	static const char *const levels[] = {"plain", "avx2", "avx512", "neon"};
	for (size_t k = 0; k < sizeof(levels) / sizeof(levels[0]); k++) {
		struct engine *engine = make(levels[k], 2);
		if (!engine)
			continue;
		for (size_t i = 0; i < WILDS; i++) {
			struct picture picture;
			struct error error;
			struct engine_begin_params begin = {.n = 4, .last_phase = -1.0};
			draw_wild(&picture, i);
			CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
			for (int step = 0; step <= 8; step++)
				check_covered(engine, step < 8 ? 0.125 * step : 8.0);
			picture_finish(&picture);
		}
		engine_destroy(&engine);
	}
}

/* Everything that the engine shows of a picture, one frame after another. */
static void show_all(struct engine *engine, const struct picture *picture, uint8_t *out)
{
	static const struct engine_request requests[] = {{ENGINE_SHOW_REAL, 0.0},       {ENGINE_SHOW_REAL, 0.3},
													 {ENGINE_SHOW_IN_BETWEEN, 0.4}, {ENGINE_SHOW_IN_BETWEEN, 0.75},
													 {ENGINE_SHOW_PLAIN, 0.0},      {ENGINE_SHOW_IN_BETWEEN, -0.6}};
	struct error error;
	struct engine_begin_params begin = {.n = 4, .last_phase = -1.0};
	CHECK_INT(engine_begin(engine, &picture->frame, &begin, &error), 0);
	for (size_t i = 0; i < sizeof(requests) / sizeof(requests[0]); i++) {
		struct engine_image image = {out, 4 * (size_t)picture->width};
		CHECK_INT(engine_render(engine, &requests[i], &image, &error), 0);
		out += 4 * (size_t)picture->width * picture->height;
	}
}

static void test_equal_bits(void)
{
	static const struct {
		const char *level;
		uint32_t threads;
	} others[] = {{"plain", 3}, {"avx2", 1}, {"avx512", 2}, {"neon", 2}, {NULL, 8}};
	struct engine *plain = make("plain", 1);
	CHECK(plain != NULL);
	for (size_t k = 0; k < sizeof(others) / sizeof(others[0]); k++) {
		struct engine *other = make(others[k].level, others[k].threads);
		for (size_t i = 0; i < WILDS + 2 && other; i++) {
			struct picture picture;
			if (i < WILDS) {
				draw_wild(&picture, i);
			} else {
				/* The second has so many triangles that threads share the work on them. */
				const uint32_t scale = i == WILDS ? 1 : 2;
				picture_init(&picture, 397 * scale, 411 * scale, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
				picture_draw_layers(&picture, 0.0);
			}
			size_t bytes = 6 * 4 * (size_t)picture.width * picture.height;
			uint8_t *a = malloc(bytes), *b = malloc(bytes);
			show_all(plain, &picture, a);
			show_all(other, &picture, b);
			CHECK(memcmp(a, b, bytes) == 0);
			free(a);
			free(b);
			picture_finish(&picture);
		}
		engine_destroy(&other);
	}
	engine_destroy(&plain);
}

static void test_no_allocation_in_the_steady_state(void)
{
	struct engine *engine = make(NULL, 2);
	uint8_t *out = calloc(6, (size_t)4 * 400 * 300);
	for (int round = 0; round < 3; round++)
		for (int i = 0; i < 6; i++) {
			struct picture picture;
			picture_init(&picture, 400, 300, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
			picture_draw_layers(&picture, i);
			unsigned before = atomic_load(&allocations);
			show_all(engine, &picture, out);
			CHECK(round == 0 || atomic_load(&allocations) == before);
			picture_finish(&picture);
		}
	CHECK(atomic_load(&allocations) > 0);
	free(out);
	engine_destroy(&engine);
}

static bool says_too_wild(struct engine *engine)
{
	const struct engine_report *report = engine_get_report(engine);
	for (uint32_t i = 0; i < report->left_out_count; i++)
		if (strcmp(report->left_out[i].name, "warp") == 0 && strcmp(report->left_out[i].reason, "too-wild") == 0)
			return true;
	return false;
}

static void show(struct engine *engine, enum engine_show what, double phase, uint8_t *out, uint32_t width)
{
	struct error error;
	const struct engine_request request = {what, phase};
	struct engine_image image = {out, 4 * (size_t)width};
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
}

/* Motion that would draw each triangle over all of the picture: shown plain, and no memory is taken for it. */
static void test_hostile_motion(void)
{
	enum { WIDTH = 1280, HEIGHT = 720 };
	struct engine *engine = make(NULL, 2);
	const struct executor_cpu *executor = (const struct executor_cpu *)engine->executor;
	const struct engine_begin_params begin = {.n = 4, .last_phase = -1.0};
	const size_t bytes = (size_t)4 * WIDTH * HEIGHT;
	uint8_t *plain = malloc(bytes), *shown = malloc(bytes);
	struct picture picture;
	struct error error;
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 3);
	for (uint32_t seed = 1; seed <= 3; seed++) {
		scatter(&picture, seed, 16000.0f, 8);
		CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
		show(engine, ENGINE_SHOW_PLAIN, 0.0, plain, WIDTH);
		CHECK(!says_too_wild(engine));
		for (int step = 1; step <= 4; step++) {
			memset(shown, 0, bytes);
			show(engine, step % 2 ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, 0.25 * step, shown, WIDTH);
			CHECK(memcmp(plain, shown, bytes) == 0);
		}
		CHECK(says_too_wild(engine));
		/* So little of it that it is bearable is drawn. */
		show(engine, ENGINE_SHOW_IN_BETWEEN, 0.0005, shown, WIDTH);
		CHECK(memcmp(plain, shown, bytes) != 0);
		CHECK(executor->scene.bins.triangle_bytes < warp_mesh_most_pixels(WIDTH, HEIGHT) / 8);
	}
	picture_finish(&picture);
	free(plain);
	free(shown);
	engine_destroy(&engine);
}

/* Images take turns, as many as presenters have; what each was left with is known when its turn comes. */
static void test_images_in_turn(void)
{
	const uint32_t images = 12;
	uint64_t held[12] = {0};
	struct contents contents = {0};
	struct error error;
	CHECK_INT(contents_begin(&contents, TILE_WIDTH, TILE_HEIGHT, false, 1, true, &error), 0);
	for (uint32_t i = 0; i < 10 * images; i++) {
		struct sheet sheet;
		contents_open(&contents, held[i % images], &sheet);
		sheet_has(&sheet, 0, contents_of(&contents, PICTURE_ORIGINAL, 0));
		held[i % images] = 2 + i;
		CHECK_INT(contents_close(&contents, held[i % images], &sheet), i < images ? 0 : TILE_PIXELS);
	}
	contents_finish(&contents);
}

/* Adds a rectangle to the counts of what covers each tile. */
static void cover(const struct tiles *tiles, const struct bounds *bounds, uint8_t *covered)
{
	CHECK(bounds->right <= tiles->width && bounds->bottom <= tiles->height);
	for (uint32_t y = bounds->top; y < bounds->bottom; y += tiles->tile_height)
		for (uint32_t x = bounds->left; x < bounds->right; x += tiles->tile_width)
			covered[y / tiles->tile_height * tiles->columns + x / tiles->tile_width]++;
}

/* Rectangles cover what is marked, nothing twice, and without a gap nothing else. */
static void test_bounds_of_tiles(void)
{
	struct tiles tiles = {0};
	struct error error;
	uint32_t random = 5;
	long wrong = 0;
	for (uint32_t round = 0; round < 400; round++) {
		const uint32_t gap = 1 + round % 4, rarity = 1 + round / 50;
		const uint32_t width = 1 + picture_random(&random) % 700, height = 1 + picture_random(&random) % 300;
		CHECK_INT(tiles_begin(&tiles, width, height, 64, 32, &error), 0);
		for (uint32_t i = 0; i < tiles.columns * tiles.rows; i++)
			tiles.marked[i] = (picture_random(&random) >> 8) % rarity == 0;
		uint8_t covered[11 * 10] = {0};
		for (struct bounds bounds = {0}; tiles_next_bounds(&tiles, gap, &bounds);)
			cover(&tiles, &bounds, covered);
		for (uint32_t i = 0; i < tiles.columns * tiles.rows; i++)
			wrong += covered[i] > 1 || (tiles.marked[i] && !covered[i]) || (gap == 1 && covered[i] != tiles.marked[i]);
	}
	CHECK_INT(wrong, 0);
	tiles_finish(&tiles);
}

static struct tile_hash hash_of(const struct tile_key *key, const uint8_t *pixels, uint32_t width, uint32_t rows)
{
	struct tile_hash hashes[3] = {0};
	for (uint32_t y = 0; y < rows; y++)
		tile_hash_row(key, y, pixels + 4 * (size_t)width * y, width, hashes);
	return hashes[(width - 1) / TILE_WIDTH];
}

/* The last of some tiles beside each other, also a narrow one: any bit of it counts, and where it is. */
static void test_hash_of_tiles(void)
{
	static const uint32_t widths[] = {64, 1, 37, 130, 192};
	static uint8_t pixels[4 * 192 * TILE_HEIGHT];
	static struct tile_key key, other;
	struct error error;
	uint32_t random = 3;
	CHECK_INT(tile_key_make(&key, &error), 0);
	CHECK_INT(tile_key_make(&other, &error), 0);
	for (size_t i = 0; i < sizeof(pixels); i++)
		pixels[i] = (uint8_t)(picture_random(&random) >> 8);
	for (size_t i = 0; i < sizeof(widths) / sizeof(widths[0]); i++) {
		const uint32_t width = widths[i], first = (width - 1) / TILE_WIDTH * TILE_WIDTH;
		const struct tile_hash want = hash_of(&key, pixels, width, TILE_HEIGHT);
		const struct tile_hash another = hash_of(&other, pixels, width, TILE_HEIGHT);
		CHECK(!tile_hash_equal(&want, &another));
		for (uint32_t k = 0; k < 300; k++) {
			const uint32_t x = first + picture_random(&random) % (width - first), y = k % TILE_HEIGHT;
			uint8_t *byte = pixels + 4 * ((size_t)width * y + x) + k % 4;
			*byte ^= (uint8_t)(1u << k % 8);
			const struct tile_hash changed = hash_of(&key, pixels, width, TILE_HEIGHT);
			*byte ^= (uint8_t)(1u << k % 8);
			CHECK(changed.halves[0] != want.halves[0] && changed.halves[1] != want.halves[1]);
		}
		const struct tile_hash same = hash_of(&key, pixels, width, TILE_HEIGHT);
		CHECK(tile_hash_equal(&want, &same));
	}
}

static void swap_pixels(uint8_t *a, uint8_t *b, size_t pixels)
{
	for (size_t i = 0; i < 4 * pixels; i++) {
		const uint8_t byte = a[i];
		a[i] = b[i];
		b[i] = byte;
	}
}

/* The same pixels at other places are another tile: rows, pixels beside each other, and those of a pair. */
static void test_hash_of_places(void)
{
	static uint8_t pixels[4 * TILE_PIXELS];
	static struct tile_key key;
	struct error error;
	uint32_t random = 4;
	CHECK_INT(tile_key_make(&key, &error), 0);
	for (size_t i = 0; i < sizeof(pixels); i++)
		pixels[i] = (uint8_t)(picture_random(&random) >> 8);
	const struct tile_hash want = hash_of(&key, pixels, TILE_WIDTH, TILE_HEIGHT);
	CHECK(want.halves[0] != want.halves[1]);
	for (uint32_t k = 0; k < 300; k++) {
		const uint32_t y = k % (TILE_HEIGHT - 1), x = k % (TILE_WIDTH / 2), what = k % 3;
		const uint32_t away = what == 0 ? TILE_WIDTH : what == 1 ? 1 : TILE_WIDTH / 2;
		uint8_t *at = pixels + 4 * (TILE_WIDTH * y + (what ? x : 0));
		swap_pixels(at, at + 4 * away, what ? 1 : TILE_WIDTH);
		const struct tile_hash changed = hash_of(&key, pixels, TILE_WIDTH, TILE_HEIGHT);
		swap_pixels(at, at + 4 * away, what ? 1 : TILE_WIDTH);
		CHECK(changed.halves[0] != want.halves[0] && changed.halves[1] != want.halves[1]);
	}
}

static void test_refuses(void)
{
	struct error error = {""};
	struct engine_params params = {.context = ENGINE_CONTEXT_CPU, .level = "mmx"};
	CHECK(engine_create(&params, &error) == NULL);
	CHECK(strstr(error.text, "mmx") != NULL);
	params = (struct engine_params){.context = ENGINE_CONTEXT_CPU, .threads = 9};
	CHECK(engine_create(&params, &error) == NULL);
	CHECK(strstr(error.text, "threads is 9") != NULL);
}

int main(void)
{
	RUN(test_pool);
	RUN(test_pool_nests);
	RUN(test_covered);
	RUN(test_equal_bits);
	RUN(test_no_allocation_in_the_steady_state);
	RUN(test_hostile_motion);
	RUN(test_images_in_turn);
	RUN(test_bounds_of_tiles);
	RUN(test_hash_of_tiles);
	RUN(test_hash_of_places);
	RUN(test_refuses);
	return test_result();
}
