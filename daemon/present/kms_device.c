/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms_device.h"

#include <drm_fourcc.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "daemon/present/kms_drm.h"

struct kms_device *kms_device_create(const struct kms_device_params *params, struct error *error)
{
	struct kms_device *device = calloc(1, sizeof(*device));
	if (!device) {
		error_set(error, -ENOMEM, "kms: out of memory");
		return NULL;
	}
	device->fd = -1;
	if (kms_find(device, params, error) == 0)
		return device;
	free(device);
	return NULL;
}

void kms_device_restore(struct kms_device *device)
{
	drmModeCrtc *before = device->before;
	if (before && before->mode_valid && before->buffer_id && !device->away)
		drmModeSetCrtc(device->fd, before->crtc_id, before->buffer_id, before->x, before->y, &device->connector, 1,
					   &before->mode);
}

void kms_device_destroy(struct kms_device **device)
{
	struct kms_device *self = *device;
	*device = NULL;
	if (!self)
		return;
	drmModeFreeCrtc(self->before);
	if (self->atomic.mode_blob)
		drmModeDestroyPropertyBlob(self->fd, self->atomic.mode_blob);
	close(self->fd);
	free(self);
}

int kms_device_get_fd(const struct kms_device *device)
{
	return device->fd;
}

const struct kms_mode *kms_device_get_mode(const struct kms_device *device)
{
	return &device->mode;
}

const char *kms_device_get_name(const struct kms_device *device)
{
	return device->name;
}

/* ---- buffers ---- */

static int map_buffer(const struct kms_device *device, struct kms_buffer *buffer)
{
	uint64_t offset;
	if (drmModeMapDumbBuffer(device->fd, buffer->handle, &offset) != 0)
		return -errno;
	void *data = mmap(NULL, buffer->size, PROT_READ | PROT_WRITE, MAP_SHARED, device->fd, (off_t)offset);
	if (data == MAP_FAILED)
		return -errno;
	buffer->data = data;
	return 0;
}

int kms_device_create_buffer(struct kms_device *device, struct kms_buffer *buffer, struct error *error)
{
	const uint32_t width = device->mode.width, height = device->mode.height;
	uint32_t pitch;
	uint64_t size;

	memset(buffer, 0, sizeof(*buffer));
	if (drmModeCreateDumbBuffer(device->fd, (width + 15) / 16 * 16, height, 32, 0, &buffer->handle, &pitch, &size) != 0)
		return error_set(error, -errno, "kms: %s gives no buffer of %ux%u: %s", device->path, width, height,
						 strerror(errno));
	buffer->stride = pitch;
	buffer->size = size;
	const uint32_t handles[4] = {buffer->handle}, pitches[4] = {pitch}, offsets[4] = {0};
	int result = map_buffer(device, buffer);
	if (result == 0 && drmModeAddFB2(device->fd, width, height, DRM_FORMAT_XRGB8888, handles, pitches, offsets,
									 &buffer->framebuffer, 0) != 0)
		result = -errno;
	if (result == 0) {
		memset(buffer->data, 0, buffer->size);
		return 0;
	}
	kms_device_destroy_buffer(device, buffer);
	return error_set(error, result, "kms: %s cannot show a buffer of %ux%u: %s", device->path, width, height,
					 strerror(-result));
}

void kms_device_destroy_buffer(struct kms_device *device, struct kms_buffer *buffer)
{
	if (buffer->framebuffer)
		drmModeRmFB(device->fd, buffer->framebuffer);
	if (buffer->data)
		munmap(buffer->data, buffer->size);
	if (buffer->handle)
		drmModeDestroyDumbBuffer(device->fd, buffer->handle);
	memset(buffer, 0, sizeof(*buffer));
}

int kms_device_adopt_buffer(struct kms_device *device, uint32_t handle, uint32_t stride, struct kms_buffer *buffer,
							struct error *error)
{
	const uint32_t handles[4] = {handle}, pitches[4] = {stride}, offsets[4] = {0};
	*buffer = (struct kms_buffer){.stride = stride};
	int result = drmModeAddFB2(device->fd, device->mode.width, device->mode.height, DRM_FORMAT_XRGB8888, handles,
							   pitches, offsets, &buffer->framebuffer, 0);
	if (result == 0 && device->atomic.usable && !device->away)
		result = kms_atomic_commit(device, buffer, -1, DRM_MODE_ATOMIC_TEST_ONLY);
	if (result == 0)
		return 0;
	result = -errno;
	kms_device_destroy_buffer(device, buffer);
	return error_set(error, result, "kms: %s does not show buffers that GL draws into: %s", device->path,
					 strerror(-result));
}

