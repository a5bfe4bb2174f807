/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "daemon/present/kms.h"

#define SECOND UINT64_C(1000000000)
/* A display that says nothing for so long is dead. */
#define SILENCE_NS (2 * SECOND)
/* So many vblanks after its own a flip will not end any more. */
#define FLIP_VBLANKS 256u

static uint64_t now_of(const struct kms *kms)
{
	return clock_now(kms->params.clock);
}

static void keep_reports(struct kms *kms, const struct presenter_flip *reports, uint32_t count)
{
	for (uint32_t i = 0; i < count && !kms->lost && kms->report_count < KMS_REPORTS; i++)
		kms->reports[kms->report_count++] = reports[i];
}

void kms_lose(struct kms *kms, const char *why)
{
	const uint64_t one = 1;
	if (kms->lost)
		return;
	error_set(&kms->loss, -ENODEV, "kms: %s: %s", kms_device_get_name(kms->device), why);
	kms->lost = true;
	kms->running = false;
	if (write(kms->wake, &one, sizeof(one)) < 0)
		log_debug(kms->params.log, "kms: eventfd: %s", strerror(errno));
}

/* ---- vblanks ---- */

int kms_anchor(struct kms *kms)
{
	uint64_t sequence, time_ns;
	const int result = kms_device_get_sequence(kms->device, &sequence, &time_ns);
	if (result < 0)
		return result;
	if (sequence != kms->sequence && time_ns != 0) {
		kms->number = vblanks_add(&kms->vblanks, sequence, time_ns);
		kms->sequence = sequence;
		kms->grid = vblanks_get_grid(&kms->vblanks);
	}
	kms->heard_ns = now_of(kms);
	return kms_device_queue_sequence(kms->device, sequence + 1);
}

void kms_start(struct kms *kms, uint64_t vblank)
{
	const uint64_t one = 1;
	kms->running = true;
	scanout_start(&kms->scanout, vblank);
	if (!kms->away && kms_anchor(kms) < 0)
		kms_lose(kms, "it counts no vblanks any more");
	if (kms->away)
		kms->number = grid_at_or_after(&kms->grid, now_of(kms) + 1) - 1;
	if (write(kms->wake, &one, sizeof(one)) < 0)
		log_debug(kms->params.log, "kms: eventfd: %s", strerror(errno));
}

void kms_choose(struct kms *kms, uint64_t vblank)
{
	const int image = scanout_choose(&kms->scanout, vblank);
	kms->chosen = vblank;
	if (image < 0)
		return;
	const struct kms_picture *picture = &kms->pictures[image];
	const int result = kms_device_flip(kms->device, &picture->shown->buffer, picture->fence);
	if (result == 0)
		return;
	scanout_failed(&kms->scanout);
	if (result == -EBUSY || result == -EAGAIN || result == -EINTR)
		return;
	kms_lose(kms, result == -EACCES || result == -EPERM ? "another program has taken the display" : strerror(-result));
}

static void on_vblank(void *data, uint64_t sequence, uint64_t time_ns)
{
	struct kms *kms = data;
	struct presenter_flip reports[2];

	/* One that lay there when kms_anchor() asked is of before. */
	if ((int64_t)(sequence - kms->sequence) <= 0 || kms->away)
		return;
	kms->number = vblanks_add(&kms->vblanks, sequence, time_ns);
	kms->sequence = sequence;
	kms->heard_ns = now_of(kms);
	const struct presenter_flip flip = {
		.vblank = kms->number,
		/* Before this stamp has moved the grid: the time that was aimed at. */
		.target_ns = grid_time(&kms->grid, kms->number),
		.flip_ns = time_ns,
		.sequence = sequence,
		.time_source = PRESENTER_TIME_KERNEL,
	};
	kms->grid = vblanks_get_grid(&kms->vblanks);
	if (!kms->running)
		return;
	keep_reports(kms, reports, scanout_vblank(&kms->scanout, &flip, reports));
	kms->asks = true;
}

static void on_flipped(void *data, uint64_t sequence, uint64_t time_ns)
{
	struct kms *kms = data;
	struct presenter_flip reports[2];
	/* The kernel's flips carry the lower half of the count. */
	const int32_t ahead = (int32_t)((uint32_t)sequence - (uint32_t)kms->sequence);
	const uint64_t vblank = kms->number + (uint64_t)(int64_t)ahead;
	const struct presenter_flip flip = {.vblank = vblank,
										.target_ns = grid_time(&kms->grid, vblank),
										.flip_ns = time_ns,
										.sequence = kms->sequence + (uint64_t)(int64_t)ahead,
										.time_source = PRESENTER_TIME_KERNEL};
	keep_reports(kms, reports, scanout_flipped(&kms->scanout, &flip, reports));
}

