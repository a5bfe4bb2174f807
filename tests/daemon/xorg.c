/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/daemon/xorg.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char configuration[] = "Section \"ServerFlags\"\n"
									" Option \"AutoAddDevices\" \"off\"\n"
									" Option \"AutoEnableDevices\" \"off\"\n"
									" Option \"AutoAddGPU\" \"off\"\n"
									" Option \"DontVTSwitch\" \"on\"\n"
									" Option \"BlankTime\" \"0\"\n"
									"EndSection\n"
									"Section \"Device\"\n"
									" Identifier \"card\"\n"
									" Driver \"dummy\"\n"
									" VideoRam 65536\n"
									"EndSection\n"
									"Section \"Monitor\"\n"
									" Identifier \"monitor\"\n"
									" HorizSync 5-1000\n"
									" VertRefresh 5-300\n"
									" Modeline \"800x600_60\" 39.96 800 832 912 1056 600 601 604 631\n"
									" Modeline \"800x600_120\" 83.95 800 856 944 1088 600 603 607 643\n"
									"EndSection\n"
									"Section \"Screen\"\n"
									" Identifier \"screen\"\n"
									" Device \"card\"\n"
									" Monitor \"monitor\"\n"
									" DefaultDepth 24\n"
									" SubSection \"Display\"\n"
									"  Depth 24\n"
									"  Modes \"800x600_60\" \"800x600_120\"\n"
									"  Virtual 1600 600\n"
									" EndSubSection\n"
									"EndSection\n";

static bool succeeds(const char *command)
{
	return system(command) == 0;
}

bool xorg_start(struct xvfb *server, const char *folder)
{
	char file[128], log[128], none[128];
	snprintf(file, sizeof(file), "%s/xorg.conf", folder);
	snprintf(log, sizeof(log), "%s/xorg.log", folder);
	snprintf(none, sizeof(none), "%s/no-xorg.conf.d", folder);
	FILE *out = fopen(file, "w");
	if (!out || !succeeds("command -v xrandr >/dev/null"))
		return false;
	fputs(configuration, out);
	fclose(out);
	const char *const arguments[] = {"Xorg",        "-config",   file,       "-configdir", none,  "-logfile", log,
									 "-novtswitch", "-sharevts", "-noreset", "-nolisten",  "tcp", NULL};
	return xvfb_start_server(server, arguments) && xorg_plug();
}

/* The driver has a monitor plugged in where there is a mode, once somebody looks. */
bool xorg_plug(void)
{
	return succeeds("xrandr --addmode DUMMY1 800x600_60 2>/dev/null;"
					"xrandr --output DUMMY1 --mode 800x600_60 --right-of DUMMY0 >/dev/null && xrandr >/dev/null");
}

bool xorg_unplug(void)
{
	return succeeds("xrandr --output DUMMY1 --off >/dev/null");
}

/* The rate of the mode in use is the one with a star, in the lines after that of the monitor. */
double xorg_rate(const char *monitor)
{
	char line[512];
	bool here = false;
	double rate = 0.0;
	FILE *answer = popen("xrandr --current", "r");
	while (answer && fgets(line, sizeof(line), answer)) {
		char *star = strchr(line, '*');
		if (line[0] != ' ')
			here = strncmp(line, monitor, strlen(monitor)) == 0 && line[strlen(monitor)] == ' ';
		while (here && star && star > line && star[-1] != ' ')
			star--;
		if (here && star && rate == 0.0)
			rate = strtod(star, NULL);
	}
	if (answer)
		pclose(answer);
	return rate;
}
