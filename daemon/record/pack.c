/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <assert.h>
#include <string.h>

#include "daemon/record/recording.h"

uint64_t recording_packed_bytes(const struct frame *frame)
{
	struct pursuit_frame_header header = frame->header;
	const uint64_t bytes = frame_layout(&header);
	return bytes ? sizeof(header) + bytes : 0;
}

/* Bytes of a row that mean something; the rest up to the stride is written as zero. */
static void pack_plane(const struct pursuit_plane *from, const uint8_t *data, const struct pursuit_plane *to,
					   uint8_t *packed)
{
	const uint64_t row = (uint64_t)from->width * pursuit_format_bytes(from->format);
	if (row == 0) {
		memcpy(packed, data, from->size);
		return;
	}
	for (uint64_t y = 0; y < from->height; y++) {
		memcpy(packed + y * to->stride, data + y * from->stride, row);
		memset(packed + y * to->stride + row, 0, to->stride - row);
	}
}

void recording_pack(const struct frame *frame, uint8_t *packed)
{
	struct pursuit_frame_header header = frame->header;
	const uint64_t bytes = frame_layout(&header);
	assert(header.plane_count <= PURSUIT_MAX_PLANES && bytes > 0);
	memcpy(packed, &header, sizeof(header));
	packed += sizeof(header);
	for (uint32_t i = 0; i < header.plane_count; i++) {
		const struct pursuit_plane *to = &header.planes[i];
		const uint64_t end = i + 1 < header.plane_count ? header.planes[i + 1].offset : bytes;
		pack_plane(&frame->header.planes[i], frame->planes[i], to, packed + to->offset);
		memset(packed + to->offset + to->size, 0, end - to->offset - to->size);
	}
}
