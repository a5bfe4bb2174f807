/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What the executor that draws with GL asks of the renderer: nothing is made, compiled or waited for once it runs, how
 * much memory it takes, that what rests is not drawn twice, and that timer queries tell times. The argument is
 * the context: surfaceless, gles, osmesa. With "memory" after it: how much memory, and nothing else.
 */
#include "tests/test.h"

#include <unistd.h>

#include "daemon/engine/gl/executor_gl.h"
#include "daemon/engine/now.h"
#include "tests/engine/picture.h"

static struct engine_params params;

/* ---- calls counted ---- */

static struct gl real;
static struct {
	uint64_t made, compiled, waited, drawn; /* drawn: indices */
} calls;

static void count_tex_image(GLenum target, GLint level, GLint internal, GLsizei width, GLsizei height, GLint border,
							GLenum format, GLenum type, const void *pixels)
{
	calls.made++;
	real.TexImage2D(target, level, internal, width, height, border, format, type, pixels);
}

static void count_buffer_data(GLenum target, GLsizeiptr size, const void *data, GLenum usage)
{
	calls.made++;
	real.BufferData(target, size, data, usage);
}

static void count_renderbuffer(GLenum target, GLenum format, GLsizei width, GLsizei height)
{
	calls.made++;
	real.RenderbufferStorage(target, format, width, height);
}

static void count_textures(GLsizei count, GLuint *names)
{
	calls.made++;
	real.GenTextures(count, names);
}

static void count_buffers(GLsizei count, GLuint *names)
{
	calls.made++;
	real.GenBuffers(count, names);
}

static void count_framebuffers(GLsizei count, GLuint *names)
{
	calls.made++;
	real.GenFramebuffers(count, names);
}

static void count_compile(GLuint shader)
{
	calls.compiled++;
	real.CompileShader(shader);
}

static void count_link(GLuint program)
{
	calls.compiled++;
	real.LinkProgram(program);
}

static void count_finish(void)
{
	calls.waited++;
	real.Finish();
}

static GLenum count_error(void)
{
	calls.waited++;
	return real.GetError();
}

static void count_elements(GLenum mode, GLsizei count, GLenum type, const void *indices)
{
	calls.drawn += (uint64_t)count;
	real.DrawElements(mode, count, type, indices);
}

static void count_calls(struct engine *engine)
{
	struct gl *gl = &gl_of(engine)->context->gl;
	real = *gl;
	gl->TexImage2D = count_tex_image;
	gl->BufferData = count_buffer_data;
	gl->RenderbufferStorage = count_renderbuffer;
	gl->GenTextures = count_textures;
	gl->GenBuffers = count_buffers;
	gl->GenFramebuffers = count_framebuffers;
	gl->CompileShader = count_compile;
	gl->LinkProgram = count_link;
	gl->Finish = count_finish;
	gl->GetError = count_error;
	gl->DrawElements = count_elements;
	memset(&calls, 0, sizeof(calls));
}

/* ---- frames ---- */

static struct engine *make(const struct engine_params *wanted)
{
	struct error error;
	struct engine *engine = engine_create(wanted, &error);
	CHECK(engine != NULL);
	if (!engine)
		fprintf(stderr, "%s\n", error.text);
	return engine;
}

static void begin(struct engine *engine, const struct picture *picture, uint32_t n)
{
	struct error error = {""};
	const struct engine_begin_params how = {.n = n, .last_phase = -1.0};
	CHECK_INT(engine_begin(engine, &picture->frame, &how, &error), 0);
}

static void show(struct engine *engine, const struct picture *picture, enum engine_show what, double phase,
				 uint8_t *out)
{
	struct error error = {""};
	struct engine_image image = {.data = out, .stride = 4 * (size_t)picture->width};
	const struct engine_request request = {what, phase};
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
}

