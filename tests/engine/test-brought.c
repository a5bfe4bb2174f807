/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* An engine in a context that was brought: what it leaves in a texture is, to the bit, what it reads back. */
#include "tests/test.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <errno.h>

#include <GL/glcorearb.h>

#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"

#define WIDTH 321u
#define HEIGHT 123u
#define BYTES ((size_t)4 * WIDTH * HEIGHT)
#define TEXTURES 6u

static struct {
	EGLDisplay display;
	EGLContext shows, draws; /* of one share group: the presenter's and the engine's */
	bool lost;
	PFNGLGENTEXTURESPROC gen_textures;
	PFNGLBINDTEXTUREPROC bind_texture;
	PFNGLTEXIMAGE2DPROC tex_image;
	PFNGLGETTEXIMAGEPROC get_tex_image;
	PFNGLCLIENTWAITSYNCPROC client_wait_sync;
	PFNGLGETINTEGERVPROC get_integer;
	uint32_t waits; /* for all that was drawn */
} gl;

static void find(const char *name, void *function)
{
	void (*found)(void) = eglGetProcAddress(name);
	memcpy(function, &found, sizeof(found));
}

static EGLContext make_context(EGLContext share)
{
	const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
	return eglCreateContext(gl.display, EGL_NO_CONFIG_KHR, share, attributes);
}

