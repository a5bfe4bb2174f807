/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The engine's methods that work pixel by pixel against the reference, on
 * memory, and both against pictures worked out by hand. A pixel may be off by
 * half a step and what float loses; where float may have decided otherwise
 * (pixels.h) anything goes, and such pixels are few.
 */
#include "pixels.h"

#include "daemon/engine/pixels/between.h"
#include "daemon/engine/pixels/inverse_filter.h"
#include "input.h"
#include "tests/test.h"

#define STEP 0.52
#define MOST_OPEN 0.02

/* Both programs' view of a frame. */
struct view {
	struct input input;
	struct plan_dense dense;
	struct reference_geometry geometry;
	struct reference_picture picture;
	struct bitmap bitmap;
};

static void view_make(struct view *view, const struct input_spec *spec)
{
	const struct engine_begin_params begin = {.n = 2, .last_phase = -1.0};
	const float display = input_display_mm(spec->width);
	const struct plan_params params = {.display_width_mm = display};
	const struct reference_transfer srgb = {PURSUIT_CURVE_SRGB, 0.0};
	struct reference_timing timing;
	struct error error;
	*view = (struct view){0};
	input_make(&view->input, spec);
	const struct frame *frame = &view->input.frame;
	const int color = frame_find_plane(&frame->header, PURSUIT_ROLE_COLOR);
	CHECK_INT(plan_dense_make(&view->dense, frame, &params, &error), 0);
	reference_timing(&timing, &frame->header, &begin);
	reference_geometry_init(&view->geometry, frame, &timing, (double)display, 600.0);
	reference_convert_color(&view->picture, &frame->header.planes[color], frame->planes[color], &srgb);
	view->bitmap = (struct bitmap){view->picture.width, view->picture.height, view->picture.data};
}

static void view_finish(struct view *view)
{
	input_finish(&view->input);
	plan_dense_finish(&view->dense);
	reference_geometry_finish(&view->geometry);
	reference_picture_finish(&view->picture);
}

/* Share of open pixels. */
static double compare(const char *what, const struct bitmap *got, const struct reference_steps *want)
{
	const size_t count = (size_t)want->width * want->height;
	size_t open = 0, wrong = 0;
	double worst = 0.0;
	for (size_t at = 0; at < count; at++) {
		open += want->open[at] != 0;
		for (size_t c = 0; c < 3 && !want->open[at]; c++) {
			const double off = fabs(got->data[4 * at + c] - fmax(0.0, fmin(255.0, want->values[3 * at + c])));
			worst = fmax(worst, off);
			wrong += off > STEP;
		}
	}
	if (wrong)
		fprintf(stderr, "%s: %zu channels off, worst by %.3f steps\n", what, wrong, worst);
	CHECK_INT(wrong, 0);
	return (double)open / (double)count;
}

static const enum input_field fields[] = {INPUT_STILL,  INPUT_TRANSLATE, INPUT_SMOOTH, INPUT_ROTATE, INPUT_ZOOM,
										  INPUT_LAYERS, INPUT_VIOLENT,   INPUT_SHAKE,  INPUT_BROKEN};
static const double phases[] = {0.3337, 0.6668, -0.7113, 1.7421, 7.9313};

static void check_dense(const struct view *view)
{
	size_t wrong = 0;
	for (size_t at = 0; at < (size_t)view->dense.width * view->dense.height; at++)
		wrong += !(fabs((double)view->dense.ux[at] - view->geometry.ux[at]) <= 2e-4) ||
				 !(fabs((double)view->dense.uy[at] - view->geometry.uy[at]) <= 2e-4) ||
				 !(fabs((double)view->dense.z[at] - view->geometry.z[at]) <= 2e-7);
	CHECK_INT(wrong, 0);
	CHECK_INT(view->dense.invalid_pixels, view->geometry.invalid);
	CHECK_INT(view->dense.rest == PLAN_MOVES, view->geometry.moves);
}

