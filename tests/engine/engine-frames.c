/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the methods show: hold, every N, every phase, UI, coverage, determinism, light. Argument: surfaceless or cpu. */
#include "tests/test.h"

#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"

static struct engine *engine;

static void set(struct engine_params params)
{
	struct error error = {""};
	CHECK_INT(engine_set_params(engine, &params, &error), 0);
}

static void begin(const struct picture *picture, uint32_t n)
{
	struct error error = {""};
	struct engine_begin_params params = {.n = n, .last_phase = -1.0};
	CHECK_INT(engine_begin(engine, &picture->frame, &params, &error), 0);
	if (error.text[0])
		fprintf(stderr, "%s\n", error.text);
}

static uint8_t *show(const struct picture *picture, enum engine_show what, double phase)
{
	struct error error = {""};
	struct engine_request request = {what, phase};
	uint8_t *pixels = calloc(picture->height, 4 * (size_t)picture->width);
	struct engine_image image = {pixels, 4 * (size_t)picture->width};
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	return pixels;
}

static size_t bytes_of(const struct picture *picture)
{
	return 4 * (size_t)picture->width * picture->height;
}

static bool left_out(const char *name, const char *reason)
{
	const struct engine_report *report = engine_get_report(engine);
	for (uint32_t i = 0; i < report->left_out_count; i++)
		if (strcmp(report->left_out[i].name, name) == 0)
			return strcmp(report->left_out[i].reason, reason) == 0;
	return false;
}

static uint32_t runs_of(const char *pass)
{
	const struct engine_report *report = engine_get_report(engine);
	for (uint32_t i = 0; i < report->pass_count; i++)
		if (strcmp(report->passes[i].name, pass) == 0)
			return report->passes[i].runs;
	return UINT32_MAX;
}

static void test_hold(void)
{
	struct picture picture;
	picture_init(&picture, 160, 90, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){.method = "hold"});
	begin(&picture, 3);
	uint8_t *pixels = show(&picture, ENGINE_SHOW_IN_BETWEEN, 0.66);
	CHECK(memcmp(pixels, picture_row(&picture, PURSUIT_ROLE_COLOR, 0), bytes_of(&picture)) == 0);
	CHECK(left_out("extrapolation", "method"));
	free(pixels);
	picture_finish(&picture);
}

/* Stays finite, opaque and the same from run to run, for each number of vblanks. */
static void test_every_n(void)
{
	struct picture picture;
	picture_init(&picture, 320, 180, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){.method = "grid"});
	for (uint32_t n = 1; n <= 8; n++) {
		begin(&picture, n);
		for (uint32_t i = 0; i < n; i++) {
			enum engine_show what = i ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL;
			uint8_t *a = show(&picture, what, (double)i / n), *b = show(&picture, what, (double)i / n);
			CHECK(memcmp(a, b, bytes_of(&picture)) == 0);
			for (size_t k = 3; k < bytes_of(&picture); k += 4)
				CHECK(a[k] == 255);
			free(a);
			free(b);
		}
		if (n == 1)
			CHECK(left_out("boost", "one-vblank") || left_out("boost", "no-distortion"));
	}
	picture_finish(&picture);
}

static void test_phases(void)
{
	static const double phases[] = {0.0, 0.05, -0.05, -1.0, 8.0, 1e300, -1e300, (double)NAN, (double)INFINITY};
	struct picture picture;
	picture_init(&picture, 200, 100, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){0});
	begin(&picture, 2);
	uint8_t *eight = show(&picture, ENGINE_SHOW_IN_BETWEEN, 8.0), *zero = show(&picture, ENGINE_SHOW_IN_BETWEEN, 0.0);
	uint8_t *real = show(&picture, ENGINE_SHOW_REAL, 0.0);
	for (size_t i = 0; i < sizeof(phases) / sizeof(phases[0]); i++) {
		uint8_t *pixels = show(&picture, ENGINE_SHOW_IN_BETWEEN, phases[i]);
		if (phases[i] >= 8.0)
			CHECK(memcmp(pixels, eight, bytes_of(&picture)) == 0);
		if (isnan(phases[i]))
			CHECK(memcmp(pixels, zero, bytes_of(&picture)) == 0);
		free(pixels);
		pixels = show(&picture, ENGINE_SHOW_REAL, phases[i]);
		CHECK((memcmp(pixels, real, bytes_of(&picture)) == 0) == !(fabs(phases[i]) > 0.05));
		free(pixels);
	}
	free(eight);
	free(zero);
	free(real);
	picture_finish(&picture);
}

