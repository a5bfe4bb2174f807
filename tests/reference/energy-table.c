/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Energy error (daemon/measure/energy.h) before and after 8-bit quantisation:
 * the built-in scenes through the reference, once without any rounding
 * (exact.h) and once as displayed.
 *   energy-table [--json FILE]
 * FILE gets a table for `pursuit report --tables`. Exit status 1 if a bound is
 * broken, 77 without a context to render scenes in.
 *
 * Methods: `blur-hold` splits the light of every pixel and displaces nothing,
 * which leaves compensation alone; `grid` and `grid` with the full blur are
 * judged along the exact motion of the scene, as `hold` is, for comparison.
 */
#include "daemon/measure/energy.h"
#include "daemon/measure/regions.h"
#include "exact.h"
#include "scene-frame.h"
#include "tests/scenes/context.h"
#include "tests/test.h"

#define WIDTH 320u
#define HEIGHT 180u
#define PIXELS ((size_t)WIDTH * HEIGHT)
#define REFRESH_HZ 120.0
#define MOST_N 3u
#define FRAMES 2u

/* Eye at rest, before quantisation: light is kept but for what float light rounds and what sRGB's pieces miss. */
#define KEPT_BOUND 1e-6
/* The same after it, of any pixel, in half steps: each picture is rounded once. */
#define PIXEL_BOUND 1.001
/*
 * Of rounding alone, in half steps. Evenly spread over a step it has a root mean square of 0.58 of them, the mean of a
 * block of 64 pixels 0.07, where a picture is rounded twice (B, then what is displayed) 0.1: twice that at most.
 */
#define ROUNDING_BOUND 0.2
/* After minus before, along the motion: rounding adds to what extrapolation has in squares, hence very little. */
#define ADDED_BOUND 2e-4
/* Before, along the motion, against `hold`: extrapolation gains, but on `tower` (docs/figures.md). */
#define HOLD_BOUND 1.1

static const double frame_times[FRAMES] = {0.7, 2.35};

struct method {
	const char *name;
	struct engine_params params;
	bool eye_rests; /* judged pixel on pixel, not along the motion */
};

#define METHODS 4
static const struct method methods[METHODS] = {
	{"hold", {.method = "hold"}, false},
	{"blur-hold, eye at rest", {.method = "blur-hold", .blur = ENGINE_BLUR_EVERYWHERE}, true},
	{"grid", {.method = "grid"}, false},
	{"grid blur=everywhere", {.method = "grid", .blur = ENGINE_BLUR_EVERYWHERE}, false},
};

/* A real frame, and where its pixels truly are in the pictures shown for it; [0] is not used. */
struct judged_frame {
	struct scene_frame read;
	float *motion[MOST_N];
	uint8_t *hidden[MOST_N];
};

/* Sums over the frames of a row. */
struct sums {
	struct energy_error before, after;
	struct energy_error rounding;  /* against 0: light after minus light before */
	struct energy_error half_step; /* against 0: light of half a code value */
	double worst_pixel;            /* after, in half steps; eye at rest only */
};

/* One picture shown for a real frame, as light. */
struct shown {
	light_pixel *before, *after, *rounding, *half_step;
};

struct row {
	char scene[24];
	const char *method;
	uint32_t n;
	bool eye_rests;
	double before, after, rounding; /* shares of the mean light */
	double half_step;               /* the same, of half a code value */
	double worst_pixel;
	double hold; /* `before` of hold, same scene and N */
};

static struct row rows[128];
static size_t row_count;
static light_pixel *black;

/* ---- scenes ---- */

/* Where the pixels of the moment `here` are at `there`. */
static bool read_motion(struct scene *scene, double here, double there, float *motion, uint32_t *ids)
{
	const struct scene_request request = {.time = here, .time_previous = there, .time_next = here};
	const struct scene_pixels pixels = {.backward = motion, .object_id = ids};
	struct scene_textures textures = {0};
	struct scene_camera camera = {0};
	if (!scene_render(scene, &request, &textures, &camera) || !scene_read(scene, &pixels))
		return false;
	for (size_t i = 0; i < 2 * PIXELS; i++)
		motion[i] = -motion[i];
	return true;
}

static bool judge_moment(struct judged_frame *frame, struct scene *scene, double real, double shown, uint32_t k)
{
	float *back = reference_alloc(2 * PIXELS, sizeof(*back));
	uint32_t *ids_real = reference_alloc(PIXELS, sizeof(*ids_real)), *ids = reference_alloc(PIXELS, sizeof(*ids));
	frame->motion[k] = reference_alloc(2 * PIXELS, sizeof(float));
	frame->hidden[k] = reference_alloc(PIXELS, 1);
	const bool good =
		read_motion(scene, real, shown, frame->motion[k], ids_real) && read_motion(scene, shown, real, back, ids);
	const struct region_view here = {frame->motion[k], ids_real, NULL}, there = {back, ids, NULL};
	if (good)
		regions_find(&here, &there, WIDTH, HEIGHT, frame->hidden[k]);
	free(back);
	free(ids_real);
	free(ids);
	return good;
}

