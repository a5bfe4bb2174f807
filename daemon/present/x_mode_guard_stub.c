/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/x_mode_guard.h"

bool x_mode_guard_run(int argc, char **argv, int *status)
{
	(void)argc;
	(void)argv;
	(void)status;
	return false;
}