static void check_methods(const struct view *now, const struct view *before, const char *name, double *open)
{
	struct reference_steps want = {0};
	struct scatter scatter = {0};
	struct error error;
	struct bitmap got = {now->bitmap.width, now->bitmap.height,
						 reference_alloc((size_t)now->bitmap.width * now->bitmap.height, 4)};
	const struct between_frame frames[2] = {{&now->dense, &now->bitmap}, {&before->dense, &before->bitmap}};
	reference_mcif(&now->geometry, &now->picture, &want);
	inverse_filter(&now->dense, &now->bitmap, &got);
	*open += compare(name, &got, &want);
	for (size_t p = 0; p < sizeof(phases) / sizeof(phases[0]); p++) {
		reference_scattered(&now->geometry, &now->picture, phases[p], &want);
		CHECK_INT(scatter_make(&scatter, &now->dense, phases[p], &error), 0);
		CHECK_INT(scatter_show(&scatter, &now->dense, phases[p], &now->bitmap, &got, &error), 0);
		*open += compare(name, &got, &want);
	}
	for (size_t p = 0; p < 2; p++) {
		reference_interpolated(&now->geometry, &now->picture, &before->geometry, &before->picture, phases[p], &want);
		CHECK_INT(between_show(&scatter, &frames[0], &frames[1], phases[p], &got, &error), 0);
		*open += compare(name, &got, &want);
	}
	scatter_finish(&scatter);
	reference_steps_finish(&want);
	free(got.data);
}

static void test_fields(void)
{
	static const uint32_t sizes[][2] = {{88, 56}, {1, 1}, {1, 9}, {7, 5}, {65, 33}};
	double open = 0.0;
	uint32_t pictures = 0;
	char name[64];
	for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++)
		for (size_t f = 0; f < sizeof(fields) / sizeof(fields[0]); f++) {
			struct view now, before;
			struct input_spec spec = {.width = sizes[s][0],
									  .height = sizes[s][1],
									  .field = fields[f],
									  .image = (f + s) % 3,
									  .seed = 1 + f + 10 * s,
									  .motion_format = f % 2 ? PURSUIT_FORMAT_RG16F : PURSUIT_FORMAT_RG32F,
									  .depth_kind = f % 3 ? PURSUIT_DEPTH_DEVICE : PURSUIT_DEPTH_DEVICE_REVERSED,
									  .depth_format = f % 4 ? PURSUIT_FORMAT_DEPTH32F : PURSUIT_FORMAT_DEPTH16,
									  .no_depth = f == 4};
			view_make(&now, &spec);
			spec.seed += 1000;
			view_make(&before, &spec);
			snprintf(name, sizeof(name), "field %zu, %u x %u", f, spec.width, spec.height);
			check_dense(&now);
			check_methods(&now, &before, name, &open);
			pictures += 8;
			view_finish(&now);
			view_finish(&before);
		}
	printf("%u pictures, %.5f of the pixels open\n", pictures, open / pictures);
	CHECK(open / pictures < MOST_OPEN);
}

/* One row, each pixel's gray 10 times its index plus 10. */
struct row {
	uint8_t pixels[8 * 4];
	float ux[8], uy[8], z[8];
	struct plan_dense dense;
	struct bitmap bitmap;
};

static void row_make(struct row *row, uint32_t width)
{
	*row = (struct row){.dense = {.width = width, .height = 1}, .bitmap = {width, 1, NULL}};
	for (uint32_t i = 0; i < width; i++) {
		memset(row->pixels + 4 * i, (int)(10 * i + 10), 4);
		row->z[i] = 0.5f;
	}
	row->dense.ux = row->ux;
	row->dense.uy = row->uy;
	row->dense.z = row->z;
	row->bitmap.data = row->pixels;
}

static void check_row(const struct row *row, double phase, const uint8_t *want)
{
	struct scatter scatter = {0};
	struct error error;
	uint8_t data[8 * 4];
	struct bitmap to = {row->bitmap.width, 1, data};
	CHECK_INT(scatter_make(&scatter, &row->dense, phase, &error), 0);
	CHECK_INT(scatter_show(&scatter, &row->dense, phase, &row->bitmap, &to, &error), 0);
	for (uint32_t i = 0; i < to.width; i++)
		CHECK_INT(data[4 * i], want[i]);
	scatter_finish(&scatter);
}

