/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/lab.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "daemon/lab/patch.h"
#include "daemon/lab/state.h"

bool lab_is_wanted(const struct lab_settings *settings)
{
	return settings->latency || *settings->latency_log || *settings->gpio_line || *settings->strobe_line ||
		   *settings->photodiode_line || *settings->trigger_line || *settings->vsync_line ||
		   settings->patch != LAB_PATCH_OFF;
}

/* ---- checks ---- */

static int check_pattern(const struct lab_settings *settings, struct error *error)
{
	const uint32_t wanted = pattern_lines((enum pattern_kind)settings->pattern);
	if (!*settings->gpio_line)
		return 0;
	const int count = chip_count_lines(settings->gpio_chip, settings->gpio_line, "gpio-line", error);
	if (count < 0)
		return count;
	if (wanted != 0 && (uint32_t)count != wanted)
		return error_set(error, -EINVAL, "gpio-line: \"%.64s\" has %d line%s, the pattern wants %u",
						 settings->gpio_line, count, count == 1 ? "" : "s", wanted);
	return 0;
}

static int check_single(const char *chip, const char *lines, const char *option, struct error *error)
{
	const int count = *lines ? chip_count_lines(chip, lines, option, error) : 1;
	if (count < 0)
		return count;
	return count == 1 ? 0 : error_set(error, -EINVAL, "%s: \"%.64s\": one line is wanted", option, lines);
}

int lab_check(const struct lab_settings *settings, struct error *error)
{
	if (check_pattern(settings, error) < 0 ||
		check_single(settings->gpio_chip, settings->strobe_line, "strobe-line", error) < 0 ||
		check_single(settings->gpio_chip, settings->photodiode_line, "photodiode-line", error) < 0 ||
		check_single(settings->gpio_chip, settings->trigger_line, "trigger-line", error) < 0 ||
		check_single(settings->gpio_chip, settings->vsync_line, "vsync-line", error) < 0)
		return -EINVAL;
	if (settings->strobe_duty > settings->strobe_limit)
		return error_set(error, -EINVAL, "strobe-duty: %g is above the strobe-limit, %g", settings->strobe_duty,
						 settings->strobe_limit);
	if (settings->photon_most_us && settings->photon_most_us <= settings->photon_least_us)
		return error_set(error, -EINVAL, "photon-most-us: %u is not above photon-least-us, %u",
						 settings->photon_most_us, settings->photon_least_us);
	return 0;
}

/* ---- life ---- */

static void init_lock(pthread_mutex_t *lock)
{
	pthread_mutexattr_t attributes;
	pthread_mutexattr_init(&attributes);
	pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
	pthread_mutex_init(lock, &attributes);
	pthread_mutexattr_destroy(&attributes);
}

static void free_lab(struct lab *lab)
{
	guard_dismiss(&lab->guard);
	latency_log_destroy(&lab->latency_log);
	code_destroy(&lab->code);
	vsync_destroy(&lab->vsync);
	if (lab->wake_fd >= 0)
		close(lab->wake_fd);
	sem_destroy(&lab->parked);
	sem_destroy(&lab->go_on);
	pthread_mutex_destroy(&lab->shared.lock);
	free(lab);
}

/* The guard before any thread. */
static int start(struct lab *lab, struct error *error)
{
	const struct lab_settings *settings = &lab->settings;
	if (lab->strobe_lines.wanted && guard_start(&lab->guard, &lab->strobe_lines.params, error) < 0)
		return -EAGAIN;
	if (*settings->latency_log)
		lab->latency_log = latency_log_create(settings->latency_log, lab->params.header, lab->params.log, error);
	if (*settings->latency_log && !lab->latency_log)
		return -EIO;
	const int result = lab_start_thread(lab, error);
	atomic_store(&lab->active, result == 0);
	return result;
}

