/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the tests of recordings share: frames to record, folders to do it in, bytes of a file. */
#ifndef PURSUIT_TESTS_SAMPLE_H
#define PURSUIT_TESTS_SAMPLE_H

#include "daemon/frame.h"

/* A frame of its own memory with colour, depth, motion, UI and object ids, and what they hold by (id, x, y). */
struct sample {
	struct frame frame;
	uint8_t *memory;
	uint64_t bytes;
};

/* Strides are larger than needed, and the gaps are filled with garbage. */
void sample_init(struct sample *sample, uint64_t id, uint32_t width, uint32_t height);
void sample_finish(struct sample *sample);

/* True if every header field that is recorded and every pixel are the same, whatever the layout. */
bool sample_equal(const struct frame *a, const struct frame *b);

/* A new folder below the temporary one; and its removal with all files in it. */
const char *sample_folder(void);
void sample_folder_remove(void);
/* Path in that folder, valid until the eighth call from now. */
const char *sample_path(const char *name);

uint8_t *sample_read_file(const char *path, size_t *size);
void sample_write_file(const char *path, const void *data, size_t size);

#endif
