/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/window_thread.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "daemon/clock.h"
#include "daemon/worker.h"

#define SECOND UINT64_C(1000000000)
#define STOP_NS (2 * SECOND)
/* Events may have been read from the connection by another thread; then no descriptor tells of them. */
#define POLL_MS 10

struct window_thread {
	struct window_work work;
	struct worker *worker;
	int wake_fd;
	_Atomic uint64_t busy_since_ns; /* 0: it waits for something to do */

	pthread_mutex_t lock; /* for what follows */
	pthread_cond_t change;
	bool opened, stop, mute;
	int result;
	struct error error;
};

static void free_thread(void *data)
{
	struct window_thread *thread = data;
	thread->work.release(thread->work.data);
	if (thread->wake_fd >= 0)
		close(thread->wake_fd);
	pthread_cond_destroy(&thread->change);
	pthread_mutex_destroy(&thread->lock);
	free(thread);
}

/* ---- the thread ---- */

static void say_opened(struct window_thread *thread, int result, const struct error *error)
{
	pthread_mutex_lock(&thread->lock);
	thread->opened = true;
	thread->result = result;
	thread->error = *error;
	pthread_cond_signal(&thread->change);
	pthread_mutex_unlock(&thread->lock);
}

static bool is_to_stop(struct window_thread *thread)
{
	pthread_mutex_lock(&thread->lock);
	const bool stop = thread->stop;
	pthread_mutex_unlock(&thread->lock);
	return stop;
}

static void wait_for_work(struct window_thread *thread, bool more)
{
	const int fd = more ? thread->work.get_fd(thread->work.data) : -1;
	struct pollfd fds[2] = {{.fd = thread->wake_fd, .events = POLLIN}, {.fd = fd, .events = POLLIN}};
	uint64_t count;
	poll(fds, 2, more ? POLL_MS : -1);
	if (read(thread->wake_fd, &count, sizeof(count)) < 0) {
		/* It was the other one, or time. */
	}
}

static void run(void *data)
{
	struct window_thread *thread = data;
	const struct window_work *work = &thread->work;
	struct error error = {""};
	pthread_setname_np(pthread_self(), "pursuit-window");
	const int result = work->open(work->data, thread, &error);
	say_opened(thread, result, &error);
	bool more = result == 0;
	while (result == 0 && !is_to_stop(thread)) {
		atomic_store(&thread->busy_since_ns, 0);
		wait_for_work(thread, more);
		atomic_store(&thread->busy_since_ns, clock_monotonic_ns());
		more = work->process(work->data) && more;
	}
	work->close(work->data);
}

/* ---- its owner ---- */

static struct window_thread *allocate(const struct window_work *work)
{
	struct window_thread *thread = calloc(1, sizeof(*thread));
	if (!thread) {
		work->release(work->data);
		return NULL;
	}
	thread->work = *work;
	thread->wake_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	atomic_init(&thread->busy_since_ns, clock_monotonic_ns());
	pthread_mutex_init(&thread->lock, NULL);
	clock_cond_init(&thread->change);
	return thread;
}

static int wait_for_open(struct window_thread *thread, uint64_t limit_ns, struct error *error)
{
	const uint64_t until_ns = clock_monotonic_ns() + limit_ns;
	pthread_mutex_lock(&thread->lock);
	while (!thread->opened && clock_cond_wait(&thread->change, &thread->lock, until_ns))
		;
	const int result = thread->opened ? thread->result : -ETIMEDOUT;
	if (thread->opened)
		*error = thread->error;
	else
		error_set(error, result, "glfw: the display server does not answer");
	pthread_mutex_unlock(&thread->lock);
	return result;
}

int window_thread_start(const struct window_work *work, uint64_t limit_ns, struct window_thread **thread,
						struct error *error)
{
	struct window_thread *self = *thread = allocate(work);
	if (!self)
		return error_set(error, -ENOMEM, "glfw: out of memory");
	int result = self->wake_fd < 0 ? -EMFILE : worker_create(&self->worker, run, self);
	if (result < 0) {
		free_thread(self);
		*thread = NULL;
		return error_set(error, result, "glfw: cannot start a thread: %s", strerror(-result));
	}
	result = wait_for_open(self, limit_ns, error);
	if (result < 0)
		window_thread_stop(thread);
	return result;
}

void window_thread_stop(struct window_thread **thread)
{
	struct window_thread *self = *thread;
	*thread = NULL;
	if (!self)
		return;
	pthread_mutex_lock(&self->lock);
	self->stop = self->mute = true;
	/* Who has waited for it to open need not wait again. */
	const uint64_t patience_ns = self->opened ? STOP_NS : 0;
	pthread_mutex_unlock(&self->lock);
	window_thread_wake(self);
	if (worker_destroy(&self->worker, patience_ns, free_thread))
		free_thread(self);
	else
		window_thread_leave_at_exit();
}

void window_thread_wake(struct window_thread *thread)
{
	const uint64_t one = 1;
	if (write(thread->wake_fd, &one, sizeof(one)) < 0) {
		/* A full counter wakes just as well. */
	}
}

bool window_thread_begin_call(struct window_thread *thread)
{
	pthread_mutex_lock(&thread->lock);
	if (!thread->mute)
		return true;
	pthread_mutex_unlock(&thread->lock);
	return false;
}

void window_thread_end_call(struct window_thread *thread)
{
	pthread_mutex_unlock(&thread->lock);
}

void window_thread_mute(struct window_thread *thread)
{
	pthread_mutex_lock(&thread->lock);
	thread->mute = true;
	pthread_mutex_unlock(&thread->lock);
}

uint64_t window_thread_busy_ns(const struct window_thread *thread)
{
	const uint64_t since_ns = atomic_load(&thread->busy_since_ns), now = clock_monotonic_ns();
	return since_ns && now > since_ns ? now - since_ns : 0;
}

static void leave_at_once(int status, void *data)
{
	(void)data;
	fflush(NULL);
	_exit(status);
}

void window_thread_leave_at_exit(void)
{
	on_exit(leave_at_once, NULL);
}
