/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The mode of a monitor of an X server, by RandR, changed for full screen and put back afterwards. GLFW could do that,
 * but would ask a server that is gone how to put it back, and end the process so. On the window's thread.
 */
#ifndef PURSUIT_X_MODE_H
#define PURSUIT_X_MODE_H

#include <X11/Xlib.h>
#include <stdbool.h>

#include "daemon/present/x_mode_guard.h"

/* What was changed, as RandR numbers things. Zeroed: nothing. */
struct x_mode {
	XID crtc, before, now;
	struct x_mode_guard guard; /* should the daemon not come to put it back */
};

/*
 * Of the modes of this output with the size that it has now, the one whose rate is nearest to the one wished for; what
 * was changed before is put back first. Gives the rate of the mode that it is in then, in Hz, 0: not known. A server
 * that refuses leaves it as it is.
 */
double x_mode_change(struct x_mode *mode, Display *display, XID output, double refresh_hz);

/* Unless somebody else has changed it meanwhile. Zeroes it. */
void x_mode_restore(struct x_mode *mode, Display *display);

/* The same without a connection, as one that broke: where the server is there still. Zeroes it. May hang. */
void x_mode_abandon(struct x_mode *mode);

#endif
