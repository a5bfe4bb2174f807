/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The methods other than `grid` against the reference, in one context:
 *
 *   test-reference-methods CONTEXT
 *
 * A pixel may be off by half a step and what float loses; where float may have
 * decided otherwise (pixels.h) anything goes, and such pixels are few. What is
 * the original must be it, bit for bit.
 */
#include "engine-case.h"
#include "engine-context.h"
#include "input.h"
#include "pixels.h"
#include "tests/test.h"

#define STEP 0.52
#define MOST_OPEN 0.02

static struct engine *engine;
static double open_pixels, all_pixels;

/* A frame and the one before it. */
struct pair {
	struct input now, before;
	struct reference reference, previous;
	uint8_t *shown;
};

static struct engine_params params_of(const struct pair *pair, const char *method)
{
	return (struct engine_params){.method = method,
								  .display_width_mm = input_display_mm(pair->now.frame.header.planes[0].width)};
}

static void pair_make(struct pair *pair, const char *method, const struct input_spec *spec)
{
	const struct engine_begin_params begin = {.n = 3, .last_phase = -1.0};
	struct input_spec earlier = *spec;
	struct error error = {""};
	earlier.seed += 1000;
	*pair = (struct pair){0};
	input_make(&pair->now, spec);
	input_make(&pair->before, &earlier);
	const struct engine_params params = params_of(pair, method);
	reference_begin(&pair->reference, &pair->now.frame, &params, &begin);
	reference_begin(&pair->previous, &pair->before.frame, &params, &begin);
	pair->shown = reference_alloc((size_t)spec->width * spec->height, 4);
	/* Another method between forgets what the last pair left. */
	CHECK_INT(engine_set_params(engine, &(struct engine_params){.method = "hold"}, &error), 0);
	CHECK_INT(engine_set_params(engine, &params, &error), 0);
	CHECK_INT(engine_begin(engine, &pair->before.frame, &begin, &error), 0);
	CHECK_INT(engine_begin(engine, &pair->now.frame, &begin, &error), 0);
	CHECK_STRING(error.text, "");
}

static void pair_finish(struct pair *pair)
{
	input_finish(&pair->now);
	input_finish(&pair->before);
	reference_finish(&pair->reference);
	reference_finish(&pair->previous);
	free(pair->shown);
}

static void show(const struct pair *pair, enum engine_show what, double phase)
{
	struct engine_image image = {pair->shown, 4 * (size_t)pair->reference.width};
	struct error error = {""};
	CHECK_INT(engine_render(engine, &(struct engine_request){what, phase}, &image, &error), 0);
	CHECK_STRING(error.text, "");
}

/* The UI over a colour in steps, before rounding. */
static double with_ui(const struct reference *reference, double steps, size_t at, size_t c)
{
	const double under = reference_code8(steps / 255.0, 0.0) / 255.0;
	if (!reference->has_ui)
		return steps;
	const uint8_t *ui = &reference->ui.data[4 * at];
	return 255.0 * reference_over(ui[c] / 255.0, ui[3] / 255.0, under);
}

static void check_steps(const struct pair *pair, const char *what, const struct reference_steps *want)
{
	const size_t count = (size_t)want->width * want->height;
	/* Over UI a step below may become one above, by a blend of its own rounding. */
	const double most = pair->reference.has_ui ? 1.02 + STEP : STEP;
	size_t wrong = 0;
	double worst = 0.0;
	for (size_t at = 0; at < count; at++) {
		open_pixels += want->open[at] != 0;
		for (size_t c = 0; c < 3 && !want->open[at]; c++) {
			const double wanted = with_ui(&pair->reference, want->values[3 * at + c], at, c);
			const double off = fabs(pair->shown[4 * at + c] - fmax(0.0, fmin(255.0, wanted)));
			worst = fmax(worst, off);
			wrong += off > most;
		}
	}
	all_pixels += (double)count;
	if (wrong)
		fprintf(stderr, "%s: %zu channels off, worst by %.3f steps\n", what, wrong, worst);
	CHECK_INT(wrong, 0);
}

static void check_picture(const struct pair *pair, const char *what, const struct reference_picture *want)
{
	struct reference_steps steps = {0};
	reference_steps_init(&steps, want->width, want->height);
	for (size_t i = 0; i < 3 * (size_t)want->width * want->height; i++)
		steps.values[i] = want->data[4 * (i / 3) + i % 3];
	check_steps(pair, what, &steps);
	reference_steps_finish(&steps);
}

