/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/readback.h"

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

void readback_forget(struct readback *readback, const struct gl *gl)
{
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
	const int result = empty(block_at(readback, 0), gl, error);
	if (result < 0)
		readback_forget(readback, gl);
	else
		close_oldest(readback, gl);
	return result;
}

int readback_receive(struct readback *readback, const struct gl *gl, const struct arrival *arrival, struct error *error)
{
	int result = 0;
	while (arrival->missing && result == 0)
		result = receive_oldest(readback, gl, error);
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	return result;
}

/* ---- asked for ---- */

/* A read that is under way: what is asked for, and how many blocks may be. */
struct asking {
	const struct readback_image *image;
	struct arrival *arrival;
	struct readback_block *open; /* that has room yet; NULL: none */
	uint32_t limit;
};

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

static void close_block(const struct gl *gl, struct asking *asking)
{
	if (asking->open)
		asking->open->filled = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	asking->open = NULL;
}

static int open_block(struct readback *readback, const struct gl *gl, struct asking *asking, struct error *error)
{
	close_block(gl, asking);
	const int result = readback->count >= asking->limit ? receive_oldest(readback, gl, error) : 0;
	if (result < 0)
		return result;
	asking->open = block_at(readback, readback->count);
	*asking->open = (struct readback_block){.buffer = make_buffer(readback, gl), .arrival = asking->arrival};
	readback->count++;
	asking->arrival->missing++;
	return 0;
}

/* Rows of that many bytes for which the open block has room. */
static uint32_t room(const struct asking *asking, size_t row_bytes)
{
	if (!asking->open || asking->open->count == READBACK_PIECES)
		return 0;
	return (uint32_t)((READBACK_BLOCK - asking->open->bytes) / row_bytes);
}

static void ask_for_piece(const struct gl *gl, struct asking *asking, const struct bounds *bounds)
{
	struct readback_block *block = asking->open;
	struct readback_piece *piece = &block->pieces[block->count++];
	const uint32_t width = bounds->right - bounds->left, rows = bounds->bottom - bounds->top;
	*piece = (struct readback_piece){block->bytes, place_of(asking->image, bounds), asking->image->stride,
									 4 * (size_t)width, rows};
	block->bytes += piece->row_bytes * rows;
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, block->buffer);
	gl->PixelStorei(GL_PACK_ROW_LENGTH, 0);
	gl->ReadPixels((GLint)bounds->left, (GLint)bounds->top, (GLsizei)width, (GLsizei)rows, gl->pixel_format,
				   gl->pixel_type, (void *)piece->offset);
}

static int ask_for(struct readback *readback, const struct gl *gl, struct asking *asking, const struct bounds *bounds,
				   struct error *error)
{
	const size_t row_bytes = 4 * (size_t)(bounds->right - bounds->left);
	struct bounds part = *bounds;
	int result = 0;
	for (; part.top < bounds->bottom && result == 0; part.top = part.bottom) {
		if (!room(asking, row_bytes))
			result = open_block(readback, gl, asking, error);
		if (result < 0)
			break;
		const uint32_t rows = room(asking, row_bytes), left = bounds->bottom - part.top;
		part.bottom = part.top + (rows < left ? rows : left);
		ask_for_piece(gl, asking, &part);
	}
	return result;
}

/* Blocks that may be under way while these are asked for. */
static uint32_t allowed(const struct readback *readback, const struct tiles *tiles, bool ahead)
{
	const uint32_t most = (uint32_t)(READBACK_BLOCK / (4 * (size_t)tiles->width));
	const uint32_t asked = (tiles->height + most - 1) / most;
	const uint32_t wanted = ahead ? readback->count + asked : buffers(readback);
	const uint32_t least = wanted > READBACK_BLOCKS ? wanted : READBACK_BLOCKS;
	return least < READBACK_MOST ? least : READBACK_MOST;
}

int readback_ask(struct readback *readback, const struct gl *gl, const struct readback_image *image,
				 struct arrival *arrival, bool ahead, uint64_t *bytes, struct error *error)
{
	struct asking asking = {.image = image, .arrival = arrival, .limit = allowed(readback, image->tiles, ahead)};
	struct bounds bounds = {0};
	int result = 0;
	while (result == 0 && tiles_next_bounds(image->tiles, GL_TILES_OF_CALL, &bounds)) {
		*bytes += 4 * (uint64_t)(bounds.right - bounds.left) * (bounds.bottom - bounds.top);
		if (readback->buffered)
			result = ask_for(readback, gl, &asking, &bounds, error);
		else
			read_at_once(gl, image, &bounds);
	}
	close_block(gl, &asking);
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	return result;
}
