/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms_device.h"

#include <drm_fourcc.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#define CARDS 16u
#define NAME_BYTES 48
#define PATH_BYTES 64

/* Properties of atomic mode setting, by number. */
struct kms_atomic {
	bool usable;
	uint32_t plane;
	uint32_t connector_crtc, crtc_mode, crtc_active;
	uint32_t plane_framebuffer, plane_crtc;
	uint32_t source[4], target[4]; /* x, y, width, height */
	uint32_t mode_blob;
};

struct kms_device {
	int fd;
	bool away;
	char path[PATH_BYTES], connector_name[NAME_BYTES], name[192];
	uint32_t connector, crtc, crtc_index;
	struct kms_mode mode;
	drmModeModeInfo timings;
	struct kms_atomic atomic;
	drmModeCrtc *before;             /* what was shown, NULL nothing */
	const struct kms_events *events; /* while they are read */
};

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

static void name_connector(const drmModeConnector *connector, char name[NAME_BYTES])
{
	const char *type = drmModeGetConnectorTypeName(connector->connector_type);
	snprintf(name, NAME_BYTES, "%s-%u", type ? type : "Unknown", connector->connector_type_id);
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

/* ---- atomic properties ---- */

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

static void find_atomic(struct kms_device *device)
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
		find_atomic(device);
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
		char path[PATH_BYTES];
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

struct kms_device *kms_device_create(const struct kms_device_params *params, struct error *error)
{
	struct kms_device *device = calloc(1, sizeof(*device));
	if (!device) {
		error_set(error, -ENOMEM, "kms: out of memory");
		return NULL;
	}
	device->fd = -1;
	const bool named = params->device && *params->device;
	if ((named ? try_card(device, params, params->device, error) : find_card(device, params, error)) == 0)
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

static int commit(const struct kms_device *device, const struct kms_buffer *buffer, uint32_t flags);

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
		result = commit(device, buffer, DRM_MODE_ATOMIC_TEST_ONLY);
	if (result == 0)
		return 0;
	result = -errno;
	kms_device_destroy_buffer(device, buffer);
	return error_set(error, result, "kms: %s does not show buffers that GL draws into: %s", device->path,
					 strerror(-result));
}

/* ---- showing ---- */

static void add_places(const struct kms_device *device, const struct kms_buffer *buffer, drmModeAtomicReq *request)
{
	const struct kms_atomic *atomic = &device->atomic;
	const struct kms_rectangle whole = {0, 0, device->mode.width, device->mode.height};
	const struct kms_rectangle from = buffer->part.width ? buffer->part : whole;
	const struct kms_rectangle to = buffer->part.width ? kms_mode_fit(&device->mode, &from) : whole;
	const uint64_t source[4] = {(uint64_t)from.x << 16, (uint64_t)from.y << 16, (uint64_t)from.width << 16,
								(uint64_t)from.height << 16};
	const uint64_t target[4] = {to.x, to.y, to.width, to.height};
	for (int i = 0; i < 4; i++) {
		drmModeAtomicAddProperty(request, atomic->plane, atomic->source[i], source[i]);
		drmModeAtomicAddProperty(request, atomic->plane, atomic->target[i], target[i]);
	}
}

static int commit(const struct kms_device *device, const struct kms_buffer *buffer, uint32_t flags)
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
	const int result = drmModeAtomicCommit(device->fd, request, flags, (void *)(uintptr_t)device);
	drmModeAtomicFree(request);
	return result;
}

bool kms_device_can_scale(const struct kms_device *device, const struct kms_buffer *buffer,
						  const struct kms_rectangle *part)
{
	struct kms_buffer scaled = *buffer;
	scaled.part = *part;
	return device->atomic.usable && !device->away && commit(device, &scaled, DRM_MODE_ATOMIC_TEST_ONLY) == 0;
}

static int set_mode(struct kms_device *device, const struct kms_buffer *buffer)
{
	if (!device->atomic.usable) {
		const int result = drmModeSetCrtc(device->fd, device->crtc, buffer->framebuffer, 0, 0, &device->connector, 1,
										  &device->timings);
		return result == 0 ? 0 : -errno;
	}
	const int result = commit(device, buffer, DRM_MODE_ATOMIC_ALLOW_MODESET | DRM_MODE_ATOMIC_TEST_ONLY);
	return result == 0 ? commit(device, buffer, DRM_MODE_ATOMIC_ALLOW_MODESET) : result;
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

int kms_device_flip(struct kms_device *device, const struct kms_buffer *buffer)
{
	if (device->atomic.usable)
		return commit(device, buffer, DRM_MODE_ATOMIC_NONBLOCK | DRM_MODE_PAGE_FLIP_EVENT);
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
	device->events->flipped(device->events->data, sequence);
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
