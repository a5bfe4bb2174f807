/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Read-back of textures with known pixels, on GL core and GLES: every pair of
 * texture and plane format, orientation, sign, state, order, and fences that
 * are not signalled.
 */

#include <errno.h>

#include "tests/client/egl_context.h"
#include "tests/client/gl_pattern.h"
#include "tests/client/harness.h"
#include "tests/test.h"

static bool es;
static struct fake_daemon daemon_side;
static struct pursuit_stream *stream;
static struct pursuit_gl *gl;

/* ---- a stream and its frame ---- */

static struct pursuit_stream_params default_params(void)
{
	return (struct pursuit_stream_params){
		.width = WIDTH,
		.height = HEIGHT,
		.geometry_width = GEOMETRY_WIDTH,
		.geometry_height = GEOMETRY_HEIGHT,
		.color_format = PURSUIT_COLOR_BGRA8,
		.depth_format = PURSUIT_DEPTH_FLOAT32,
		.motion_format = PURSUIT_MOTION_FLOAT16,
		.ui_format = PURSUIT_UI_RGBA8,
		.object_id_format = PURSUIT_OBJECT_ID_UINT16,
		.socket_path = harness.path,
	};
}

static struct pursuit_gl_textures default_textures(void)
{
	return (struct pursuit_gl_textures){
		.color = color_texture(GL_RGBA8),
		.depth = depth_texture(GL_R32F),
		.motion = motion_texture(GL_RG16F),
		.ui = color_texture(GL_RGBA8),
		.object_id = id_texture(GL_R16UI),
	};
}

static void delete_textures(const struct pursuit_gl_textures *textures)
{
	const GLuint names[] = {textures->color, textures->depth, textures->motion, textures->ui, textures->object_id};
	glDeleteTextures(5, names);
}

static void begin(const struct pursuit_stream_params *params, pursuit_gl_lookup lookup)
{
	CHECK(fake_start(&daemon_side, harness.path, FAKE_GOOD));
	stream = pursuit_open(params);
	CHECK(stream && attach(stream, &daemon_side));
	gl = pursuit_gl_create(stream, lookup);
	CHECK(gl != NULL);
}

static void end(void)
{
	CHECK_INT(glGetError(), GL_NO_ERROR);
	pursuit_gl_destroy(&gl);
	CHECK(gl == NULL);
	pursuit_gl_destroy(&gl);
	pursuit_close(&stream);
	fake_stop(&daemon_side, true);
	CHECK_INT(glGetError(), GL_NO_ERROR);
}

/* Reads one frame back and takes it as the daemon; NULL if none came. */
static const struct pursuit_frame_header *read_back(const struct pursuit_gl_textures *textures, const uint8_t **planes)
{
	struct pursuit_frame frame = {.time_ns = 1000};

	CHECK_INT(pursuit_gl_submit(gl, textures, &frame), 0);
	pursuit_gl_flush(gl);
	return fake_take(&daemon_side, planes);
}

/* ---- tests ---- */

static void test_all_planes(void)
{
	struct pursuit_stream_params params = default_params();
	struct pursuit_gl_textures textures = default_textures();
	const uint8_t *planes = NULL;

	begin(&params, egl_context_lookup);
	const struct pursuit_frame_header *header = read_back(&textures, &planes);
	CHECK(header != NULL);
	if (header) {
		CHECK_INT(header->plane_count, 5);
		CHECK_INT(header->flags, 0);
		CHECK_INT(wrong_colors(&header->planes[0], planes, false), 0);
		CHECK(worst_depth(&header->planes[1], planes) == 0.0);
		CHECK_INT(wrong_motion(&header->planes[2], planes, false, 1.0f), 0);
		CHECK_INT(wrong_colors(&header->planes[3], planes, false), 0);
		CHECK_INT(wrong_ids(&header->planes[4], planes), 0);
		CHECK_INT(status_of(stream).bytes_copied, WIDTH * HEIGHT * 8 + GEOMETRY_WIDTH * GEOMETRY_HEIGHT * (4 + 4 + 2));
	}
	delete_textures(&textures);
	end();
}

