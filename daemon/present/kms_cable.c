/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms_cable.h"

#include <errno.h>
#include <glob.h>
#include <poll.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "daemon/present/kms_hotplug.h"

#define LOOK_MS 1000

struct kms_cable {
	struct kms_device *device;
	void (*unplugged)(void *data);
	void *data;
	int stop, hotplug; /* hotplug -1: the kernel sends no messages */
	pthread_t thread;
};

static void *run(void *data)
{
	struct kms_cable *cable = data;
	struct pollfd fds[2] = {{cable->stop, POLLIN, 0}, {cable->hotplug, POLLIN, 0}};
	pthread_setname_np(pthread_self(), "pursuit-cable");
	for (;;) {
		if (poll(fds, 2, LOOK_MS) < 0)
			fds[0].revents = fds[1].revents = 0;
		if (fds[0].revents)
			return NULL;
		const bool told = fds[1].revents && kms_hotplug_read(cable->hotplug);
		if (!kms_device_is_connected(cable->device, told)) {
			cable->unplugged(cable->data);
			return NULL;
		}
	}
}

static void free_cable(struct kms_cable *cable)
{
	if (cable->stop >= 0)
		close(cable->stop);
	if (cable->hotplug >= 0)
		close(cable->hotplug);
	free(cable);
}

struct kms_cable *kms_cable_create(struct kms_device *device, void (*unplugged)(void *data), void *data,
								   struct error *error)
{
	struct kms_cable *cable = calloc(1, sizeof(*cable));
	if (!cable) {
		error_set(error, -ENOMEM, "kms: out of memory");
		return NULL;
	}
	*cable = (struct kms_cable){.device = device, .unplugged = unplugged, .data = data};
	cable->hotplug = kms_hotplug_open();
	cable->stop = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	const int result = cable->stop < 0 ? errno : pthread_create(&cable->thread, NULL, run, cable);
	if (result == 0)
		return cable;
	error_set(error, -result, "kms: cannot watch the cable: %s", strerror(result));
	free_cable(cable);
	return NULL;
}

void kms_cable_destroy(struct kms_cable **cable)
{
	struct kms_cable *self = *cable;
	const uint64_t one = 1;
	*cable = NULL;
	if (!self)
		return;
	/* It cannot fail: the counter is empty. */
	if (write(self->stop, &one, sizeof(one)) == (ssize_t)sizeof(one))
		pthread_join(self->thread, NULL);
	free_cable(self);
}

/* ---- without a device ---- */

static bool says_connected(const char *path)
{
	char text[16] = "";
	FILE *file = fopen(path, "re");
	if (!file)
		return false;
	const bool read = fgets(text, sizeof(text), file) != NULL;
	fclose(file);
	return read && strcmp(text, "connected\n") == 0;
}

bool kms_cable_is_plugged(const char *device, const char *connector)
{
	const char *slash = device ? strrchr(device, '/') : NULL, *card = slash ? slash + 1 : "";
	char pattern[160];
	glob_t found;
	bool plugged = false;
	snprintf(pattern, sizeof(pattern), "/sys/class/drm/%.60s-%.60s/status", *card ? card : "card*",
			 connector && *connector ? connector : "*");
	if (glob(pattern, 0, NULL, &found) != 0)
		return false;
	for (size_t i = 0; i < found.gl_pathc && !plugged; i++)
		plugged = says_connected(found.gl_pathv[i]);
	globfree(&found);
	return plugged;
}
