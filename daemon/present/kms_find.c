/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Which card, connector, CRTC and mode. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "daemon/present/kms_drm.h"

#define CARDS 16u

/* ---- modes ---- */

static struct kms_mode mode_from_kernel(const drmModeModeInfo *info)
{
	return (struct kms_mode){
		.clock_khz = info->clock,
		.width = info->hdisplay,
		.hsync_start = info->hsync_start,
		.hsync_end = info->hsync_end,
		.htotal = info->htotal,
		.height = info->vdisplay,
		.vsync_start = info->vsync_start,
		.vsync_end = info->vsync_end,
		.vtotal = info->vtotal,
		.flags = info->flags,
		.preferred = info->type & DRM_MODE_TYPE_PREFERRED,
	};
}

static drmModeModeInfo mode_to_kernel(const struct kms_mode *mode)
{
	drmModeModeInfo info = {
		.clock = mode->clock_khz,
		.hdisplay = mode->width,
		.hsync_start = mode->hsync_start,
		.hsync_end = mode->hsync_end,
		.htotal = mode->htotal,
		.vdisplay = mode->height,
		.vsync_start = mode->vsync_start,
		.vsync_end = mode->vsync_end,
		.vtotal = mode->vtotal,
		.vrefresh = (uint32_t)(kms_mode_refresh_hz(mode) + 0.5),
		.flags = mode->flags,
		.type = DRM_MODE_TYPE_USERDEF,
	};
	kms_mode_print(mode, info.name, sizeof(info.name));
	return info;
}

static int choose_mode(struct kms_device *device, const drmModeConnector *connector, const struct kms_mode_wish *wish,
					   struct error *error)
{
	const size_t count = (size_t)connector->count_modes;
	struct kms_mode *modes = calloc(count + 1, sizeof(*modes));
	char list[240] = "";
	int result = 0;
	if (!modes)
		return error_set(error, -ENOMEM, "kms: out of memory");
	for (size_t i = 0; i < count; i++)
		modes[i] = mode_from_kernel(&connector->modes[i]);
	const int chosen = kms_mode_choose(modes, count, wish);
	kms_mode_list(modes, count, list, sizeof(list));
	if (chosen >= 0) {
		device->mode = modes[chosen];
		device->timings = connector->modes[chosen];
	} else if (wish->width > 0 && wish->exact) {
		result = kms_mode_make(wish, &device->mode, error);
		device->timings = mode_to_kernel(&device->mode);
	} else {
		result = error_set(error, -EINVAL, "kms: %s of %s has no mode that fits; give one as --mode WxH@R; it lists %s",
						   device->connector_name, device->path, list);
	}
	free(modes);
	return result;
}

/* ---- connector and CRTC ---- */

static void name_connector(const drmModeConnector *connector, char name[KMS_NAME_BYTES])
{
	const char *type = drmModeGetConnectorTypeName(connector->connector_type);
	snprintf(name, KMS_NAME_BYTES, "%s-%u", type ? type : "Unknown", connector->connector_type_id);
}

/* The one asked for, or the first that is plugged in. NULL with a sentence. */
static drmModeConnector *find_connector(struct kms_device *device, const drmModeRes *resources, const char *wanted,
										struct error *error)
{
	char names[160] = "";
	for (int i = 0; i < resources->count_connectors; i++) {
		drmModeConnector *connector = drmModeGetConnector(device->fd, resources->connectors[i]);
		if (!connector)
			continue;
		const bool plugged = connector->connection == DRM_MODE_CONNECTED;
		const size_t used = strlen(names);
		name_connector(connector, device->connector_name);
		snprintf(names + used, sizeof(names) - used, "%s%s", used ? ", " : "", device->connector_name);
		if (wanted && *wanted ? strcmp(wanted, device->connector_name) == 0 : plugged) {
			if (plugged && connector->count_modes > 0)
				return connector;
			error_set(error, -ENODEV, "kms: no display is plugged into %s of %s", device->connector_name, device->path);
			drmModeFreeConnector(connector);
			return NULL;
		}
		drmModeFreeConnector(connector);
	}
	if (wanted && *wanted)
		error_set(error, -ENODEV, "kms: %s has no connector \"%.32s\"; it has %s", device->path, wanted,
				  *names ? names : "none");
	else
		error_set(error, -ENODEV, "kms: no display is plugged into %s (%s)", device->path,
				  *names ? names : "no connectors");
	return NULL;
}

