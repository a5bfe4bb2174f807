/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A display controller through atomic calls and through the older ones: modes, flips, counts, what it refuses. */
#include <errno.h>
#include <poll.h>
#include <xf86drmMode.h>

#include "daemon/present/kms_device.h"
#include "tests/test.h"

#define FLIPS 60u

struct heard {
	uint64_t vblank, vblank_ns, flipped, flipped_ns;
	uint32_t vblanks, flips;
};

static void on_vblank(void *data, uint64_t sequence, uint64_t time_ns)
{
	struct heard *heard = data;
	heard->vblank = sequence;
	heard->vblank_ns = time_ns;
	heard->vblanks++;
}

static void on_flipped(void *data, uint64_t sequence, uint64_t time_ns)
{
	struct heard *heard = data;
	heard->flipped = sequence;
	heard->flipped_ns = time_ns;
	heard->flips++;
}

/* ---- a display that enlarges, which the kernel's virtual one does not ---- */

static struct {
	bool on;
	uint64_t source[4], target[4]; /* of the last commit: x, y, width, height */
	uint32_t names[8];             /* the properties' numbers, as they first came: source and target in turn */
} scaler;

int __real_drmModeAtomicAddProperty(drmModeAtomicReq *request, uint32_t object, uint32_t property, uint64_t value);
int __wrap_drmModeAtomicAddProperty(drmModeAtomicReq *request, uint32_t object, uint32_t property, uint64_t value);

/* Notes what it was asked for, and asks the kernel for the whole buffer instead. */
int __wrap_drmModeAtomicAddProperty(drmModeAtomicReq *request, uint32_t object, uint32_t property, uint64_t value)
{
	static const uint64_t whole[8] = {0, 0, 0, 0, 160u << 16, 160, 120u << 16, 120};
	for (uint32_t i = 0; scaler.on && i < 8; i++)
		if (scaler.names[i] == property) {
			(i % 2 == 0 ? scaler.source : scaler.target)[i / 2] = value;
			value = whole[i];
			break;
		}
	return __real_drmModeAtomicAddProperty(request, object, property, value);
}

static uint32_t find_plane_property(int fd, const char *name)
{
	drmModePlaneRes *planes = drmModeGetPlaneResources(fd);
	drmModeObjectProperties *properties = drmModeObjectGetProperties(fd, planes->planes[0], DRM_MODE_OBJECT_PLANE);
	uint32_t found = 0;
	for (uint32_t i = 0; i < properties->count_props; i++) {
		drmModePropertyRes *property = drmModeGetProperty(fd, properties->props[i]);
		if (strcmp(property->name, name) == 0)
			found = property->prop_id;
		drmModeFreeProperty(property);
	}
	drmModeFreeObjectProperties(properties);
	drmModeFreePlaneResources(planes);
	return found;
}

static void turn_scaler_on(struct kms_device *device)
{
	static const char *const names[8] = {"SRC_X", "CRTC_X", "SRC_Y", "CRTC_Y", "SRC_W", "CRTC_W", "SRC_H", "CRTC_H"};
	for (int i = 0; i < 8; i++)
		scaler.names[i] = find_plane_property(kms_device_get_fd(device), names[i]);
	scaler.on = true;
}

static struct kms_device *open_device(bool legacy, const char *mode)
{
	struct kms_device_params params = {.legacy = legacy};
	struct error error = {""};
	CHECK_INT(kms_mode_parse(mode, &params.mode, &error), 0);
	struct kms_device *device = kms_device_create(&params, &error);
	if (!device)
		fprintf(stderr, "%s\n", error.text);
	CHECK(device != NULL);
	return device;
}

/* Waits until the flip and the count of its vblank have come. */
static void wait_for_both(struct kms_device *device, struct heard *heard, uint32_t count)
{
	const struct kms_events events = {on_vblank, on_flipped, heard};
	struct pollfd fd = {kms_device_get_fd(device), POLLIN, 0};
	while (heard->vblanks < count || heard->flips < count) {
		if (poll(&fd, 1, 1000) != 1) {
			CHECK(!"the kernel says nothing");
			return;
		}
		CHECK_INT(kms_device_read_events(device, &events), 0);
	}
}

