/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/x_mode.h"

double x_mode_change(struct x_mode *mode, Display *display, XID output, double refresh_hz)
{
	(void)mode;
	(void)display;
	(void)output;
	(void)refresh_hz;
	return 0.0;
}

void x_mode_restore(struct x_mode *mode, Display *display)
{
	(void)mode;
	(void)display;
}

void x_mode_abandon(struct x_mode *mode)
{
	(void)mode;
}