static void test_turned(void)
{
	struct pursuit_stream_params params = default_params();
	struct pursuit_gl_textures textures = default_textures();
	const uint8_t *planes = NULL;

	textures.bottom_up = 1;
	textures.motion_y_up = 1;
	begin(&params, egl_context_lookup);
	const struct pursuit_frame_header *header = read_back(&textures, &planes);
	CHECK(header != NULL);
	if (header) {
		CHECK_INT(wrong_colors(&header->planes[0], planes, true), 0);
		CHECK_INT(wrong_motion(&header->planes[2], planes, true, -1.0f), 0);
	}
	delete_textures(&textures);
	end();
}

static void test_color_formats(void)
{
	const GLenum internals[] = {GL_RGBA8, GL_RGBA8, GL_RGB10_A2, GL_RGBA16F, GL_SRGB8_ALPHA8};
	const enum pursuit_color_format formats[] = {PURSUIT_COLOR_BGRA8, PURSUIT_COLOR_RGBA8, PURSUIT_COLOR_RGB10A2,
												 PURSUIT_COLOR_RGBA16F, PURSUIT_COLOR_BGRA8};

	for (int i = 0; i < 5; i++) {
		struct pursuit_stream_params params = {
			.width = WIDTH, .height = HEIGHT, .color_format = formats[i], .socket_path = harness.path};
		struct pursuit_gl_textures textures = {.color = color_texture(internals[i])};
		const uint8_t *planes = NULL;
		begin(&params, egl_context_lookup);
		const struct pursuit_frame_header *header = read_back(&textures, &planes);
		CHECK(header && wrong_colors(&header->planes[0], planes, false) == 0);
		if (!header) {
			fprintf(stderr, "color %d: %s\n", i, status_of(stream).message);
		}
		delete_textures(&textures);
		end();
	}
}

static void test_depth_formats(void)
{
	const GLenum internals[] = {GL_R32F, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT16};
	const enum pursuit_depth_format formats[] = {PURSUIT_DEPTH_FLOAT32, PURSUIT_DEPTH_UNORM24, PURSUIT_DEPTH_UNORM16};

	for (int i = 0; i < (es ? 3 : 12); i++) {
		struct pursuit_stream_params params = default_params();
		struct pursuit_gl_textures textures = default_textures();
		const uint8_t *planes = NULL;
		glDeleteTextures(1, &textures.depth);
		textures.depth = depth_texture(internals[i / 3]);
		params.depth_format = formats[i % 3];
		begin(&params, egl_context_lookup);
		const struct pursuit_frame_header *header = read_back(&textures, &planes);
		bool coarse = i / 3 == 3 || i % 3 == 2;
		CHECK(header && worst_depth(&header->planes[1], planes) <= (coarse ? 1.01 / 65535 : 1.01 / 16777215));
		if (!header) {
			fprintf(stderr, "depth %d: %s\n", i, status_of(stream).message);
		}
		delete_textures(&textures);
		end();
	}
}

static void test_motion_and_id_formats(void)
{
	const GLenum motions[] = {GL_RG16F, GL_RG32F}, ids[] = {GL_R8UI, GL_R16UI, GL_R32UI};
	const enum pursuit_motion_format motion_formats[] = {PURSUIT_MOTION_FLOAT16, PURSUIT_MOTION_FLOAT32};
	const enum pursuit_object_id_format id_formats[] = {PURSUIT_OBJECT_ID_UINT8, PURSUIT_OBJECT_ID_UINT16,
														PURSUIT_OBJECT_ID_UINT32};

	for (int i = 0; i < 9; i++) {
		struct pursuit_stream_params params = default_params();
		struct pursuit_gl_textures textures = default_textures();
		const uint8_t *planes = NULL;
		glDeleteTextures(2, (const GLuint[]){textures.motion, textures.object_id});
		textures.motion = motion_texture(motions[i % 2]);
		textures.object_id = id_texture(ids[i % 3]);
		textures.motion_y_up = 1;
		params.motion_format = motion_formats[i / 2 % 2];
		params.object_id_format = id_formats[i / 3];
		begin(&params, egl_context_lookup);
		const struct pursuit_frame_header *header = read_back(&textures, &planes);
		CHECK(header && wrong_motion(&header->planes[2], planes, false, -1.0f) == 0);
		CHECK(header && wrong_ids(&header->planes[4], planes) == 0);
		if (!header) {
			fprintf(stderr, "motion and id %d: %s\n", i, status_of(stream).message);
		}
		delete_textures(&textures);
		end();
	}
}