static void test_rest(void)
{
	struct picture picture;
	picture_init(&picture, 64, 48, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){.blur = ENGINE_BLUR_EVERYWHERE});
	picture.frame.header.flags = PURSUIT_FRAME_CUT;
	begin(&picture, 2);
	CHECK(left_out("extrapolation", "cut"));
	picture.frame.header.flags = PURSUIT_FRAME_MOTION_INVALID;
	begin(&picture, 2);
	CHECK(left_out("extrapolation", "motion-invalid"));
	uint8_t *pixels = show(&picture, ENGINE_SHOW_IN_BETWEEN, 0.5);
	CHECK(memcmp(pixels, picture_row(&picture, PURSUIT_ROLE_COLOR, 0), bytes_of(&picture)) == 0);
	CHECK_INT(runs_of("warp"), 0);
	free(pixels);
	picture_finish(&picture);
}

/* Over a warped and over an unwarped picture: premultiplied, rounded, clamped. */
static void check_ui(struct picture *picture, enum engine_show what)
{
	uint8_t *ui = picture_row(picture, PURSUIT_ROLE_UI, 0);
	uint64_t stride = picture->frame.header.planes[frame_find_plane(&picture->frame.header, PURSUIT_ROLE_UI)].stride;
	uint32_t size = 0;
	picture_fill_random(picture, PURSUIT_ROLE_UI, 4);
	for (size_t i = 0; i < stride * picture->height; i += 4)
		for (int c = 0; c < 3; c++)
			ui[i + (size_t)c] = (uint8_t)(ui[i + (size_t)c] * ui[i + 3] / 255);
	memset(ui, 0, stride * 3);
	begin(picture, 3);
	uint8_t *with = show(picture, what, 0.5);
	memset(ui, 0, stride * picture->height);
	begin(picture, 3);
	CHECK(left_out("ui", "absent") || runs_of("ui") == 0);
	uint8_t *without = show(picture, what, 0.5);
	CHECK(left_out("ui", "absent"));
	picture_fill_random(picture, PURSUIT_ROLE_UI, 4);
	for (size_t y = 3; y < picture->height; y++)
		for (size_t x = 0; x < picture->width; x++)
			for (size_t c = 0; c < 3; c++) {
				const uint8_t *layer = ui + y * stride + 4 * x;
				size_t at = 4 * (y * picture->width + x) + c;
				double want = layer[c] * layer[3] / 255 + (255.0 - layer[3]) / 255.0 * without[at];
				/* Fixed-function blending is exact but for the last bit of the product. */
				bool mixed = layer[3] > 0 && layer[3] < 255;
				size += fabs(with[at] - fmin(floor(want + 0.5), 255.0)) > (mixed ? 1.0 : 0.0);
			}
	CHECK_INT(size, 0);
	CHECK(memcmp(with, without, 4 * 3 * (size_t)picture->width) == 0);
	free(with);
	free(without);
}

static void test_ui(void)
{
	struct picture picture;
	picture_init(&picture, 256, 120, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){0});
	check_ui(&picture, ENGINE_SHOW_PLAIN);
	check_ui(&picture, ENGINE_SHOW_IN_BETWEEN);
	picture_finish(&picture);
}

