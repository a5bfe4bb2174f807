/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "control.h"
#include "daemon/engine/engine.h"
#include "doctor.h"

static void look_at_renderer(struct doctor *doctor, enum engine_context_kind kind, const char *option)
{
	const struct engine_params params = {.context = kind};
	struct error error = {""};
	struct engine *engine = engine_create(&params, &error);
	if (!engine) {
		doctor_add(doctor, kind == ENGINE_CONTEXT_AUTO ? DOCTOR_FAILS : DOCTOR_NOTE, "renderer", NULL,
				   "--context %s: %s", option, error.text);
		return;
	}
	const struct engine_info *info = engine_get_info(engine);
	doctor_add(doctor, DOCTOR_WORKS, "renderer", NULL, "--context %s: %s, %s%s", option, info->context, info->renderer,
			   info->software ? " (on the CPU)" : "");
	engine_destroy(&engine);
}

void doctor_look_at_renderers(struct doctor *doctor)
{
	look_at_renderer(doctor, ENGINE_CONTEXT_AUTO, "auto");
	look_at_renderer(doctor, ENGINE_CONTEXT_CPU, "cpu");
	look_at_renderer(doctor, ENGINE_CONTEXT_EGL_SURFACELESS, "egl");
	look_at_renderer(doctor, ENGINE_CONTEXT_OSMESA, "osmesa");
}

void doctor_look_at_gpio(struct doctor *doctor)
{
	unsigned chips = 0;
	for (int chip = 0; chip < 16; chip++) {
		char path[320];
		snprintf(path, sizeof(path), "%s/dev/gpiochip%d", doctor->system, chip);
		if (access(path, F_OK) != 0)
			continue;
		chips++;
		if (access(path, R_OK | W_OK) == 0)
			doctor_add(doctor, DOCTOR_WORKS, "gpio", NULL, "/dev/gpiochip%d may be opened", chip);
		else
			doctor_add(doctor, DOCTOR_LIMIT, "gpio", "sudo usermod -aG gpio $USER, then log in anew (docs/lab.md)",
					   "/dev/gpiochip%d may not be opened", chip);
	}
	if (!chips)
		doctor_add(doctor, DOCTOR_NOTE, "gpio", NULL, "there is no GPIO chip; only laboratories need one");
}

static void look_at_limit(struct doctor *doctor, int which, rlim_t wanted, const char *what, const char *mend)
{
	struct rlimit limit;
	if (getrlimit(which, &limit) < 0)
		return;
	if (geteuid() == 0 || limit.rlim_max == RLIM_INFINITY || limit.rlim_max >= wanted)
		doctor_add(doctor, DOCTOR_WORKS, "scheduling", NULL, "%s is permitted", what);
	else
		doctor_add(doctor, DOCTOR_LIMIT, "scheduling", mend, "%s is not permitted (limit %llu, wanted %llu)", what,
				   (unsigned long long)limit.rlim_max, (unsigned long long)wanted);
}

void doctor_look_at_scheduling(struct doctor *doctor)
{
	struct utsname system;
	cpu_set_t cpus;
	int major = 0, minor = 0;
	if (sched_getaffinity(0, sizeof(cpus), &cpus) == 0)
		doctor_add(doctor, CPU_COUNT(&cpus) > 1 ? DOCTOR_WORKS : DOCTOR_LIMIT, "scheduling", NULL,
				   "%d processors; without a GPU the game and the daemon share them", CPU_COUNT(&cpus));
	if (uname(&system) == 0 && sscanf(system.release, "%d.%d", &major, &minor) == 2) {
		if (major > 6 || (major == 6 && minor >= 12))
			doctor_add(doctor, DOCTOR_WORKS, "scheduling", NULL, "Linux %.60s gives short slices to the render thread",
					   system.release);
		else
			doctor_add(doctor, DOCTOR_LIMIT, "scheduling", "Linux 6.12 or later, or real-time priority",
					   "Linux %.60s: the render thread may wait milliseconds behind a busy game", system.release);
	}
	look_at_limit(doctor, RLIMIT_NICE, 23, "a better than ordinary priority",
				  "a line '@pursuit - nice -3' in /etc/security/limits.d/pursuit.conf");
	look_at_limit(doctor, RLIMIT_RTPRIO, 20, "real-time priority (of the thread that sets GPIO lines)",
				  "a line '@pursuit - rtprio 20' in /etc/security/limits.d/pursuit.conf");
}

void doctor_look_at_daemon(struct doctor *doctor, const char *socket)
{
	struct control control;
	struct error error = {""};
	json_t *reply = NULL;
	if (control_open(&control, socket, &error) < 0) {
		doctor_add(doctor, DOCTOR_NOTE, "daemon", "pursuitd, or systemctl --user start pursuitd.socket", "%s",
				   error.text);
		return;
	}
	if (control_ask(&control, "status", -1, &reply, &error) == 0) {
		const json_t *output = json_array_get(json_object_get(reply, "outputs"), 0);
		const char *presenter = json_string_value(json_object_get(output, "presenter"));
		doctor_add(doctor, DOCTOR_WORKS, "daemon", NULL, "it runs and answers%s%s", presenter ? ", presenter " : "",
				   presenter ? presenter : "");
		json_decref(reply);
	} else {
		doctor_add(doctor, DOCTOR_FAILS, "daemon", "stop it, start it again, and look at its log", "%s", error.text);
	}
	control_close(&control);
}
