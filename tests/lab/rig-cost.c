/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/lab/rig-cost.h"

#include <dirent.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

struct rig_cost {
	int fd;
	uint32_t priority;
	pthread_t thread;
	atomic_bool stop;
};

static void *run(void *data)
{
	struct rig_cost *cost = data;
	struct pollfd poll_fd = {.fd = cost->fd, .events = POLLIN};
	const struct sched_param priority = {.sched_priority = (int)cost->priority};
	uint64_t count;
	pthread_setname_np(pthread_self(), "bare");
	if (cost->priority && pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) != 0)
		fprintf(stderr, "the bare thread has no real-time priority\n");
	while (!atomic_load(&cost->stop))
		if (ppoll(&poll_fd, 1, NULL, NULL) > 0 && read(cost->fd, &count, sizeof(count)) < 0)
			break;
	return NULL;
}

struct rig_cost *rig_cost_create(uint32_t priority)
{
	struct rig_cost *cost = calloc(1, sizeof(*cost));
	if (!cost)
		return NULL;
	cost->priority = priority;
	cost->fd = eventfd(0, EFD_CLOEXEC);
	if (cost->fd >= 0 && pthread_create(&cost->thread, NULL, run, cost) == 0)
		return cost;
	free(cost);
	return NULL;
}

void rig_cost_flip(struct rig_cost *cost)
{
	const uint64_t one = 1;
	if (cost && write(cost->fd, &one, sizeof(one)) < 0)
		perror("eventfd");
}

void rig_cost_destroy(struct rig_cost **cost)
{
	struct rig_cost *self = *cost;
	*cost = NULL;
	if (!self)
		return;
	atomic_store(&self->stop, true);
	rig_cost_flip(self);
	pthread_join(self->thread, NULL);
	close(self->fd);
	free(self);
}

static bool read_line(const char *task, const char *file, char *line, int size)
{
	char path[300];
	snprintf(path, sizeof(path), "/proc/self/task/%s/%s", task, file);
	FILE *in = fopen(path, "re");
	const bool got = in && fgets(line, size, in);
	if (in)
		fclose(in);
	return got;
}

json_t *rig_cost_threads(uint64_t flips)
{
	json_t *threads = json_object();
	DIR *folder = opendir("/proc/self/task");
	const struct dirent *entry;
	char name[64], time_ns[128];
	while (folder && (entry = readdir(folder))) {
		if (*entry->d_name == '.' || !read_line(entry->d_name, "comm", name, sizeof(name)) ||
			!read_line(entry->d_name, "schedstat", time_ns, sizeof(time_ns)))
			continue;
		name[strcspn(name, "\n")] = '\0';
		json_object_set_new(threads, name, json_real(strtod(time_ns, NULL) / 1e3 / (double)flips));
	}
	if (folder)
		closedir(folder);
	return threads;
}
