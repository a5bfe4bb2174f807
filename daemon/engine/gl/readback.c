/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/readback.h"

#include <errno.h>
#include <string.h>

/* A GPU that needs longer is not coming back. */
#define PATIENCE_NS UINT64_C(5000000000)

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
	*readback = (struct readback){.buffered = readback->buffered};
}

/* ---- there ---- */

static bool is_filled(const struct readback_block *block, const struct gl *gl)
{
	if (!block->filled)
		return false;
	const GLenum result = gl->ClientWaitSync(block->filled, GL_SYNC_FLUSH_COMMANDS_BIT, PATIENCE_NS);
	return result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED;
}

/* To where it belongs. */
static int empty(const struct readback_block *block, const struct gl *gl, struct error *error)
{
	if (!is_filled(block, gl))
		return error_set(error, -EIO, "the context is lost: a block of rows does not come back");
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, block->buffer);
	const uint8_t *from =
		gl->MapBufferRange(GL_PIXEL_PACK_BUFFER, 0, (GLsizeiptr)(block->row_bytes * block->rows), GL_MAP_READ_BIT);
	if (!from)
		return error_set(error, -EIO, "the renderer does not give back a block of %u rows", block->rows);
	for (uint32_t i = 0; i < block->rows; i++)
		memcpy(block->data + i * block->stride, from + i * block->row_bytes, block->row_bytes);
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

static void read_at_once(const struct gl *gl, const struct readback_image *image)
{
	gl->PixelStorei(GL_PACK_ROW_LENGTH, (GLint)(image->stride / 4));
	gl->ReadPixels(0, 0, (GLsizei)image->width, (GLsizei)image->height, gl->pixel_format, gl->pixel_type, image->data);
}

static void ask_for_rows(struct readback *readback, const struct gl *gl, const struct readback_image *image,
						 uint32_t first, uint32_t rows, struct arrival *arrival)
{
	struct readback_block *block = block_at(readback, readback->count);
	*block = (struct readback_block){.buffer = make_buffer(readback, gl),
									 .data = image->data + first * image->stride,
									 .stride = image->stride,
									 .row_bytes = 4 * (size_t)image->width,
									 .rows = rows,
									 .arrival = arrival};
	gl->PixelStorei(GL_PACK_ROW_LENGTH, 0);
	gl->ReadPixels(0, (GLint)first, (GLsizei)image->width, (GLsizei)rows, gl->pixel_format, gl->pixel_type, NULL);
	block->filled = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	readback->count++;
	arrival->missing++;
}

/* Blocks that may be under way while these are asked for. */
static uint32_t allowed(const struct readback *readback, uint32_t asked, bool ahead)
{
	const uint32_t made = buffers(readback) > READBACK_BLOCKS ? buffers(readback) : READBACK_BLOCKS;
	const uint32_t wanted = ahead && readback->count + asked > made ? readback->count + asked : made;
	return wanted < READBACK_MOST ? wanted : READBACK_MOST;
}

int readback_ask(struct readback *readback, const struct gl *gl, const struct readback_image *image,
				 struct arrival *arrival, bool ahead, struct error *error)
{
	if (!readback->buffered) {
		read_at_once(gl, image);
		return 0;
	}
	const uint32_t most = (uint32_t)(READBACK_BLOCK / (4 * (size_t)image->width));
	const uint32_t limit = allowed(readback, (image->height + most - 1) / most, ahead);
	int result = 0;
	for (uint32_t y = 0; y < image->height && result == 0; y += most) {
		if (readback->count >= limit)
			result = receive_oldest(readback, gl, error);
		if (result == 0)
			ask_for_rows(readback, gl, image, y, image->height - y < most ? image->height - y : most, arrival);
	}
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	return result;
}