static bool make_current(EGLContext context)
{
	return eglMakeCurrent(gl.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

static bool start(void)
{
	gl.display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
	if (!gl.display || !eglInitialize(gl.display, NULL, NULL) || !eglBindAPI(EGL_OPENGL_API))
		return false;
	gl.shows = make_context(EGL_NO_CONTEXT);
	gl.draws = gl.shows ? make_context(gl.shows) : EGL_NO_CONTEXT;
	find("glGenTextures", &gl.gen_textures);
	find("glBindTexture", &gl.bind_texture);
	find("glTexImage2D", &gl.tex_image);
	find("glGetTexImage", &gl.get_tex_image);
	return gl.draws != EGL_NO_CONTEXT;
}

static bool enter(void *data)
{
	(void)data;
	return !gl.lost && make_current(gl.draws);
}

static void release(void *data)
{
	(void)data;
	make_current(EGL_NO_CONTEXT);
}

static GLenum APIENTRY count_wait(GLsync sync, GLbitfield flags, GLuint64 timeout)
{
	gl.waits++;
	return gl.client_wait_sync(sync, flags, timeout);
}

/* A renderer of larger pictures than there are. */
static void APIENTRY tell_more(GLenum name, GLint *values)
{
	gl.get_integer(name, values);
	if (name == GL_MAX_TEXTURE_SIZE || name == GL_MAX_VIEWPORT_DIMS)
		values[0] = 2 * (GLint)PURSUIT_MAX_SIZE;
	if (name == GL_MAX_VIEWPORT_DIMS)
		values[1] = values[0];
}

typedef void (*function)(void);

static function find_counted(const char *name)
{
	if (strcmp(name, "glGetIntegerv") == 0) {
		find(name, &gl.get_integer);
		return (function)tell_more;
	}
	if (strcmp(name, "glClientWaitSync") != 0)
		return eglGetProcAddress(name);
	find(name, &gl.client_wait_sync);
	return (function)count_wait;
}

static const struct engine_context brought = {.name = "test", .enter = enter, .release = release, .find = find_counted};

static struct engine *make(const char *method, enum engine_context_kind kind)
{
	const struct engine_params params = {
		.method = method, .context = kind, .brought = &brought, .buffer_software = true};
	struct error error = {""};
	struct engine *engine = engine_create(&params, &error);
	if (!engine)
		fprintf(stderr, "%s\n", error.text);
	CHECK(engine != NULL);
	return engine;
}

static uint32_t make_texture(void)
{
	GLuint texture;
	gl.gen_textures(1, &texture);
	gl.bind_texture(GL_TEXTURE_2D, texture);
	gl.tex_image(GL_TEXTURE_2D, 0, GL_RGBA, WIDTH, HEIGHT, 0, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, NULL);
	return texture;
}

#define MARGIN 9u
#define LARGER_WIDTH (WIDTH + 2 * MARGIN)
#define LARGER_BYTES ((size_t)4 * LARGER_WIDTH * (HEIGHT + 2 * MARGIN))

/* One that is larger than the picture, which has its place in the middle. */
static struct engine_image make_larger(void)
{
	static uint8_t pixels[LARGER_BYTES];
	const uint32_t texture = make_texture();
	memset(pixels, 0x5a, LARGER_BYTES);
	gl.bind_texture(GL_TEXTURE_2D, texture);
	gl.tex_image(GL_TEXTURE_2D, 0, GL_RGBA, LARGER_WIDTH, HEIGHT + 2 * MARGIN, 0, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV,
				 pixels);
	return (struct engine_image){.texture = texture, .texture_x = MARGIN, .texture_y = MARGIN};
}

/* As the other context sees it. */
static void look(uint32_t texture, uint8_t *pixels)
{
	CHECK(make_current(gl.shows));
	gl.bind_texture(GL_TEXTURE_2D, texture);
	gl.get_tex_image(GL_TEXTURE_2D, 0, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, pixels);
}

static uint32_t runs_of(struct engine *engine, const char *name)
{
	const struct engine_report *report = engine_get_report(engine);
	for (uint32_t i = 0; i < report->pass_count; i++)
		if (strcmp(report->passes[i].name, name) == 0)
			return report->passes[i].runs;
	return 0;
}

static void check_method(const char *method)
{
	static const struct engine_request requests[] = {{ENGINE_SHOW_REAL, 0.0},
													 {ENGINE_SHOW_REAL, 0.2},
													 {ENGINE_SHOW_IN_BETWEEN, 0.33},
													 {ENGINE_SHOW_IN_BETWEEN, 0.66},
													 {ENGINE_SHOW_PLAIN, 0.0}};
	static uint8_t read[BYTES], left[BYTES];
	const struct engine_begin_params begin = {.n = 3, .last_phase = -1.0};
	struct engine *engine = make(method, ENGINE_CONTEXT_EGL_SURFACELESS);
	const uint32_t texture = make_texture();
	struct picture picture;
	struct error error = {""};

	CHECK_STRING(engine_get_info(engine)->context, "test");
	CHECK(engine_get_info(engine)->brought);
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
	picture_draw_layers(&picture, 0.0);
	memset(picture_row(&picture, PURSUIT_ROLE_UI, 20), 0x60, (size_t)4 * WIDTH);
	for (size_t i = 0; i < sizeof(requests) / sizeof(requests[0]); i++) {
		struct engine_image image = {.data = read, .stride = (size_t)4 * WIDTH}, target = {.texture = texture};
		CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
		CHECK_INT(engine_render(engine, &requests[i], &target, &error), 0);
		CHECK_INT(runs_of(engine, "read"), 0);
		CHECK_INT(engine_get_report(engine)->bytes_down, 0);
		look(texture, left);
		CHECK_INT(engine_render(engine, &requests[i], &image, &error), 0);
		CHECK_INT(runs_of(engine, "read"), 1);
		CHECK(memcmp(read, left, BYTES) == 0);
		CHECK(target.holds != 0 && image.holds != 0);
	}
	picture_finish(&picture);
	engine_destroy(&engine);
}

static void test_same_bits(void)
{
	for (const struct engine_method_info *method = engine_methods(); method->name; method++)
		check_method(method->name);
}

/* What the texture holds is not copied again. */
static void test_kept(void)
{
	const struct engine_begin_params begin = {.n = 1};
	const struct engine_request request = {ENGINE_SHOW_PLAIN, 0.0};
	struct engine *engine = make("hold", ENGINE_CONTEXT_EGL_SURFACELESS);
	struct engine_image image = {.texture = make_texture()};
	struct picture picture;
	struct error error = {""};
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, 0);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 3);
	CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	CHECK_INT(runs_of(engine, "copy"), 1);
	image.holds = 0;
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	CHECK_INT(runs_of(engine, "copy"), 2);
	picture_finish(&picture);
	engine_destroy(&engine);
}

/* A patch that moves, elsewhere in each frame; the rest stands still. */
static void move_patch(const struct picture *picture, uint32_t frame)
{
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			const bool inside = x / 50 == frame % 6 && y / 40 == frame % 3;
			picture_set_motion(picture, x, y, inside ? 3.5f : 0.0f, inside ? -2.0f : 0.0f);
			if (inside)
				picture_row(picture, PURSUIT_ROLE_COLOR, y)[4 * x] ^= (uint8_t)(frame * 7 + y);
		}
}

