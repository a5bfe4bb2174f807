/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The engine's displayed pictures against the reference, in one context:
 *
 *   test-reference-engine surfaceless-gl | surfaceless-gles | device-gl | osmesa | cpu
 *
 * Every pixel must lie in its interval (bounds.h: what may differ and why).
 * Over all cases, where only the last rounding is open, 99.9% of the pixels
 * are within one step; at most 1% show another candidate than the reference's
 * and at most 0.5% an undecided vertex; a fair share is sharp, so that the
 * intervals are known to be narrow.
 */
#include "engine-case.h"
#include "engine-context.h"
#include "input.h"
#include "tests/test.h"

static struct engine *engine;
static struct case_totals totals;

#define REQUESTS(list) .requests = list, .request_count = sizeof(list) / sizeof(list[0])

static const struct engine_request all_requests[] = {
	{ENGINE_SHOW_REAL, 0.0},       {ENGINE_SHOW_REAL, -0.05},         {ENGINE_SHOW_REAL, 0.21},
	{ENGINE_SHOW_IN_BETWEEN, 0.5}, {ENGINE_SHOW_IN_BETWEEN, 1.0 / 3}, {ENGINE_SHOW_PLAIN, 0.5},
};
static const struct engine_request few_requests[] = {
	{ENGINE_SHOW_REAL, 0.0},
	{ENGINE_SHOW_IN_BETWEEN, 0.5},
	{ENGINE_SHOW_REAL, 0.3},
	{ENGINE_SHOW_PLAIN, 0.0},
};

/* The phase of the last in-between that is asked for, as the pacer would announce it. */
static double last_phase(const struct engine_case *what)
{
	double last = 0.0;
	for (uint32_t i = 0; i < what->request_count; i++)
		last = fmax(last, what->requests[i].phase);
	return last;
}

static void run(const struct input_spec *spec, struct engine_case *what)
{
	struct input input;
	if (!(what->params.display_width_mm > 0.0f))
		what->params.display_width_mm = input_display_mm(spec->width);
	if (!what->params.method)
		what->params.method = "grid";
	if (what->begin.last_phase == 0.0)
		what->begin.last_phase = what->begin.n > 2 ? -1.0 : last_phase(what);
	input_make(&input, spec);
	CHECK(engine_case_run(engine, &input.frame, what, &totals));
	input_finish(&input);
}

static const enum input_field fields[] = {INPUT_STILL,  INPUT_TRANSLATE, INPUT_SMOOTH, INPUT_ROTATE, INPUT_ZOOM,
										  INPUT_LAYERS, INPUT_VIOLENT,   INPUT_SHAKE,  INPUT_BROKEN};
#define FIELDS (sizeof(fields) / sizeof(fields[0]))

static void test_hold(void)
{
	for (size_t f = 3; f < FIELDS; f += 2) {
		const struct input_spec spec = {.width = 61,
										.height = 40,
										.field = fields[f],
										.image = INPUT_NOISE,
										.seed = f,
										.ui_format = f & 2 ? PURSUIT_FORMAT_BGRA8 : 0};
		struct engine_case what = {.name = "hold", .params.method = "hold", .begin.n = 2, REQUESTS(all_requests)};
		run(&spec, &what);
	}
}

static void test_fields(void)
{
	char name[64];
	for (size_t f = 0; f < FIELDS; f++)
		for (uint32_t blur = 0; blur < 3; blur++)
			for (uint32_t image = 0; image < 3; image++) {
				const struct input_spec spec = {.width = 88,
												.height = 56,
												.field = fields[f],
												.image = image,
												.seed = 1 + f + 9 * blur + 27 * image};
				struct engine_case what = {.name = name, .params.blur = blur, .begin.n = 2, REQUESTS(all_requests)};
				snprintf(name, sizeof(name), "field %zu blur %u image %u", f, blur, image);
				run(&spec, &what);
			}
}

