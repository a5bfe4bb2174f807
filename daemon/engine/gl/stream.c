/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/stream.h"

#include <errno.h>
#include <string.h>

/* Few calls a picture, and a CPU renderer finds it in a core's cache still. */
#define BLOCK_BYTES ((size_t)512 * 1024)

#define LEAST_BYTES ((size_t)32 * 1024)

/* Longer than any GPU takes for a block. */
#define WAIT_NS 1000000000u

void stream_finish(struct stream *stream, const struct gl *gl)
{
	for (uint32_t i = 0; i < stream->made; i++) {
		if (stream->blocks[i].busy)
			gl->DeleteSync(stream->blocks[i].busy);
		gl->DeleteBuffers(1, &stream->blocks[i].buffer);
	}
	*stream = (struct stream){0};
}

uint32_t stream_rows(size_t row_bytes)
{
	return row_bytes < BLOCK_BYTES ? (uint32_t)(BLOCK_BYTES / row_bytes) : 1;
}

void stream_widen(struct stream *stream, uint32_t blocks)
{
	const uint32_t wished = blocks < STREAM_MOST - STREAM_BLOCKS ? STREAM_BLOCKS + blocks : STREAM_MOST;
	stream->wished = wished > stream->wished ? wished : stream->wished;
}

static bool is_busy(const struct stream_block *block, const struct gl *gl)
{
	return block->busy && gl->ClientWaitSync(block->busy, 0, 0) == GL_TIMEOUT_EXPIRED;
}

/* Before the oldest one, which then is the next but one. */
static void make_block(struct stream *stream, const struct gl *gl)
{
	struct stream_block *block = &stream->blocks[stream->next];
	memmove(block + 1, block, (stream->made - stream->next) * sizeof(*block));
	*block = (struct stream_block){.buffer = 0};
	gl->GenBuffers(1, &block->buffer);
	stream->made++;
}

/* Its memory is left to whoever may read it yet, and it gets other memory. */
static void abandon(struct stream_block *block)
{
	block->bytes = 0;
}

/* The next block, which nobody reads. */
static struct stream_block *free_block(struct stream *stream, const struct gl *gl)
{
	struct stream_block *block = &stream->blocks[stream->next];
	bool busy = stream->made >= STREAM_BLOCKS && is_busy(block, gl);
	if (stream->made < STREAM_BLOCKS || (busy && stream->made < stream->wished)) {
		make_block(stream, gl);
		return block;
	}
	if (busy) {
		stream->waits++;
		busy = gl->ClientWaitSync(block->busy, GL_SYNC_FLUSH_COMMANDS_BIT, WAIT_NS) == GL_TIMEOUT_EXPIRED;
	}
	if (busy)
		abandon(block);
	if (block->busy)
		gl->DeleteSync(block->busy);
	block->busy = NULL;
	return block;
}

uint8_t *stream_begin(struct stream *stream, const struct gl *gl, size_t bytes, struct error *error)
{
	struct stream_block *block = free_block(stream, gl);
	const GLbitfield access = GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT | GL_MAP_UNSYNCHRONIZED_BIT;
	gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, block->buffer);
	if (bytes > block->bytes) {
		/* Where there are many they are as large as they must be. */
		const size_t least = stream->made > STREAM_BLOCKS ? LEAST_BYTES : BLOCK_BYTES;
		block->bytes = (bytes + least - 1) / least * least;
		gl->BufferData(GL_PIXEL_UNPACK_BUFFER, (GLsizeiptr)block->bytes, NULL, GL_STREAM_DRAW);
	}
	uint8_t *data = gl->MapBufferRange(GL_PIXEL_UNPACK_BUFFER, 0, (GLsizeiptr)bytes, access);
	if (data)
		return data;
	gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
	block->bytes = 0;
	error_set(error, -ENOMEM, "the renderer has no room for a block of rows of %zu bytes", bytes);
	return NULL;
}

int stream_send(struct stream *stream, const struct gl *gl, const struct stream_target *targets, uint32_t count,
				struct error *error)
{
	struct stream_block *block = &stream->blocks[stream->next];
	bool good = gl->UnmapBuffer(GL_PIXEL_UNPACK_BUFFER);
	for (const struct stream_target *to = targets; to < targets + count && good; to++)
		gl->TexSubImage2D(GL_TEXTURE_2D, 0, to->x, to->y, to->width, to->rows, to->format, to->type,
						  (const void *)to->offset);
	if (good) {
		block->busy = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
		if (!block->busy)
			abandon(block);
		stream->next = (stream->next + 1) % stream->made;
	}
	gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
	return good ? 0 : error_set(error, -EIO, "the renderer lost a block of rows on its way up");
}

uint64_t stream_bytes(const struct stream *stream)
{
	uint64_t bytes = 0;
	for (uint32_t i = 0; i < stream->made; i++)
		bytes += stream->blocks[i].bytes;
	return bytes;
}