static const enum input_field fields[] = {INPUT_STILL,  INPUT_TRANSLATE, INPUT_SMOOTH, INPUT_ROTATE, INPUT_ZOOM,
										  INPUT_LAYERS, INPUT_VIOLENT,   INPUT_SHAKE,  INPUT_BROKEN};
#define FIELDS (sizeof(fields) / sizeof(fields[0]))

static struct input_spec spec_of(size_t f)
{
	static const uint32_t sizes[][2] = {{88, 56}, {61, 40}, {7, 5}, {1, 1}, {130, 3}};
	return (struct input_spec){.width = sizes[f % 5][0],
							   .height = sizes[f % 5][1],
							   .field = fields[f % FIELDS],
							   .image = f % 3,
							   .seed = 1 + f,
							   .ui_format = f % 4 == 3 ? PURSUIT_FORMAT_BGRA8 : 0};
}

static void test_black(void)
{
	for (size_t f = 0; f < 5; f++) {
		struct pair pair;
		struct reference_picture black = {0};
		const struct input_spec spec = spec_of(f);
		pair_make(&pair, "black", &spec);
		reference_picture_init(&black, spec.width, spec.height);
		show(&pair, ENGINE_SHOW_REAL, 0.3);
		check_picture(&pair, "black: real", &pair.reference.original);
		show(&pair, ENGINE_SHOW_IN_BETWEEN, 0.5);
		check_picture(&pair, "black: in-between", &black);
		show(&pair, ENGINE_SHOW_PLAIN, 0.5);
		check_picture(&pair, "black: plain", &pair.reference.original);
		reference_picture_finish(&black);
		pair_finish(&pair);
	}
}

static void test_blur_hold(void)
{
	static const struct engine_request requests[] = {
		{ENGINE_SHOW_REAL, 0.0}, {ENGINE_SHOW_REAL, 0.3}, {ENGINE_SHOW_IN_BETWEEN, 0.5}, {ENGINE_SHOW_PLAIN, 0.5}};
	struct case_totals totals = {0};
	for (size_t f = 0; f < 2 * FIELDS; f++) {
		struct input input;
		const struct input_spec spec = spec_of(f);
		const struct engine_case what = {
			.name = "blur-hold",
			.params = {.method = "blur-hold",
					   .blur = (enum engine_blur)(f % 3),
					   .curve = f & 1 ? ENGINE_CURVE_GAMMA : ENGINE_CURVE_SRGB,
					   .gamma = f & 1 ? 2.2f : 0.0f,
					   .display_width_mm = input_display_mm(spec.width)},
			.begin = {.n = (uint32_t)(1 + f % 4), .last_phase = -1.0},
			.requests = requests,
			.request_count = 4,
		};
		input_make(&input, &spec);
		CHECK(engine_case_run(engine, &input.frame, &what, &totals));
		input_finish(&input);
	}
}

static void test_mcif(void)
{
	for (size_t f = 0; f < 2 * FIELDS; f++) {
		struct pair pair;
		struct reference_steps want = {0};
		const struct input_spec spec = spec_of(f);
		pair_make(&pair, "mcif", &spec);
		reference_mcif(&pair.reference.geometry, &pair.reference.original, &want);
		show(&pair, ENGINE_SHOW_REAL, 0.0);
		check_steps(&pair, "mcif: real", &want);
		show(&pair, ENGINE_SHOW_IN_BETWEEN, 0.66);
		check_steps(&pair, "mcif: in-between", &want);
		show(&pair, ENGINE_SHOW_PLAIN, 0.66);
		check_picture(&pair, "mcif: plain", &pair.reference.original);
		reference_steps_finish(&want);
		pair_finish(&pair);
	}
}

static void test_scatter(void)
{
	for (size_t f = 0; f < 2 * FIELDS; f++) {
		struct pair pair;
		struct reference_steps want = {0};
		const struct input_spec spec = spec_of(f);
		pair_make(&pair, "scatter", &spec);
		show(&pair, ENGINE_SHOW_REAL, 0.04);
		check_picture(&pair, "scatter: real", &pair.reference.original);
		show(&pair, ENGINE_SHOW_REAL, 0.31);
		reference_scattered(&pair.reference.geometry, &pair.reference.original, 0.31, &want);
		check_steps(&pair, "scatter: real, late", &want);
		show(&pair, ENGINE_SHOW_IN_BETWEEN, 0.6667);
		reference_scattered(&pair.reference.geometry, &pair.reference.original, 0.6667, &want);
		check_steps(&pair, "scatter: in-between", &want);
		reference_steps_finish(&want);
		pair_finish(&pair);
	}
}

