/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms_hotplug.h"

#include <errno.h>
#include <linux/netlink.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define KERNEL_GROUP 1u

int kms_hotplug_open(void)
{
	const struct sockaddr_nl address = {.nl_family = AF_NETLINK, .nl_groups = KERNEL_GROUP};
	const int fd = socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_KOBJECT_UEVENT);
	if (fd >= 0 && bind(fd, (const struct sockaddr *)&address, sizeof(address)) == 0)
		return fd;
	if (fd >= 0)
		close(fd);
	return -1;
}

/* "change@/devices/...", then KEY=VALUE, each ended by a zero. */
static bool is_about_displays(const char *message, size_t length)
{
	for (size_t at = 0; at < length; at += strlen(message + at) + 1)
		if (strcmp(message + at, "SUBSYSTEM=drm") == 0)
			return true;
	return false;
}

bool kms_hotplug_read(int fd)
{
	char message[4096];
	bool any = false;
	for (;;) {
		struct sockaddr_nl sender = {.nl_pid = 1};
		socklen_t size = sizeof(sender);
		const ssize_t length = recvfrom(fd, message, sizeof(message) - 1, 0, (struct sockaddr *)&sender, &size);
		if (length < 0 && errno == ENOBUFS) {
			any = true; /* there were too many to keep */
			continue;
		}
		if (length <= 0)
			return any;
		message[length] = 0;
		/* Programs can send as well; the kernel's number is 0. */
		any = any || (sender.nl_pid == 0 && is_about_displays(message, (size_t)length));
	}
}