/* Wild motion: still every pixel shows some of the picture, nothing of what the target held before. */
static void check_covered(uint32_t seed, unsigned planes, float range, uint32_t patch)
{
	struct picture picture;
	picture_init(&picture, 301, 205, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_UI | planes);
	memset(picture_row(&picture, PURSUIT_ROLE_UI, 0), 255,
		   picture.frame.header.planes[frame_find_plane(&picture.frame.header, PURSUIT_ROLE_UI)].size);
	memset(picture_row(&picture, PURSUIT_ROLE_COLOR, 0), 100, picture.frame.header.planes[0].size);
	for (uint32_t y = 0; y < picture.height; y++)
		for (uint32_t x = 0; x < picture.width; x++) {
			uint32_t state = seed + x / patch * 7919u + y / patch * 104729u;
			picture_random(&state);
			float mx = (float)(picture_random(&state) & 0xffff) / 32768.0f - 1.0f;
			float my = (float)(picture_random(&state) & 0xffff) / 32768.0f - 1.0f;
			picture_set_motion(&picture, x, y, range * mx, range * my);
			picture_set_depth(&picture, x, y, (float)(picture_random(&state) & 0xff) / 255.0f);
		}
	for (int i = 0; i <= 4; i++) {
		memset(picture_row(&picture, PURSUIT_ROLE_UI, 0), 255, (size_t)picture.width);
		begin(&picture, 4);
		free(show(&picture, ENGINE_SHOW_PLAIN, 0.0));
		memset(picture_row(&picture, PURSUIT_ROLE_UI, 0), 0,
			   picture.frame.header.planes[frame_find_plane(&picture.frame.header, PURSUIT_ROLE_UI)].size);
		begin(&picture, 4);
		uint8_t *pixels = show(&picture, ENGINE_SHOW_IN_BETWEEN, i < 4 ? i * 0.25 : 8.0);
		long wrong = 0;
		for (size_t k = 0; k < bytes_of(&picture); k++)
			wrong += pixels[k] != (k % 4 == 3 ? 255 : 100);
		CHECK_INT(wrong, 0);
		free(pixels);
		memset(picture_row(&picture, PURSUIT_ROLE_UI, 0), 255,
			   picture.frame.header.planes[frame_find_plane(&picture.frame.header, PURSUIT_ROLE_UI)].size);
	}
	picture_finish(&picture);
}

static void test_covered(void)
{
	static const enum engine_blur blurs[] = {ENGINE_BLUR_DOUBTFUL, ENGINE_BLUR_OFF};
	for (int i = 0; i < 2; i++) {
		/* At a metre wide and 10 m away nothing is too fast to follow. */
		set((struct engine_params){.blur = blurs[i], .display_width_mm = 10.0f, .viewing_distance_mm = 10000.0f});
		check_covered(1, PICTURE_DEPTH, 3.0f, 1);
		check_covered(2, PICTURE_DEPTH, 40.0f, 1);
		check_covered(3, 0, 40.0f, 1);
		check_covered(4, PICTURE_DEPTH, 60.0f, 24);
		check_covered(5, 0, 500.0f, 24);
		check_covered(6, PICTURE_DEPTH, 60000.0f, 24);
		check_covered(7, PICTURE_DEPTH, 1e30f, 3);
	}
}