static void show_all(struct engine *engine, const struct picture *picture, uint8_t *out)
{
	begin(engine, picture, 3);
	show(engine, picture, ENGINE_SHOW_REAL, 0.0, out);
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 1.0 / 3, out);
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 2.0 / 3, out);
}

/* Everything that a frame can need: folds, tears, a blur, the boost, a UI over part of it. */
static void draw(struct picture *picture, uint32_t width, uint32_t height, double t)
{
	picture_init(picture, width, height, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
	picture_draw_layers(picture, t);
	for (uint32_t y = 10; y < 30 && y < height; y++)
		memset(picture_row(picture, PURSUIT_ROLE_UI, y), 0x40 + (int)y, 4 * (size_t)width / 2);
}

#define PICTURES 4

static void check_steady(const char *method, enum engine_analysis analysis)
{
	struct engine_params own = params;
	struct picture pictures[PICTURES];
	uint8_t *out = malloc((size_t)4 * 400 * 300);
	own.method = method;
	own.analysis = analysis;
	own.buffer_software = true;
	struct engine *engine = make(&own);
	for (int i = 0; i < PICTURES; i++)
		draw(&pictures[i], 400, 300, 0.7 * i);
	for (int i = 0; i < 2 * PICTURES; i++)
		show_all(engine, &pictures[i % PICTURES], out);
	count_calls(engine);
	for (int i = 0; i < 3 * PICTURES; i++)
		show_all(engine, &pictures[i % PICTURES], out);
	engine_get_report(engine);
	CHECK_INT(calls.made, 0);
	CHECK_INT(calls.compiled, 0);
	CHECK_INT(calls.waited, 0);
	CHECK(calls.drawn > 0 || strcmp(method, "blur-hold") == 0);
	for (int i = 0; i < PICTURES; i++)
		picture_finish(&pictures[i]);
	engine_destroy(&engine);
	free(out);
}

static void test_steady_state(void)
{
	check_steady("pursuit", ENGINE_ANALYSIS_CPU);
	check_steady("pursuit", ENGINE_ANALYSIS_GPU);
	check_steady("adaptive-grid", ENGINE_ANALYSIS_CPU);
	check_steady("blur-hold", ENGINE_ANALYSIS_CPU);
}

/* The counters see what they are there for: a picture of another size needs other textures. */
static void test_counters_count(void)
{
	struct engine *engine = make(&params);
	struct picture picture;
	uint8_t *out = malloc((size_t)4 * 400 * 300);
	count_calls(engine);
	draw(&picture, 400, 300, 0.0);
	show_all(engine, &picture, out);
	CHECK(calls.made > 5);
	CHECK(calls.drawn > 0);
	picture_finish(&picture);
	engine_destroy(&engine);
	free(out);
}

/* ---- memory ---- */

#define MB UINT64_C(1000000)

/* Frames that need everything, at phases that do. */
static uint64_t memory_of(struct engine *engine, struct picture *pictures, uint32_t count, uint8_t *out)
{
	for (uint32_t i = 0; i < count; i++) {
		pictures[i].frame.header.frame_id = engine->report.frame_id + 1;
		begin(engine, &pictures[i], 3);
		show(engine, &pictures[i], ENGINE_SHOW_REAL, 0.0, out);
		show(engine, &pictures[i], ENGINE_SHOW_IN_BETWEEN, i ? 2.0 : 2.0 / 3, out);
	}
	return engine_get_report(engine)->memory_bytes;
}

/* Each pixel moves another way by up to three pixels, so that everything is snapped, folds, is torn and blurred. */
static void shake(const struct picture *picture, uint32_t seed)
{
	for (uint32_t y = 0; y < picture->height; y++)
		for (uint32_t x = 0; x < picture->width; x++) {
			const uint32_t bits = picture_random(&seed);
			picture_set_motion(picture, x, y, (float)(bits >> 8 & 0xff) / 42.0f - 3.0f,
							   (float)(bits >> 16 & 0xff) / 42.0f - 3.0f);
			picture_set_depth(picture, x, y, (float)(bits & 0xff) / 255.0f);
		}
}

static void check_memory(const char *name, const struct engine_params *own, struct picture pictures[2])
{
	struct engine *engine = make(own);
	uint8_t *out = malloc((size_t)4 * 1920 * 1080);
	const uint64_t bytes = memory_of(engine, pictures, 2, out);
	printf("%.1f MB at 1920x1080: %s\n", (double)bytes * 1e-6, name);
	CHECK(bytes > 5 * 4 * UINT64_C(1920) * 1080);
	CHECK(bytes <= 60 * MB);
	CHECK_INT(memory_of(engine, pictures, 2, out), bytes);
	CHECK(engine->bend.bent > 0 || own->motion_model != ENGINE_MOTION_QUADRATIC);
	engine_destroy(&engine);
	free(out);
}

static void test_memory(void)
{
	struct engine_params own = params, quadratic;
	struct picture pictures[2];
	/* All planes as large as they can be, the UI everywhere. */
	for (int i = 0; i < 2; i++) {
		draw(&pictures[i], 1920, 1080, i);
		for (uint32_t y = 0; y < 1080; y++)
			memset(picture_row(&pictures[i], PURSUIT_ROLE_UI, y), 0x40, (size_t)4 * 1920);
	}
	own.buffer_software = true;
	check_memory("default", &own, pictures);
	own.motion_model = ENGINE_MOTION_QUADRATIC;
	own.analysis = ENGINE_ANALYSIS_GPU;
	own.method = "adaptive-grid"; /* cells of 4 */
	quadratic = own;
	own.blur = ENGINE_BLUR_EVERYWHERE;
	check_memory("adaptive-grid, quadratic, analysed by GL, blurred everywhere", &own, pictures);
	/* Nothing can be left out. */
	for (int i = 0; i < 2; i++)
		shake(&pictures[i], 7u + (uint32_t)i);
	check_memory("adaptive-grid, quadratic, analysed by GL, everything wild", &quadratic, pictures);
	for (int i = 0; i < 2; i++)
		picture_finish(&pictures[i]);
}

/* ---- the way back ---- */

/* By buffers or at once: the same bits, and nothing beside them. Sizes of less than a row of blocks and of many. */
static void test_read_back(void)
{
	static const uint32_t sizes[][2] = {{1, 1}, {7, 3}, {640, 360}, {1500, 1000}, {2, 900}, {2048, 2}};
	struct engine_params own = params;
	own.buffer_software = true;
	struct engine *engines[2] = {make(&params), make(&own)};
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		const uint32_t width = sizes[i][0], height = sizes[i][1];
		const size_t stride = 4 * (size_t)width + 20, bytes = stride * height;
		struct picture picture;
		uint8_t *out[2] = {malloc(bytes), malloc(bytes)};
		picture_init(&picture, width, height, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
		picture_draw_layers(&picture, 0.0);
		for (int k = 0; k < 2; k++) {
			const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, 0.5};
			struct engine_image image = {.data = out[k], .stride = stride};
			struct error error = {""};
			memset(out[k], 0x5a, bytes);
			begin(engines[k], &picture, 2);
			CHECK_INT(engine_render(engines[k], &request, &image, &error), 0);
			CHECK_STRING(error.text, "");
		}
		CHECK(memcmp(out[0], out[1], bytes) == 0);
		CHECK(out[1][bytes - 1] == 0x5a && out[1][bytes - 21] == 255);
		picture_finish(&picture);
		free(out[0]);
		free(out[1]);
	}
	for (int k = 0; k < 2; k++)
		engine_destroy(&engines[k]);
}