static bool judged_frame_init(struct judged_frame *frame, struct scene *scene, double time, uint32_t n)
{
	const struct scene_moment moment = {WIDTH, HEIGHT, time, n / REFRESH_HZ, false};
	bool good = scene_frame_read(&frame->read, scene, &moment);
	for (uint32_t k = 1; k < n && good; k++)
		good = judge_moment(frame, scene, time, time + k / REFRESH_HZ, k);
	return good;
}

static void judged_frame_finish(struct judged_frame *frame)
{
	scene_frame_finish(&frame->read);
	for (uint32_t k = 0; k < MOST_N; k++) {
		free(frame->motion[k]);
		free(frame->hidden[k]);
	}
	*frame = (struct judged_frame){0};
}

/* ---- light ---- */

static void fill_shown(struct shown *shown, const struct exact *exact, const struct engine_request *request)
{
	const struct reference *reference = exact->reference;
	const struct reference_transfer *display = &reference->compensation.display;
	double *codes = reference_alloc(PIXELS * 3, sizeof(*codes));
	uint8_t *rounded = reference_alloc(PIXELS, 4);
	exact_render(exact, request, codes);
	reference_render(reference, request, rounded);
	for (size_t at = 0; at < PIXELS * 3; at++) {
		const size_t i = at / 3, c = at % 3;
		const double code = rounded[4 * i + c] / 255.0;
		const double before = reference_to_light(display, codes[at]), after = reference_to_light(display, code);
		shown->before[i][c] = (float)before;
		shown->after[i][c] = (float)after;
		shown->rounding[i][c] = (float)(after - before);
		shown->half_step[i][c] = (float)reference_half_step(display, code);
	}
	free(codes);
	free(rounded);
}

static light_pixel *new_light(void)
{
	return reference_alloc(PIXELS, sizeof(light_pixel));
}

static void add_energy(struct energy_error *sum, const light_pixel *original, const struct energy_picture *pictures,
					   const light_pixel *const lights[MOST_N], uint32_t n)
{
	struct energy_picture these[MOST_N];
	for (uint32_t k = 0; k < n; k++) {
		these[k] = pictures[k];
		these[k].light = lights[k];
	}
	energy_error_add(sum, original, these, n, WIDTH, HEIGHT);
}

static light_pixel *light_of_original(const struct reference *reference)
{
	light_pixel *light = new_light();
	for (size_t at = 0; at < PIXELS * 3; at++)
		light[at / 3][at % 3] = (float)reference_to_light(&reference->compensation.display,
														  reference->original.data[at / 3 * 4 + at % 3] / 255.0);
	return light;
}

static double worst_pixel(const light_pixel *original, const struct shown *shown, uint32_t n)
{
	double worst = 0.0;
	for (size_t at = 0; at < PIXELS * 3; at++) {
		double error = 0.0, allowed = 0.0;
		for (uint32_t k = 0; k < n; k++) {
			error += (double)shown[k].after[at / 3][at % 3] - (double)original[at / 3][at % 3];
			allowed += (double)shown[k].half_step[at / 3][at % 3];
		}
		worst = fmax(worst, fabs(error) / allowed);
	}
	return worst;
}

static void add_shown(struct sums *sums, const struct reference *reference, const struct shown *shown,
					  const struct energy_picture *pictures, uint32_t n)
{
	const light_pixel *before[MOST_N], *after[MOST_N], *rounding[MOST_N], *steps[MOST_N];
	light_pixel *original = light_of_original(reference);
	for (uint32_t k = 0; k < n; k++) {
		before[k] = shown[k].before;
		after[k] = shown[k].after;
		rounding[k] = shown[k].rounding;
		steps[k] = shown[k].half_step;
	}
	add_energy(&sums->before, original, pictures, before, n);
	add_energy(&sums->after, original, pictures, after, n);
	add_energy(&sums->rounding, black, pictures, rounding, n);
	add_energy(&sums->half_step, black, pictures, steps, n);
	if (!pictures[n - 1].motion)
		sums->worst_pixel = fmax(sums->worst_pixel, worst_pixel(original, shown, n));
	free(original);
}

static void add_frame(struct sums *sums, const struct judged_frame *frame, const struct method *method, uint32_t n)
{
	const struct engine_begin_params begin = {.n = n, .last_phase = (n - 1.0) / n};
	struct energy_picture pictures[MOST_N] = {{0}};
	struct shown shown[MOST_N];
	struct reference reference = {0};
	struct exact exact;
	reference_begin(&reference, &frame->read.frame, &method->params, &begin);
	exact_init(&exact, &reference);
	for (uint32_t k = 0; k < n; k++) {
		const struct engine_request request = {k ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, (double)k / n};
		shown[k] = (struct shown){new_light(), new_light(), new_light(), new_light()};
		fill_shown(&shown[k], &exact, &request);
		if (!method->eye_rests)
			pictures[k] = (struct energy_picture){NULL, frame->motion[k], frame->hidden[k], REGION_HIDDEN};
	}
	add_shown(sums, &reference, shown, pictures, n);
	for (uint32_t k = 0; k < n; k++) {
		free(shown[k].before);
		free(shown[k].after);
		free(shown[k].rounding);
		free(shown[k].half_step);
	}
	exact_finish(&exact);
	reference_finish(&reference);
}