/* ---- showing ---- */

bool kms_device_can_scale(const struct kms_device *device, const struct kms_buffer *buffer,
						  const struct rectangle *part)
{
	struct kms_buffer scaled = *buffer;
	scaled.part = *part;
	return device->atomic.usable && !device->away &&
		   kms_atomic_commit(device, &scaled, -1, DRM_MODE_ATOMIC_TEST_ONLY) == 0;
}

static int set_mode(struct kms_device *device, const struct kms_buffer *buffer)
{
	if (!device->atomic.usable) {
		const int result = drmModeSetCrtc(device->fd, device->crtc, buffer->framebuffer, 0, 0, &device->connector, 1,
										  &device->timings);
		return result == 0 ? 0 : -errno;
	}
	const int result = kms_atomic_commit(device, buffer, -1, DRM_MODE_ATOMIC_ALLOW_MODESET | DRM_MODE_ATOMIC_TEST_ONLY);
	return result == 0 ? kms_atomic_commit(device, buffer, -1, DRM_MODE_ATOMIC_ALLOW_MODESET) : result;
}

int kms_device_show(struct kms_device *device, const struct kms_buffer *buffer, struct error *error)
{
	const int result = set_mode(device, buffer);
	char mode[48];
	if (result == 0)
		return 0;
	kms_mode_print(&device->mode, mode, sizeof(mode));
	return error_set(error, result, "kms: %s does not take the mode %s%s: %s%s", device->name, mode,
					 device->mode.made ? ", which it does not list" : "", strerror(-result),
					 device->mode.made ? "; give another as --mode WxH@R" : "");
}

bool kms_device_takes_fences(const struct kms_device *device)
{
	return device->atomic.usable && device->atomic.plane_fence;
}

int kms_device_flip(struct kms_device *device, const struct kms_buffer *buffer, int fence)
{
	if (device->atomic.usable)
		return kms_atomic_commit(device, buffer, fence, DRM_MODE_ATOMIC_NONBLOCK | DRM_MODE_PAGE_FLIP_EVENT);
	return drmModePageFlip(device->fd, device->crtc, buffer->framebuffer, DRM_MODE_PAGE_FLIP_EVENT, device) == 0
			   ? 0
			   : -errno;
}

/* ---- vblanks ---- */

int kms_device_get_sequence(struct kms_device *device, uint64_t *sequence, uint64_t *time_ns)
{
	return drmCrtcGetSequence(device->fd, device->crtc, sequence, time_ns) == 0 ? 0 : -errno;
}

int kms_device_queue_sequence(struct kms_device *device, uint64_t sequence)
{
	uint64_t queued;
	return drmCrtcQueueSequence(device->fd, device->crtc, DRM_CRTC_SEQUENCE_NEXT_ON_MISS, sequence, &queued,
								(uintptr_t)device) == 0
			   ? 0
			   : -errno;
}

static void on_sequence(int fd, uint64_t sequence, uint64_t time_ns, uint64_t data)
{
	const struct kms_device *device = (const struct kms_device *)(uintptr_t)data;
	device->events->vblank(device->events->data, sequence, time_ns);
}

static void on_flip(int fd, unsigned sequence, unsigned seconds, unsigned microseconds, void *data)
{
	const struct kms_device *device = data;
	device->events->flipped(device->events->data, sequence,
							seconds * UINT64_C(1000000000) + microseconds * UINT64_C(1000));
}

int kms_device_read_events(struct kms_device *device, const struct kms_events *events)
{
	drmEventContext context = {.version = 4, .page_flip_handler = on_flip, .sequence_handler = on_sequence};
	device->events = events;
	return drmHandleEvent(device->fd, &context) == 0 ? 0 : -errno;
}

/* ---- changes from outside ---- */

bool kms_device_is_connected(struct kms_device *device, bool probe)
{
	drmModeConnector *connector = probe ? drmModeGetConnector(device->fd, device->connector)
										: drmModeGetConnectorCurrent(device->fd, device->connector);
	const bool connected = connector && connector->connection != DRM_MODE_DISCONNECTED;
	drmModeFreeConnector(connector);
	return connected;
}

void kms_device_leave(struct kms_device *device)
{
	drmDropMaster(device->fd);
	device->away = true;
}

int kms_device_return(struct kms_device *device)
{
	if (drmSetMaster(device->fd) != 0)
		return -errno;
	device->away = false;
	return 0;
}
