/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the quadratic motion model takes for the motion of the frame before (docs/method.md, 10). */
#include "tests/test.h"

#include "daemon/engine/state.h"
#include "tests/engine/picture.h"

#define WIDTH 96u
#define HEIGHT 64u
#define STRIDE (4u * WIDTH)

static struct engine *make_engine(enum engine_motion_model model)
{
	struct error error;
	/* Pixels of common size, so that motion of some of them can be tracked. */
	const struct engine_params params = {
		.context = ENGINE_CONTEXT_CPU, .motion_model = model, .threads = 1, .display_width_mm = 27.0f};
	return engine_create(&params, &error);
}

/* Another picture, which moves as a whole. */
static void move(const struct picture *picture, uint32_t seed, float by)
{
	picture_fill_random(picture, PURSUIT_ROLE_COLOR, seed);
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			picture_set_motion(picture, x, y, by, 0.0f);
}

static void begin(struct engine *engine, struct picture *picture, uint64_t frame_id)
{
	struct error error;
	const struct engine_begin_params params = {.n = 2, .last_phase = -1.0};
	picture->frame.stream = 3;
	picture->frame.header.frame_id = frame_id;
	CHECK_INT(engine_begin(engine, &picture->frame, &params, &error), 0);
}

static void draw_between(struct engine *engine, uint8_t *pixels)
{
	struct error error;
	const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, 0.5};
	struct engine_image image = {.data = pixels, .stride = STRIDE};
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
}

/* Does the third of three frames bend, whose second is as the first, its motion plane too, and `said` to be? */
static bool bends_after(bool same, bool said)
{
	static uint8_t bent[STRIDE * HEIGHT], straight[STRIDE * HEIGHT];
	struct engine *quadratic = make_engine(ENGINE_MOTION_QUADRATIC), *linear = make_engine(ENGINE_MOTION_LINEAR);
	struct picture picture;
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION);
	move(&picture, 1, 1.5f);
	begin(quadratic, &picture, 1);
	if (!same)
		move(&picture, 2, 1.5f);
	if (said) {
		picture.frame.header.flags = PURSUIT_FRAME_DAMAGE;
		picture.frame.header.damage_since = 1;
	}
	begin(quadratic, &picture, 2);
	picture.frame.header.flags = 0;
	picture.frame.header.damage_since = 0;
	move(&picture, 3, 2.0f);
	begin(quadratic, &picture, 3);
	begin(linear, &picture, 3);
	draw_between(quadratic, bent);
	draw_between(linear, straight);
	picture_finish(&picture);
	engine_destroy(&quadratic);
	engine_destroy(&linear);
	return memcmp(bent, straight, sizeof(bent)) != 0;
}

static void test_motion_that_changes(void)
{
	CHECK(bends_after(false, false));
}

/* It stood still, whatever its motion plane says still: 2 pixels after none are a jerk. */
static void test_unchanged_frame_stood_still(void)
{
	CHECK(!bends_after(true, true));
}

/* ---- frames that are no neighbours ---- */

#define T_NS UINT64_C(25000000)

/* How a frame differs from one that is the next, T after the one before. */
struct step {
	float motion; /* pixels that all moves by */
	uint64_t id;
	uint64_t time_ns, real_ns, motion_ns;
	uint32_t flags;
	bool forward, small;
};

