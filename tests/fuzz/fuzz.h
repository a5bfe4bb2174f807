/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What fuzz targets share. A target is one function; it is driven by libFuzzer
 * (tests/fuzz/run) or by replay.c over the files of its corpus (./check). A
 * finding is a sanitizer's report, an abort, or a hang.
 */
#ifndef PURSUIT_TESTS_FUZZ_H
#define PURSUIT_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Tries one input. Deterministic, and leaves nothing behind. Gives 0. */
int fuzz_one(const uint8_t *data, size_t size);

/* A property that must hold whatever the input: aborts, and names it, if it does not. */
#define FUZZ_EXPECT(condition) fuzz_expect((condition), #condition, __FILE__, __LINE__)
void fuzz_expect(bool holds, const char *condition, const char *file, int line);

/* The input, taken from its front; zeros when it is used up. */
struct fuzz_input {
	const uint8_t *data;
	size_t size;
};

uint8_t fuzz_u8(struct fuzz_input *input);
uint16_t fuzz_u16(struct fuzz_input *input);
uint32_t fuzz_u32(struct fuzz_input *input);
/* At most `most` bytes; *taken says how many there are. Points into the input. */
const uint8_t *fuzz_bytes(struct fuzz_input *input, size_t most, size_t *taken);

/* A number, at times a small one and at times one of those that break programs. */
uint64_t fuzz_number(struct fuzz_input *input);

/*
 * A nameless regular file that holds these bytes; its path is valid until
 * fuzz_file_finish(). One at a time.
 */
struct fuzz_file {
	int fd;
	char path[32];
};

void fuzz_file_init(struct fuzz_file *file, const void *data, size_t size);
void fuzz_file_finish(struct fuzz_file *file);

/* Reads every byte, so that a sanitizer sees what is not there. Gives their sum. */
uint64_t fuzz_touch(const volatile uint8_t *data, size_t size);

/* Descriptors of this process: as many before as after a target that closes all it opens. One call of the kernel. */
int fuzz_open_fds(void);

#endif
