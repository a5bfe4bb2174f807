/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#define MS UINT64_C(1000000)
/* The kernel takes a flip so long before the display's blank begins; at most a quarter of a vblank. */
#define GUARD_NS (MS + MS / 5)
/* Made before the first picture; more as they are needed. */
#define FIRST_BUFFERS 3u
#define PAGE_BYTES 4096u
#define STACK_BYTES ((size_t)256 * 1024)

/* ---- life ---- */

static struct kms_device *open_device(const struct presenter_params *params, struct error *error)
{
	struct kms_device_params device = {.device = params->options.device, .connector = params->options.connector};
	if (params->refresh_denominator)
		device.mode.refresh_hz = (double)params->refresh_numerator / (double)params->refresh_denominator;
	if (kms_mode_parse(params->options.mode, &device.mode, error) < 0)
		return NULL;
	return kms_device_create(&device, error);
}

static int light_up(struct kms *kms, struct error *error)
{
	const struct kms_mode *mode = kms_device_get_mode(kms->device);
	uint64_t numerator, denominator;
	int result = kms_device_create_buffer(kms->device, &kms->backdrop, error);
	for (uint32_t i = 0; i < FIRST_BUFFERS && result == 0; i++)
		result = kms_device_create_buffer(kms->device, &kms->pictures[i].memory.buffer, error);
	if (result == 0)
		result = kms_device_show(kms->device, &kms->backdrop, error);
	if (result < 0)
		return result;
	kms_mode_refresh(mode, &numerator, &denominator);
	vblanks_init(&kms->vblanks, numerator, denominator, clock_now(kms->params.clock));
	kms->grid = vblanks_get_grid(&kms->vblanks);
	const uint64_t period_ns = (uint64_t)grid_period_ns(&kms->grid);
	kms->guard_ns = kms_mode_blank_ns(mode) + GUARD_NS;
	if (kms->guard_ns > period_ns / 4)
		kms->guard_ns = period_ns / 4;
	result = kms_anchor(kms);
	return result == 0 ? 0
					   : error_set(error, result, "kms: %s counts no vblanks (%s); use --present glfw or headless",
								   kms_device_get_name(kms->device), strerror(-result));
}

static void take_down(struct kms *kms)
{
	kms_cable_destroy(&kms->cable);
	if (kms->device) {
		/* First what was there before, so that the display does not go dark in between. */
		kms_device_restore(kms->device);
		kms_destroy_pictures(kms);
		kms_device_destroy_buffer(kms->device, &kms->backdrop);
	}
	kms_gl_destroy(&kms->gl);
	kms_device_destroy(&kms->device);
	kms_console_finish(&kms->console);
	if (kms->wake >= 0)
		close(kms->wake);
	pthread_mutex_destroy(&kms->lock);
	free(kms);
}

/* With a stack so small that it can be locked. */
static int start_thread(struct kms *kms)
{
	pthread_attr_t attributes;
	pthread_attr_init(&attributes);
	pthread_attr_setstacksize(&attributes, STACK_BYTES);
	const int code = pthread_create(&kms->thread, &attributes, kms_run, kms);
	pthread_attr_destroy(&attributes);
	return code;
}

static void open_gl(struct kms *kms)
{
	struct error error;
	if (!kms->params.options.share_gl)
		return;
	kms->gl = kms_gl_create(kms_device_get_fd(kms->device), &error);
	if (!kms->gl)
		log_info(kms->params.log, "%s", error.text);
	else if (kms_can_fence(kms))
		log_info(kms->params.log, "kms: flips wait for what GL draws by its fences");
}

/* On the thread that watches the cable. */
static void on_unplugged(void *data)
{
	struct kms *kms = data;
	pthread_mutex_lock(&kms->lock);
	kms_lose(kms, "the display was unplugged");
	pthread_mutex_unlock(&kms->lock);
}

static int start(struct kms *kms, struct error *error)
{
	kms->wake = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	if (kms->wake < 0)
		return error_set(error, -errno, "kms: eventfd: %s", strerror(errno));
	kms->device = open_device(&kms->params, error);
	if (!kms->device)
		return -ENODEV;
	const int result = light_up(kms, error);
	if (result < 0)
		return result;
	open_gl(kms);
	kms_console_init(&kms->console, kms->params.log);
	kms->cable = kms_cable_create(kms->device, on_unplugged, kms, error);
	if (!kms->cable)
		return -ENOMEM;
	const int code = start_thread(kms);
	return code == 0 ? 0 : error_set(error, -code, "kms: cannot start a thread: %s", strerror(code));
}

static bool kms_is_possible(const struct presenter_params *params)
{
	return kms_cable_is_plugged(params->options.device, params->options.connector);
}

/* On pages of its own, to be locked. */
static struct kms *allocate(void)
{
	const size_t size = (sizeof(struct kms) + PAGE_BYTES - 1) / PAGE_BYTES * PAGE_BYTES;
	struct kms *kms = aligned_alloc(PAGE_BYTES, size);
	return kms ? memset(kms, 0, size) : NULL;
}

