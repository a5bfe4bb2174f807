/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/slots.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL)

/* What the daemon holds and what `latest` names, at the start (proto/shm.h). */
#define FIRST_LATEST 1u
#define FIRST_FREE 2u

static struct shim_slots *allocate(const struct shim_layout *layout, uint32_t slot_count)
{
	size_t planes_bytes;

	if (__builtin_mul_overflow(layout->slot_bytes, slot_count, &planes_bytes)) {
		errno = ENOMEM;
		return NULL;
	}

	struct shim_slots *slots = calloc(1, sizeof(*slots));

	if (slots) {
		slots->control_fd = -1;
		slots->planes_fd = -1;
		slots->slot_count = slot_count;
		slots->planes_bytes = planes_bytes;
	}
	return slots;
}

static void *map(size_t bytes, int flags, int fd)
{
	void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, flags, fd, 0);
	return memory == MAP_FAILED ? NULL : memory;
}

struct shim_slots *shim_slots_create_plain(const struct shim_layout *layout)
{
	struct shim_slots *slots = allocate(layout, layout->slot_count - FIRST_FREE);

	if (!slots) {
		return NULL;
	}
	slots->planes = map(slots->planes_bytes, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1);
	if (!slots->planes) {
		shim_slots_destroy(&slots);
		errno = ENOMEM;
		return NULL;
	}
	for (uint32_t i = 0; i < slots->slot_count; i++) {
		slots->owners[i] = SHIM_SLOT_FREE;
	}
	return slots;
}

static int sealed_memfd(const char *name, size_t bytes)
{
	int fd = memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING);

	if (fd >= 0 && (ftruncate(fd, (off_t)bytes) < 0 || fcntl(fd, F_ADD_SEALS, SEALS) < 0)) {
		int error = errno;
		close(fd);
		errno = error;
		return -1;
	}
	return fd;
}

static bool map_shared(struct shim_slots *slots)
{
	slots->control_fd = sealed_memfd("pursuit-control", sizeof(*slots->control));
	slots->planes_fd = slots->control_fd < 0 ? -1 : sealed_memfd("pursuit-planes", slots->planes_bytes);
	if (slots->planes_fd < 0) {
		return false;
	}
	slots->control = map(sizeof(*slots->control), MAP_SHARED, slots->control_fd);
	slots->planes = map(slots->planes_bytes, MAP_SHARED, slots->planes_fd);
	return slots->control && slots->planes;
}

struct shim_slots *shim_slots_create_shared(const struct shim_layout *layout)
{
	struct shim_slots *slots = allocate(layout, layout->slot_count);

	if (!slots) {
		return NULL;
	}
	if (!map_shared(slots)) {
		int error = errno;
		shim_slots_destroy(&slots);
		errno = error;
		return NULL;
	}
	slots->control->magic = PURSUIT_SHM_MAGIC;
	slots->control->version = PURSUIT_SHM_VERSION;
	slots->control->slot_count = slots->slot_count;
	slots->control->slot_bytes = layout->slot_bytes;
	slots->control->latest = FIRST_LATEST;
	for (uint32_t i = FIRST_FREE; i < slots->slot_count; i++) {
		slots->owners[i] = SHIM_SLOT_FREE;
	}
	return slots;
}

void shim_close_fd(int *fd)
{
	if (*fd >= 0) {
		close(*fd);
		*fd = -1;
	}
}

void shim_slots_forget_fds(struct shim_slots *slots)
{
	shim_close_fd(&slots->control_fd);
	shim_close_fd(&slots->planes_fd);
}

void shim_slots_destroy(struct shim_slots **slots)
{
	if (!slots || !*slots) {
		return;
	}
	shim_slots_forget_fds(*slots);
	if ((*slots)->control) {
		munmap((*slots)->control, sizeof(*(*slots)->control));
	}
	if ((*slots)->planes) {
		munmap((*slots)->planes, (*slots)->planes_bytes);
	}
	free(*slots);
	*slots = NULL;
}

struct pursuit_frame *shim_slots_take(struct shim_slots *slots, const struct shim_layout *layout)
{
	for (uint32_t i = 0; i < slots->slot_count; i++) {
		if (slots->owners[i] == SHIM_SLOT_FREE) {
			slots->owners[i] = SHIM_SLOT_TAKEN;
			slots->taken++;
			shim_layout_place(layout, slots->planes + layout->slot_bytes * i, &slots->frames[i]);
			return &slots->frames[i];
		}
	}
	return NULL;
}

int shim_slots_index(const struct shim_slots *slots, const struct pursuit_frame *frame)
{
	for (uint32_t i = 0; i < slots->slot_count; i++) {
		if (frame == &slots->frames[i] && slots->owners[i] == SHIM_SLOT_TAKEN) {
			return (int)i;
		}
	}
	return -1;
}

void shim_slots_give(struct shim_slots *slots, int index)
{
	slots->owners[index] = SHIM_SLOT_FREE;
	slots->taken--;
}

enum shim_published shim_slots_publish(struct shim_slots *slots, int index, const struct pursuit_frame_header *header)
{
	uint32_t mine = (uint32_t)index | PURSUIT_SLOT_FRESH;

	slots->control->headers[index] = *header;
	slots->taken--;

	uint32_t theirs = __atomic_exchange_n(&slots->control->latest, mine, __ATOMIC_ACQ_REL);
	uint32_t next = theirs & ~PURSUIT_SLOT_FRESH;

	bool sound = next < slots->slot_count && slots->owners[next] == SHIM_SLOT_AWAY;

	slots->owners[index] = SHIM_SLOT_AWAY;
	if (!sound) {
		return SHIM_PUBLISH_BROKEN;
	}
	slots->owners[next] = SHIM_SLOT_FREE;
	return theirs & PURSUIT_SLOT_FRESH ? SHIM_PUBLISHED_OVER : SHIM_PUBLISHED;
}

void shim_slots_release_pages(struct shim_slots *slots)
{
	if (!slots->control && slots->taken == 0) {
		madvise(slots->planes, slots->planes_bytes, MADV_DONTNEED);
	}
}