/* While another console is on display: nobody sees it. */
static void tick(struct kms *kms)
{
	struct presenter_flip reports[2];
	const uint64_t vblank = kms->number + 1;
	const struct presenter_flip flip = {.vblank = vblank,
										.target_ns = grid_time(&kms->grid, vblank),
										.flip_ns = now_of(kms),
										.time_source = PRESENTER_TIME_TIMER};
	kms->number = kms->chosen = vblank;
	if (scanout_choose(&kms->scanout, vblank) >= 0)
		keep_reports(kms, reports, scanout_flipped(&kms->scanout, &flip, reports));
	keep_reports(kms, reports, scanout_vblank(&kms->scanout, &flip, reports));
}

/* ---- changes from outside ---- */

static void leave(struct kms *kms)
{
	log_info(kms->params.log, "kms: another console is on display; going on unseen");
	kms_device_leave(kms->device);
	kms_console_left(&kms->console);
	kms->away = true;
}

/* Setting a mode takes long: nobody waits for it but this thread, and as long as we are away nobody flips. */
static int light_up_again(struct kms *kms, struct error *error)
{
	const struct scanout *scanout = &kms->scanout;
	const struct kms_buffer *buffer =
		scanout->shown.any ? &kms->pictures[scanout->shown.image].shown->buffer : &kms->backdrop;
	int result = kms_device_return(kms->device);
	if (result < 0)
		return error_set(error, result, "another program has taken the display");
	pthread_mutex_unlock(&kms->lock);
	result = kms_device_show(kms->device, buffer, error);
	pthread_mutex_lock(&kms->lock);
	return result;
}

static void come_back(struct kms *kms)
{
	struct error error;

	if (!kms->away)
		return;
	if (light_up_again(kms, &error) < 0)
		kms_lose(kms, error.text);
	else if (kms->running && kms_anchor(kms) < 0)
		kms_lose(kms, "it counts no vblanks any more");
	else
		log_info(kms->params.log, "kms: back on display");
	kms->away = false;
}

/* ---- what the user hears ---- */

/* Without the lock. */
static void tell_flips(struct kms *kms)
{
	for (uint32_t i = 0; i < kms->report_count; i++)
		kms->params.flip(kms->params.data, &kms->reports[i]);
	kms->report_count = 0;
}

static void tell_loss(struct kms *kms, bool lost)
{
	if (lost && !kms->told_loss && kms->params.lost)
		kms->params.lost(kms->params.data, kms->loss.text);
	kms->told_loss = lost;
}

/* With the lock, which is given up meanwhile: a flip is told before anything else is done. */
static void hand_on_flips(struct kms *kms)
{
	if (kms->report_count == 0)
		return;
	pthread_mutex_unlock(&kms->lock);
	tell_flips(kms);
	pthread_mutex_lock(&kms->lock);
}

/* With the lock. */
static void ask_for_vblank(struct kms *kms)
{
	const bool ask = kms->asks && kms->running && !kms->away;
	kms->asks = false;
	if (ask && kms_device_queue_sequence(kms->device, kms->sequence + 1) < 0)
		kms_lose(kms, "it counts no vblanks any more");
}

/* ---- the thread ---- */

static bool is_to_choose(const struct kms *kms, uint64_t vblank)
{
	return kms->chosen < vblank && vblank >= kms->scanout.next_vblank;
}

/*
 * One that waits for the GPU is the GPU's affair: its driver ends it, if need be with a reset. From then on it has as
 * long as any other.
 */
static bool flip_hangs(struct kms *kms)
{
	const struct scanout *scanout = &kms->scanout;
	const uint64_t due = scanout->under_way_vblank;
	if (!scanout->under_way.any || kms->number <= due + FLIP_VBLANKS / 2)
		return false;
	struct pollfd fence = {kms->pictures[scanout->under_way.image].fence, POLLIN, 0};
	if (fence.fd >= 0 && poll(&fence, 1, 0) == 0)
		kms->undrawn_vblank = kms->number;
	return kms->number > (due > kms->undrawn_vblank ? due : kms->undrawn_vblank) + FLIP_VBLANKS;
}

