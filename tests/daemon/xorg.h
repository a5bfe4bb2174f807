/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * An Xorg of one's own with monitors that are not there (the driver `dummy`), which can be plugged and have modes to
 * choose from; what a test does to its windows is in xvfb.h.
 */
#ifndef PURSUIT_TEST_XORG_H
#define PURSUIT_TEST_XORG_H

#include "tests/daemon/xvfb.h"

/* The monitors that it is started with, DUMMY0 and right of it DUMMY1. */
#define XORG_WIDTH 800u
#define XORG_HEIGHT 600u
#define XORG_USUAL_HZ 59.97 /* their mode at first; there are others of that size with 56 to 120 Hz */

/*
 * Starts it, with files in this folder, and both monitors. False: it, its driver or xrandr is not installed, or it
 * does not start here. As xvfb_start(); ended by xvfb_stop().
 */
bool xorg_start(struct xvfb *server, const char *folder);

/* Plugs DUMMY1 in, in its usual mode. */
bool xorg_plug(void);
/* Unplugs it. */
bool xorg_unplug(void);
/* The rate of the mode that a monitor is in, Hz; 0: it is off. */
double xorg_rate(const char *monitor);

#endif