static void test_scatter_by_hand(void)
{
	struct row row;
	row_make(&row, 4);
	check_row(&row, 0.5, (const uint8_t[]){10, 20, 30, 40});
	/* The first two go two pixels to the right, behind the others: 10 and 20 are hidden, their places are holes. */
	row.ux[0] = row.ux[1] = 4.0f;
	row.z[0] = row.z[1] = 0.75f;
	/* Pull: level 1 is {none, 35}, level 2 35. Push: level 1's hole is 35, so are both of level 0 but for the 1/4. */
	check_row(&row, 0.5, (const uint8_t[]){35, 35, 30, 40});
	/* In front, they hide the others. */
	row.z[0] = row.z[1] = 0.25f;
	check_row(&row, 0.5, (const uint8_t[]){15, 15, 10, 20});
	/* At equal depth the first in rows wins, whatever moves. */
	row.z[0] = row.z[1] = 0.5f;
	check_row(&row, 0.5, (const uint8_t[]){15, 15, 10, 20});
	/* A quarter of a pixel: shown there. */
	for (int i = 0; i < 4; i++)
		row.ux[i] = 0.25f;
	check_row(&row, 1.0, (const uint8_t[]){10, 18, 28, 38});
	/* All of it out of the picture: as it was. */
	for (int i = 0; i < 4; i++)
		row.ux[i] = 400.0f;
	check_row(&row, 1.0, (const uint8_t[]){10, 20, 30, 40});
}

static void test_mcif_by_hand(void)
{
	struct row row;
	uint8_t data[8 * 4];
	row_make(&row, 4);
	row.pixels[4] = row.pixels[5] = row.pixels[6] = 80; /* 10 80 30 40 */
	row.ux[1] = 2.0f;                                   /* samples at 1.0 and 2.0: (45 + 55) / 2 */
	row.uy[3] = 0.5f;                                   /* one sample: itself */
	inverse_filter(&row.dense, &row.bitmap, &(struct bitmap){4, 1, data});
	CHECK_INT(data[0], 10);
	CHECK_INT(data[4], 110);
	CHECK_INT(data[8], 30);
	CHECK_INT(data[12], 40);
}

static void test_between_by_hand(void)
{
	struct row now, before;
	struct scatter scatter = {0};
	struct error error;
	uint8_t data[8 * 4];
	row_make(&now, 4);
	row_make(&before, 4);
	/* Before: 10 20 30 40; now the same two pixels further right, and brighter by 100. */
	for (int i = 0; i < 4; i++) {
		now.ux[i] = 2.0f;
		memset(now.pixels + 4 * i, 100 + 10 * i, 3);
	}
	const struct between_frame frames[2] = {{&now.dense, &now.bitmap}, {&before.dense, &before.bitmap}};
	CHECK_INT(between_show(&scatter, &frames[0], &frames[1], 0.5, &(struct bitmap){4, 1, data}, &error), 0);
	/* Target i: now i + 1, before i - 1, clamped; the last is a hole, which only the frame before fills. */
	CHECK_INT(data[0], (110 + 10) / 2);
	CHECK_INT(data[4], (120 + 10) / 2);
	CHECK_INT(data[8], (130 + 20) / 2);
	CHECK_INT(data[12], 30);
	/* Something near lay over pixel 1 before: what shows at 2 comes from now alone. */
	for (int i = 0; i < 4; i++)
		now.z[i] = 0.9f;
	before.z[0] = before.z[2] = before.z[3] = 0.9f;
	before.z[1] = 0.1f;
	CHECK_INT(between_show(&scatter, &frames[0], &frames[1], 0.5, &(struct bitmap){4, 1, data}, &error), 0);
	CHECK_INT(data[4], (120 + 10) / 2);
	CHECK_INT(data[8], 130);
	scatter_finish(&scatter);
}

int main(void)
{
	RUN(test_scatter_by_hand);
	RUN(test_mcif_by_hand);
	RUN(test_between_by_hand);
	RUN(test_fields);
	return test_result();
}