/* The CRTC that the connector has already, else one that nobody has. */
static bool find_crtc(struct kms_device *device, const drmModeRes *resources, const drmModeConnector *connector)
{
	uint32_t current = 0, used = 0;
	for (int i = 0; i < resources->count_encoders; i++) {
		drmModeEncoder *encoder = drmModeGetEncoder(device->fd, resources->encoders[i]);
		for (int k = 0; encoder && k < resources->count_crtcs; k++)
			if (encoder->crtc_id == resources->crtcs[k])
				used |= 1u << k;
		if (encoder && encoder->encoder_id == connector->encoder_id)
			current = encoder->crtc_id;
		drmModeFreeEncoder(encoder);
	}
	for (int i = 0; i < connector->count_encoders; i++) {
		drmModeEncoder *encoder = drmModeGetEncoder(device->fd, connector->encoders[i]);
		const uint32_t possible = encoder ? encoder->possible_crtcs : 0;
		drmModeFreeEncoder(encoder);
		for (int k = 0; k < resources->count_crtcs; k++) {
			const bool fits = current ? resources->crtcs[k] == current : !(used & 1u << k);
			if (!(possible & 1u << k) || !fits)
				continue;
			device->crtc = resources->crtcs[k];
			device->crtc_index = (uint32_t)k;
			return true;
		}
	}
	return false;
}

/* ---- opening ---- */

static int open_card(struct kms_device *device, const char *path, struct error *error)
{
	snprintf(device->path, sizeof(device->path), "%s", path);
	device->fd = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
	if (device->fd >= 0)
		return 0;
	const int code = -errno;
	if (code == -EACCES || code == -EPERM)
		return error_set(error, code,
						 "kms: %s: permission denied; add yourself to the group that owns it (mostly: sudo usermod -aG "
						 "video $USER), then log in again",
						 path);
	return error_set(error, code, "kms: %s: %s", path, strerror(-code));
}

static int become_master(const struct kms_device *device, struct error *error)
{
	if (drmIsMaster(device->fd) || drmSetMaster(device->fd) == 0)
		return 0;
	return error_set(
		error, -EBUSY,
		"kms: %s is in use by another display server or compositor; end it, or start pursuitd on a console "
		"of its own (Ctrl+Alt+F3), or use --present glfw",
		device->path);
}

static int set_up(struct kms_device *device, const struct kms_device_params *params, struct error *error)
{
	drmModeRes *resources = drmModeGetResources(device->fd);
	if (!resources)
		return error_set(error, -ENODEV, "kms: %s drives no display", device->path);
	drmModeConnector *connector = find_connector(device, resources, params->connector, error);
	int result = connector ? 0 : -ENODEV;
	if (connector && !find_crtc(device, resources, connector))
		result = error_set(error, -EBUSY, "kms: %s: all controllers are in use by other displays", device->path);
	if (result == 0)
		result = choose_mode(device, connector, &params->mode, error);
	if (connector)
		device->connector = connector->connector_id;
	drmModeFreeConnector(connector);
	drmModeFreeResources(resources);
	return result;
}

static void describe(struct kms_device *device)
{
	drmVersion *version = drmGetVersion(device->fd);
	snprintf(device->name, sizeof(device->name), "%s of %s (%s, %s)", device->connector_name, device->path,
			 version && version->name ? version->name : "unknown driver", device->atomic.usable ? "atomic" : "legacy");
	drmFreeVersion(version);
}

static int try_card(struct kms_device *device, const struct kms_device_params *params, const char *path,
					struct error *error)
{
	uint64_t dumb = 0;
	int result = open_card(device, path, error);
	if (result < 0)
		return result;
	result = set_up(device, params, error);
	if (result == 0 && (drmGetCap(device->fd, DRM_CAP_DUMB_BUFFER, &dumb) != 0 || !dumb))
		result = error_set(error, -ENODEV, "kms: %s has no buffers that a CPU can draw into", path);
	if (result == 0)
		result = become_master(device, error);
	if (result < 0) {
		close(device->fd);
		device->fd = -1;
		return result;
	}
	if (!params->legacy)
		kms_atomic_find(device);
	device->before = drmModeGetCrtc(device->fd, device->crtc);
	describe(device);
	return 0;
}

/* How telling the refusal of a card is; the best is passed on. */
static int weight(int code)
{
	return code == -EBUSY ? 3 : code == -EINVAL || code == -ERANGE ? 2 : code == -ENOENT ? 0 : 1;
}

static int find_card(struct kms_device *device, const struct kms_device_params *params, struct error *error)
{
	int best = -ENOENT;
	error_set(error, best, "kms: this machine has no display controller (/dev/dri/card*)");
	for (unsigned i = 0; i < CARDS; i++) {
		char path[KMS_PATH_BYTES];
		struct error why;
		snprintf(path, sizeof(path), "/dev/dri/card%u", i);
		const int result = try_card(device, params, path, &why);
		if (result == 0)
			return 0;
		if (weight(result) <= weight(best))
			continue;
		best = result;
		*error = why;
	}
	return best;
}

int kms_find(struct kms_device *device, const struct kms_device_params *params, struct error *error)
{
	const bool named = params->device && *params->device;
	return named ? try_card(device, params, params->device, error) : find_card(device, params, error);
}
