/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* EDIDs whole, cut and of random bytes; a made-up system with connectors and cards. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/cli/doctor.h"
#include "tests/test.h"

/* A detailed timing: clock in 10 kHz, active and blanking sizes. */
static void put_timing(uint8_t *to, uint32_t clock, uint32_t width, uint32_t blank_x, uint32_t height, uint32_t blank_y)
{
	to[0] = (uint8_t)clock;
	to[1] = (uint8_t)(clock >> 8);
	to[2] = (uint8_t)width;
	to[3] = (uint8_t)blank_x;
	to[4] = (uint8_t)(width >> 8 << 4 | blank_x >> 8);
	to[5] = (uint8_t)height;
	to[6] = (uint8_t)blank_y;
	to[7] = (uint8_t)(height >> 8 << 4 | blank_y >> 8);
}

static void test_edid(void)
{
	uint8_t edid[256] = {0};
	uint32_t width, height;
	put_timing(edid + 54, 14850, 1920, 280, 1080, 45);
	CHECK(fabs(doctor_read_edid(edid, 128, &width, &height) - 60.0) < 1e-9 && width == 1920 && height == 1080);
	edid[128] = 2;
	edid[130] = 4;
	put_timing(edid + 132, 28500, 1920, 160, 1080, 64);
	CHECK(fabs(doctor_read_edid(edid, 256, &width, &height) - 119.773) < 1e-2);
	CHECK(fabs(doctor_read_edid(edid, 200, &width, &height) - 60.0) < 1e-9);
	CHECK(doctor_read_edid(edid, 127, &width, &height) == 0.0);
	CHECK(doctor_read_edid(edid, 0, &width, &height) == 0.0);
}

static void test_random_edid(void)
{
	uint8_t *edid = malloc(512);
	uint32_t width, height, state = 1;
	for (int round = 0; round < 20000; round++) {
		for (int i = 0; i < 512; i++) {
			state = state * 1664525u + 1013904223u;
			edid[i] = (uint8_t)(state >> 24);
		}
		edid[128] = edid[256] = edid[384] = 2;
		double hz = doctor_read_edid(edid, state % 513, &width, &height);
		CHECK(hz >= 0.0 && hz < 1000.0 && width < 4096 && height < 4096);
	}
	free(edid);
}

static void write_file(const char *root, const char *name, const void *bytes, size_t size)
{
	char path[600];
	snprintf(path, sizeof(path), "%s/%s", root, name);
	FILE *out = fopen(path, "wb");
	CHECK(out && fwrite(bytes, 1, size, out) == size && fclose(out) == 0);
}

static void make_folder(const char *root, const char *name)
{
	char path[600];
	snprintf(path, sizeof(path), "%s/%s", root, name);
	CHECK(mkdir(path, 0700) == 0);
}

static bool found(const struct doctor *doctor, enum doctor_state state, const char *text)
{
	for (uint32_t i = 0; i < doctor->count; i++)
		if (doctor->findings[i].state == state && strstr(doctor->findings[i].text, text))
			return true;
	return false;
}

static void test_system(void)
{
	char root[] = "/tmp/pursuit-doctor-XXXXXX";
	uint8_t edid[128] = {0};
	CHECK(mkdtemp(root));
	static const char *const folders[] = {
		"sys", "sys/class", "sys/class/drm", "sys/class/drm/card0-DP-1", "sys/class/drm/card0-HDMI-A-1",
		"dev", "dev/dri"};
	for (size_t i = 0; i < sizeof(folders) / sizeof(folders[0]); i++)
		make_folder(root, folders[i]);
	put_timing(edid + 54, 28500, 1920, 160, 1080, 64);
	write_file(root, "sys/class/drm/card0-DP-1/status", "connected\n", 10);
	write_file(root, "sys/class/drm/card0-DP-1/edid", edid, sizeof(edid));
	write_file(root, "sys/class/drm/card0-HDMI-A-1/status", "disconnected\n", 13);
	write_file(root, "dev/dri/card0", "", 0);
	write_file(root, "dev/gpiochip2", "", 0);
	struct doctor doctor = {.system = root};
	doctor_look_at_displays(&doctor);
	doctor_look_at_gpio(&doctor);
	CHECK(found(&doctor, DOCTOR_WORKS, "DP-1: 1920x1080 at 119.77 Hz"));
	CHECK(!found(&doctor, DOCTOR_WORKS, "HDMI") && !found(&doctor, DOCTOR_NOTE, "HDMI"));
	CHECK(found(&doctor, DOCTOR_WORKS, "/dev/dri/card0 may be opened"));
	CHECK(found(&doctor, DOCTOR_WORKS, "/dev/gpiochip2 may be opened"));
	char command[640];
	snprintf(command, sizeof(command), "rm -r '%s'", root);
	CHECK(system(command) == 0);
}

int main(void)
{
	RUN(test_edid);
	RUN(test_random_edid);
	RUN(test_system);
	return test_result();
}
