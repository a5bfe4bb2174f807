/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The daemon as a service: units of systemd, the socket, the daemon behind it and its configuration. */

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "control.h"
#include "doctor.h"

#define UNIT "pursuit.socket"

/* ---- units ---- */

static bool is_there(const struct doctor *doctor, const char *folder, const char *path)
{
	char whole[PATH_MAX];
	snprintf(whole, sizeof(whole), "%s%s%s", doctor->system, folder, path);
	return access(whole, F_OK) == 0;
}

/* Folders of units, where packages and where people put them: %s is system or user. */
static bool find_unit(const struct doctor *doctor, const char *scope, const char *name)
{
	static const char *const folders[] = {"/etc/systemd/", "/usr/local/lib/systemd/", "/usr/lib/systemd/",
										  "/lib/systemd/"};
	char path[128];
	snprintf(path, sizeof(path), "%s/%s", scope, name);
	for (size_t i = 0; i < sizeof(folders) / sizeof(folders[0]); i++)
		if (is_there(doctor, folders[i], path))
			return true;
	const char *home = getenv("HOME");
	snprintf(path, sizeof(path), "/.config/systemd/user/%s", name);
	return strcmp(scope, "user") == 0 && home && is_there(doctor, home, path);
}

static void look_at_units(struct doctor *doctor, const char *scope, const char *enable)
{
	if (!find_unit(doctor, scope, UNIT))
		doctor_add(doctor, DOCTOR_NOTE, "service", "sudo meson install -C build-dev, or the package",
				   "the %s units of systemd are not installed", scope);
	else if (find_unit(doctor, scope, "sockets.target.wants/" UNIT))
		doctor_add(doctor, DOCTOR_WORKS, "service", NULL, "the %s units are installed, and %s is enabled", scope, UNIT);
	else
		doctor_add(doctor, DOCTOR_NOTE, "service", enable, "the %s units are installed, but %s is not enabled", scope,
				   UNIT);
}

void doctor_look_at_service(struct doctor *doctor)
{
	if (!is_there(doctor, "", "/run/systemd/system")) {
		doctor_add(doctor, DOCTOR_NOTE, "service", "pursuitd &",
				   "systemd does not run here, so the daemon is started by hand");
		return;
	}
	look_at_units(doctor, "user", "systemctl --user enable --now " UNIT);
	look_at_units(doctor, "system", "sudo systemctl enable --now " UNIT);
}

/* ---- the daemon ---- */

static void add_unreachable(struct doctor *doctor, int result, const struct error *error)
{
	const bool refused = strncmp(error->text, "the daemon refused", 18) == 0;
	if (refused)
		doctor_add(doctor, DOCTOR_FAILS, "daemon", "its owner: pursuit set allow-users=NAME, or max-clients=N",
				   "%.200s", error->text);
	else if (result == -EACCES)
		doctor_add(doctor, DOCTOR_FAILS, "socket", "sudo usermod -aG pursuit $USER, then log in anew", "%.200s",
				   error->text);
	else if (result == -ECONNREFUSED)
		doctor_add(doctor, DOCTOR_LIMIT, "socket", "pursuitd", "%.200s; the socket is that of a daemon that is gone",
				   error->text);
	else if (result == -ENOENT)
		doctor_add(doctor, DOCTOR_NOTE, "socket", "systemctl --user start " UNIT ", or pursuitd", "%.200s",
				   error->text);
	else
		doctor_add(doctor, DOCTOR_FAILS, "daemon", "systemctl --user restart pursuit, or pkill pursuitd; pursuitd",
				   "%.200s", error->text);
}

/* "FILE:LINE: what": an editor at that line. */
static void look_at_configuration(struct doctor *doctor, const json_t *configuration)
{
	const char *mistake = json_string_value(json_object_get(configuration, "mistake"));
	char mend[sizeof(doctor->findings[0].mend)];
	unsigned line = 0;
	if (!mistake || !*mistake) {
		doctor_add(doctor, DOCTOR_WORKS, "daemon", NULL, "it reads %zu configuration files, without a mistake",
				   json_array_size(json_object_get(configuration, "files")));
		return;
	}
	const int length = (int)strcspn(mistake, ":");
	sscanf(mistake + length, ":%u", &line);
	snprintf(mend, sizeof(mend), "${EDITOR:-vi} +%u %.*s", line, length < 150 ? length : 150, mistake);
	doctor_add(doctor, DOCTOR_LIMIT, "daemon", mend, "it keeps older settings: %.180s", mistake);
}

static void look_at_status(struct doctor *doctor, const json_t *status)
{
	const char *presenter = json_string_value(json_object_get(status, "presenter"));
	if (presenter && strcmp(presenter, "none") == 0)
		doctor_add(doctor, DOCTOR_LIMIT, "daemon", "pursuit status; pursuitd --present kms,glfw,headless",
				   "it runs and answers, but its display is lost");
	else
		doctor_add(doctor, DOCTOR_WORKS, "daemon", NULL, "it runs and answers, presenter %s, %.2f Hz",
				   presenter ? presenter : "not told", json_number_value(json_object_get(status, "refresh")));
	look_at_configuration(doctor, json_object_get(status, "configuration"));
}

void doctor_look_at_daemon(struct doctor *doctor, const char *socket)
{
	struct control control;
	struct error error = {""};
	json_t *reply = NULL;
	int result = control_open(&control, socket, &error);
	if (result < 0) {
		add_unreachable(doctor, result, &error);
		return;
	}
	result = control_ask(&control, "status", -1, &reply, &error);
	if (result == 0)
		look_at_status(doctor, reply);
	else
		add_unreachable(doctor, result, &error);
	json_decref(reply);
	control_close(&control);
}