/* The picture, and nothing around it has been written to. */
static bool shows(const struct engine_image *target, const uint8_t *picture)
{
	static uint8_t left[LARGER_BYTES], want[LARGER_BYTES];
	const size_t stride = 4 * (size_t)(WIDTH + 2 * target->texture_x);
	const size_t bytes = stride * (HEIGHT + 2 * target->texture_y);
	look(target->texture, left);
	memset(want, 0x5a, bytes);
	for (size_t y = 0; y < HEIGHT; y++)
		memcpy(want + (y + target->texture_y) * stride + 4 * (size_t)target->texture_x, picture + 4 * WIDTH * y,
			   4 * WIDTH);
	return memcmp(left, want, bytes) == 0;
}

/* One of the textures shows a picture, to the bit as it is read back; some have been drawn over, which is said. */
static void check_texture(struct engine *engine, struct engine_image *target, uint32_t step)
{
	static uint8_t read[BYTES];
	const struct engine_request request = {step % 3 ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, 0.25 * (step % 4)};
	struct engine_image image = {.data = read, .stride = (size_t)4 * WIDTH};
	struct error error = {""};
	target->holds = step % 11 == 10 ? 0 : target->holds;
	CHECK_INT(engine_render(engine, &request, target, &error), 0);
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	CHECK(shows(target, read));
}

/* Tiles that a texture has are not copied to it again, whichever of several, one of them larger, has its turn. */
static void test_textures_in_turn(void)
{
	const struct engine_begin_params begin = {.n = 3, .last_phase = -1.0};
	struct engine *engine = make("pursuit", ENGINE_CONTEXT_EGL_SURFACELESS);
	struct engine_image targets[TEXTURES] = {0};
	struct picture picture;
	struct error error = {""};
	uint64_t kept = 0;
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 9);
	memset(picture_row(&picture, PURSUIT_ROLE_UI, 50), 0x60, (size_t)2 * WIDTH);
	targets[0] = make_larger();
	for (uint32_t i = 1; i < TEXTURES; i++)
		targets[i].texture = make_texture();
	for (uint32_t frame = 0; frame < 24; frame++) {
		move_patch(&picture, frame / 2);
		picture_row(&picture, PURSUIT_ROLE_UI, 50)[frame] ^= 0x20;
		CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
		for (uint32_t i = 0; i < 3; i++)
			check_texture(engine, &targets[(3 * frame + i) % TEXTURES], 3 * frame + i);
		kept += engine_get_report(engine)->bytes_kept;
	}
	CHECK(kept > 24 * BYTES);
	picture_finish(&picture);
	engine_destroy(&engine);
}

/* Who fences the texture himself need not wait for it; who wants to know when it is done waits later. */
static void test_unfinished(void)
{
	const struct engine_begin_params begin = {.n = 1};
	const struct engine_request request = {ENGINE_SHOW_PLAIN, 0.0};
	struct engine *engine = make("hold", ENGINE_CONTEXT_EGL_SURFACELESS);
	struct engine_image finished = {.texture = make_texture()};
	struct engine_image image = {.texture = make_texture(), .unfinished = true};
	static uint8_t want[BYTES], got[BYTES];
	struct picture picture;
	struct error error = {""};
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, 0);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 5);
	CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
	const uint32_t waits = gl.waits;
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	CHECK_INT(gl.waits, waits);
	CHECK_INT(engine_finish(engine, &error), 0);
	CHECK_INT(gl.waits, waits + 1);
	CHECK_INT(engine_render(engine, &request, &finished, &error), 0);
	CHECK_INT(gl.waits, waits + 2);
	look(image.texture, got);
	look(finished.texture, want);
	CHECK(memcmp(got, want, BYTES) == 0);
	gl.lost = true;
	CHECK_INT(engine_finish(engine, &error), -EIO);
	gl.lost = false;
	picture_finish(&picture);
	engine_destroy(&engine);

	engine = make("hold", ENGINE_CONTEXT_CPU);
	CHECK_INT(engine_finish(engine, &error), 0);
	engine_destroy(&engine);
}