/* ---- rows ---- */

/* Root mean square of what was added against 0, as a share of the light of `of`. */
static double share(const struct energy_error *error, const struct energy_error *of)
{
	return sqrt(error->squares / (double)error->count) / (of->light / (double)of->count);
}

static void add_row(const char *scene, const struct method *method, const struct judged_frame *frames, uint32_t n)
{
	struct sums sums = {0};
	if (row_count == sizeof(rows) / sizeof(rows[0]))
		abort();
	for (uint32_t i = 0; i < FRAMES; i++)
		add_frame(&sums, &frames[i], method, n);
	struct row *row = &rows[row_count++];
	*row =
		(struct row){.method = method->name, .n = n, .eye_rests = method->eye_rests, .worst_pixel = sums.worst_pixel};
	snprintf(row->scene, sizeof(row->scene), "%s", scene);
	row->before = energy_error_root(&sums.before);
	row->after = energy_error_root(&sums.after);
	row->rounding = share(&sums.rounding, &sums.before);
	row->half_step = share(&sums.half_step, &sums.before);
	row->hold = method == methods ? row->before : row[-(method - methods)].before;
}

static void run_scene(const char *name)
{
	char text[256] = "";
	struct scene *scene = scene_create(name, WIDTH, HEIGHT, test_context_lookup, text, sizeof(text));
	CHECK_STRING(text, "");
	for (uint32_t n = 2; n <= MOST_N && scene; n++) {
		struct judged_frame frames[FRAMES] = {{{{{0}}}}};
		bool good = true;
		for (uint32_t i = 0; i < FRAMES && good; i++)
			good = judged_frame_init(&frames[i], scene, frame_times[i], n);
		CHECK(good);
		for (size_t m = 0; m < METHODS && good; m++)
			add_row(name, &methods[m], frames, n);
		for (uint32_t i = 0; i < FRAMES; i++)
			judged_frame_finish(&frames[i]);
	}
	scene_destroy(&scene);
}

static bool is_kept(const struct row *row)
{
	const bool rounding = row->rounding <= ROUNDING_BOUND * row->half_step;
	if (row->eye_rests)
		return rounding && row->before <= KEPT_BOUND && row->worst_pixel <= PIXEL_BOUND;
	return rounding && row->after - row->before <= ADDED_BOUND && row->before <= HOLD_BOUND * row->hold + KEPT_BOUND;
}

static void print_rows(void)
{
	printf("%-10s %-22s N  %-9s %-9s %-9s in half steps  worst pixel\n", "scene", "method", "before", "after",
		   "rounding");
	for (size_t i = 0; i < row_count; i++) {
		const struct row *row = &rows[i];
		printf("%-10s %-22s %u  %-9.3g %-9.3g %-9.3g %-14.4f ", row->scene, row->method, row->n, row->before,
			   row->after, row->rounding, row->rounding / row->half_step);
		if (row->eye_rests)
			printf("%-12.4f", row->worst_pixel);
		printf("%s\n", is_kept(row) ? "" : "BROKEN");
		CHECK(is_kept(row));
	}
}

static void write_json(const char *path)
{
	FILE *out = fopen(path, "w");
	CHECK(out != NULL);
	if (!out)
		return;
	fprintf(out,
			"{\"title\": \"Energy error before and after 8-bit quantisation (the reference, %ux%u)\", \"columns\": "
			"[\"scene\", \"method\", \"N\", \"before\", \"after\", \"rounding alone\", \"in half steps\", "
			"\"bounds\"], \"rows\": [",
			WIDTH, HEIGHT);
	for (size_t i = 0; i < row_count; i++) {
		const struct row *row = &rows[i];
		/* JSON knows no NaN. */
		fprintf(out, "%s\n[\"%s\", \"%s\", %u, %.4g, %.4g, %.4g, %.4g, \"%s\"]", i ? "," : "", row->scene, row->method,
				row->n, fmin(row->before, 1e300), fmin(row->after, 1e300), fmin(row->rounding, 1e300),
				fmin(row->rounding / row->half_step, 1e300), is_kept(row) ? "kept" : "BROKEN");
	}
	fprintf(out, "\n]}\n");
	CHECK(fclose(out) == 0);
}

int main(int argc, char **argv)
{
	struct test_context context;
	if (!test_context_init(&context, false))
		SKIP("no EGL surfaceless context to render scenes in");
	black = new_light();
	for (const struct scene_info *info = scene_list(); info->name; info++)
		run_scene(info->name);
	test_context_finish(&context);
	free(black);
	print_rows();
	if (argc > 2 && strcmp(argv[1], "--json") == 0)
		write_json(argv[2]);
	return test_result();
}