static double light(uint8_t code)
{
	double c = code / 255.0;
	return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/*
 * Blur everywhere over a picture that hardly moves: over the vblanks of one real frame each pixel emits the light of
 * the original, as near as rounding to code values lets it.
 */
static void test_light(void)
{
	struct picture picture;
	picture_init(&picture, 128, 96, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 8);
	picture_set_motion(&picture, 64, 40, 0.01f, 0.0f);
	set((struct engine_params){.blur = ENGINE_BLUR_EVERYWHERE});
	for (uint32_t n = 2; n <= 4; n++) {
		begin(&picture, n);
		uint8_t *real = show(&picture, ENGINE_SHOW_REAL, 0.0), *between = show(&picture, ENGINE_SHOW_IN_BETWEEN, 0.0);
		double worst = 0.0;
		long changed = 0;
		for (size_t i = 0; i < bytes_of(&picture); i++) {
			if (i % 4 == 3)
				continue;
			size_t y = i / 4 / picture.width, x = i / 4 % picture.width;
			uint8_t code = picture_row(&picture, PURSUIT_ROLE_COLOR, (uint32_t)y)[4 * x + i % 4];
			double sum = light(real[i]) + (n - 1) * light(between[i]);
			worst = fmax(worst, fabs(sum / n - light(code)));
			changed += real[i] != code;
		}
		/* Half a code value is at most 0.0045 of the light. */
		CHECK(worst < 0.0047);
		CHECK(changed > 5000);
		free(real);
		free(between);
	}
	picture_finish(&picture);
}

/* One frame after another of a stream; only what the damage tells may be taken anew. */
static void next(struct picture *picture, uint64_t since, uint32_t count)
{
	struct pursuit_frame_header *header = &picture->frame.header;
	picture->frame.stream = 5;
	header->frame_id++;
	header->flags = since ? PURSUIT_FRAME_DAMAGE : 0;
	header->damage_since = since;
	header->damage_count = count;
	header->damage[0] = (struct pursuit_rectangle){10, 20, 30, 5};
	begin(picture, 2);
}

/* Rows of the displayed picture that are not the frame's own. */
static long wrong_rows(const struct picture *picture)
{
	uint8_t *pixels = show(picture, ENGINE_SHOW_PLAIN, 0.0);
	long wrong = 0;
	for (uint32_t y = 0; y < picture->height; y++)
		wrong += memcmp(pixels + 4 * (size_t)picture->width * y, picture_row(picture, PURSUIT_ROLE_COLOR, y),
						4 * (size_t)picture->width) != 0;
	free(pixels);
	return wrong;
}

static void test_damage(void)
{
	struct picture picture;
	picture_init(&picture, 160, 90, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){0});
	next(&picture, 0, 0);
	CHECK_INT(wrong_rows(&picture), 0);
	free(show(&picture, ENGINE_SHOW_IN_BETWEEN, 0.5));
	picture_draw_layers(&picture, 3.0);
	/* Nothing changed, its client says: it is not looked at. */
	next(&picture, picture.frame.header.frame_id, 0);
	CHECK(left_out("upload", "unchanged"));
	CHECK(left_out("extrapolation", "unchanged"));
	CHECK(wrong_rows(&picture) > 80);
	/* Five rows changed. Those are taken at least, the others need not be. */
	next(&picture, picture.frame.header.frame_id, 1);
	CHECK(wrong_rows(&picture) <= 85);
	/* Against another frame than the one before; of another stream; without a stream. */
	next(&picture, picture.frame.header.frame_id - 1, 0);
	CHECK_INT(wrong_rows(&picture), 0);
	picture_draw_layers(&picture, 4.0);
	picture.frame.header.damage_since = picture.frame.header.frame_id++;
	picture.frame.stream = 6;
	begin(&picture, 2);
	CHECK_INT(wrong_rows(&picture), 0);
	picture_draw_layers(&picture, 5.0);
	picture.frame.header.damage_since = picture.frame.header.frame_id++;
	picture.frame.stream = 0;
	begin(&picture, 2);
	CHECK_INT(wrong_rows(&picture), 0);
	picture_finish(&picture);
}

static void fill_motion(const struct picture *picture, float x)
{
	for (uint32_t j = 0; j < picture->height; j++)
		for (uint32_t i = 0; i < picture->width; i++)
			picture_set_motion(picture, i, j, j > 30 && j < 60 ? x : 0.0f, 0.0f);
}

/* What rests may be about to move: forward motion counts, though the picture is as it was; backward motion does not. */
static void test_forward_motion_of_a_repeated_picture(void)
{
	struct picture picture;
	picture_init(&picture, 160, 90, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){0});
	for (uint32_t kind = PURSUIT_MOTION_BACKWARD; kind <= PURSUIT_MOTION_FORWARD; kind++) {
		picture.frame.header.motion_kind = kind;
		fill_motion(&picture, 0.0f);
		for (int i = 0; i < 40; i++)
			next(&picture, 0, 0);
		CHECK(left_out("extrapolation", kind == PURSUIT_MOTION_BACKWARD ? "unchanged" : "still"));
		CHECK(left_out("upload", "unchanged"));
		fill_motion(&picture, 7.0f);
		next(&picture, 0, 0);
		CHECK(!left_out("extrapolation", "unchanged") || kind == PURSUIT_MOTION_BACKWARD);
		CHECK(!left_out("extrapolation", "still"));
		uint8_t *between = show(&picture, ENGINE_SHOW_IN_BETWEEN, 0.5), *plain = show(&picture, ENGINE_SHOW_PLAIN, 0.5);
		const bool same = memcmp(between, plain, 4 * (size_t)picture.width * picture.height) == 0;
		CHECK_INT(same, kind == PURSUIT_MOTION_BACKWARD);
		free(between);
		free(plain);
	}
	picture_finish(&picture);
}