/* A frame leaves with the call after its own, with its own number, times and flags. */
static void test_order(void)
{
	struct pursuit_stream_params params = default_params();
	struct pursuit_gl_textures textures = default_textures();
	uint64_t last = 0;

	begin(&params, egl_context_lookup);
	for (uint64_t id = 1; id <= 5; id++) {
		struct pursuit_frame frame = {.time_ns = id * 1000, .flags = id == 3 ? PURSUIT_FLAG_CUT : 0};
		frame.motion_interval_ns = id;
		last = pursuit_gl_submit(gl, &textures, &frame);
		CHECK_INT(last, id - 1);
		const struct pursuit_frame_header *header = fake_take(&daemon_side, NULL);
		CHECK_INT(header ? header->frame_id : 0, id - 1);
		if (header) {
			CHECK_INT(header->time_ns, (id - 1) * 1000);
			CHECK_INT(header->motion_interval_ns, id - 1);
			CHECK_INT(header->real_interval_ns, id == 2 ? 0 : 1000);
			CHECK_INT(header->flags, id == 4 ? PURSUIT_FRAME_CUT : 0);
		}
		glFinish();
	}
	CHECK_INT(pursuit_gl_update(gl), 5);
	CHECK_INT(pursuit_gl_update(gl), 0);
	CHECK_INT(pursuit_gl_flush(gl), 0);
	delete_textures(&textures);
	end();
}

static int reads;

static void count_reads(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type, void *pixels)
{
	reads++;
	glReadPixels(x, y, width, height, format, type, pixels);
}

static void *counting_lookup(const char *name)
{
	void (*function)(GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void *) = count_reads;
	void *address;

	memcpy(&address, &function, sizeof(address));
	return strcmp(name, "glReadPixels") == 0 ? address : egl_context_lookup(name);
}

static void test_no_daemon(void)
{
	struct pursuit_stream_params params = default_params();
	struct pursuit_gl_textures textures = default_textures();
	struct pursuit_frame frame = {.time_ns = 1};

	stream = pursuit_open(&params);
	gl = pursuit_gl_create(stream, counting_lookup);
	for (int i = 0; i < 10; i++) {
		CHECK_INT(pursuit_gl_submit(gl, &textures, &frame), 0);
	}
	CHECK_INT(pursuit_gl_flush(gl), 0);
	CHECK_INT(status_of(stream).submitted, 10);
	CHECK_INT(status_of(stream).bytes_copied, 0);
	CHECK_INT(reads, 0);
	pursuit_gl_destroy(&gl);
	pursuit_close(&stream);
	delete_textures(&textures);
}