static void test_interpolate(void)
{
	for (size_t f = 0; f < 2 * FIELDS; f++) {
		struct pair pair;
		struct reference_steps want = {0};
		const struct input_spec spec = spec_of(f);
		pair_make(&pair, "interpolate", &spec);
		show(&pair, ENGINE_SHOW_REAL, 0.0);
		check_picture(&pair, "interpolate: real", &pair.previous.original);
		show(&pair, ENGINE_SHOW_PLAIN, 0.5);
		check_picture(&pair, "interpolate: plain", &pair.previous.original);
		for (int k = 0; k < 3; k++) {
			static const double phases[] = {0.3337, 0.6667, 1.3};
			const double share = fmin(phases[k], 1.0);
			show(&pair, ENGINE_SHOW_IN_BETWEEN, phases[k]);
			reference_interpolated(&pair.reference.geometry, &pair.reference.original, &pair.previous.geometry,
								   &pair.previous.original, share, &want);
			check_steps(&pair, "interpolate: in-between", &want);
		}
		reference_steps_finish(&want);
		pair_finish(&pair);
	}
}

/* The first frame, a cut, another size: there is nothing between. */
static void test_interpolate_without_before(void)
{
	const struct engine_begin_params begin = {.n = 3, .last_phase = -1.0};
	struct error error = {""};
	struct pair pair;
	struct input small;
	struct input_spec spec = spec_of(5);
	spec.flags = PURSUIT_FRAME_CUT;
	pair_make(&pair, "interpolate", &spec);
	show(&pair, ENGINE_SHOW_IN_BETWEEN, 0.5);
	check_picture(&pair, "a cut holds the frame before", &pair.previous.original);
	input_make(&small, &(struct input_spec){.width = 20, .height = 10, .field = INPUT_LAYERS});
	CHECK_INT(engine_begin(engine, &small.frame, &begin, &error), 0);
	CHECK_INT(engine_begin(engine, &pair.now.frame, &begin, &error), 0);
	show(&pair, ENGINE_SHOW_IN_BETWEEN, 0.5);
	check_picture(&pair, "another size before", &pair.reference.original);
	input_finish(&small);
	pair_finish(&pair);
}

/* The frame before with motion a little other than now, as of things that turn. */
static void turn(const struct input *input)
{
	const struct pursuit_frame_header *header = &input->frame.header;
	const int index = frame_find_plane(header, PURSUIT_ROLE_MOTION);
	const struct pursuit_plane *plane = &header->planes[index];
	uint8_t *data = input->memory + (input->frame.planes[index] - input->memory);
	for (uint32_t j = 0; j < plane->height; j++)
		for (uint32_t i = 0; i < plane->width; i++) {
			float m[2];
			memcpy(m, data + j * plane->stride + i * sizeof(m), sizeof(m));
			const float turned[2] = {0.95f * m[0] - 0.2f * m[1], 0.2f * m[0] + 0.95f * m[1]};
			memcpy(data + j * plane->stride + i * sizeof(m), turned, sizeof(m));
		}
}

/* How the two frames lie in time, ns: T as the pacer knows it; S' and S; from one to the other, frames lost between. */
struct times {
	uint64_t real, span_before, span, gap;
	uint32_t lost;
};

static void put_times(struct input *before, struct input *now, const struct times *times)
{
	struct pursuit_frame_header *first = &before->frame.header, *second = &now->frame.header;
	first->frame_id = 5;
	second->frame_id = 6 + times->lost;
	first->time_ns = 1000000000;
	second->time_ns = first->time_ns + times->gap;
	first->real_interval_ns = first->motion_interval_ns = times->span_before;
	second->motion_interval_ns = times->span;
	second->real_interval_ns = times->lost ? times->span : times->gap;
}

