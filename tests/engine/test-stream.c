/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Blocks on their way up and down, with a GPU that carries out its commands late, at random: none is written to while
 * that GPU may still read it, though it hangs and gives no fences, and there are no more of them than were asked for.
 */
#include "tests/test.h"

#include "daemon/engine/gl/readback.h"
#include "daemon/engine/gl/stream.h"
#include "tests/engine/picture.h"

#define BUFFERS 1000u

/* Commands are counted from 1. */
static struct {
	uint32_t random;
	uint64_t asked, done;       /* commands */
	uint64_t read[BUFFERS + 1]; /* by buffer: the last command that reads its memory of now */
	size_t bytes[BUFFERS + 1];
	GLuint made, bound, framebuffer;
	uint64_t pixels[3]; /* read, by framebuffer */
	bool sound;         /* it does not hang, and gives fences */
	uint32_t hangs, fenceless, waits;
	uint8_t memory[READBACK_BLOCK];
} gpu;

static uint32_t pick(uint32_t count)
{
	return picture_random(&gpu.random) % count;
}

static void APIENTRY gen_buffers(GLsizei count, GLuint *buffers)
{
	for (GLsizei i = 0; i < count; i++)
		buffers[i] = ++gpu.made;
	CHECK(gpu.made <= BUFFERS);
}

static void APIENTRY delete_buffers(GLsizei count, const GLuint *buffers)
{
	(void)count;
	(void)buffers;
}

static void APIENTRY bind_buffer(GLenum target, GLuint buffer)
{
	CHECK(target == GL_PIXEL_UNPACK_BUFFER || target == GL_PIXEL_PACK_BUFFER);
	gpu.bound = buffer;
}

static void APIENTRY buffer_data(GLenum target, GLsizeiptr size, const void *data, GLenum usage)
{
	(void)target;
	(void)data;
	(void)usage;
	gpu.bytes[gpu.bound] = (size_t)size;
	gpu.read[gpu.bound] = 0;
}

static void *APIENTRY map(GLenum target, GLintptr offset, GLsizeiptr length, GLbitfield access)
{
	CHECK(target == GL_PIXEL_PACK_BUFFER || access & GL_MAP_UNSYNCHRONIZED_BIT);
	CHECK((size_t)(offset + length) <= gpu.bytes[gpu.bound]);
	CHECK(gpu.read[gpu.bound] <= gpu.done);
	return gpu.memory;
}

static GLboolean APIENTRY unmap(GLenum target)
{
	(void)target;
	return GL_TRUE;
}

static void APIENTRY tex_sub_image(GLenum target, GLint level, GLint x, GLint y, GLsizei width, GLsizei height,
								   GLenum format, GLenum type, const void *pixels)
{
	(void)target;
	(void)level;
	(void)x;
	(void)y;
	(void)format;
	(void)type;
	CHECK((size_t)pixels + 4 * (size_t)width * (size_t)height <= gpu.bytes[gpu.bound]);
	gpu.read[gpu.bound] = ++gpu.asked;
}

static void APIENTRY bind_framebuffer(GLenum target, GLuint framebuffer)
{
	CHECK(target == GL_READ_FRAMEBUFFER);
	gpu.framebuffer = framebuffer;
}

static void APIENTRY flush(void)
{
}

static void APIENTRY pixel_store(GLenum name, GLint value)
{
	(void)name;
	(void)value;
}

static void APIENTRY read_pixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type,
								 void *pixels)
{
	(void)x;
	(void)y;
	(void)format;
	(void)type;
	CHECK((size_t)pixels + 4 * (size_t)width * (size_t)height <= gpu.bytes[gpu.bound]);
	gpu.pixels[gpu.framebuffer] += (uint64_t)width * (uint64_t)height;
	gpu.asked++;
}

static GLsync APIENTRY fence(GLenum condition, GLbitfield flags)
{
	(void)condition;
	(void)flags;
	const bool none = !gpu.sound && pick(20) == 0;
	gpu.fenceless += none;
	/* A fence is the number of the command that it stands behind. */
	return none ? NULL : (GLsync)(uintptr_t)(gpu.asked + 1);
}

static void APIENTRY delete_sync(GLsync sync)
{
	CHECK(sync != NULL);
}