struct lab *lab_create(const struct lab_params *params, struct error *error)
{
	if (lab_check(params->settings, error) < 0)
		return NULL;
	struct lab *lab = calloc(1, sizeof(*lab));
	if (!lab) {
		error_set(error, -ENOMEM, "lab: out of memory");
		return NULL;
	}
	lab->params = *params;
	lab->params.header = params->header ? params->header : "";
	lab->settings = *params->settings;
	lab->period_ns = params->period_ns;
	lab->wake_fd = -1;
	init_lock(&lab->shared.lock);
	sem_init(&lab->parked, 0, 0);
	sem_init(&lab->go_on, 0, 0);
	lab->vsync = vsync_create(lab->period_ns, lab->settings.vsync_offset_us * 1e3);
	outputs_init(lab);
	inputs_init(lab);
	lab_publish_patch(lab);
	int result = lab->vsync ? 0 : error_set(error, -ENOMEM, "lab: out of memory");
	if (result == 0 && lab_is_wanted(&lab->settings))
		result = start(lab, error);
	lab->params.header = NULL; /* the caller's */
	if (result == 0)
		return lab;
	free_lab(lab);
	return NULL;
}

void lab_destroy(struct lab **lab)
{
	struct lab *self = *lab;
	*lab = NULL;
	if (!self)
		return;
	lab_stop_thread(self);
	free_lab(self);
}

bool lab_is_active(const struct lab *lab)
{
	return lab && atomic_load(&lab->active);
}

struct vsync *lab_get_vsync(struct lab *lab)
{
	return lab ? lab->vsync : NULL;
}

/* ---- the thread ---- */

/* What was fed before it stopped last. */
static void clear(struct queue *queue)
{
	while (queue_front(queue))
		queue_pop(queue);
}

int lab_start_thread(struct lab *lab, struct error *error)
{
	if (lab->wake_fd < 0)
		lab->wake_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	if (!lab->code)
		lab->code = code_create();
	if (lab->wake_fd < 0 || !lab->code)
		return error_set(error, -ENOMEM, "lab: out of memory or file descriptors");
	clear(&lab->flips);
	clear(&lab->render);
	atomic_store(&lab->stop, false);
	const int result = pthread_create(&lab->thread, NULL, lab_run, lab);
	lab->running = result == 0;
	return result == 0 ? 0 : error_set(error, -result, "lab: cannot start a thread: %s", strerror(result));
}

void lab_stop_thread(struct lab *lab)
{
	atomic_store(&lab->active, false);
	if (!lab->running)
		return;
	atomic_store(&lab->stop, true);
	lab_wake(lab);
	pthread_join(lab->thread, NULL);
	lab->running = false;
}

void lab_wake(struct lab *lab)
{
	const uint64_t one = 1;
	/* A full counter wakes just as well. */
	if (write(lab->wake_fd, &one, sizeof(one)) < 0 && errno != EAGAIN)
		log_error(lab->params.log, "lab: eventfd: %s", strerror(errno));
}

/* ---- feeding ---- */

void lab_flip(struct lab *lab, const struct presenter_flip *flip)
{
	if (!lab_is_active(lab))
		return;
	const struct queue_message message = {.kind = QUEUE_FLIP, .event_ns = clock_now(lab->params.clock), .flip = *flip};
	queue_push(&lab->flips, &message);
	lab_wake(lab);
}

void lab_publish_patch(struct lab *lab)
{
	const struct lab_settings *settings = &lab->settings;
	atomic_store(&lab->patch, settings->patch | settings->patch_corner << 2 | settings->patch_size << 4);
}

bool lab_draws(const struct lab *lab)
{
	return lab_is_active(lab) && (atomic_load(&lab->patch) & 3) != LAB_PATCH_OFF;
}

void lab_mark_picture(struct lab *lab, struct presenter_image *image, uint64_t serial, uint64_t vblank,
					  enum points_show show)
{
	if (!lab_is_active(lab))
		return;
	const uint32_t word = atomic_load(&lab->patch), patch = word & 3, corner = word >> 2 & 3, size = word >> 4;
	struct queue_message message = {.kind = QUEUE_PICTURE,
									.picture = {.serial = serial, .code = (uint32_t)vblank, .show = (uint8_t)show}};
	message.picture.level = patch == LAB_PATCH_ALTERNATE ? vblank & 1 : code_bit(lab->code, message.picture.code);
	if (patch != LAB_PATCH_OFF && image->data) {
		patch_draw(image, corner, size, message.picture.level);
		image->holds = 0;
	}
	queue_push(&lab->render, &message);
}

void lab_tell(struct lab *lab, const struct points *points)
{
	if (!lab_is_active(lab))
		return;
	const struct queue_message message = {.kind = QUEUE_POINTS, .points = *points};
	queue_push(&lab->render, &message);
}