static struct presenter *kms_create(const struct presenter_params *params, struct error *error)
{
	struct kms *kms = allocate();
	char mode[48];
	if (!kms) {
		error_set(error, -ENOMEM, "kms: out of memory");
		return NULL;
	}
	kms->presenter.impl = &presenter_kms;
	kms->params = *params;
	kms->wake = -1;
	for (uint32_t i = 0; i < FLIPS_IMAGES; i++)
		kms->pictures[i].fence = -1;
	kms->console = (struct kms_console){-1, -1};
	pthread_mutex_init(&kms->lock, NULL);
	if (start(kms, error) < 0) {
		take_down(kms);
		return NULL;
	}
	kms_mode_print(kms_device_get_mode(kms->device), mode, sizeof(mode));
	snprintf(kms->display, sizeof(kms->display), "%s on %s", mode, kms_device_get_name(kms->device));
	log_info(params->log, "kms: %s", kms->display);
	return &kms->presenter;
}

static void kms_destroy(struct presenter *presenter)
{
	struct kms *kms = kms_of(presenter);
	const uint64_t one = 1;
	pthread_mutex_lock(&kms->lock);
	kms->stop = true;
	pthread_mutex_unlock(&kms->lock);
	if (write(kms->wake, &one, sizeof(one)) < 0)
		log_debug(kms->params.log, "kms: eventfd: %s", strerror(errno));
	pthread_join(kms->thread, NULL);
	take_down(kms);
}

/* ---- queueing ---- */

/* The kernel has no picture for this vblank yet and can still take one. */
static bool is_open(const struct kms *kms, uint64_t vblank, uint64_t now_ns)
{
	const struct scanout *scanout = &kms->scanout;
	return now_ns < grid_time(&kms->grid, vblank) && vblank > kms->number && vblank >= scanout->next_vblank &&
		   !(scanout->under_way.any && scanout->under_way_vblank >= vblank);
}

static int kms_present(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank,
					   uint64_t group, uint64_t serial)
{
	struct kms *kms = kms_of(presenter);
	int result = -ETIME;

	kms_take_back(kms, image);
	pthread_mutex_lock(&kms->lock);
	if (!kms->running && !kms->lost && clock_now(kms->params.clock) < grid_time(&kms->grid, vblank))
		kms_start(kms, vblank);
	const uint64_t now_ns = clock_now(kms->params.clock);
	if (kms->lost)
		result = -ENODEV;
	else if (kms->running && is_open(kms, vblank, now_ns))
		result = flips_present(&kms->scanout.flips, image->index, vblank, group, serial) ? 0 : -EBUSY;
	/* The event thread has found nothing for it. */
	if (result == 0 && vblank == kms->chosen && !kms->away)
		kms_choose(kms, vblank);
	pthread_mutex_unlock(&kms->lock);
	return result;
}

static void kms_set_standby(struct presenter *presenter, const struct presenter_image *image, uint64_t group,
							uint64_t serial)
{
	struct kms *kms = kms_of(presenter);
	kms_take_back(kms, image);
	pthread_mutex_lock(&kms->lock);
	flips_set_standby(&kms->scanout.flips, image->index, group, serial);
	pthread_mutex_unlock(&kms->lock);
}

static void kms_clear_standby(struct presenter *presenter)
{
	struct kms *kms = kms_of(presenter);
	pthread_mutex_lock(&kms->lock);
	flips_clear_standby(&kms->scanout.flips);
	pthread_mutex_unlock(&kms->lock);
}

static void kms_pause(struct presenter *presenter)
{
	struct kms *kms = kms_of(presenter);
	pthread_mutex_lock(&kms->lock);
	kms->running = false;
	scanout_pause(&kms->scanout);
	pthread_mutex_unlock(&kms->lock);
}

static struct grid kms_get_grid(struct presenter *presenter)
{
	struct kms *kms = kms_of(presenter);
	pthread_mutex_lock(&kms->lock);
	const struct grid grid = kms->grid;
	pthread_mutex_unlock(&kms->lock);
	return grid;
}

static const char *kms_get_display(struct presenter *presenter)
{
	return kms_of(presenter)->display;
}

static uint64_t kms_get_lead(struct presenter *presenter)
{
	struct kms *kms = kms_of(presenter);
	pthread_mutex_lock(&kms->lock);
	const uint64_t lead_ns = kms->away ? 0 : kms->guard_ns;
	pthread_mutex_unlock(&kms->lock);
	return lead_ns;
}

const struct presenter_impl presenter_kms = {
	.name = "kms",
	.description = "a display without any compositor: pictures scanned out by the kernel's display controller",
	.kind = PRESENTER_DEVICE,
	.is_possible = kms_is_possible,
	.create = kms_create,
	.destroy = kms_destroy,
	.get_grid = kms_get_grid,
	.get_lead = kms_get_lead,
	.get_display = kms_get_display,
	.acquire = kms_acquire,
	.get_context = kms_get_context,
	.acquire_texture = kms_acquire_texture,
	.release = kms_release,
	.present = kms_present,
	.set_standby = kms_set_standby,
	.clear_standby = kms_clear_standby,
	.pause = kms_pause,
};