static void test_compensation(void)
{
	static const uint32_t ns[] = {1, 2, 3, 8};
	static const float gammas[] = {0.0f, 1.0f, 2.2f, 5.0f};
	static const uint64_t intervals[] = {25000000, 39000000, 55000000};
	char name[64];
	for (size_t n = 0; n < 4; n++)
		for (size_t g = 0; g < 4; g++)
			for (uint32_t how = 0; how < 4; how++) {
				const struct input_spec spec = {.width = 72,
												.height = 40,
												.field = how & 1 ? INPUT_LAYERS : INPUT_ZOOM,
												.image = (n + g + how) % 3,
												.seed = n + 4 * g,
												.real_interval_ns = intervals[how == 3 ? g % 3 : 0]};
				struct engine_case what = {
					.name = name,
					.params = {.blur = how < 2 ? ENGINE_BLUR_EVERYWHERE : ENGINE_BLUR_DOUBTFUL,
							   .curve = gammas[g] > 0.0f ? ENGINE_CURVE_GAMMA : ENGINE_CURVE_SRGB,
							   .gamma = gammas[g],
							   .no_compensation = how == 2 && n == 3},
					.begin = {.n = ns[n]},
					REQUESTS(few_requests)};
				snprintf(name, sizeof(name), "compensation n %u gamma %g how %u", ns[n], (double)gammas[g], how);
				run(&spec, &what);
			}
}

static void test_sizes(void)
{
	static const uint32_t sizes[][2] = {{1, 1}, {2, 1},   {1, 3},   {3, 2},   {7, 9}, {8, 8},
										{9, 7}, {16, 17}, {65, 33}, {131, 5}, {5, 67}};
	static const uint32_t cells[] = {0, 4, 13, 64};
	char name[64];
	for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++)
		for (size_t c = 0; c < sizeof(cells) / sizeof(cells[0]); c++) {
			const struct input_spec spec = {.width = sizes[s][0],
											.height = sizes[s][1],
											.field = fields[1 + (s + c) % 8],
											.image = (s + 2 * c) % 3,
											.seed = 1 + s + 3 * c,
											.ui_format = s & 1 ? PURSUIT_FORMAT_RGBA8 : 0};
			struct engine_case what = {.name = name,
									   .params = {.cell = cells[c],
												  .blur_level = (uint32_t)(1 + (s + c) % 6),
												  .threshold_quarter = c == 2 ? 9 : 0,
												  .blur = (enum engine_blur)(c & 1)},
									   .begin.n = 3,
									   REQUESTS(few_requests)};
			snprintf(name, sizeof(name), "size %ux%u cell %u level %u field %d", sizes[s][0], sizes[s][1], cells[c],
					 what.params.blur_level, spec.field);
			run(&spec, &what);
		}
}

static void test_color_formats(void)
{
	static const uint32_t formats[] = {PURSUIT_FORMAT_BGRA8, PURSUIT_FORMAT_RGBA8, PURSUIT_FORMAT_RGB10A2,
									   PURSUIT_FORMAT_RGBA16F};
	static const struct pursuit_transfer transfers[] = {
		{.curve = PURSUIT_CURVE_SRGB},
		{.curve = PURSUIT_CURVE_LINEAR},
		{.curve = PURSUIT_CURVE_GAMMA, .gamma = 2.2f},
		{.curve = PURSUIT_CURVE_LINEAR, .black = 0.05f, .peak = 0.7f},
		{.curve = PURSUIT_CURVE_GAMMA, .gamma = 4.5f, .black = -0.1f, .peak = 2.0f}};
	char name[64];
	for (size_t f = 0; f < 4; f++)
		for (size_t t = 0; t < 5; t++) {
			const struct input_spec spec = {.width = 50,
											.height = 31,
											.field = INPUT_LAYERS,
											.image = t % 3,
											.seed = 7 + f,
											.color_format = formats[f],
											.transfer = transfers[t],
											.ui_format = f & 1 ? PURSUIT_FORMAT_BGRA8 : PURSUIT_FORMAT_RGBA8};
			struct engine_case what = {.name = name,
									   .params = {.curve = t & 1, .gamma = t & 1 ? 1.8f : 0.0f},
									   .begin.n = 2,
									   REQUESTS(few_requests)};
			snprintf(name, sizeof(name), "colour format %u transfer %zu", formats[f], t);
			run(&spec, &what);
		}
}

