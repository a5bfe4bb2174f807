/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/fuzz/fuzz.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define MOST_FDS 256

void fuzz_expect(bool holds, const char *condition, const char *file, int line)
{
	if (holds)
		return;
	fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, condition);
	abort();
}

const uint8_t *fuzz_bytes(struct fuzz_input *input, size_t most, size_t *taken)
{
	const uint8_t *start = input->data;
	*taken = input->size < most ? input->size : most;
	input->data += *taken;
	input->size -= *taken;
	return start;
}

static uint64_t number_of(struct fuzz_input *input, size_t bytes)
{
	uint64_t value = 0;
	size_t taken;
	const uint8_t *from = fuzz_bytes(input, bytes, &taken);
	for (size_t i = 0; i < taken; i++)
		value |= (uint64_t)from[i] << 8 * i;
	return value;
}

uint8_t fuzz_u8(struct fuzz_input *input)
{
	return (uint8_t)number_of(input, 1);
}

uint16_t fuzz_u16(struct fuzz_input *input)
{
	return (uint16_t)number_of(input, 2);
}

uint32_t fuzz_u32(struct fuzz_input *input)
{
	return (uint32_t)number_of(input, 4);
}

uint64_t fuzz_number(struct fuzz_input *input)
{
	static const uint64_t hard[] = {
		0,
		1,
		63,
		64,
		65,
		4095,
		4096,
		4097,
		16384,
		16385,
		0x7f800000,
		0x7fc00000,
		0xff800000,
		0x80000000,
		0x7fffffff,
		0xffffffff,
		0x100000000,
		1u << 30,
		(1u << 30) + 1,
		UINT64_MAX,
		UINT64_MAX - 63,
		INT64_MAX,
		UINT64_MAX / 2 + 1,
		0x3f800000,
	};
	const uint8_t kind = fuzz_u8(input);
	switch (kind & 3) {
	case 0:
		return kind >> 2;
	case 1:
		return hard[(kind >> 2) % (sizeof(hard) / sizeof(hard[0]))];
	case 2:
		return number_of(input, 2);
	default:
		return number_of(input, 8);
	}
}

void fuzz_file_init(struct fuzz_file *file, const void *data, size_t size)
{
	file->fd = memfd_create("fuzz", MFD_CLOEXEC);
	FUZZ_EXPECT(file->fd >= 0 && write(file->fd, data, size) == (ssize_t)size);
	snprintf(file->path, sizeof(file->path), "/proc/self/fd/%d", file->fd);
}

void fuzz_file_finish(struct fuzz_file *file)
{
	close(file->fd);
	file->fd = -1;
}

uint64_t fuzz_touch(const volatile uint8_t *data, size_t size)
{
	uint64_t sum = 0;
	for (size_t i = 0; i < size; i++)
		sum += data[i];
	return sum;
}

int fuzz_open_fds(void)
{
	struct pollfd fds[MOST_FDS];
	int count = 0;
	for (int i = 0; i < MOST_FDS; i++)
		fds[i] = (struct pollfd){.fd = i};
	FUZZ_EXPECT(poll(fds, MOST_FDS, 0) >= 0);
	for (int i = 0; i < MOST_FDS; i++)
		count += !(fds[i].revents & POLLNVAL);
	return count;
}
