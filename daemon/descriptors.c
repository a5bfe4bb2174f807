/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/descriptors.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

/* More than any process has, where the limit says nothing. */
#define MOST (1u << 20)

void descriptors_close(unsigned first, unsigned last)
{
	struct rlimit limit = {MOST, MOST};
	if (close_range(first, last, 0) == 0)
		return;
	/* Kernels before 5.9, or a filter that does not know the call. */
	getrlimit(RLIMIT_NOFILE, &limit);
	const rlim_t end = limit.rlim_cur < MOST ? limit.rlim_cur : MOST;
	for (unsigned fd = first; fd <= last && fd < end; fd++)
		close((int)fd);
}

void descriptors_fill(void)
{
	int fd;
	/* They are given from the lowest on. */
	while ((fd = open("/dev/null", O_RDONLY)) >= 0 && fd <= STDERR_FILENO)
		;
	if (fd >= 0)
		close(fd);
}
