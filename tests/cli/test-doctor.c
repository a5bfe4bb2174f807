/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* EDIDs whole, cut and of random bytes; a made-up system with connectors and cards. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
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

static const char *mend_of(const struct doctor *doctor, const char *text)
{
	for (uint32_t i = 0; i < doctor->count; i++)
		if (strstr(doctor->findings[i].text, text))
			return doctor->findings[i].mend;
	return "";
}

/* Units that are not there, there, and enabled: each with the command that comes next. */
static void test_units(void)
{
	char root[] = "/tmp/pursuit-doctor-XXXXXX";
	CHECK(mkdtemp(root));
	struct doctor doctor = {.system = root};
	doctor_look_at_service(&doctor);
	CHECK(found(&doctor, DOCTOR_NOTE, "systemd does not run here"));
	static const char *const folders[] = {"run", "run/systemd", "run/systemd/system",
										  "etc", "etc/systemd", "etc/systemd/user"};
	for (size_t i = 0; i < sizeof(folders) / sizeof(folders[0]); i++)
		make_folder(root, folders[i]);
	doctor.count = 0;
	doctor_look_at_service(&doctor);
	CHECK(found(&doctor, DOCTOR_NOTE, "the user units of systemd are not installed"));
	CHECK(strstr(mend_of(&doctor, "the user units of systemd are not"), "meson install"));
	write_file(root, "etc/systemd/user/pursuit.socket", "", 0);
	doctor.count = 0;
	doctor_look_at_service(&doctor);
	CHECK_STRING(mend_of(&doctor, "the user units are installed, but"), "systemctl --user enable --now pursuit.socket");
	make_folder(root, "etc/systemd/user/sockets.target.wants");
	write_file(root, "etc/systemd/user/sockets.target.wants/pursuit.socket", "", 0);
	doctor.count = 0;
	doctor_look_at_service(&doctor);
	CHECK(found(&doctor, DOCTOR_WORKS, "the user units are installed, and pursuit.socket is enabled"));
	CHECK(found(&doctor, DOCTOR_NOTE, "the system units of systemd are not installed"));
	char command[640];
	snprintf(command, sizeof(command), "rm -r '%s'", root);
	CHECK(system(command) == 0);
}

/* A socket that nobody listens at, a file that is none, and nothing. */
static void test_socket(void)
{
	char path[] = "/tmp/pursuit-doctor-XXXXXX";
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	struct doctor doctor = {.system = ""};
	CHECK(mkdtemp(path));
	snprintf(address.sun_path, sizeof(address.sun_path), "%s/socket", path);
	doctor_look_at_daemon(&doctor, address.sun_path);
	CHECK(doctor.count == 1 && doctor.findings[0].state == DOCTOR_NOTE);
	CHECK(strstr(doctor.findings[0].mend, "systemctl --user start pursuit.socket"));
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	CHECK(bind(fd, (const struct sockaddr *)&address, sizeof(address)) == 0);
	doctor.count = 0;
	doctor_look_at_daemon(&doctor, address.sun_path);
	CHECK(found(&doctor, DOCTOR_LIMIT, "a daemon that is gone"));
	CHECK_STRING(doctor.findings[0].mend, "pursuitd");
	close(fd);
	unlink(address.sun_path);
	rmdir(path);
}

int main(void)
{
	RUN(test_edid);
	RUN(test_random_edid);
	RUN(test_system);
	RUN(test_units);
	RUN(test_socket);
	return test_result();
}