static void test_geometry_formats(void)
{
	static const uint32_t depths[][2] = {{PURSUIT_FORMAT_DEPTH16, PURSUIT_DEPTH_DEVICE},
										 {PURSUIT_FORMAT_DEPTH24, PURSUIT_DEPTH_DEVICE_REVERSED},
										 {PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_DEVICE_REVERSED},
										 {PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_LINEAR},
										 {PURSUIT_FORMAT_DEPTH24, PURSUIT_DEPTH_DEVICE}};
	char name[64];
	for (size_t d = 0; d < 5; d++)
		for (uint32_t m = 0; m < 4; m++) {
			const struct input_spec spec = {.width = 84,
											.height = 45,
											.field = m == 3 ? INPUT_SHAKE : INPUT_LAYERS,
											.image = m % 3,
											.seed = 40 + d,
											.motion_format = m & 1 ? PURSUIT_FORMAT_RG16F : PURSUIT_FORMAT_RG32F,
											.motion_kind = m >= 2 ? PURSUIT_MOTION_FORWARD : PURSUIT_MOTION_BACKWARD,
											.motion_width = m == 2 ? 42 : 0,
											.motion_height = m == 2 ? 23 : 0,
											.depth_format = depths[d][0],
											.depth_kind = depths[d][1],
											.depth_width = m == 1 ? 100 : 0,
											.depth_height = m == 1 ? 90 : 0,
											.near_distance = 0.1f,
											.far_distance = m & 1 ? INFINITY : 40.0f,
											.motion_interval_ns = m == 0 ? 12000000 : 0,
											.no_depth = d == 4 && m == 3};
			struct engine_case what = {
				.name = name, .begin = {.n = 3, .real_interval_ns = m == 2 ? 20000000 : 0}, REQUESTS(few_requests)};
			snprintf(name, sizeof(name), "depth %u kind %u motion %u", depths[d][0], depths[d][1], m);
			run(&spec, &what);
		}
}

/* Folds without depth: the first in drawing order shows. */
static void test_order(void)
{
	char name[64];
	for (uint64_t seed = 1; seed <= 6; seed++) {
		const struct input_spec spec = {.width = 90,
										.height = 50,
										.field = seed % 3 ? INPUT_LAYERS : INPUT_SHAKE,
										.image = INPUT_EDGES,
										.seed = 60 + seed,
										.no_depth = true};
		struct engine_case what = {.name = name, .params.blur = ENGINE_BLUR_OFF, .begin.n = 2, REQUESTS(all_requests)};
		snprintf(name, sizeof(name), "order %u", (unsigned)seed);
		run(&spec, &what);
	}
}

/* Frames that rest, one after another in one engine with frames that move: nothing may be left over. */
static void test_rest(void)
{
	char name[64];
	for (int i = 0; i < 12; i++) {
		const struct input_spec spec = {.width = 60,
										.height = 34,
										.field = i % 6 == 4 ? INPUT_STILL : INPUT_LAYERS,
										.image = INPUT_EDGES,
										.seed = (uint64_t)i,
										.flags = i % 6 == 0   ? PURSUIT_FRAME_CUT
												 : i % 6 == 1 ? PURSUIT_FRAME_MOTION_INVALID
															  : 0,
										.no_motion = i % 6 == 2,
										.real_interval_ns = i % 6 == 3};
		struct engine_case what = {.name = name,
								   .params.blur = i / 6 ? ENGINE_BLUR_EVERYWHERE : ENGINE_BLUR_DOUBTFUL,
								   .begin.n = 2,
								   REQUESTS(all_requests)};
		snprintf(name, sizeof(name), "rest %d", i);
		run(&spec, &what);
	}
}

/* L alone: everything blurred, not compensated, shown where it is. Exact but for halves in the pyramid. */
static void test_low_frequency_layer(void)
{
	static const struct engine_request here[] = {{ENGINE_SHOW_IN_BETWEEN, 0.0}};
	char name[64];
	for (uint32_t level = 1; level <= 6; level++)
		for (uint32_t image = 0; image < 3; image++) {
			struct case_totals before = totals;
			const struct input_spec spec = {
				.width = 90 + level, .height = 64 - level, .field = INPUT_TRANSLATE, .image = image, .seed = level};
			struct engine_case what = {
				.name = name,
				.params = {.blur = ENGINE_BLUR_EVERYWHERE, .no_compensation = true, .blur_level = level},
				.begin.n = 2,
				REQUESTS(here)};
			snprintf(name, sizeof(name), "L level %u image %u", level, image);
			run(&spec, &what);
			const struct bounds_report *now = &totals.reports[1], *then = &before.reports[1];
			CHECK_INT(now->within_one - then->within_one, now->pixels - then->pixels);
			/* Sums are sixteenths, so a texel in 16 is a half at each level, and high levels spread one far. */
			if (level <= 3)
				CHECK((double)(now->same - then->same) >=
					  (1.0 - (level + 1) / 16.0) * (double)(now->pixels - then->pixels));
		}
}