static void take(struct engine *engine, const struct step *step)
{
	struct picture picture;
	picture_init(&picture, WIDTH, step->small ? HEIGHT / 2 : HEIGHT, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 5);
	for (uint32_t y = 0; y < picture.height; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			picture_set_motion(&picture, x, y, step->motion, 0.0f);
	struct pursuit_frame_header *header = &picture.frame.header;
	header->flags = step->flags;
	header->time_ns = step->time_ns;
	header->real_interval_ns = step->real_ns;
	header->motion_interval_ns = step->motion_ns;
	header->motion_kind = step->forward ? PURSUIT_MOTION_FORWARD : PURSUIT_MOTION_BACKWARD;
	begin(engine, &picture, step->id);
	picture_finish(&picture);
}

/* Why the frame begun last did not bend; "" if it did. */
static const char *reason_of(struct engine *engine)
{
	const struct engine_report *report = engine_get_report(engine);
	for (uint32_t i = 0; i < report->left_out_count; i++)
		if (strcmp(report->left_out[i].name, "acceleration") == 0)
			return report->left_out[i].reason;
	return "";
}

static const char *reason_after(const struct step *before, const struct step *now)
{
	struct engine *engine = make_engine(ENGINE_MOTION_QUADRATIC);
	take(engine, before);
	take(engine, now);
	const char *reason = reason_of(engine);
	engine_destroy(&engine);
	return reason;
}

static const struct step first = {.motion = 3.0f, .id = 7, .time_ns = 100 * T_NS, .real_ns = T_NS};
static const struct step second = {.motion = 4.0f, .id = 8, .time_ns = 101 * T_NS, .real_ns = T_NS};

static void check_reason(const char *reason, struct step before, struct step now)
{
	CHECK_STRING(reason_after(&before, &now), reason);
}

static void test_reasons(void)
{
	struct engine *engine = make_engine(ENGINE_MOTION_QUADRATIC);
	struct step now = second, before = first;
	take(engine, &first);
	CHECK_STRING(reason_of(engine), "first");
	engine_destroy(&engine);
	check_reason("", first, second);
	now.motion = 3.0f;
	check_reason("no-change", first, now);
	now = second;
	now.small = true;
	check_reason("size", first, now);
	now = second;
	now.forward = true;
	check_reason("forward", first, now);
	before.forward = true;
	check_reason("forward", before, second);
	before = first;
	before.flags = PURSUIT_FRAME_CUT;
	check_reason("cut", before, second);
	before.flags = PURSUIT_FRAME_MOTION_INVALID;
	check_reason("motion-invalid", before, second);
}

/* What times say counts, of neighbours the interval before them; without any only neighbours are known to be T apart.
 */
static void test_times(void)
{
	struct step now = second, before = first;
	now.id = 9;
	now.time_ns = 102 * T_NS;
	check_reason("", first, now);
	now.time_ns = 108 * T_NS;
	check_reason("", first, now);
	now.time_ns = 109 * T_NS;
	check_reason("frames-lost", first, now);
	now.time_ns = first.time_ns;
	check_reason("frames-lost", first, now);
	now.time_ns = first.time_ns - 1;
	check_reason("frames-lost", first, now);
	now.time_ns = 0;
	check_reason("frames-lost", first, now);
	before.time_ns = 0;
	check_reason("frames-lost", before, now);
	now.id = 8;
	check_reason("", before, now);
	now.id = 7;
	check_reason("not-later", first, now);
	now.id = 1;
	check_reason("not-later", first, now);
	now = second;
	now.real_ns = 1;
	now.motion_ns = T_NS;
	check_reason("intervals", first, now);
	before = first;
	before.motion_ns = 1;
	check_reason("intervals", before, second);
	before.motion_ns = 1000 * T_NS;
	check_reason("intervals", before, second);
}

static void draw_after(const struct step *before, const struct step *now, uint8_t *pixels)
{
	struct engine *engine = make_engine(ENGINE_MOTION_QUADRATIC);
	take(engine, before);
	take(engine, now);
	draw_between(engine, pixels);
	engine_destroy(&engine);
}

/* Where the older of two frames shows what is here, several steps to the left. */
static bool same_right_half(const uint8_t *a, const uint8_t *b)
{
	for (uint32_t y = 0; y < HEIGHT; y++)
		if (memcmp(a + (size_t)STRIDE * y + STRIDE / 2, b + (size_t)STRIDE * y + STRIDE / 2, STRIDE / 2) != 0)
			return false;
	return true;
}

/* Two frames, so many intervals apart, of which the first moves by so much and the second by 8 pixels. */
struct pair {
	float motion;
	uint64_t motion_ns; /* that the first's spans; 0: unknown */
	uint64_t apart;
};

static void draw_pair(const struct pair *pair, uint8_t *pixels)
{
	struct step before = first, now = second;
	before.motion = pair->motion;
	before.motion_ns = pair->motion_ns;
	now.motion = 8.0f;
	now.id = first.id + pair->apart;
	now.time_ns = first.time_ns + pair->apart * T_NS;
	draw_after(&before, &now, pixels);
}

/* What speeds up evenly is followed as well when frames between were lost, or motion spans another time. */
static void test_lost_frames(void)
{
	static const struct pair neighbours = {7.5f, 0, 1};
	static const struct {
		struct pair pair;
		bool same;
	} cases[] = {
		{{7.0f, 0, 2}, true},
		{{6.0f, 0, 4}, true},
		/* The same at twice the speed of the middle of two intervals. */
		{{14.5f, 2 * T_NS, 1}, true},
		{{7.0f, 0, 1}, false},
	};
	static uint8_t next[STRIDE * HEIGHT], other[STRIDE * HEIGHT];
	draw_pair(&neighbours, next);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		draw_pair(&cases[i].pair, other);
		CHECK_INT(same_right_half(next, other), cases[i].same);
	}
}

