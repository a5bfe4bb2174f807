/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/fault/faults.h"

#include <errno.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

static _Atomic int planned = FAULT_NONE;
static _Atomic uint64_t left; /* calls of the kind before the one that fails */
static atomic_bool happened, paused;

/* Counts a call; true: it is to fail. `lasting`: so are all after it. */
static bool due(enum fault_kind kind, bool lasting)
{
	if (atomic_load(&planned) != (int)kind || atomic_load(&paused))
		return false;
	if (atomic_load(&happened))
		return lasting;
	if (atomic_fetch_sub(&left, 1) != 0)
		return false;
	atomic_store(&happened, true);
	return true;
}

static bool fails(enum fault_kind kind, bool lasting, int code)
{
	const bool failed = due(kind, lasting);
	if (failed)
		errno = code;
	return failed;
}

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
char *__real_strdup(const char *text);
char *__wrap_strdup(const char *text);
void *__real_mmap64(void *at, size_t size, int protection, int flags, int fd, off_t offset);
void *__wrap_mmap64(void *at, size_t size, int protection, int flags, int fd, off_t offset);
int __real_open64(const char *path, int flags, ...);
int __wrap_open64(const char *path, int flags, ...);
int __real_socket(int domain, int type, int protocol);
int __wrap_socket(int domain, int type, int protocol);
int __real_accept4(int fd, struct sockaddr *address, socklen_t *size, int flags);
int __wrap_accept4(int fd, struct sockaddr *address, socklen_t *size, int flags);
int __real_eventfd(unsigned value, int flags);
int __wrap_eventfd(unsigned value, int flags);
int __real_memfd_create(const char *name, unsigned flags);
int __wrap_memfd_create(const char *name, unsigned flags);
int __real_epoll_create1(int flags);
int __wrap_epoll_create1(int flags);
ssize_t __real_read(int fd, void *to, size_t size);
ssize_t __wrap_read(int fd, void *to, size_t size);
ssize_t __real_write(int fd, const void *from, size_t size);
ssize_t __wrap_write(int fd, const void *from, size_t size);
ssize_t __real_pread64(int fd, void *to, size_t size, off_t offset);
ssize_t __wrap_pread64(int fd, void *to, size_t size, off_t offset);
ssize_t __real_recvmsg(int fd, struct msghdr *message, int flags);
ssize_t __wrap_recvmsg(int fd, struct msghdr *message, int flags);
ssize_t __real_sendmsg(int fd, const struct msghdr *message, int flags);
ssize_t __wrap_sendmsg(int fd, const struct msghdr *message, int flags);
int __real_ftruncate64(int fd, off_t size);
int __wrap_ftruncate64(int fd, off_t size);
int __real_fsync(int fd);
int __wrap_fsync(int fd);

void fault_plan(enum fault_kind kind, uint64_t index)
{
	json_set_alloc_funcs(__wrap_malloc, free);
	atomic_store(&left, index);
	atomic_store(&happened, false);
	atomic_store(&paused, false);
	atomic_store(&planned, (int)kind);
}

void fault_pause(bool pause)
{
	atomic_store(&paused, pause);
}

bool fault_end(void)
{
	atomic_store(&planned, FAULT_NONE);
	return atomic_load(&happened);
}

const char *fault_name(enum fault_kind kind)
{
	static const char *const names[FAULT_KINDS] = {"none",  "out of memory", "out of descriptors", "interrupted",
												   "short", "disk full",     "input/output error"};
	return names[kind];
}

/* ---- memory ---- */