static void flip(struct kms_device *device, struct kms_buffer buffers[2])
{
	struct heard heard = {0};
	uint64_t sequence, last_ns;
	CHECK_INT(kms_device_get_sequence(device, &sequence, &last_ns), 0);
	for (uint32_t i = 0; i < FLIPS; i++) {
		CHECK_INT(kms_device_queue_sequence(device, sequence + 1), 0);
		CHECK_INT(kms_device_flip(device, &buffers[i % 2], -1), 0);
		CHECK_INT(kms_device_flip(device, &buffers[(i + 1) % 2], -1), -EBUSY);
		wait_for_both(device, &heard, i + 1);
		CHECK_INT(heard.vblank, sequence + 1);
		CHECK_INT((uint32_t)heard.flipped, (uint32_t)heard.vblank);
		CHECK_NEAR(heard.flipped_ns, heard.vblank_ns, 1000.0);
		CHECK_NEAR(heard.vblank_ns - last_ns, 1e9 / kms_mode_refresh_hz(kms_device_get_mode(device)), 2000.0);
		last_ns = heard.vblank_ns;
		sequence = heard.vblank;
	}
}

static void test_flips(bool legacy)
{
	struct kms_device *device = open_device(legacy, "160x120@120");
	struct kms_buffer buffers[2];
	struct error error;
	if (!device)
		return;
	CHECK(strstr(kms_device_get_name(device), legacy ? "legacy" : "atomic") != NULL);
	for (int i = 0; i < 2; i++) {
		CHECK_INT(kms_device_create_buffer(device, &buffers[i], &error), 0);
		CHECK_INT(buffers[i].stride % 64, 0);
		memset(buffers[i].data, 0x40 + i, buffers[i].stride * 120);
	}
	CHECK_INT(kms_device_show(device, &buffers[1], &error), 0);
	flip(device, buffers);
	CHECK(kms_device_is_connected(device, true));
	CHECK(kms_device_is_connected(device, false));
	kms_device_restore(device);
	for (int i = 0; i < 2; i++)
		kms_device_destroy_buffer(device, &buffers[i]);
	kms_device_destroy(&device);
	CHECK(device == NULL);
	kms_device_destroy(&device);
}

static void test_atomic(void)
{
	test_flips(false);
}

static void test_legacy(void)
{
	test_flips(true);
}

/* Part of a buffer: refused where the display cannot enlarge, else as large as fits and centred, with each flip. */
static void test_scaling(void)
{
	struct kms_device *device = open_device(false, "160x120@120");
	const struct rectangle part = {48, 40, 64, 40};
	struct kms_buffer buffers[2];
	struct error error;
	if (!device)
		return;
	for (int i = 0; i < 2; i++)
		CHECK_INT(kms_device_create_buffer(device, &buffers[i], &error), 0);
	CHECK_INT(kms_device_show(device, &buffers[1], &error), 0);
	CHECK(!kms_device_can_scale(device, &buffers[0], &part));
	turn_scaler_on(device);
	CHECK(kms_device_can_scale(device, &buffers[0], &part));
	CHECK_INT(buffers[0].part.width, 0);
	buffers[0].part = part;
	CHECK_INT(kms_device_flip(device, &buffers[0], -1), 0);
	CHECK(scaler.source[0] == 48 << 16 && scaler.source[1] == 40 << 16);
	CHECK(scaler.source[2] == 64 << 16 && scaler.source[3] == 40 << 16);
	CHECK(scaler.target[0] == 0 && scaler.target[1] == 10 && scaler.target[2] == 160 && scaler.target[3] == 100);
	scaler.on = false;
	kms_device_restore(device);
	for (int i = 0; i < 2; i++)
		kms_device_destroy_buffer(device, &buffers[i]);
	kms_device_destroy(&device);
}

/* By rate alone: the display lists 60 Hz. By size alone: what it lists of that size. */
static void test_listed_modes(void)
{
	struct kms_device *device = open_device(false, "");
	if (device) {
		CHECK(!kms_device_get_mode(device)->made);
		CHECK_INT(kms_device_get_mode(device)->width, 1024); /* the display's preference */
	}
	kms_device_destroy(&device);
	device = open_device(false, "800x600");
	if (device) {
		CHECK(!kms_device_get_mode(device)->made);
		CHECK_INT(kms_device_get_mode(device)->height, 600);
	}
	kms_device_destroy(&device);
}

static void test_mode_beyond_the_display(void)
{
	struct kms_device *device = open_device(false, "9000x64@60");
	struct kms_buffer buffer;
	struct error error = {""};
	if (!device)
		return;
	CHECK(kms_device_create_buffer(device, &buffer, &error) < 0);
	CHECK(strstr(error.text, "9000x64") != NULL);
	kms_device_destroy(&device);
}

int main(void)
{
	RUN(test_atomic);
	RUN(test_legacy);
	RUN(test_scaling);
	RUN(test_listed_modes);
	RUN(test_mode_beyond_the_display);
	return test_result();
}
