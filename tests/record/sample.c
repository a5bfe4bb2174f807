/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/record/sample.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[512];

static void set_plane(struct pursuit_plane *plane, uint32_t role, uint32_t format, uint32_t width, uint32_t height,
					  uint64_t *end)
{
	const uint64_t bytes = pursuit_format_bytes(format);
	*plane = (struct pursuit_plane){
		.role = role,
		.format = format,
		.storage = PURSUIT_STORAGE_MEMORY,
		.width = width,
		.height = height,
		.offset = *end,
		.stride = bytes * (width + 3),
	};
	plane->size = plane->stride * (height - 1) + bytes * width;
	*end = (*end + plane->size + 127) / 64 * 64;
	if (role == PURSUIT_ROLE_COLOR)
		plane->transfer.curve = PURSUIT_CURVE_SRGB;
}

void sample_init(struct sample *sample, uint64_t id, uint32_t width, uint32_t height)
{
	struct pursuit_frame_header *header = &sample->frame.header;
	uint32_t noise = (uint32_t)id * 2654435761u + 1;
	uint64_t end = 64;

	*sample = (struct sample){0};
	header->frame_id = id;
	header->time_ns = 1000000000u + id * 33333333u;
	header->submit_ns = header->time_ns + 1000;
	header->real_interval_ns = 33333333;
	header->motion_interval_ns = 33333333;
	header->flags = PURSUIT_FRAME_JITTER | PURSUIT_FRAME_MATRICES;
	header->plane_count = 5;
	header->motion_kind = PURSUIT_MOTION_BACKWARD;
	header->depth_kind = PURSUIT_DEPTH_DEVICE;
	header->near_distance = 0.1f;
	header->far_distance = 100.0f;
	header->jitter_x = 0.25f;
	for (int i = 0; i < 16; i++)
		header->view_projection[i] = (float)i + (float)id;
	set_plane(&header->planes[0], PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8, width, height, &end);
	set_plane(&header->planes[1], PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH32F, width, height, &end);
	set_plane(&header->planes[2], PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG16F, (width + 1) / 2, height, &end);
	set_plane(&header->planes[3], PURSUIT_ROLE_UI, PURSUIT_FORMAT_RGBA8, width, height, &end);
	set_plane(&header->planes[4], PURSUIT_ROLE_OBJECT_ID, PURSUIT_FORMAT_R8UI, width, height, &end);
	sample->bytes = end;
	sample->memory = aligned_alloc(64, end);
	for (uint64_t i = 0; i < end; i++) {
		noise = noise * 1664525u + 1013904223u;
		/* Half noise, half pattern: something to compress, but not to nothing. */
		sample->memory[i] = (uint8_t)(i % 64 < 32 ? noise >> 24 : i / 64);
	}
	for (uint32_t i = 0; i < header->plane_count; i++)
		sample->frame.planes[i] = sample->memory + header->planes[i].offset;
}

void sample_finish(struct sample *sample)
{
	free(sample->memory);
	*sample = (struct sample){0};
}

static bool plane_equal(const struct pursuit_plane *p, const uint8_t *a, const struct pursuit_plane *q,
						const uint8_t *b)
{
	const size_t row = (size_t)p->width * pursuit_format_bytes(p->format);
	if (p->role != q->role || p->format != q->format || p->width != q->width || p->height != q->height ||
		memcmp(&p->transfer, &q->transfer, sizeof(p->transfer)) != 0)
		return false;
	for (uint32_t y = 0; y < p->height; y++)
		if (memcmp(a + y * p->stride, b + y * q->stride, row) != 0)
			return false;
	return true;
}

bool sample_equal(const struct frame *a, const struct frame *b)
{
	const size_t before = offsetof(struct pursuit_frame_header, planes);
	if (memcmp(&a->header, &b->header, before) != 0)
		return false;
	for (uint32_t i = 0; i < a->header.plane_count; i++)
		if (!plane_equal(&a->header.planes[i], a->planes[i], &b->header.planes[i], b->planes[i]))
			return false;
	return true;
}

const char *sample_folder(void)
{
	const char *base = getenv("TMPDIR");
	if (folder[0])
		return folder;
	snprintf(folder, sizeof(folder), "%s/pursuit-test-XXXXXX", base && *base ? base : "/tmp");
	if (!mkdtemp(folder)) {
		perror(folder);
		exit(1);
	}
	return folder;
}

void sample_folder_remove(void)
{
	DIR *dir = folder[0] ? opendir(folder) : NULL;
	for (struct dirent *entry; dir && (entry = readdir(dir));)
		if (entry->d_name[0] != '.')
			unlink(sample_path(entry->d_name));
	if (dir)
		closedir(dir);
	if (folder[0])
		rmdir(folder);
	folder[0] = '\0';
}

const char *sample_path(const char *name)
{
	static char paths[8][1024];
	static unsigned next;
	char *path = paths[next++ % 8];
	snprintf(path, sizeof(paths[0]), "%s/%s", sample_folder(), name);
	return path;
}

uint8_t *sample_read_file(const char *path, size_t *size)
{
	FILE *file = fopen(path, "rb");
	uint8_t *data = NULL;
	*size = 0;
	if (!file)
		return NULL;
	fseek(file, 0, SEEK_END);
	*size = (size_t)ftell(file);
	rewind(file);
	data = malloc(*size + 1);
	if (fread(data, 1, *size, file) != *size)
		*size = 0;
	fclose(file);
	return data;
}

void sample_write_file(const char *path, const void *data, size_t size)
{
	/* A truncated file is flushed to the disk at its close by some file systems; a new one is not. */
	unlink(path);
	FILE *file = fopen(path, "wb");
	if (!file || (size && fwrite(data, 1, size, file) != size) || fclose(file) != 0) {
		perror(path);
		exit(1);
	}
}
