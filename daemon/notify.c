/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/notify.h"

#include <errno.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "daemon/clock.h"

/* Looks in one interval: with three, one that comes late costs nothing. */
#define LOOKS 3u

struct watchdog {
	const struct log *log;
	struct output *output;
	struct loop *loop;
	int timer_fd;
	struct loop_source *source;
	double step_s; /* between looks */
	uint64_t beats, rounds, work;
	uint64_t steps, cpu_ns, looks_in_step;
	bool stuck;
};

void notify_send(const struct log *log, const char *state)
{
	const char *path = getenv("NOTIFY_SOCKET");
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	if (!path || (*path != '/' && *path != '@') || strlen(path) >= sizeof(address.sun_path))
		return;
	const size_t length = strlen(path);
	memcpy(address.sun_path, path, length);
	if (*path == '@')
		address.sun_path[0] = 0;
	const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return;
	if (sendto(fd, state, strlen(state), MSG_NOSIGNAL, (struct sockaddr *)&address,
			   (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length)) < 0)
		log_warning(log, "NOTIFY_SOCKET: %s", strerror(errno));
	close(fd);
}

void notify_ready(const struct log *log)
{
	notify_send(log, "READY=1");
}

void notify_reloading(const struct log *log)
{
	char text[64];
	snprintf(text, sizeof(text), "RELOADING=1\nMONOTONIC_USEC=%" PRIu64, clock_monotonic_ns() / 1000u);
	notify_send(log, text);
}

void notify_stopping(const struct log *log)
{
	notify_send(log, "STOPPING=1");
}

/* ---- the watchdog ---- */

/* Since the last look, which was `looks` steps ago. */
static bool spins(struct watchdog *watchdog, uint64_t looks)
{
	const uint64_t rounds = loop_get_rounds(watchdog->loop), work = loop_get_work(watchdog->loop);
	const double gone = (double)(rounds - watchdog->rounds), done = (double)(work - watchdog->work);
	watchdog->rounds = rounds;
	watchdog->work = work;
	return gone - done > WATCHDOG_ROUNDS * watchdog->step_s * (double)looks;
}

static uint64_t cpu_time_ns(clockid_t clock)
{
	struct timespec time = {0, 0};
	clock_gettime(clock, &time);
	return (uint64_t)time.tv_sec * UINT64_C(1000000000) + (uint64_t)time.tv_nsec;
}

/* Since the last look: has it been in one step, at which it works, or others for it? */
static bool works(struct watchdog *watchdog, uint64_t looks)
{
	const uint64_t steps = output_rounds(watchdog->output);
	const uint64_t cpu_ns = cpu_time_ns(CLOCK_PROCESS_CPUTIME_ID) - cpu_time_ns(CLOCK_THREAD_CPUTIME_ID);
	const double used_s = (double)(int64_t)(cpu_ns - watchdog->cpu_ns) * 1e-9; /* the clocks are not read at once */
	watchdog->looks_in_step = steps == watchdog->steps ? watchdog->looks_in_step + looks : 0;
	watchdog->steps = steps;
	watchdog->cpu_ns = cpu_ns;
	return watchdog->looks_in_step > 0 && watchdog->looks_in_step <= WATCHDOG_LONGEST * LOOKS &&
		   used_s > WATCHDOG_SHARE * watchdog->step_s * (double)looks;
}

static void on_timer(void *data, uint32_t events)
{
	struct watchdog *watchdog = data;
	uint64_t looks;
	(void)events;
	if (read(watchdog->timer_fd, &looks, sizeof(looks)) < 0)
		return;
	const uint64_t beats = output_beats(watchdog->output);
	const bool working = works(watchdog, looks), spinning = spins(watchdog, looks);
	const bool stands = beats == watchdog->beats && !working, stuck = stands || spinning;
	if (!stuck)
		notify_send(watchdog->log, "WATCHDOG=1");
	else if (!watchdog->stuck)
		log_error(watchdog->log, "%s: the watchdog is not fed",
				  stands ? "the presentation loop is stuck, or its display" : "the main loop spins");
	watchdog->stuck = stuck;
	watchdog->beats = beats;
	output_wake(watchdog->output);
}

/* Microseconds, 0: none wanted, or not of this process. */
static uint64_t interval_wanted(void)
{
	const char *interval = getenv("WATCHDOG_USEC"), *pid = getenv("WATCHDOG_PID");
	if (!interval || (pid && strtol(pid, NULL, 10) != (long)getpid()))
		return 0;
	return strtoull(interval, NULL, 10);
}

static int start_timer(struct watchdog *watchdog, uint64_t interval_us)
{
	const uint64_t step_us = interval_us / LOOKS + 1;
	const struct timespec step = {(time_t)(step_us / 1000000), (long)(step_us % 1000000) * 1000};
	const struct itimerspec times = {step, step};
	watchdog->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (watchdog->timer_fd < 0 || timerfd_settime(watchdog->timer_fd, 0, &times, NULL) < 0)
		return -errno;
	return 0;
}

int watchdog_create(struct watchdog **watchdog, struct loop *loop, const struct log *log, struct output *output,
					struct error *error)
{
	const uint64_t interval_us = interval_wanted();
	*watchdog = NULL;
	if (interval_us == 0)
		return 0;
	struct watchdog *self = calloc(1, sizeof(*self));
	if (!self)
		return error_set(error, -ENOMEM, "watchdog: out of memory");
	*self = (struct watchdog){.log = log,
							  .output = output,
							  .loop = loop,
							  .timer_fd = -1,
							  .step_s = (double)interval_us / LOOKS * 1e-6,
							  .beats = UINT64_MAX,
							  .steps = UINT64_MAX,
							  .rounds = loop_get_rounds(loop),
							  .work = loop_get_work(loop)};
	int result = start_timer(self, interval_us);
	if (result == 0) {
		self->source = loop_add(loop, self->timer_fd, EPOLLIN, on_timer, self);
		result = self->source ? 0 : -errno;
	}
	if (result < 0) {
		watchdog_destroy(&self);
		return error_set(error, result, "watchdog: %s", strerror(-result));
	}
	log_debug(log, "watchdog: fed every %" PRIu64 " ms", interval_us / LOOKS / 1000);
	*watchdog = self;
	return 0;
}

void watchdog_destroy(struct watchdog **watchdog)
{
	struct watchdog *self = *watchdog;
	*watchdog = NULL;
	if (!self)
		return;
	loop_remove(&self->source);
	if (self->timer_fd >= 0)
		close(self->timer_fd);
	free(self);
}