void *__wrap_malloc(size_t size)
{
	return fails(FAULT_MEMORY, false, ENOMEM) ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
	return fails(FAULT_MEMORY, false, ENOMEM) ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size)
{
	return fails(FAULT_MEMORY, false, ENOMEM) ? NULL : __real_realloc(memory, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
	return fails(FAULT_MEMORY, false, ENOMEM) ? NULL : __real_aligned_alloc(alignment, size);
}

char *__wrap_strdup(const char *text)
{
	return fails(FAULT_MEMORY, false, ENOMEM) ? NULL : __real_strdup(text);
}

void *__wrap_mmap64(void *at, size_t size, int protection, int flags, int fd, off_t offset)
{
	return fails(FAULT_MEMORY, false, ENOMEM) ? MAP_FAILED : __real_mmap64(at, size, protection, flags, fd, offset);
}

/* ---- descriptors ---- */

int __wrap_open64(const char *path, int flags, ...)
{
	va_list arguments;
	va_start(arguments, flags);
	const mode_t mode = (mode_t)va_arg(arguments, int);
	va_end(arguments);
	return fails(FAULT_DESCRIPTORS, false, EMFILE) ? -1 : __real_open64(path, flags, mode);
}

int __wrap_socket(int domain, int type, int protocol)
{
	return fails(FAULT_DESCRIPTORS, false, EMFILE) ? -1 : __real_socket(domain, type, protocol);
}

int __wrap_accept4(int fd, struct sockaddr *address, socklen_t *size, int flags)
{
	return fails(FAULT_DESCRIPTORS, false, EMFILE) ? -1 : __real_accept4(fd, address, size, flags);
}

int __wrap_eventfd(unsigned value, int flags)
{
	return fails(FAULT_DESCRIPTORS, false, EMFILE) ? -1 : __real_eventfd(value, flags);
}

int __wrap_memfd_create(const char *name, unsigned flags)
{
	return fails(FAULT_DESCRIPTORS, false, EMFILE) ? -1 : __real_memfd_create(name, flags);
}

int __wrap_epoll_create1(int flags)
{
	return fails(FAULT_DESCRIPTORS, false, EMFILE) ? -1 : __real_epoll_create1(flags);
}

/* ---- reading and writing ---- */

/* Disks fail; eventfds and sockets do not in that way. */
static bool is_on_disk(int fd)
{
	struct stat status;
	return fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
}

static bool cannot_read(int fd)
{
	return fails(FAULT_INTERRUPTED, false, EINTR) || (is_on_disk(fd) && fails(FAULT_IO, true, EIO));
}

static size_t shortened(int fd, size_t size)
{
	return size > 1 && is_on_disk(fd) && due(FAULT_SHORT, false) ? size / 2 : size;
}

ssize_t __wrap_read(int fd, void *to, size_t size)
{
	return cannot_read(fd) ? -1 : __real_read(fd, to, shortened(fd, size));
}

ssize_t __wrap_pread64(int fd, void *to, size_t size, off_t offset)
{
	return cannot_read(fd) ? -1 : __real_pread64(fd, to, shortened(fd, size), offset);
}

ssize_t __wrap_write(int fd, const void *from, size_t size)
{
	if (cannot_read(fd) || (is_on_disk(fd) && fails(FAULT_DISK_FULL, true, ENOSPC)))
		return -1;
	return __real_write(fd, from, shortened(fd, size));
}

ssize_t __wrap_recvmsg(int fd, struct msghdr *message, int flags)
{
	return fails(FAULT_INTERRUPTED, false, EINTR) ? -1 : __real_recvmsg(fd, message, flags);
}

ssize_t __wrap_sendmsg(int fd, const struct msghdr *message, int flags)
{
	return fails(FAULT_INTERRUPTED, false, EINTR) ? -1 : __real_sendmsg(fd, message, flags);
}

int __wrap_ftruncate64(int fd, off_t size)
{
	return fails(FAULT_DISK_FULL, false, ENOSPC) ? -1 : __real_ftruncate64(fd, size);
}

int __wrap_fsync(int fd)
{
	return fails(FAULT_DISK_FULL, true, ENOSPC) || fails(FAULT_IO, true, EIO) ? -1 : __real_fsync(fd);
}
