/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/readback.h"

#include <assert.h>
#include <errno.h>
#include <string.h>

_Static_assert(4 * PURSUIT_MAX_SIZE <= READBACK_BLOCK, "a block holds a row");

static uint32_t buffers(const struct readback *readback)
{
	return readback->count + readback->spare_count;
}

uint64_t readback_bytes(const struct readback *readback)
{
	return buffers(readback) * READBACK_BLOCK;
}

/* ---- blocks ---- */

static struct readback_block *block_at(struct readback *readback, uint32_t index)
{
	return &readback->blocks[(readback->first + index) % READBACK_MOST];
}

static GLuint make_buffer(struct readback *readback, const struct gl *gl)
{
	GLuint buffer = 0;
	if (readback->spare_count) {
		buffer = readback->spare[--readback->spare_count];
		gl->BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
		return buffer;
	}
	gl->GenBuffers(1, &buffer);
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
	gl->BufferData(GL_PIXEL_PACK_BUFFER, (GLsizeiptr)READBACK_BLOCK, NULL, GL_STREAM_READ);
	return buffer;
}

/* The oldest one is over, one way or the other. */
static void close_oldest(struct readback *readback, const struct gl *gl)
{
	struct readback_block *block = block_at(readback, 0);
	if (block->filled)
		gl->DeleteSync(block->filled);
	readback->spare[readback->spare_count++] = block->buffer;
	block->arrival->missing--;
	readback->first = (readback->first + 1) % READBACK_MOST;
	readback->count--;
}

static void close_rest(struct readback_rest *rest)
{
	rest->arrival->missing--;
	rest->arrival = NULL;
}

void readback_forget(struct readback *readback, const struct gl *gl)
{
	struct readback_rest *rest = &readback->rest;
	if (rest->arrival) {
		rest->arrival->lost = true;
		close_rest(rest);
	}
	while (readback->count) {
		block_at(readback, 0)->arrival->lost = true;
		close_oldest(readback, gl);
	}
}

void readback_finish(struct readback *readback, const struct gl *gl)
{
	readback_forget(readback, gl);
	gl->DeleteBuffers((GLsizei)readback->spare_count, readback->spare);
	const bool buffered = readback->buffered;
	memset(readback, 0, sizeof(*readback));
	readback->buffered = buffered;
}

/* ---- there ---- */

/* To where it belongs. */
static int empty(const struct readback_block *block, const struct gl *gl, struct error *error)
{
	const int result = gl_wait(gl, block->filled, error);
	if (result < 0)
		return result;
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, block->buffer);
	const uint8_t *from = gl->MapBufferRange(GL_PIXEL_PACK_BUFFER, 0, (GLsizeiptr)block->bytes, GL_MAP_READ_BIT);
	if (!from)
		return error_set(error, -EIO, "the renderer does not give back a block of %zu bytes", block->bytes);
	for (const struct readback_piece *piece = block->pieces; piece < block->pieces + block->count; piece++)
		for (uint32_t i = 0; i < piece->rows; i++)
			memcpy(piece->data + i * piece->stride, from + piece->offset + i * piece->row_bytes, piece->row_bytes);
	return gl->UnmapBuffer(GL_PIXEL_PACK_BUFFER) ? 0 : error_set(error, -EIO, "the renderer lost a block of rows");
}

static int receive_oldest(struct readback *readback, const struct gl *gl, struct error *error)
{
	assert(readback->count);
	const int result = empty(block_at(readback, 0), gl, error);
	if (result < 0)
		readback_forget(readback, gl);
	else
		close_oldest(readback, gl);
	return result;
}

/* ---- asked for ---- */

static uint8_t *place_of(const struct readback_image *image, const struct bounds *bounds)
{
	return image->data + bounds->top * image->stride + 4 * (size_t)bounds->left;
}

static void read_at_once(const struct gl *gl, const struct readback_image *image, const struct bounds *bounds)
{
	gl->PixelStorei(GL_PACK_ROW_LENGTH, (GLint)(image->stride / 4));
	gl->ReadPixels((GLint)bounds->left, (GLint)bounds->top, (GLsizei)(bounds->right - bounds->left),
				   (GLsizei)(bounds->bottom - bounds->top), gl->pixel_format, gl->pixel_type, place_of(image, bounds));
}

static void close_block(struct readback_rest *rest, const struct gl *gl)
{
	if (rest->open)
		rest->open->filled = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	rest->open = NULL;
}

static bool is_full(const struct readback *readback)
{
	return readback->count >= readback->rest.limit;
}

static int open_block(struct readback *readback, const struct gl *gl, struct error *error)
{
	struct readback_rest *rest = &readback->rest;
	const int result = is_full(readback) ? receive_oldest(readback, gl, error) : 0;
	if (result < 0)
		return result;
	rest->open = block_at(readback, readback->count);
	*rest->open = (struct readback_block){.buffer = make_buffer(readback, gl), .arrival = rest->arrival};
	readback->count++;
	rest->arrival->missing++;
	return 0;
}