/* ---- what does not move ---- */

/* Tiles of SHOWN that the picture made last has written. */
static uint32_t written(const struct engine *engine)
{
	struct tiles *tiles = &gl_of(engine)->shown.written;
	tiles_sum(tiles);
	return tiles->count;
}

/* Where all is blurred, what rests stays from one in-between to the next only. */
static void check_not_twice(struct engine *engine, const struct picture *picture, bool blurred)
{
	const size_t bytes = 4 * (size_t)picture->width * picture->height;
	uint8_t *kept = malloc(bytes), *anew = malloc(bytes);
	begin(engine, picture, 3);
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 1.0 / 3, kept);
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 2.0 / 3, kept);
	const uint32_t few = written(engine);
	/* From one real frame to the next. */
	begin(engine, picture, 3);
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 1.0 / 3, anew);
	CHECK(written(engine) <= (blurred ? 10 * 12 : few + 10));
	gl_of(engine)->shown.number = 0;
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 2.0 / 3, anew);
	CHECK_INT(written(engine), 10 * 12);
	CHECK(memcmp(kept, anew, bytes) == 0);
	CHECK(few > 0 && few < 10 * 12 * 2 / 3);
	/* There and back, also with the real frame between them. */
	show(engine, picture, ENGINE_SHOW_REAL, 0.4, kept);
	show(engine, picture, ENGINE_SHOW_REAL, 0.0, kept);
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 0.9, kept);
	show(engine, picture, ENGINE_SHOW_PLAIN, 0.0, kept);
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 2.0 / 3, kept);
	CHECK(memcmp(kept, anew, bytes) == 0);
	free(kept);
	free(anew);
}