/* What is between two frames of a stream has nothing of another stream's; also if settings change in between. */
static void test_streams_do_not_mix(void)
{
	const struct engine_params interpolate = {.method = "interpolate"};
	struct picture picture;
	picture_init(&picture, 160, 90, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	set(interpolate);
	for (uint64_t stream = 11; stream < 14; stream++) {
		picture_draw_layers(&picture, (double)stream);
		picture.frame.stream = stream;
		set(interpolate);
		begin(&picture, 2);
		CHECK_INT(wrong_rows(&picture), 0);
	}
	/* The next one of the same stream comes a frame late, as it should. */
	picture_draw_layers(&picture, 20.0);
	begin(&picture, 2);
	CHECK(wrong_rows(&picture) > 80);
	picture_finish(&picture);
}

/* Memory that holds the picture already is not written; whatever shows something else is. */
static void test_held(void)
{
	struct picture picture;
	picture_init(&picture, 96, 64, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){0});
	next(&picture, 0, 0);
	const struct engine_request plain = {ENGINE_SHOW_PLAIN, 0.0}, between = {ENGINE_SHOW_IN_BETWEEN, 0.5};
	uint8_t *pixels = calloc(1, bytes_of(&picture));
	struct engine_image image = {.data = pixels, .stride = 4 * (size_t)picture.width};
	struct error error;
	CHECK_INT(engine_render(engine, &plain, &image, &error), 0);
	CHECK(image.holds != 0);
	memset(pixels, 7, bytes_of(&picture));
	next(&picture, picture.frame.header.frame_id, 0);
	CHECK_INT(engine_render(engine, &between, &image, &error), 0);
	CHECK_INT(pixels[0], 7);
	picture_draw_layers(&picture, 1.0);
	next(&picture, 0, 0);
	CHECK_INT(engine_render(engine, &plain, &image, &error), 0);
	CHECK(memcmp(pixels, picture_row(&picture, PURSUIT_ROLE_COLOR, 0), bytes_of(&picture)) == 0);
	const uint64_t real = image.holds;
	CHECK_INT(engine_render(engine, &between, &image, &error), 0);
	CHECK(image.holds != real);
	free(pixels);
	picture_finish(&picture);
}

static void test_plan_is_printed(void)
{
	struct picture picture;
	char text[1024], small[8];
	picture_init(&picture, 128, 96, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	set((struct engine_params){0});
	begin(&picture, 2);
	engine_print_plan(engine, text, sizeof(text));
	CHECK(text[0] == '{' && strchr(text, '}'));
	engine_print_plan(engine, small, sizeof(small));
	CHECK(strlen(small) < sizeof(small));
	CHECK_STRING(engine_methods()[0].name, "hold");
	picture_finish(&picture);
}

int main(int argc, char **argv)
{
	const bool cpu = argc > 1 && strcmp(argv[1], "cpu") == 0;
	const struct engine_params params = {.context = cpu ? ENGINE_CONTEXT_CPU : ENGINE_CONTEXT_EGL_SURFACELESS};
	struct error error;
	engine = engine_create(&params, &error);
	if (!engine)
		SKIP(error.text);
	RUN(test_hold);
	RUN(test_every_n);
	RUN(test_phases);
	RUN(test_rest);
	RUN(test_ui);
	RUN(test_covered);
	RUN(test_light);
	RUN(test_damage);
	RUN(test_forward_motion_of_a_repeated_picture);
	RUN(test_streams_do_not_mix);
	RUN(test_held);
	RUN(test_plan_is_printed);
	engine_destroy(&engine);
	return test_result();
}