static void test_missing_textures(void)
{
	struct pursuit_stream_params params = default_params();
	struct pursuit_gl_textures textures = default_textures(), some = {.color = textures.color};
	const uint8_t *planes = NULL;

	begin(&params, egl_context_lookup);
	CHECK(read_back(&textures, &planes) != NULL);
	for (int i = 0; i < 4; i++) {
		struct pursuit_frame frame = {.time_ns = 2000};
		pursuit_gl_submit(gl, &some, &frame);
		pursuit_gl_flush(gl);
		const struct pursuit_frame_header *header = fake_take(&daemon_side, &planes);
		CHECK(header && header->flags == PURSUIT_FRAME_MOTION_INVALID);
		CHECK(header && wrong_colors(&header->planes[0], planes, false) == 0);
		for (uint32_t p = 1; header && p < 5; p++) {
			const struct pursuit_plane *plane = &header->planes[p];
			CHECK_INT(*(const uint8_t *)pixel(plane, planes, 3, plane->height - 1), 0);
		}
	}
	some.color = 0;
	CHECK(read_back(&some, &planes) == NULL);
	delete_textures(&textures);
	end();
}

static void test_unreadable(void)
{
	struct pursuit_stream_params params = default_params();
	struct pursuit_gl_textures textures = default_textures(), swapped = textures;

	begin(&params, egl_context_lookup);
	swapped.motion = textures.object_id;
	CHECK(read_back(&swapped, NULL) == NULL);
	CHECK(strstr(status_of(stream).message, "the motion texture"));
	swapped = textures;
	swapped.object_id = textures.color;
	CHECK(read_back(&swapped, NULL) == NULL);
	CHECK(strstr(status_of(stream).message, "the object_id texture"));
	swapped = textures;
	swapped.color = textures.object_id;
	CHECK(read_back(&swapped, NULL) == NULL);
	printf("       %s\n", status_of(stream).message);
	CHECK(read_back(&textures, NULL) != NULL);
	delete_textures(&textures);
	end();
}

/* The texture names of a frame may be new in each frame, sizes too. */
static void test_new_textures(void)
{
	struct pursuit_stream_params params = default_params();

	begin(&params, egl_context_lookup);
	for (int i = 0; i < 4; i++) {
		struct pursuit_gl_textures textures = default_textures();
		const uint8_t *planes = NULL;
		if (!es && i % 2) {
			glDeleteTextures(1, &textures.depth);
			textures.depth = depth_texture(GL_DEPTH_COMPONENT32F);
		}
		const struct pursuit_frame_header *header = read_back(&textures, &planes);
		CHECK(header && worst_depth(&header->planes[1], planes) == 0.0);
		delete_textures(&textures);
	}
	end();
}

static void test_state_is_kept(void)
{
	const GLenum names[] = {GL_READ_FRAMEBUFFER_BINDING,
							GL_DRAW_FRAMEBUFFER_BINDING,
							GL_PIXEL_PACK_BUFFER_BINDING,
							GL_PACK_ALIGNMENT,
							GL_PACK_ROW_LENGTH,
							GL_PACK_SKIP_ROWS,
							GL_PACK_SKIP_PIXELS,
							GL_TEXTURE_BINDING_2D,
							GL_ACTIVE_TEXTURE,
							GL_PIXEL_UNPACK_BUFFER_BINDING};
	struct pursuit_stream_params params = default_params();
	struct pursuit_gl_textures textures = default_textures();
	GLint before[10], after[10];
	GLuint framebuffers[2], buffer;

	glGenFramebuffers(2, framebuffers);
	glGenBuffers(1, &buffer);
	glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[0]);
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffers[1]);
	glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
	glPixelStorei(GL_PACK_ALIGNMENT, 8);
	glPixelStorei(GL_PACK_ROW_LENGTH, 5);
	glPixelStorei(GL_PACK_SKIP_ROWS, 2);
	glPixelStorei(GL_PACK_SKIP_PIXELS, 3);
	for (int i = 0; i < 10; i++) {
		glGetIntegerv(names[i], &before[i]);
	}
	begin(&params, egl_context_lookup);
	const uint8_t *planes = NULL;
	const struct pursuit_frame_header *header = read_back(&textures, &planes);
	CHECK(header && wrong_colors(&header->planes[0], planes, false) == 0);
	end();
	for (int i = 0; i < 10; i++) {
		glGetIntegerv(names[i], &after[i]);
		CHECK_INT(after[i], before[i]);
	}
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glPixelStorei(GL_PACK_ROW_LENGTH, 0);
	glPixelStorei(GL_PACK_SKIP_ROWS, 0);
	glPixelStorei(GL_PACK_SKIP_PIXELS, 0);
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	glDeleteFramebuffers(2, framebuffers);
	glDeleteBuffers(1, &buffer);
	delete_textures(&textures);
}

