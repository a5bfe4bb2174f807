/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/slices.h"

#include <errno.h>
#include <sched.h>
#include <stdint.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#define SLICE_NS UINT64_C(100000)

/* As the kernel has it; the C library has no name for it yet. */
struct scheduling {
	uint32_t size, policy;
	uint64_t flags;
	int32_t nice;
	uint32_t priority;
	uint64_t runtime_ns, deadline_ns, period_ns;
};

void slices_shorten(const struct log *log)
{
	const struct scheduling scheduling = {
		.size = sizeof(scheduling), .nice = getpriority(PRIO_PROCESS, (id_t)gettid()), .runtime_ns = SLICE_NS};
	if (sched_getscheduler(0) != SCHED_OTHER)
		return; /* somebody has given it a real-time priority */
	if (syscall(SYS_sched_setattr, 0, &scheduling, 0) < 0)
		log_debug(log, "rendering with slices of the default length (%s)", strerror(errno));
}