static GLenum APIENTRY wait(GLsync sync, GLbitfield flags, GLuint64 timeout)
{
	const uint64_t command = (uint64_t)(uintptr_t)sync - 1;
	const bool hangs = !gpu.sound && pick(10) == 0;
	CHECK(timeout == 0 || flags & GL_SYNC_FLUSH_COMMANDS_BIT);
	if (command <= gpu.done)
		return GL_ALREADY_SIGNALED;
	gpu.waits += timeout > 0;
	if (timeout == 0 || hangs) {
		gpu.hangs += timeout > 0;
		return GL_TIMEOUT_EXPIRED;
	}
	gpu.done = command;
	return GL_CONDITION_SATISFIED;
}

static const struct gl gl = {.GenBuffers = gen_buffers,
							 .DeleteBuffers = delete_buffers,
							 .BindBuffer = bind_buffer,
							 .BufferData = buffer_data,
							 .MapBufferRange = map,
							 .UnmapBuffer = unmap,
							 .TexSubImage2D = tex_sub_image,
							 .BindFramebuffer = bind_framebuffer,
							 .Flush = flush,
							 .PixelStorei = pixel_store,
							 .ReadPixels = read_pixels,
							 .FenceSync = fence,
							 .DeleteSync = delete_sync,
							 .ClientWaitSync = wait};

static void send(struct stream *stream, uint32_t rows)
{
	const struct stream_target target = {.width = 10, .rows = (GLsizei)rows};
	struct error error;
	CHECK(stream_begin(stream, &gl, 40 * (size_t)rows, &error) != NULL);
	CHECK_INT(stream_send(stream, &gl, &target, 1, &error), 0);
}

static void check_seed(uint32_t seed)
{
	struct stream stream = {.made = 0};
	memset(&gpu, 0, sizeof(gpu));
	gpu.random = seed;
	for (uint32_t i = 0; i < 2000; i++) {
		if (i % 500 == 499)
			stream_widen(&stream, 1 + pick(200));
		if (pick(3) == 0)
			gpu.done += pick((uint32_t)(gpu.asked - gpu.done) + 1);
		send(&stream, 1 + pick(100));
		CHECK(stream.made <= STREAM_MOST && (stream.made <= STREAM_BLOCKS || stream.made <= stream.wished));
		CHECK_INT(stream.made, gpu.made);
	}
	CHECK(gpu.hangs > 0 && gpu.fenceless > 0 && stream.made > STREAM_BLOCKS);
	stream_finish(&stream, &gl);
}

static void test_none_is_overwritten(void)
{
	for (uint32_t seed = 1; seed <= 20; seed++)
		check_seed(seed);
}

/* Those of a GPU that does nothing are made until there are as many as were asked for; then somebody waits. */
static void test_who_waits(void)
{
	struct stream stream = {.made = 0};
	memset(&gpu, 0, sizeof(gpu));
	gpu.random = 5;
	stream_widen(&stream, 10);
	for (uint32_t i = 0; i < STREAM_BLOCKS + 10; i++)
		send(&stream, 1);
	CHECK_INT(gpu.waits, 0);
	CHECK_INT(stream.made, STREAM_BLOCKS + 10);
	send(&stream, 1);
	CHECK_INT(stream.made, STREAM_BLOCKS + 10);
	CHECK(gpu.waits > 0);
	stream_finish(&stream, &gl);
}

/* ---- down ---- */

#define WIDTH 1920u
#define HEIGHT 1080u

/* Tiles that lie apart in each row: as many rectangles as there can be. */
static void scatter(struct tiles *tiles)
{
	struct error error = {""};
	CHECK_INT(tiles_begin(tiles, WIDTH, HEIGHT, 64, 32, &error), 0);
	for (uint32_t i = 0; i < tiles->columns * tiles->rows; i++)
		tiles->marked[i] = i % tiles->columns % 4 == i / tiles->columns % 2;
}

static void test_begin(struct readback *readback)
{
	memset(&gpu, 0, sizeof(gpu));
	gpu.sound = true;
	memset(readback, 0, sizeof(*readback));
	readback->buffered = true;
}