/* ---- anything ---- */

static float any_motion(uint32_t *seed)
{
	static const float values[] = {0.0f, -0.0f, 1e-42f, 0.5f, -3.0f, 17.0f, 65504.0f, -1e30f, INFINITY, -INFINITY, NAN};
	const uint32_t bits = picture_random(seed) >> 8;
	return values[bits % (sizeof(values) / sizeof(values[0]))];
}

static uint64_t any_time(uint32_t *seed)
{
	static const uint64_t values[] = {0,        1,        1000000,           T_NS - 3000000, T_NS, T_NS + 9000000,
									  8 * T_NS, 9 * T_NS, UINT64_C(1) << 62, UINT64_MAX};
	return values[(picture_random(seed) >> 8) % (sizeof(values) / sizeof(values[0]))];
}

static void check_finite(const struct plan *plan)
{
	int wrong = 0;
	for (uint32_t i = 0; i < plan->columns * plan->rows; i++)
		wrong += !isfinite(plan->vertices[i].ux) || !isfinite(plan->vertices[i].uy);
	CHECK_INT(wrong, 0);
}

static void test_anything(void)
{
	static const double phases[] = {-1.0, 0.0, 0.5, 1.0, 7.5, 8.0, 1e9, NAN};
	static uint8_t pixels[STRIDE * HEIGHT];
	struct engine *engine = make_engine(ENGINE_MOTION_QUADRATIC);
	uint32_t seed = 11;
	for (int round = 0; round < 200; round++) {
		struct picture picture;
		struct error error;
		picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION);
		const uint32_t patch = 1 + (picture_random(&seed) >> 8) % WIDTH;
		for (uint32_t y = 0; y < HEIGHT; y++)
			for (uint32_t x = 0; x < WIDTH; x += patch) {
				const float mx = any_motion(&seed), my = any_motion(&seed);
				for (uint32_t i = x; i < x + patch && i < WIDTH; i++)
					picture_set_motion(&picture, i, y, mx, my);
			}
		struct pursuit_frame_header *header = &picture.frame.header;
		header->frame_id = 1 + any_time(&seed) / 2;
		header->time_ns = any_time(&seed);
		header->real_interval_ns = any_time(&seed);
		header->motion_interval_ns = any_time(&seed);
		const struct engine_begin_params params = {
			.n = 8, .last_phase = 8.0 * (round & 1), .real_interval_ns = round % 3 ? 0 : any_time(&seed)};
		const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, phases[round % 8]};
		struct engine_image image = {.data = pixels, .stride = STRIDE};
		picture.frame.stream = 3;
		CHECK_INT(engine_begin(engine, &picture.frame, &params, &error), 0);
		check_finite(&engine->plan);
		CHECK_INT(engine_render(engine, &request, &image, &error), 0);
		check_finite(&engine->plan);
		picture_finish(&picture);
	}
	engine_destroy(&engine);
}

/* ---- what is kept of it ---- */

