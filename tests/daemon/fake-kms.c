/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/daemon/fake-kms.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include "daemon/present/kms_console.h"
#include "daemon/present/kms_device.h"
#include "daemon/present/kms_gl.h"

#define SECOND UINT64_C(1000000000)

struct kms_device {
	int timer;
	bool away;
	struct kms_mode mode;
	uint64_t epoch_ns, period_ns;
	uint64_t wanted;  /* vblank to be told of; 0: none */
	uint64_t flip_at; /* vblank of the flip under way; 0: none */
	int fence;        /* that it waits for; -1: none */
	struct kms_buffer next, now;
};

struct fake_kms fake_kms;

/* ---- vblanks ---- */

static uint64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * SECOND + (uint64_t)now.tv_nsec;
}

static uint64_t sequence_now(const struct kms_device *device)
{
	return (now_ns() - device->epoch_ns) / device->period_ns + 1;
}

static uint64_t time_of(const struct kms_device *device, uint64_t sequence)
{
	return device->epoch_ns + (sequence - 1) * device->period_ns;
}

static void arm(const struct kms_device *device)
{
	uint64_t next = device->wanted;
	if (device->flip_at != 0 && (next == 0 || device->flip_at < next))
		next = device->flip_at;
	const uint64_t at_ns = next == 0 ? 0 : time_of(device, next);
	const struct itimerspec when = {.it_value = {(time_t)(at_ns / SECOND), (long)(at_ns % SECOND)}};
	timerfd_settime(device->timer, TFD_TIMER_ABSTIME, &when, NULL);
}

int kms_device_get_sequence(struct kms_device *device, uint64_t *sequence, uint64_t *time_ns)
{
	*sequence = sequence_now(device);
	*time_ns = time_of(device, *sequence);
	return 0;
}

int kms_device_queue_sequence(struct kms_device *device, uint64_t sequence)
{
	device->wanted = sequence;
	arm(device);
	return 0;
}

static void scan_out(const struct kms_buffer *buffer)
{
	bool whole = true;
	for (uint32_t y = 0; buffer->data && y < FAKE_HEIGHT; y++)
		whole = whole && memcmp(buffer->data + y * buffer->stride, buffer->data, (size_t)FAKE_WIDTH * 4 - 1) == 0 &&
				memcmp(buffer->data, buffer->data + 4, (size_t)FAKE_WIDTH * 4 - 8) == 0;
	if (!whole)
		atomic_fetch_add(&fake_kms.torn, 1);
}

/* A flip that cannot be at this vblank is at the next one, perhaps. */
static void put_off_flip(struct kms_device *device, uint64_t sequence)
{
	struct pollfd fence = {device->fence, POLLIN, 0};
	if (device->flip_at == 0 || sequence < device->flip_at)
		return;
	if (atomic_load(&fake_kms.stuck) || (fence.fd >= 0 && poll(&fence, 1, 0) != 1))
		device->flip_at = sequence + 1;
}

int kms_device_read_events(struct kms_device *device, const struct kms_events *events)
{
	uint64_t count;
	if (read(device->timer, &count, sizeof(count)) < 0)
		return -errno;
	const uint64_t sequence = sequence_now(device), wanted = device->wanted;
	put_off_flip(device, sequence);
	const uint64_t flip_at = device->flip_at;
	scan_out(&device->now);
	if (flip_at != 0 && sequence >= flip_at) {
		device->flip_at = 0;
		device->now = device->next;
		atomic_fetch_add(&fake_kms.flips, 1);
	}
	if (wanted != 0 && sequence >= wanted)
		device->wanted = 0;
	arm(device);
	const bool ended = flip_at != 0 && sequence >= flip_at, old = ended && atomic_load(&fake_kms.old_event);
	if (old)
		events->vblank(events->data, sequence - 3, time_of(device, sequence - 3));
	if (old)
		events->flipped(events->data, flip_at, time_of(device, flip_at));
	if (wanted != 0 && sequence >= wanted)
		events->vblank(events->data, sequence, time_of(device, sequence));
	if (ended && !old)
		events->flipped(events->data, flip_at, time_of(device, flip_at));
	return 0;
}

/* ---- showing ---- */

int kms_device_show(struct kms_device *device, const struct kms_buffer *buffer, struct error *error)
{
	const struct timespec while_it_lights_up = {0, 3000000};
	nanosleep(&while_it_lights_up, NULL);
	device->now = *buffer;
	return 0;
}

static bool is_busy(void)
{
	if (atomic_load(&fake_kms.busy) == 0)
		return false;
	atomic_fetch_sub(&fake_kms.busy, 1);
	return true;
}

int kms_device_flip(struct kms_device *device, const struct kms_buffer *buffer, int fence)
{
	if (device->away)
		atomic_fetch_add(&fake_kms.intruding, 1);
	if (device->flip_at != 0 || is_busy())
		return -EBUSY;
	device->next = *buffer;
	device->fence = fence;
	device->flip_at = sequence_now(device) + 1;
	arm(device);
	return 0;
}

bool kms_device_takes_fences(const struct kms_device *device)
{
	return false;
}

bool kms_device_can_scale(const struct kms_device *device, const struct kms_buffer *buffer,
						  const struct rectangle *part)
{
	return false;
}

