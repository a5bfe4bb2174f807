/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/readback.h"

#include <errno.h>
#include <string.h>

#define BLOCK_BYTES ((size_t)512 * 1024)

/* A GPU that needs longer is not coming back. */
#define PATIENCE_NS UINT64_C(5000000000)

void readback_finish(struct readback *readback, const struct gl *gl)
{
	for (uint32_t i = 0; i < READBACK_BLOCKS; i++) {
		if (readback->blocks[i].filled)
			gl->DeleteSync(readback->blocks[i].filled);
		gl->DeleteBuffers(1, &readback->blocks[i].buffer);
	}
	*readback = (struct readback){.buffered = readback->buffered};
}

uint64_t readback_bytes(const struct readback *readback)
{
	uint64_t bytes = 0;
	for (uint32_t i = 0; i < READBACK_BLOCKS; i++)
		bytes += readback->blocks[i].bytes;
	return bytes;
}

static void read_at_once(const struct gl *gl, const struct readback_image *image)
{
	gl->PixelStorei(GL_PACK_ROW_LENGTH, (GLint)(image->stride / 4));
	gl->ReadPixels(0, 0, (GLsizei)image->width, (GLsizei)image->height, gl->pixel_format, gl->pixel_type, image->data);
}

/* Rows of an image that a block takes, and of the last one. */
struct rows {
	uint32_t first, count;
};

static struct rows rows_of(const struct readback_image *image, uint32_t index)
{
	const size_t row_bytes = 4 * (size_t)image->width;
	const uint32_t most = row_bytes < BLOCK_BYTES ? (uint32_t)(BLOCK_BYTES / row_bytes) : 1;
	const uint32_t first = index * most;
	if (first >= image->height)
		return (struct rows){image->height, 0};
	return (struct rows){first, image->height - first < most ? image->height - first : most};
}

/* Asks for the rows of a block; nobody waits. */
static void ask(struct readback *readback, const struct gl *gl, const struct readback_image *image, uint32_t index)
{
	struct readback_block *block = &readback->blocks[index % READBACK_BLOCKS];
	const struct rows rows = rows_of(image, index);
	const size_t bytes = 4 * (size_t)image->width * rows.count;
	if (!rows.count)
		return;
	if (!block->buffer)
		gl->GenBuffers(1, &block->buffer);
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, block->buffer);
	if (bytes > block->bytes) {
		block->bytes = bytes > BLOCK_BYTES ? bytes : BLOCK_BYTES;
		gl->BufferData(GL_PIXEL_PACK_BUFFER, (GLsizeiptr)block->bytes, NULL, GL_STREAM_READ);
	}
	gl->PixelStorei(GL_PACK_ROW_LENGTH, 0);
	gl->ReadPixels(0, (GLint)rows.first, (GLsizei)image->width, (GLsizei)rows.count, gl->pixel_format, gl->pixel_type,
				   NULL);
	block->filled = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

static bool wait_for(struct readback_block *block, const struct gl *gl)
{
	GLenum result = GL_WAIT_FAILED;
	if (block->filled) {
		result = gl->ClientWaitSync(block->filled, GL_SYNC_FLUSH_COMMANDS_BIT, PATIENCE_NS);
		gl->DeleteSync(block->filled);
	}
	block->filled = NULL;
	return result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED;
}

static int take(struct readback *readback, const struct gl *gl, const struct readback_image *image, uint32_t index,
				struct error *error)
{
	struct readback_block *block = &readback->blocks[index % READBACK_BLOCKS];
	const struct rows rows = rows_of(image, index);
	const size_t row_bytes = 4 * (size_t)image->width;
	if (!wait_for(block, gl))
		return error_set(error, -EIO, "the context is lost: a block of rows does not come back");
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, block->buffer);
	const uint8_t *from =
		gl->MapBufferRange(GL_PIXEL_PACK_BUFFER, 0, (GLsizeiptr)(row_bytes * rows.count), GL_MAP_READ_BIT);
	if (!from)
		return error_set(error, -EIO, "the renderer does not give back a block of %u rows", rows.count);
	for (uint32_t i = 0; i < rows.count; i++)
		memcpy(image->data + (rows.first + i) * image->stride, from + i * row_bytes, row_bytes);
	return gl->UnmapBuffer(GL_PIXEL_PACK_BUFFER) ? 0 : error_set(error, -EIO, "the renderer lost a block of rows");
}

static void drop(struct readback *readback, const struct gl *gl)
{
	for (uint32_t i = 0; i < READBACK_BLOCKS; i++) {
		if (readback->blocks[i].filled)
			gl->DeleteSync(readback->blocks[i].filled);
		readback->blocks[i].filled = NULL;
	}
}

int readback_run(struct readback *readback, const struct gl *gl, const struct readback_image *image,
				 struct error *error)
{
	if (!readback->buffered) {
		read_at_once(gl, image);
		return 0;
	}
	int result = 0;
	for (uint32_t i = 0; i + 1 < READBACK_BLOCKS; i++)
		ask(readback, gl, image, i);
	for (uint32_t i = 0; rows_of(image, i).count && result == 0; i++) {
		ask(readback, gl, image, i + READBACK_BLOCKS - 1);
		result = take(readback, gl, image, i, error);
	}
	drop(readback, gl);
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	return result;
}
