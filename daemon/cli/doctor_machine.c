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

#include "daemon/engine/engine.h"
#include "doctor.h"

static void look_at_renderer(struct doctor *doctor, enum engine_context_kind kind, const char *option, const char *mend)
{
	const struct engine_params params = {.context = kind};
	struct error error = {""};
	struct engine *engine = engine_create(&params, &error);
	if (!engine) {
		doctor_add(doctor, kind == ENGINE_CONTEXT_AUTO ? DOCTOR_FAILS : DOCTOR_NOTE, "renderer", mend,
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
	look_at_renderer(doctor, ENGINE_CONTEXT_AUTO, "auto", "pursuitd --context cpu, which needs no GL");
	look_at_renderer(doctor, ENGINE_CONTEXT_CPU, "cpu", NULL);
	look_at_renderer(doctor, ENGINE_CONTEXT_EGL_SURFACELESS, "egl",
					 "sudo apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri");
	look_at_renderer(doctor, ENGINE_CONTEXT_OSMESA, "osmesa", "sudo apt-get install libosmesa6");
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
		doctor_add(doctor, CPU_COUNT(&cpus) > 1 ? DOCTOR_WORKS : DOCTOR_LIMIT, "scheduling",
				   CPU_COUNT(&cpus) > 1 ? NULL : "taskset -cp 0-$(($(nproc --all) - 1)) $$, or a machine with more",
				   "%d processors; without a GPU the game and the daemon share them", CPU_COUNT(&cpus));
	if (uname(&system) == 0 && sscanf(system.release, "%d.%d", &major, &minor) == 2) {
		if (major > 6 || (major == 6 && minor >= 12))
			doctor_add(doctor, DOCTOR_WORKS, "scheduling", NULL, "Linux %.60s gives short slices to the render thread",
					   system.release);
		else
			doctor_add(doctor, DOCTOR_LIMIT, "scheduling",
					   "sudo apt-get install -t bookworm-backports linux-image-amd64, or any Linux from 6.12 on",
					   "Linux %.60s: the render thread may wait milliseconds behind a busy game", system.release);
	}
	look_at_limit(doctor, RLIMIT_NICE, 23, "a better than ordinary priority",
				  "echo '@pursuit - nice -3' | sudo tee -a /etc/security/limits.d/pursuit.conf, then log in anew");
	look_at_limit(doctor, RLIMIT_RTPRIO, 20, "real-time priority (of the thread that sets GPIO lines)",
				  "echo '@pursuit - rtprio 20' | sudo tee -a /etc/security/limits.d/pursuit.conf, then log in anew");
}
