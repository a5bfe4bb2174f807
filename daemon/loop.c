/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/loop.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/signalfd.h>
#include <unistd.h>

#define EVENTS_AT_ONCE 32

struct loop_source {
	struct loop *loop;
	struct loop_source *next; /* in loop->removed */
	int fd;
	bool removed;
	loop_callback callback;
	void *data;
};

struct loop {
	int epoll;
	int signals; /* -1: none */
	bool quit;
	uint64_t rounds, work;
	struct loop_source *removed; /* freed after the events at hand: one of them may name it */
	struct loop_source *signal_source;
	loop_signal_callback signal_callback;
	void *signal_data;
};

struct loop *loop_create(struct error *error)
{
	struct loop *loop = calloc(1, sizeof(*loop));
	if (!loop) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	loop->signals = -1;
	loop->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (loop->epoll < 0) {
		error_set(error, -errno, "epoll_create1: %s", strerror(errno));
		free(loop);
		return NULL;
	}
	return loop;
}

static void free_removed(struct loop *loop)
{
	while (loop->removed) {
		struct loop_source *source = loop->removed;
		loop->removed = source->next;
		free(source);
	}
}

void loop_destroy(struct loop **loop)
{
	if (!*loop)
		return;
	loop_remove(&(*loop)->signal_source);
	free_removed(*loop);
	if ((*loop)->signals >= 0)
		close((*loop)->signals);
	close((*loop)->epoll);
	free(*loop);
	*loop = NULL;
}

struct loop_source *loop_add(struct loop *loop, int fd, uint32_t events, loop_callback callback, void *data)
{
	struct loop_source *source = calloc(1, sizeof(*source));
	if (!source)
		return NULL;
	*source = (struct loop_source){.loop = loop, .fd = fd, .callback = callback, .data = data};
	struct epoll_event event = {.events = events, .data.ptr = source};
	if (epoll_ctl(loop->epoll, EPOLL_CTL_ADD, fd, &event) < 0) {
		const int saved = errno;
		free(source);
		errno = saved;
		return NULL;
	}
	return source;
}

void loop_remove(struct loop_source **source)
{
	if (!*source)
		return;
	struct loop *loop = (*source)->loop;
	epoll_ctl(loop->epoll, EPOLL_CTL_DEL, (*source)->fd, NULL);
	(*source)->removed = true;
	(*source)->next = loop->removed;
	loop->removed = *source;
	*source = NULL;
}

static void on_signal(void *data, uint32_t events)
{
	struct loop *loop = data;
	struct signalfd_siginfo info;
	(void)events;
	while (read(loop->signals, &info, sizeof(info)) == (ssize_t)sizeof(info))
		loop->signal_callback(loop->signal_data, (int)info.ssi_signo);
}

int loop_add_signals(struct loop *loop, const int *numbers, unsigned count, loop_signal_callback callback, void *data,
					 struct error *error)
{
	sigset_t set;
	sigemptyset(&set);
	for (unsigned i = 0; i < count; i++)
		sigaddset(&set, numbers[i]);
	if (sigprocmask(SIG_BLOCK, &set, NULL) < 0)
		return error_set(error, -errno, "sigprocmask: %s", strerror(errno));
	loop->signals = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
	if (loop->signals < 0)
		return error_set(error, -errno, "signalfd: %s", strerror(errno));
	loop->signal_callback = callback;
	loop->signal_data = data;
	loop->signal_source = loop_add(loop, loop->signals, EPOLLIN, on_signal, loop);
	return loop->signal_source ? 0 : error_set(error, -errno, "epoll_ctl: %s", strerror(errno));
}

int loop_step(struct loop *loop, int timeout_ms, struct error *error)
{
	struct epoll_event events[EVENTS_AT_ONCE];
	const int count = epoll_wait(loop->epoll, events, EVENTS_AT_ONCE, timeout_ms);
	if (count < 0)
		return errno == EINTR ? 0 : error_set(error, -errno, "epoll_wait: %s", strerror(errno));
	loop->rounds++;
	for (int i = 0; i < count; i++) {
		const struct loop_source *source = events[i].data.ptr;
		if (!source->removed)
			source->callback(source->data, events[i].events);
	}
	free_removed(loop);
	return 0;
}

int loop_run(struct loop *loop, struct error *error)
{
	while (!loop->quit) {
		const int result = loop_step(loop, -1, error);
		if (result < 0)
			return result;
	}
	return 0;
}

uint64_t loop_get_rounds(const struct loop *loop)
{
	return loop->rounds;
}

uint64_t loop_get_work(const struct loop *loop)
{
	return loop->work;
}

void loop_add_work(struct loop *loop, uint32_t pieces)
{
	loop->work += pieces;
}

void loop_quit(struct loop *loop)
{
	loop->quit = true;
}
