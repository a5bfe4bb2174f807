/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Displays as the kernel shows them to everybody, without opening one. EDID: VESA E-EDID 1.4, 3.10.2; CTA-861. */

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "doctor.h"

#define AREA "display"
#define BLOCK 128u
#define TIMING 18u
#define CTA_EXTENSION 0x02u
#define MOST_EDID 4096u
#define WISHED_HZ 119.0

struct best {
	double hz;
	uint32_t width, height;
};

static void take_timing(const uint8_t *timing, struct best *best)
{
	const uint32_t clock = (uint32_t)timing[0] | (uint32_t)timing[1] << 8; /* 10 kHz */
	const uint32_t width = timing[2] | (timing[4] & 0xf0u) << 4, blank_x = timing[3] | (timing[4] & 0x0fu) << 8;
	const uint32_t height = timing[5] | (timing[7] & 0xf0u) << 4, blank_y = timing[6] | (timing[7] & 0x0fu) << 8;
	const uint64_t total = (uint64_t)(width + blank_x) * (height + blank_y);
	if (!clock || !width || !height || !total)
		return;
	const double hz = 1e4 * clock / (double)total;
	if (hz > best->hz && hz < 1000.0)
		*best = (struct best){hz, width, height};
}

static void take_block(const uint8_t *block, uint32_t first, struct best *best)
{
	for (uint32_t at = first; at + TIMING < BLOCK; at += TIMING)
		take_timing(block + at, best);
}

double doctor_read_edid(const uint8_t *edid, uint32_t bytes, uint32_t *width, uint32_t *height)
{
	struct best best = {0.0, 0, 0};
	if (bytes >= BLOCK)
		take_block(edid, 54, &best);
	for (uint32_t start = BLOCK; start + BLOCK <= bytes; start += BLOCK) {
		const uint32_t timings = edid[start + 2];
		if (edid[start] == CTA_EXTENSION && timings >= 4 && timings < BLOCK)
			take_block(edid + start, timings, &best);
	}
	*width = best.width;
	*height = best.height;
	return best.hz;
}

static long read_file(const char *path, void *to, size_t size)
{
	const int fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return -errno;
	const ssize_t got = read(fd, to, size);
	close(fd);
	return got < 0 ? -errno : (long)got;
}

static bool is_connected(const char *folder)
{
	char path[640], status[32] = "";
	snprintf(path, sizeof(path), "%s/status", folder);
	return read_file(path, status, sizeof(status) - 1) > 0 && strncmp(status, "connected", 9) == 0;
}

static void look_at_connector(struct doctor *doctor, const char *folder, const char *name)
{
	uint8_t edid[MOST_EDID];
	char path[640];
	uint32_t width, height;
	snprintf(path, sizeof(path), "%s/edid", folder);
	const long bytes = read_file(path, edid, sizeof(edid));
	const double hz = doctor_read_edid(edid, bytes > 0 ? (uint32_t)bytes : 0, &width, &height);
	if (hz >= WISHED_HZ)
		doctor_add(doctor, DOCTOR_WORKS, AREA, NULL, "%s: %ux%u at %.2f Hz", name, width, height, hz);
	else if (hz > 0.0)
		doctor_add(doctor, DOCTOR_LIMIT, AREA,
				   "xrandr --output NAME --rate 120, if xrandr lists it; else the display's menu, or another cable",
				   "%s: its fastest detailed timing is %ux%u at %.2f Hz; a CTA or DisplayID mode may be faster", name,
				   width, height, hz);
	else
		doctor_add(doctor, DOCTOR_NOTE, AREA, NULL, "%s: connected, it does not say its timings", name);
}

/* "card0-HDMI-A-1" */
static bool is_connector(const char *name)
{
	return strncmp(name, "card", 4) == 0 && strchr(name, '-');
}

static unsigned look_at_connectors(struct doctor *doctor)
{
	char folder[320];
	unsigned found = 0;
	snprintf(folder, sizeof(folder), "%s/sys/class/drm", doctor->system);
	DIR *list = opendir(folder);
	if (!list)
		return 0;
	for (const struct dirent *entry = readdir(list); entry; entry = readdir(list)) {
		char path[600];
		snprintf(path, sizeof(path), "%s/%s", folder, entry->d_name);
		if (!is_connector(entry->d_name) || !is_connected(path))
			continue;
		look_at_connector(doctor, path, strchr(entry->d_name, '-') + 1);
		found++;
	}
	closedir(list);
	return found;
}

static void look_at_cards(struct doctor *doctor)
{
	for (int card = 0; card < 8; card++) {
		char path[320];
		snprintf(path, sizeof(path), "%s/dev/dri/card%d", doctor->system, card);
		if (access(path, F_OK) != 0)
			continue;
		if (access(path, R_OK | W_OK) == 0)
			doctor_add(doctor, DOCTOR_WORKS, AREA, NULL, "/dev/dri/card%d may be opened, for --present kms", card);
		else
			doctor_add(doctor, DOCTOR_LIMIT, AREA, "sudo usermod -aG video $USER, then log in anew",
					   "/dev/dri/card%d may not be opened, so --present kms cannot work", card);
	}
}

void doctor_look_at_displays(struct doctor *doctor)
{
	const char *x11 = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
	if ((x11 && *x11) || (wayland && *wayland))
		doctor_add(doctor, DOCTOR_WORKS, AREA, NULL, "a desktop is there (%s), for --present glfw",
				   wayland && *wayland ? "Wayland" : "X11");
	else
		doctor_add(doctor, DOCTOR_NOTE, AREA, NULL, "no desktop: neither DISPLAY nor WAYLAND_DISPLAY is set");
	if (!look_at_connectors(doctor))
		doctor_add(doctor, DOCTOR_NOTE, AREA, NULL,
				   "the kernel knows no connected display; --present headless needs none");
	look_at_cards(doctor);
}