/* Floats of large pictures as half floats, to the nearest; numbers beyond them as the largest. */
static void test_motion_of_large_pictures(void)
{
	static const float values[][2] = {{1.0f, 1.0f},        {1.00048828125f, 1.0f}, {1.001f, 1.0009765625f},
									  {-1e30f, -65504.0f}, {1e-30f, 0.0f},         {NAN, 0.0f}};
	const struct plan_scale scale = {.ratio = 0.125f, .degrees = 0.0f};
	struct plan_motion_plane plane = {0};
	struct picture picture;
	picture_init(&picture, 1024, 576, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION);
	for (uint32_t i = 0; i < 6; i++)
		picture_set_motion(&picture, i, 3, values[i][0], 2.0f);
	CHECK(plan_motion_plane_take(&plane, &picture.frame, plan_level_kernels(plan_level_best()), NULL));
	CHECK(plan_motion_plane_bytes(&plane) <= UINT64_C(4) * 1024 * 576 + 8192);
	for (uint32_t i = 0; i < 6; i++) {
		float ux, uy;
		plan_motion_plane_get(&plane, i, 3, &scale, &ux, &uy);
		CHECK(ux == 0.125f * values[i][1] && uy == (isnan(values[i][0]) ? 0.0f : 0.25f));
	}
	picture_finish(&picture);
	plan_motion_plane_finish(&plane);
}

/* ---- threads ---- */

/* Things that turn and lie beside each other, in a plane that is copied before it is looked at. */
static void turn(struct picture *picture, uint32_t seed, float by)
{
	picture_fill_random(picture, PURSUIT_ROLE_COLOR, seed);
	for (uint32_t y = 0; y < picture->height; y++)
		for (uint32_t x = 0; x < picture->width; x++) {
			const float thing = (float)((x / 37 + y / 23) % 3);
			picture_set_motion(picture, x, y, thing + by * (float)y / 100.0f, by * (float)x / 100.0f);
		}
	picture->frame.volatile_memory = true;
}

/* The third of three frames, by one thread and by some. */
static void check_threads(struct picture *picture, uint32_t threads)
{
	const struct engine_params params = {.context = ENGINE_CONTEXT_CPU,
										 .motion_model = ENGINE_MOTION_QUADRATIC,
										 .threads = threads,
										 .display_width_mm = 27.0f};
	struct error error;
	struct engine *one = make_engine(ENGINE_MOTION_QUADRATIC), *some = engine_create(&params, &error);
	for (uint32_t i = 0; i < 3; i++) {
		turn(picture, 1 + i, 2.0f + 0.3f * (float)i);
		begin(one, picture, 1 + i);
		begin(some, picture, 1 + i);
	}
	const size_t count = one->plan.columns * one->plan.rows;
	const struct plan_motion_plane *a = &one->bend.before.motion, *b = &some->bend.before.motion;
	CHECK(one->bend.bent > count / 4);
	CHECK_INT(some->bend.bent, one->bend.bent);
	CHECK(memcmp(some->bend.straight, one->bend.straight, count * sizeof(*one->bend.straight)) == 0);
	CHECK(memcmp(some->bend.change, one->bend.change, count * sizeof(*one->bend.change)) == 0);
	CHECK(a->width == picture->width && a->height == picture->height && a->half == b->half);
	CHECK(memcmp(a->pixels, b->pixels, (a->half ? 4 : 8) * (size_t)a->width * a->height) == 0);
	engine_destroy(&one);
	engine_destroy(&some);
}

static void test_threads(void)
{
	static const uint32_t sizes[][2] = {{WIDTH, HEIGHT}, {301, 170}, {1024, 576}};
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
		for (uint32_t threads = 2; threads <= 8; threads += 3) {
			struct picture picture;
			picture_init(&picture, sizes[i][0], sizes[i][1], PURSUIT_FORMAT_BGRA8, PICTURE_MOTION);
			check_threads(&picture, threads);
			picture_finish(&picture);
		}
}

int main(void)
{
	RUN(test_motion_that_changes);
	RUN(test_unchanged_frame_stood_still);
	RUN(test_reasons);
	RUN(test_times);
	RUN(test_lost_frames);
	RUN(test_anything);
	RUN(test_motion_of_large_pictures);
	RUN(test_threads);
	return test_result();
}
