/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The render thread's slices are short, and all else of its scheduling stays: niceness, a real-time priority. */

#include <pthread.h>
#include <sched.h>
#include <stdint.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "daemon/slices.h"
#include "tests/test.h"

/* As sched_setattr(2) has it; no header of the C library does. */
struct attributes {
	uint32_t size, policy;
	uint64_t flags;
	int32_t nice;
	uint32_t priority;
	uint64_t runtime_ns, deadline_ns, period_ns;
};

static struct log test_log;

static struct attributes get(void)
{
	struct attributes attributes = {.size = sizeof(attributes)};
	CHECK_INT(syscall(SYS_sched_getattr, 0, &attributes, sizeof(attributes), 0), 0);
	return attributes;
}

/* Linux 6.12 and later; not in every container. */
static void *try_slices(void *known)
{
	const struct attributes wanted = {.size = sizeof(wanted), .runtime_ns = 700000};
	*(bool *)known = syscall(SYS_sched_setattr, 0, &wanted, 0) == 0 && get().runtime_ns == wanted.runtime_ns;
	return NULL;
}

static void *shorten(void *data)
{
	(void)data;
	CHECK_INT(setpriority(PRIO_PROCESS, (id_t)gettid(), 7), 0);
	slices_shorten(&test_log);
	const struct attributes attributes = get();
	CHECK_INT(attributes.runtime_ns, 100000);
	CHECK_INT(attributes.policy, SCHED_OTHER);
	CHECK_INT(attributes.nice, 7);
	return NULL;
}

static void *shorten_real_time(void *data)
{
	const struct sched_param priority = {.sched_priority = 5};
	(void)data;
	if (sched_setscheduler(0, SCHED_FIFO, &priority) < 0)
		return NULL; /* it needs a privilege */
	slices_shorten(&test_log);
	const struct attributes attributes = get();
	CHECK_INT(attributes.policy, SCHED_FIFO);
	CHECK_INT(attributes.priority, 5);
	return NULL;
}

static void on_thread(void *(*function)(void *data), void *data)
{
	pthread_t thread;
	CHECK_INT(pthread_create(&thread, NULL, function, data), 0);
	pthread_join(thread, NULL);
}

static void test_shortened(void)
{
	on_thread(shorten, NULL);
}

static void test_real_time(void)
{
	on_thread(shorten_real_time, NULL);
}

int main(void)
{
	bool known = false;
	log_init(&test_log, LOG_LEVEL_ERROR);
	on_thread(try_slices, &known);
	RUN(test_real_time);
	if (!known)
		SKIP("the kernel has no slices to set");
	RUN(test_shortened);
	return test_result();
}