/* Two pictures, of the framebuffers 1 and 2, that nobody waits for. */
static uint64_t ask_for_two(struct readback *readback, const struct tiles *tiles, struct arrival *arrivals)
{
	static uint8_t data[2][4 * WIDTH * HEIGHT];
	struct error error = {""};
	uint64_t bytes = 0;
	gpu.waits = 0;
	for (uint32_t i = 0; i < 2; i++) {
		const struct readback_image image = {data[i], 4 * (size_t)WIDTH, tiles, 1 + i};
		arrivals[i] = (struct arrival){.missing = 0};
		CHECK_INT(readback_ask(readback, &gl, &image, &arrivals[i], true, &bytes, &error), 0);
	}
	CHECK_INT(gpu.waits, 0);
	return bytes;
}

/* Two pictures in pieces under way take no more blocks than a whole one and two, however many were before. */
static void test_pieces(void)
{
	static struct readback readback;
	struct tiles tiles = {.marked = NULL};
	struct error error = {""};
	test_begin(&readback);
	scatter(&tiles);
	for (uint32_t frame = 0; frame < 30; frame++) {
		struct arrival arrivals[2];
		const uint64_t bytes = ask_for_two(&readback, &tiles, arrivals);
		CHECK(bytes > 0 && bytes < 2 * UINT64_C(4) * WIDTH * HEIGHT / 3);
		for (int i = 0; i < 2; i++)
			CHECK_INT(readback_receive(&readback, &gl, &arrivals[i], &error), 0);
		CHECK(!arrivals[0].missing && !arrivals[1].missing && !readback.count);
		CHECK_INT(4 * (gpu.pixels[1] + gpu.pixels[2]), (frame + 1) * bytes);
		CHECK(readback_bytes(&readback) <= 18 * READBACK_BLOCK);
	}
	readback_finish(&readback, &gl);
	tiles_finish(&tiles);
}

#define PICTURE_PIXELS ((uint64_t)WIDTH * HEIGHT)

/* What there was no block for is asked for as blocks get free, or before it is drawn over: and of its own framebuffer.
 */
static void test_rest(void)
{
	static struct readback readback;
	struct tiles tiles = {.marked = NULL};
	struct arrival arrivals[2];
	struct error error = {""};
	test_begin(&readback);
	CHECK_INT(tiles_begin(&tiles, WIDTH, HEIGHT, 64, 32, &error), 0);
	tiles_mark_all(&tiles);
	CHECK_INT(ask_for_two(&readback, &tiles, arrivals), 8 * PICTURE_PIXELS);
	CHECK_INT(gpu.pixels[1], PICTURE_PIXELS);
	CHECK(gpu.pixels[2] > 0 && gpu.pixels[2] < PICTURE_PIXELS / 4);
	gpu.framebuffer = 0;
	CHECK_INT(readback_receive(&readback, &gl, &arrivals[0], &error), 0);
	CHECK_INT(gpu.pixels[2], PICTURE_PIXELS);
	CHECK(arrivals[1].missing > 0);
	CHECK_INT(readback_receive(&readback, &gl, &arrivals[1], &error), 0);
	ask_for_two(&readback, &tiles, arrivals);
	gpu.framebuffer = 0;
	CHECK_INT(readback_settle(&readback, &gl, 1, &error), 0);
	CHECK(gpu.pixels[2] < 2 * PICTURE_PIXELS && gpu.waits == 0);
	CHECK_INT(readback_settle(&readback, &gl, 2, &error), 0);
	CHECK_INT(gpu.pixels[2], 2 * PICTURE_PIXELS);
	CHECK(gpu.waits > 0 && arrivals[0].missing > 0);
	readback_forget(&readback, &gl);
	CHECK(arrivals[0].lost && arrivals[1].lost && !arrivals[0].missing && !arrivals[1].missing);
	ask_for_two(&readback, &tiles, arrivals);
	readback_forget(&readback, &gl);
	CHECK(arrivals[1].lost && !arrivals[1].missing);
	CHECK_INT(readback_bytes(&readback), 18 * READBACK_BLOCK);
	readback_finish(&readback, &gl);
	tiles_finish(&tiles);
}

int main(void)
{
	RUN(test_none_is_overwritten);
	RUN(test_who_waits);
	RUN(test_pieces);
	RUN(test_rest);
	return test_result();
}