static void check_bent(const struct input *before, const struct input *now, const struct engine_params *params,
					   const struct times *times, struct bounds_report *report)
{
	static const struct engine_request requests[] = {{ENGINE_SHOW_REAL, 0.0},
													 {ENGINE_SHOW_IN_BETWEEN, 1.0 / 3},
													 {ENGINE_SHOW_IN_BETWEEN, 2.0 / 3},
													 {ENGINE_SHOW_REAL, 0.3}};
	const struct engine_begin_params begin = {.n = 3, .last_phase = -1.0, .real_interval_ns = times->real};
	struct reference reference = {0}, previous = {0};
	struct bounds bounds;
	struct error error = {""};
	CHECK_INT(engine_begin(engine, &before->frame, &begin, &error), 0);
	CHECK_INT(engine_begin(engine, &now->frame, &begin, &error), 0);
	reference_begin(&reference, &now->frame, params, &begin);
	reference_begin(&previous, &before->frame, params, &begin);
	reference_bend(&reference, &previous, (double)times->gap * 1e-9);
	bounds_init(&bounds, &reference);
	uint8_t *pixels = reference_alloc((size_t)reference.width * reference.height, 4);
	for (size_t i = 0; i < 4; i++) {
		struct engine_image image = {pixels, 4 * (size_t)reference.width};
		CHECK_INT(engine_render(engine, &requests[i], &image, &error), 0);
		bounds_compare(&bounds, &requests[i], pixels, image.stride, report);
	}
	CHECK_STRING(error.text, "");
	free(pixels);
	bounds_finish(&bounds);
	reference_finish(&reference);
	reference_finish(&previous);
}

static void test_quadratic(void)
{
	static const struct times cases[] = {{0, 16666667, 16666667, 16666667, 0},
										 {0, 16666667, 16666667, 33333333, 1},
										 {15000000, 12000000, 20000000, 20000000, 0},
										 {33333333, 8000000, 16666667, 33333333, 0},
										 {0, 16666667, 16666667, 66666667, 3}};
	struct bounds_report all = {0};
	for (size_t f = 0; f < FIELDS; f++) {
		struct input before, now;
		struct error error = {""};
		struct bounds_report report = {0};
		const struct input_spec spec = {
			.width = 130, .height = 84, .field = fields[f], .image = f % 3, .seed = 3 + f, .no_depth = f == 3};
		const struct engine_params params = {.method = "grid",
											 .motion_model = ENGINE_MOTION_QUADRATIC,
											 .blur = f % 2 ? ENGINE_BLUR_DOUBTFUL : ENGINE_BLUR_EVERYWHERE,
											 .display_width_mm = input_display_mm(spec.width)};
		input_make(&before, &spec);
		input_make(&now, &spec);
		turn(&before);
		CHECK_INT(engine_set_params(engine, &(struct engine_params){.method = "hold"}, &error), 0);
		CHECK_INT(engine_set_params(engine, &params, &error), 0);
		const struct times *times = &cases[f % (sizeof(cases) / sizeof(cases[0]))];
		put_times(&before, &now, times);
		check_bent(&before, &now, &params, times, &report);
		if (report.outside)
			fprintf(stderr, "quadratic, field %zu: %llu pixels outside, worst by %.2f steps at (%u, %u)\n", f,
					(unsigned long long)report.outside, report.worst, report.worst_x, report.worst_y);
		CHECK_INT(report.outside, 0);
		all.pixels += report.pixels;
		all.excused += report.excused;
		input_finish(&before);
		input_finish(&now);
	}
	printf("quadratic: %.5f of the pixels excused\n", (double)all.excused / (double)all.pixels);
	CHECK((double)all.excused <= 0.02 * (double)all.pixels);
}

static void test_lag_is_told(void)
{
	for (const struct engine_method_info *info = engine_methods(); info->name; info++)
		CHECK_INT(info->lag, strcmp(info->name, "interpolate") == 0);
}

int main(int argc, char **argv)
{
	if (argc != 2) {
		fprintf(stderr, "usage: %s " ENGINE_CONTEXT_USAGE "\n", argv[0]);
		return 2;
	}
	engine = engine_context_open(argv[1], "grid");
	RUN(test_black);
	RUN(test_blur_hold);
	RUN(test_mcif);
	RUN(test_scatter);
	RUN(test_interpolate);
	RUN(test_interpolate_without_before);
	RUN(test_quadratic);
	RUN(test_lag_is_told);
	printf("%.5f of the pixels open\n", open_pixels / all_pixels);
	CHECK(open_pixels / all_pixels < MOST_OPEN);
	engine_destroy(&engine);
	return test_result();
}