void kms_device_leave(struct kms_device *device)
{
	device->away = true;
}

int kms_device_return(struct kms_device *device)
{
	device->away = false;
	return 0;
}

bool kms_device_is_connected(struct kms_device *device, bool probe)
{
	return !atomic_load(&fake_kms.unplugged);
}

/* ---- buffers ---- */

int kms_device_create_buffer(struct kms_device *device, struct kms_buffer *buffer, struct error *error)
{
	const size_t stride = FAKE_WIDTH * 4;
	if (atomic_load(&fake_kms.full))
		return error_set(error, -ENOMEM, "kms: the test gives no buffer");
	*buffer = (struct kms_buffer){.stride = stride, .size = stride * FAKE_HEIGHT, .framebuffer = 1};
	buffer->data = calloc(1, buffer->size);
	atomic_fetch_add(&fake_kms.buffers, 1);
	return buffer->data ? 0 : -ENOMEM;
}

void kms_device_destroy_buffer(struct kms_device *device, struct kms_buffer *buffer)
{
	if (buffer->data)
		atomic_fetch_sub(&fake_kms.buffers, 1);
	free(buffer->data);
	memset(buffer, 0, sizeof(*buffer));
}

int kms_device_adopt_buffer(struct kms_device *device, uint32_t handle, uint32_t stride, struct kms_buffer *buffer,
							struct error *error)
{
	*buffer = (struct kms_buffer){.stride = stride, .framebuffer = 1, .handle = handle};
	return 0;
}

/* ---- buffers of GL: nothing is ever drawn there ---- */

struct kms_gl {
	struct presenter_context context;
};

struct kms_gl *kms_gl_create(int fd, struct error *error)
{
	return calloc(1, sizeof(struct kms_gl));
}

void kms_gl_destroy(struct kms_gl **gl)
{
	free(*gl);
	*gl = NULL;
}

const struct presenter_context *kms_gl_get_context(const struct kms_gl *gl)
{
	return &gl->context;
}

int kms_gl_create_buffer(struct kms_gl *gl, uint32_t width, uint32_t height, struct kms_gl_buffer *buffer,
						 struct error *error)
{
	*buffer = (struct kms_gl_buffer){.texture = 1, .stride = 4 * width};
	return 0;
}

void kms_gl_blacken(struct kms_gl *gl, const struct kms_gl_buffer *buffer)
{
}

int kms_gl_resize(struct kms_gl *gl, struct kms_gl_large *large, uint32_t width, uint32_t height, struct error *error)
{
	*large = (struct kms_gl_large){width != 0, width, height};
	return 0;
}

void kms_gl_shrink(struct kms_gl *gl, const struct kms_gl_large *large, const struct kms_gl_buffer *buffer,
				   const struct rectangle *part)
{
}

bool kms_gl_can_fence(const struct kms_gl *gl)
{
	return false;
}

int kms_gl_fence(struct kms_gl *gl)
{
	return -1;
}

void kms_gl_wait(struct kms_gl *gl)
{
}

void kms_gl_destroy_buffer(struct kms_gl *gl, struct kms_gl_buffer *buffer)
{
	*buffer = (struct kms_gl_buffer){0};
}

/* ---- life ---- */

struct kms_device *kms_device_create(const struct kms_device_params *params, struct error *error)
{
	const struct kms_mode_wish wish = {FAKE_WIDTH, FAKE_HEIGHT, 250.0, true};
	struct kms_device *device = calloc(1, sizeof(*device));
	if (!device || kms_mode_make(&wish, &device->mode, error) < 0)
		abort();
	device->period_ns = (uint64_t)(1e9 / kms_mode_refresh_hz(&device->mode));
	device->epoch_ns = now_ns() - 100 * device->period_ns;
	device->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	atomic_fetch_add(&fake_kms.devices, 1);
	return device;
}

void kms_device_restore(struct kms_device *device)
{
	device->now = (struct kms_buffer){.data = NULL};
}

void kms_device_destroy(struct kms_device **device)
{
	if (*device) {
		close((*device)->timer);
		atomic_fetch_sub(&fake_kms.devices, 1);
	}
	free(*device);
	*device = NULL;
}

int kms_device_get_fd(const struct kms_device *device)
{
	return device->timer;
}

const struct kms_mode *kms_device_get_mode(const struct kms_device *device)
{
	return &device->mode;
}

const char *kms_device_get_name(const struct kms_device *device)
{
	return "Fake-1";
}

/* ---- the terminal ---- */

void kms_console_init(struct kms_console *console, const struct log *log)
{
	*console = (struct kms_console){-1, fake_kms.terminal[0]};
}

void kms_console_finish(struct kms_console *console)
{
}

int kms_console_get_fd(const struct kms_console *console)
{
	return console->signals;
}

enum kms_console_event kms_console_read(struct kms_console *console)
{
	char event = 0;
	if (read(console->signals, &event, 1) != 1)
		return KMS_CONSOLE_NOTHING;
	return event == 'L' ? KMS_CONSOLE_LEAVE : KMS_CONSOLE_RETURN;
}

void kms_console_left(struct kms_console *console)
{
	sem_post(&fake_kms.left);
}