static void test_still_is_not_drawn_twice(void)
{
	for (int i = 0; i < 4; i++) {
		struct engine_params own = params;
		struct picture picture;
		own.blur = i == 3 ? ENGINE_BLUR_EVERYWHERE : ENGINE_BLUR_DOUBTFUL;
		struct engine *engine = make(&own);
		picture_init(&picture, 640, 360, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | (i ? PICTURE_UI : 0u));
		picture_draw_discs(&picture, 0.4 * i);
		for (uint32_t y = 40; y < 60 && i; y++)
			memset(picture_row(&picture, PURSUIT_ROLE_UI, y) + 400, 0x70, 600);
		check_not_twice(engine, &picture, i == 3);
		picture_finish(&picture);
		engine_destroy(&engine);
	}
}

/* ---- bits ---- */

/* Large patches that fold over each other, without depth. */
static void draw_patches(struct picture *picture, uint32_t seed)
{
	picture_init(picture, 400, 300, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION);
	picture_draw_layers(picture, 0.0);
	for (uint32_t y = 0; y < picture->height; y++)
		for (uint32_t x = 0; x < picture->width; x++) {
			uint32_t state = seed + x / 64 * 7919u + y / 64 * 104729u;
			picture_random(&state);
			const float mx = (float)(picture_random(&state) & 0xffff) / 32768.0f - 1.0f;
			const float my = (float)(picture_random(&state) & 0xffff) / 32768.0f - 1.0f;
			picture_set_motion(picture, x, y, 100.0f * mx, 100.0f * my);
		}
}

/*
 * All contexts of a CPU renderer give the same bits. llvmpipe (Mesa 22.3) has a shorter way for pictures in BGRA order
 * that takes red for blue at some borders of large triangles; in RGBA order, as the engine takes them, it does not.
 */
static void test_contexts_agree(void)
{
	struct engine_params own = params, other = {.context = ENGINE_CONTEXT_EGL_SURFACELESS, .gles = true};
	uint8_t *out = malloc((size_t)4 * 400 * 300), *want = malloc((size_t)4 * 400 * 300);
	own.display_width_mm = other.display_width_mm = 10.0f;
	own.viewing_distance_mm = other.viewing_distance_mm = 10000.0f;
	struct engine *engines[2] = {make(&own), make(&other)};
	for (uint32_t i = 0; i < 8 && engine_get_info(engines[0])->software; i++) {
		struct picture picture;
		draw_patches(&picture, 11 * i);
		for (int k = 0; k < 2; k++)
			begin(engines[k], &picture, 4);
		for (int step = 0; step < 7; step++) {
			show(engines[0], &picture, ENGINE_SHOW_IN_BETWEEN, 0.125 * step, out);
			show(engines[1], &picture, ENGINE_SHOW_IN_BETWEEN, 0.125 * step, want);
			CHECK(memcmp(out, want, (size_t)4 * 400 * 300) == 0);
		}
		picture_finish(&picture);
	}
	for (int k = 0; k < 2; k++)
		engine_destroy(&engines[k]);
	free(out);
	free(want);
}