/* ---- a context whose GPU is busy, and one that lacks a function ---- */

static bool gpu_is_busy;

static GLenum wait_for_busy(GLsync sync, GLbitfield flags, GLuint64 timeout)
{
	return gpu_is_busy ? GL_TIMEOUT_EXPIRED : glClientWaitSync(sync, flags, timeout);
}

static void *busy_lookup(const char *name)
{
	GLenum (*function)(GLsync, GLbitfield, GLuint64) = wait_for_busy;
	void *address;

	memcpy(&address, &function, sizeof(address));
	return strcmp(name, "glClientWaitSync") == 0 ? address : egl_context_lookup(name);
}

static void *poor_lookup(const char *name)
{
	return strcmp(name, "glFenceSync") == 0 ? NULL : egl_context_lookup(name);
}

static void test_busy_gpu(void)
{
	struct pursuit_stream_params params = default_params();
	struct pursuit_gl_textures textures = default_textures();

	begin(&params, busy_lookup);
	gpu_is_busy = true;
	for (uint64_t id = 1; id <= 6; id++) {
		struct pursuit_frame frame = {.time_ns = id * 1000};
		CHECK_INT(pursuit_gl_submit(gl, &textures, &frame), 0);
	}
	CHECK(fake_take(&daemon_side, NULL) == NULL);
	CHECK_INT(status_of(stream).submitted, 6);
	gpu_is_busy = false;
	glFinish();
	/* Three are under way; of those only the newest is of use. */
	CHECK_INT(pursuit_gl_update(gl), 3);
	const struct pursuit_frame_header *header = fake_take(&daemon_side, NULL);
	CHECK(header && header->frame_id == 3 && header->real_interval_ns == 1000);
	CHECK_INT(status_of(stream).published, 1);
	CHECK(status_of(stream).bytes_copied < 2 * 8 * WIDTH * HEIGHT);
	CHECK(read_back(&textures, NULL) != NULL);
	delete_textures(&textures);
	end();
}

static void test_unsupported(void)
{
	struct pursuit_stream_params params = default_params();

	stream = pursuit_open(&params);
	errno = 0;
	CHECK(pursuit_gl_create(stream, poor_lookup) == NULL);
	CHECK_INT(errno, ENOTSUP);
	CHECK(pursuit_gl_create(NULL, egl_context_lookup) == NULL);
	CHECK_INT(errno, EINVAL);
	CHECK_INT(pursuit_gl_submit(NULL, NULL, NULL), 0);
	CHECK_INT(pursuit_gl_update(NULL), 0);
	CHECK_INT(pursuit_gl_flush(NULL), 0);
	pursuit_close(&stream);
}

static void run_all(void)
{
	RUN(test_all_planes);
	RUN(test_turned);
	RUN(test_color_formats);
	RUN(test_depth_formats);
	RUN(test_motion_and_id_formats);
	RUN(test_order);
	RUN(test_no_daemon);
	RUN(test_missing_textures);
	RUN(test_unreadable);
	RUN(test_new_textures);
	RUN(test_state_is_kept);
	RUN(test_busy_gpu);
	RUN(test_unsupported);
}

int main(int count, char **arguments)
{
	es = count > 1 && strcmp(arguments[1], "es") == 0;
	if (!egl_context_start(es)) {
		SKIP("no EGL context without a surface on this machine");
	}
	printf("%s, %s\n", (const char *)glGetString(GL_VERSION), (const char *)glGetString(GL_RENDERER));
	if (!harness_start()) {
		return 1;
	}
	run_all();
	harness_finish();
	egl_context_finish();
	return test_result();
}