/* Later than announced (a late real frame), and earlier than the real frame. */
static void test_beyond_last_phase(void)
{
	static const struct engine_request beyond[] = {{ENGINE_SHOW_IN_BETWEEN, 1.0},  {ENGINE_SHOW_IN_BETWEEN, 2.5},
												   {ENGINE_SHOW_REAL, -0.4},       {ENGINE_SHOW_REAL, 1.0},
												   {ENGINE_SHOW_IN_BETWEEN, -1.0}, {ENGINE_SHOW_IN_BETWEEN, 8.0}};
	char name[64];
	for (size_t f = 1; f < FIELDS; f++)
		for (uint32_t blur = 0; blur < 3; blur++) {
			const struct input_spec spec = {
				.width = 88, .height = 56, .field = fields[f], .image = INPUT_EDGES, .seed = 100 + f};
			struct engine_case what = {.name = name,
									   .params.blur = blur,
									   .begin = {.n = 2, .last_phase = blur == 2 ? 0.05 : 0.5},
									   REQUESTS(beyond)};
			snprintf(name, sizeof(name), "beyond field %zu blur %u", f, blur);
			run(&spec, &what);
		}
}

/* Everything at once, by dice. */
static void test_random(void)
{
	uint64_t dice = 20100503;
	char name[64];
	for (uint32_t i = 0; i < 100; i++) {
		const uint64_t a = input_random(&dice), b = input_random(&dice);
		const struct input_spec spec = {.width = 1 + (uint32_t)(a % 120),
										.height = 1 + (uint32_t)((a >> 8) % 70),
										.seed = i,
										.field = fields[(a >> 16) % FIELDS],
										.image = (a >> 24) % 3,
										.color_format = 1 + (uint32_t)((a >> 32) % 4),
										.motion_format = 32 + (uint32_t)((a >> 36) % 2),
										.depth_format = 16 + (uint32_t)((a >> 40) % 3),
										.depth_kind = 1 + (uint32_t)((a >> 44) % 2),
										.no_depth = (a >> 48) % 8 == 0,
										.motion_kind = 1 + (uint32_t)((a >> 52) % 2),
										.ui_format = (uint32_t)((a >> 56) % 3)};
		const struct engine_request requests[] = {{ENGINE_SHOW_REAL, 0.5 * input_uniform(&dice)},
												  {ENGINE_SHOW_IN_BETWEEN, 1.5 * input_uniform(&dice)},
												  {ENGINE_SHOW_IN_BETWEEN, 0.5},
												  {ENGINE_SHOW_REAL, 0.0}};
		struct engine_case what = {.name = name,
								   .params = {.blur = b % 4 == 3 ? ENGINE_BLUR_DOUBTFUL : b % 4,
											  .no_compensation = (b >> 8) % 5 == 0,
											  .cell = 4 + (uint32_t)((b >> 16) % 20),
											  .blur_level = 1 + (uint32_t)((b >> 24) % 4),
											  .curve = (b >> 32) % 2,
											  .gamma = (b >> 32) % 2 ? 1.0f + (float)((b >> 40) % 40) / 10.0f : 0.0f},
								   .begin = {.n = (uint32_t)((b >> 48) % 10), .last_phase = 1.5},
								   REQUESTS(requests)};
		snprintf(name, sizeof(name), "random %u", i);
		run(&spec, &what);
	}
}

static void test_shares(void)
{
	case_totals_print(&totals);
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
	if (argc != 2) {
		fprintf(stderr, "usage: %s " ENGINE_CONTEXT_USAGE "\n", argv[0]);
		return 2;
	}
	engine = engine_context_open(argv[1], "grid");
	RUN(test_hold);
	RUN(test_fields);
	RUN(test_compensation);
	RUN(test_sizes);
	RUN(test_color_formats);
	RUN(test_geometry_formats);
	RUN(test_order);
	RUN(test_rest);
	RUN(test_low_frequency_layer);
	RUN(test_beyond_last_phase);
	RUN(test_random);
	RUN(test_shares);
	engine_destroy(&engine);
	return test_result();
}