/* ---- failures ---- */

static uint32_t fails_at; /* the call, counted from 1, that fails; 0: none */

static bool fails(void)
{
	return fails_at > 0 && --fails_at == 0;
}

static GLenum fail_framebuffer(GLenum target)
{
	const GLenum status = real.CheckFramebufferStatus(target);
	return fails() ? GL_FRAMEBUFFER_UNSUPPORTED : status;
}

static void *fail_map(GLenum target, GLintptr offset, GLsizeiptr length, GLbitfield access)
{
	return fails() ? NULL : real.MapBufferRange(target, offset, length, access);
}

static GLboolean fail_unmap(GLenum target)
{
	const GLboolean good = real.UnmapBuffer(target);
	return fails() ? GL_FALSE : good;
}

/* A frame of which any step may fail. True if one did. */
static bool try_all(struct engine *engine, const struct picture *picture, uint8_t *out)
{
	struct error error = {""};
	const struct engine_begin_params how = {.n = 3, .last_phase = -1.0};
	struct engine_image image = {.data = out, .stride = 4 * (size_t)picture->width};
	const struct engine_request requests[] = {{ENGINE_SHOW_REAL, 0.0}, {ENGINE_SHOW_IN_BETWEEN, 1.0 / 3}};
	bool failed = engine_begin(engine, &picture->frame, &how, &error) < 0;
	for (int i = 0; i < 2 && !failed; i++)
		failed = engine_render(engine, &requests[i], &image, &error) < 0;
	CHECK(!failed || error.text[0]);
	return failed;
}

static void show_both(struct engine *engine, const struct picture *picture, uint8_t *out)
{
	begin(engine, picture, 3);
	show(engine, picture, ENGINE_SHOW_REAL, 0.0, out);
	show(engine, picture, ENGINE_SHOW_IN_BETWEEN, 1.0 / 3, out + 4 * (size_t)picture->width * picture->height);
}

/* What fails while a frame of another size is taken and shown is told, and the next is shown as if nothing had. */
static void check_failures(enum engine_analysis analysis, bool shrinks)
{
	struct engine_params own = params;
	struct picture small, large;
	const struct picture *fails_with = shrinks ? &small : &large;
	const size_t bytes = (size_t)2 * 4 * 400 * 300;
	uint8_t *want = malloc(bytes), *out = malloc(bytes);
	uint32_t count = 0;
	bool failed = true;
	own.analysis = analysis;
	own.buffer_software = true;
	struct engine *engine = make(&own);
	struct gl *gl = &gl_of(engine)->context->gl;
	draw(&small, 200, 150, 0.0);
	shake(&small, 1);
	draw(&large, 400, 300, 0.7);
	show_both(engine, &large, want);
	real = *gl;
	gl->CheckFramebufferStatus = fail_framebuffer;
	gl->MapBufferRange = fail_map;
	gl->UnmapBuffer = fail_unmap;
	while (failed) {
		fails_at = 0;
		show_both(engine, shrinks ? &large : &small, out);
		fails_at = ++count;
		failed = try_all(engine, fails_with, out);
		CHECK_INT(failed, fails_at == 0);
		fails_at = 0;
		show_both(engine, &large, out);
		const bool same = memcmp(out, want, bytes) == 0;
		CHECK(same);
		if (!same)
			fprintf(stderr, "after failure %u another picture is shown\n", count);
	}
	CHECK(count > 15);
	picture_finish(&small);
	picture_finish(&large);
	engine_destroy(&engine);
	free(want);
	free(out);
}