/* The context goes with pictures on their way to memory, so that none is current: they are lost, or were there before.
 */
static void test_lost_under_way(void)
{
	static uint8_t out[3][BYTES], untouched[BYTES];
	const struct engine_begin_params begin = {.n = 1};
	const struct engine_request request = {ENGINE_SHOW_PLAIN, 0.0};
	struct picture picture;
	struct error error = {""};
	picture_init(&picture, WIDTH, HEIGHT, PURSUIT_FORMAT_BGRA8, 0);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 5);
	for (int dropped = 0; dropped < 2; dropped++) {
		struct engine *engine = make("hold", ENGINE_CONTEXT_EGL_SURFACELESS);
		struct engine_image image = {.data = out[0], .stride = (size_t)4 * WIDTH, .unfinished = true};
		CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
		CHECK_INT(engine_render(engine, &request, &image, &error), 0);
		CHECK_INT(engine_finish(engine, &error), 0);
		image.data = out[1 + dropped];
		CHECK_INT(engine_render(engine, &request, &image, &error), 0);
		engine_leave(engine);
		gl.lost = true;
		if (dropped)
			engine_drop(engine);
		CHECK_INT(engine_take(engine, &image, &error), dropped ? -ENOENT : 0);
		CHECK(dropped || (image.data == out[0] && memcmp(out[0], untouched, BYTES) != 0));
		CHECK_INT(engine_take(engine, &image, &error), dropped ? -ENOENT : -EIO);
		CHECK(dropped || (image.data == out[1] && strstr(error.text, "lost")));
		engine_destroy(&engine);
		gl.lost = false;
		CHECK(memcmp(out[1 + dropped], untouched, BYTES) == 0);
	}
	picture_finish(&picture);
}

/* One that was not asked for, that of a CPU renderer for AUTO, and a lost one. */
static void test_not_taken(void)
{
	const struct engine_begin_params begin = {.n = 1};
	const struct engine_request request = {ENGINE_SHOW_PLAIN, 0.0};
	struct engine_image image = {.texture = 1};
	struct engine *engine = make("hold", ENGINE_CONTEXT_CPU);
	struct picture picture;
	struct error error = {""};
	picture_init(&picture, 8, 8, PURSUIT_FORMAT_BGRA8, 0);
	CHECK(!engine_get_info(engine)->brought);
	CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), 0);
	CHECK_INT(engine_render(engine, &request, &image, &error), -EINVAL);
	CHECK(strstr(error.text, "texture") != NULL);
	engine_destroy(&engine);

	engine = make("hold", ENGINE_CONTEXT_AUTO);
	CHECK(!engine_get_info(engine)->brought || !engine_get_info(engine)->software);
	engine_destroy(&engine);

	gl.lost = true;
	engine = make("hold", ENGINE_CONTEXT_EGL_SURFACELESS);
	CHECK(!engine_get_info(engine)->brought);
	engine_destroy(&engine);
	gl.lost = false;

	engine = make("hold", ENGINE_CONTEXT_EGL_SURFACELESS);
	CHECK(engine_get_info(engine)->brought);
	gl.lost = true;
	CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), -EIO);
	engine_destroy(&engine);
	gl.lost = false;
	picture_finish(&picture);
}

static void test_too_large(void)
{
	const struct engine_begin_params begin = {.n = 2, .last_phase = -1.0};
	struct engine *engine = make("hold", ENGINE_CONTEXT_EGL_SURFACELESS);
	struct picture picture;
	struct error error = {""};
	picture_init(&picture, PURSUIT_MAX_SIZE + 4096, 1, PURSUIT_FORMAT_BGRA8, 0);
	CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), -EINVAL);
	CHECK(strstr(error.text, "20480 x 1") && strstr(error.text, "16384 x 16384"));
	picture_finish(&picture);
	engine_destroy(&engine);
}

int main(void)
{
	if (!start())
		SKIP("no two GL contexts that share");
	RUN(test_same_bits);
	RUN(test_kept);
	RUN(test_textures_in_turn);
	RUN(test_unfinished);
	RUN(test_lost_under_way);
	RUN(test_not_taken);
	RUN(test_too_large);
	return test_result();
}
