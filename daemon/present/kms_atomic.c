/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <string.h>

#include "daemon/present/kms_drm.h"

/* ---- properties ---- */

static uint32_t find_property(int fd, uint32_t object, uint32_t type, const char *name, uint64_t *value)
{
	drmModeObjectProperties *properties = drmModeObjectGetProperties(fd, object, type);
	uint32_t found = 0;
	for (uint32_t i = 0; properties && i < properties->count_props && !found; i++) {
		drmModePropertyRes *property = drmModeGetProperty(fd, properties->props[i]);
		if (property && strcmp(property->name, name) == 0) {
			found = property->prop_id;
			if (value)
				*value = properties->prop_values[i];
		}
		drmModeFreeProperty(property);
	}
	drmModeFreeObjectProperties(properties);
	return found;
}

static uint32_t find_primary_plane(const struct kms_device *device)
{
	drmModePlaneRes *planes = drmModeGetPlaneResources(device->fd);
	uint32_t found = 0;
	for (uint32_t i = 0; planes && i < planes->count_planes && !found; i++) {
		drmModePlane *plane = drmModeGetPlane(device->fd, planes->planes[i]);
		uint64_t type = DRM_PLANE_TYPE_OVERLAY;
		find_property(device->fd, planes->planes[i], DRM_MODE_OBJECT_PLANE, "type", &type);
		if (plane && type == DRM_PLANE_TYPE_PRIMARY && (plane->possible_crtcs & 1u << device->crtc_index))
			found = plane->plane_id;
		drmModeFreePlane(plane);
	}
	drmModeFreePlaneResources(planes);
	return found;
}

void kms_atomic_find(struct kms_device *device)
{
	static const char *const sources[] = {"SRC_X", "SRC_Y", "SRC_W", "SRC_H"};
	static const char *const targets[] = {"CRTC_X", "CRTC_Y", "CRTC_W", "CRTC_H"};
	struct kms_atomic *atomic = &device->atomic;
	const int fd = device->fd;

	if (drmSetClientCap(fd, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1) != 0 ||
		drmSetClientCap(fd, DRM_CLIENT_CAP_ATOMIC, 1) != 0)
		return;
	atomic->plane = find_primary_plane(device);
	atomic->connector_crtc = find_property(fd, device->connector, DRM_MODE_OBJECT_CONNECTOR, "CRTC_ID", NULL);
	atomic->crtc_mode = find_property(fd, device->crtc, DRM_MODE_OBJECT_CRTC, "MODE_ID", NULL);
	atomic->crtc_active = find_property(fd, device->crtc, DRM_MODE_OBJECT_CRTC, "ACTIVE", NULL);
	atomic->plane_framebuffer = find_property(fd, atomic->plane, DRM_MODE_OBJECT_PLANE, "FB_ID", NULL);
	atomic->plane_crtc = find_property(fd, atomic->plane, DRM_MODE_OBJECT_PLANE, "CRTC_ID", NULL);
	atomic->plane_fence = find_property(fd, atomic->plane, DRM_MODE_OBJECT_PLANE, "IN_FENCE_FD", NULL);
	atomic->usable = atomic->plane && atomic->connector_crtc && atomic->crtc_mode && atomic->crtc_active &&
					 atomic->plane_framebuffer && atomic->plane_crtc;
	for (int i = 0; i < 4; i++) {
		atomic->source[i] = find_property(fd, atomic->plane, DRM_MODE_OBJECT_PLANE, sources[i], NULL);
		atomic->target[i] = find_property(fd, atomic->plane, DRM_MODE_OBJECT_PLANE, targets[i], NULL);
		atomic->usable = atomic->usable && atomic->source[i] && atomic->target[i];
	}
	if (atomic->usable &&
		drmModeCreatePropertyBlob(fd, &device->timings, sizeof(device->timings), &atomic->mode_blob) != 0)
		atomic->usable = false;
}

/* ---- commits ---- */

static void add_places(const struct kms_device *device, const struct kms_buffer *buffer, drmModeAtomicReq *request)
{
	const struct kms_atomic *atomic = &device->atomic;
	const struct rectangle whole = {0, 0, device->mode.width, device->mode.height};
	const struct rectangle from = buffer->part.width ? buffer->part : whole;
	const struct rectangle to =
		buffer->part.width ? rectangle_fit(from.width, from.height, whole.width, whole.height) : whole;
	const uint64_t source[4] = {(uint64_t)from.x << 16, (uint64_t)from.y << 16, (uint64_t)from.width << 16,
								(uint64_t)from.height << 16};
	const uint64_t target[4] = {to.x, to.y, to.width, to.height};
	for (int i = 0; i < 4; i++) {
		drmModeAtomicAddProperty(request, atomic->plane, atomic->source[i], source[i]);
		drmModeAtomicAddProperty(request, atomic->plane, atomic->target[i], target[i]);
	}
}

int kms_atomic_commit(const struct kms_device *device, const struct kms_buffer *buffer, int fence, uint32_t flags)
{
	const struct kms_atomic *atomic = &device->atomic;
	drmModeAtomicReq *request = drmModeAtomicAlloc();
	if (!request)
		return -ENOMEM;
	if (flags & DRM_MODE_ATOMIC_ALLOW_MODESET) {
		drmModeAtomicAddProperty(request, device->connector, atomic->connector_crtc, device->crtc);
		drmModeAtomicAddProperty(request, device->crtc, atomic->crtc_mode, atomic->mode_blob);
		drmModeAtomicAddProperty(request, device->crtc, atomic->crtc_active, 1);
		drmModeAtomicAddProperty(request, atomic->plane, atomic->plane_crtc, device->crtc);
	}
	add_places(device, buffer, request);
	drmModeAtomicAddProperty(request, atomic->plane, atomic->plane_framebuffer, buffer->framebuffer);
	if (fence >= 0)
		drmModeAtomicAddProperty(request, atomic->plane, atomic->plane_fence, (uint64_t)fence);
	const int result = drmModeAtomicCommit(device->fd, request, flags, (void *)(uintptr_t)device);
	drmModeAtomicFree(request);
	return result;
}