/* False: there are no more. */
static bool find_rows(struct readback_rest *rest)
{
	if (rest->top < rest->bounds.bottom)
		return true;
	if (!tiles_next_bounds(rest->image.tiles, GL_TILES_OF_CALL, &rest->bounds))
		return false;
	rest->top = rest->bounds.top;
	return true;
}

/* Of those rows so many as the open block has room for. */
static uint32_t count_rows(const struct readback_rest *rest)
{
	const size_t row_bytes = 4 * (size_t)(rest->bounds.right - rest->bounds.left);
	if (!rest->open || rest->open->count == READBACK_PIECES)
		return 0;
	const size_t room = (READBACK_BLOCK - rest->open->bytes) / row_bytes, rows = rest->bounds.bottom - rest->top;
	return (uint32_t)(room < rows ? room : rows);
}

static void ask_for_rows(struct readback_rest *rest, const struct gl *gl, uint32_t rows)
{
	struct readback_block *block = rest->open;
	struct readback_piece *piece = &block->pieces[block->count++];
	struct bounds bounds = rest->bounds;
	const uint32_t width = bounds.right - bounds.left;
	bounds.top = rest->top;
	*piece = (struct readback_piece){block->bytes, place_of(&rest->image, &bounds), rest->image.stride,
									 4 * (size_t)width, rows};
	block->bytes += piece->row_bytes * rows;
	rest->top += rows;
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, block->buffer);
	gl->PixelStorei(GL_PACK_ROW_LENGTH, 0);
	gl->ReadPixels((GLint)bounds.left, (GLint)bounds.top, (GLsizei)width, (GLsizei)rows, gl->pixel_format,
				   gl->pixel_type, (void *)piece->offset);
}

/* All of the rest, or as much as there are free blocks for. */
static int ask_on(struct readback *readback, const struct gl *gl, bool all, struct error *error)
{
	struct readback_rest *rest = &readback->rest;
	int result = 0;
	if (rest->arrival)
		gl->BindFramebuffer(GL_READ_FRAMEBUFFER, rest->image.framebuffer);
	while (rest->arrival && result == 0) {
		const bool more = find_rows(rest);
		const uint32_t rows = more ? count_rows(rest) : 0;
		if (rows) {
			ask_for_rows(rest, gl, rows);
			continue;
		}
		close_block(rest, gl);
		if (!more)
			close_rest(rest);
		else if (all || !is_full(readback))
			result = open_block(readback, gl, error);
		else
			break;
	}
	return result;
}

/* Blocks that may be under way while these are asked for. */
static uint32_t allowed(const struct readback *readback, const struct tiles *tiles, bool ahead)
{
	const uint32_t most = (uint32_t)(READBACK_BLOCK / (4 * (size_t)tiles->width));
	const uint32_t asked = (tiles->height + most - 1) / most;
	const uint32_t wanted = ahead ? asked + READBACK_SPARE : buffers(readback);
	const uint32_t least = wanted > READBACK_BLOCKS ? wanted : READBACK_BLOCKS;
	return least < READBACK_MOST ? least : READBACK_MOST;
}

static void read_all(const struct gl *gl, const struct readback_image *image)
{
	struct bounds bounds = {0};
	gl->BindFramebuffer(GL_READ_FRAMEBUFFER, image->framebuffer);
	while (tiles_next_bounds(image->tiles, GL_TILES_OF_CALL, &bounds))
		read_at_once(gl, image, &bounds);
}

static uint64_t count_bytes(const struct readback_image *image)
{
	struct bounds bounds = {0};
	uint64_t bytes = 0;
	while (tiles_next_bounds(image->tiles, GL_TILES_OF_CALL, &bounds))
		bytes += 4 * (uint64_t)(bounds.right - bounds.left) * (bounds.bottom - bounds.top);
	return bytes;
}

int readback_ask(struct readback *readback, const struct gl *gl, const struct readback_image *image,
				 struct arrival *arrival, bool ahead, uint64_t *bytes, struct error *error)
{
	assert(!readback->rest.arrival);
	*bytes += count_bytes(image);
	if (!readback->buffered) {
		read_all(gl, image);
		return 0;
	}
	readback->rest =
		(struct readback_rest){.arrival = arrival, .image = *image, .limit = allowed(readback, image->tiles, ahead)};
	arrival->missing++;
	const int result = ask_on(readback, gl, !ahead, error);
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	return result;
}

int readback_settle(struct readback *readback, const struct gl *gl, GLuint framebuffer, struct error *error)
{
	const struct readback_rest *rest = &readback->rest;
	if (!rest->arrival || (framebuffer && framebuffer != rest->image.framebuffer))
		return 0;
	const int result = ask_on(readback, gl, true, error);
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	return result;
}

/* ---- received ---- */

int readback_receive(struct readback *readback, const struct gl *gl, const struct arrival *arrival, struct error *error)
{
	const bool rest = readback->rest.arrival != NULL;
	int result = 0;
	while (arrival->missing && result == 0) {
		result = receive_oldest(readback, gl, error);
		if (result == 0)
			result = ask_on(readback, gl, false, error);
	}
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	if (rest)
		gl->Flush();
	return result;
}