static void test_failures(void)
{
	check_failures(ENGINE_ANALYSIS_CPU, false);
	check_failures(ENGINE_ANALYSIS_CPU, true);
	check_failures(ENGINE_ANALYSIS_GPU, false);
}

/* ---- times ---- */

static bool is_on_cpu(const char *name)
{
	return strcmp(name, "analyse") == 0 || strcmp(name, "field") == 0 || strcmp(name, "paint") == 0;
}

/*
 * Each pass that ran took some time, and all together no more than passed; of a CPU renderer's threads each may be in
 * another pass.
 */
static void check_times(const struct engine *engine, const struct engine_report *report, double wall_ms)
{
	const double threads = engine_get_info(engine)->software ? (double)sysconf(_SC_NPROCESSORS_ONLN) : 1.0;
	double sum = 0.0;
	uint32_t ran = 0;
	CHECK_STRING(report->time_source, "timer-query");
	for (uint32_t i = 0; i < report->pass_count; i++) {
		const struct engine_pass_report *pass = &report->passes[i];
		CHECK(pass->ms >= 0.0 && (pass->runs > 0 || pass->ms == 0.0));
		if (pass->runs > 0 && !is_on_cpu(pass->name)) {
			sum += pass->ms;
			ran++;
		}
	}
	CHECK(ran >= 4);
	CHECK(sum > 0.0);
	CHECK(sum <= wall_ms * threads);
	printf("%u passes of the renderer, %.3f of %.3f ms\n", ran, sum, wall_ms);
}

static void test_timer_queries(void)
{
	struct engine_params own = params;
	struct picture picture;
	uint8_t *out = malloc((size_t)4 * 640 * 360);
	own.query_software = true;
	struct engine *engine = make(&own);
	if (!gl_of(engine)->timer.queries) {
		printf("no timer queries here\n");
		CHECK(!real.timer_queries);
		engine_destroy(&engine);
		free(out);
		return;
	}
	draw(&picture, 640, 360, 0.0);
	for (int i = 0; i < 3; i++) {
		const uint64_t began = now_ns();
		show_all(engine, &picture, out);
		const struct engine_report *report = engine_get_report(engine);
		check_times(engine, report, (double)(now_ns() - began) * 1e-6);
		CHECK_INT(gl_of(engine)->timer.pending, 0);
	}
	/* What nobody asks for is forgotten, not counted for the next frame; and more than there are queries is no harm. */
	for (int i = 0; i < 3; i++)
		show_all(engine, &picture, out);
	begin(engine, &picture, 3);
	for (int i = 0; i < 2 * TIMER_QUERIES; i++)
		show(engine, &picture, ENGINE_SHOW_PLAIN, 0.0, out);
	CHECK(gl_of(engine)->timer.pending <= TIMER_QUERIES);
	CHECK(engine_get_report(engine)->pass_count > 0);
	picture_finish(&picture);
	engine_destroy(&engine);
	free(out);
}

int main(int argc, char **argv)
{
	const char *kind = argc > 1 ? argv[1] : "surfaceless";
	struct error error;
	params.context = strcmp(kind, "osmesa") == 0 ? ENGINE_CONTEXT_OSMESA : ENGINE_CONTEXT_EGL_SURFACELESS;
	params.gles = strcmp(kind, "gles") == 0;
	struct engine *engine = engine_create(&params, &error);
	if (!engine)
		SKIP(error.text);
	real = *table_of(engine);
	engine_destroy(&engine);
	if (argc > 2 && strcmp(argv[2], "memory") == 0) {
		RUN(test_memory);
		return test_result();
	}
	RUN(test_counters_count);
	RUN(test_steady_state);
	RUN(test_read_back);
	RUN(test_still_is_not_drawn_twice);
	RUN(test_contexts_agree);
	RUN(test_failures);
	RUN(test_timer_queries);
	return test_result();
}