static void act_on_time(struct kms *kms)
{
	const uint64_t now_ns = now_of(kms), next = kms->number + 1, time_ns = grid_time(&kms->grid, next);
	if (!kms->running)
		return;
	if (kms->away && now_ns >= time_ns)
		tick(kms);
	else if (!kms->away && is_to_choose(kms, next) && now_ns + kms->guard_ns >= time_ns)
		kms_choose(kms, next);
	if (!kms->away && now_ns > kms->heard_ns + SILENCE_NS)
		kms_lose(kms, "it sends no vblanks any more");
	if (flip_hangs(kms))
		kms_lose(kms, "a flip has not ended");
}

/* When there is something to do even if nobody says anything; UINT64_MAX: never. */
static uint64_t next_time(const struct kms *kms)
{
	const uint64_t next = kms->number + 1, time_ns = grid_time(&kms->grid, next);
	const uint64_t silence_ns = kms->heard_ns + SILENCE_NS + 1;
	if (!kms->running)
		return UINT64_MAX;
	if (kms->away)
		return time_ns;
	return is_to_choose(kms, next) && time_ns - kms->guard_ns < silence_ns ? time_ns - kms->guard_ns : silence_ns;
}

/* What the descriptors say; with the lock. */
static void act(struct kms *kms, const struct pollfd *fds)
{
	const struct kms_events events = {on_vblank, on_flipped, kms};
	uint64_t count;
	if (fds[0].revents && kms_device_read_events(kms->device, &events) < 0 && errno != EAGAIN && errno != EINTR)
		kms_lose(kms, strerror(errno));
	hand_on_flips(kms);
	ask_for_vblank(kms);
	if (fds[1].revents && read(kms->wake, &count, sizeof(count)) < 0)
		log_debug(kms->params.log, "kms: eventfd: %s", strerror(errno));
	if (fds[2].revents) {
		const enum kms_console_event event = kms_console_read(&kms->console);
		if (event == KMS_CONSOLE_LEAVE)
			leave(kms);
		else if (event == KMS_CONSOLE_RETURN)
			come_back(kms);
	}
	act_on_time(kms);
}

static bool get_stack(void **stack, size_t *size)
{
	pthread_attr_t attributes;
	if (pthread_getattr_np(pthread_self(), &attributes) != 0)
		return false;
	const bool known = pthread_attr_getstack(&attributes, stack, size) == 0;
	pthread_attr_destroy(&attributes);
	return known;
}

/* What it measures is the display, and it runs for microseconds a vblank. Not permitted to most. */
static void prepare_thread(const struct kms *kms)
{
	const struct sched_param priority = {.sched_priority = 1};
	void *stack;
	size_t size;

	pthread_setname_np(pthread_self(), "pursuit-flip");
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	if (pthread_setschedparam(pthread_self(), SCHED_RR, &priority) != 0)
		log_info(kms->params.log,
				 "kms: flips without real-time priority (RLIMIT_RTPRIO is 0); a busy machine may miss some");
	if (get_stack(&stack, &size) && (mlock(kms, sizeof(*kms)) != 0 || mlock(stack, size) != 0))
		log_info(kms->params.log,
				 "kms: flips without locked memory (RLIMIT_MEMLOCK); a machine short of it may miss some");
}

/* Memory that is freed, and stacks that the C library keeps, would stay locked. */
static void unlock_memory(const struct kms *kms)
{
	void *stack;
	size_t size;
	munlock(kms, sizeof(*kms));
	if (get_stack(&stack, &size))
		munlock(stack, size);
}

void *kms_run(void *data)
{
	struct kms *kms = data;
	struct pollfd fds[3] = {{kms_device_get_fd(kms->device), POLLIN, 0},
							{kms->wake, POLLIN, 0},
							{kms_console_get_fd(&kms->console), POLLIN, 0}};

	prepare_thread(kms);
	pthread_mutex_lock(&kms->lock);
	while (!kms->stop) {
		const uint64_t now_ns = now_of(kms), then_ns = next_time(kms), span = then_ns > now_ns ? then_ns - now_ns : 0;
		const struct timespec timeout = {(time_t)(span / SECOND), (long)(span % SECOND)};
		const bool lost = kms->lost;
		if (lost)
			fds[0].fd = -1; /* a controller that is gone would wake us for ever */
		pthread_mutex_unlock(&kms->lock);
		tell_flips(kms);
		tell_loss(kms, lost);
		if (ppoll(fds, 3, then_ns == UINT64_MAX ? NULL : &timeout, NULL) < 0)
			for (int i = 0; i < 3; i++)
				fds[i].revents = 0;
		pthread_mutex_lock(&kms->lock);
		if (!kms->stop)
			act(kms, fds);
	}
	pthread_mutex_unlock(&kms->lock);
	unlock_memory(kms);
	return NULL;
}
