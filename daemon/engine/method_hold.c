/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/method.h"
#include "daemon/engine/pass.h"

static int hold_begin(struct engine *engine, struct error *error)
{
	report_leave_out(&engine->report, "extrapolation", "method");
	return 0;
}

static int hold_show(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture,
					 struct error *error)
{
	*picture = PICTURE_ORIGINAL;
	return 0;
}

const struct method method_hold = {
	.name = "hold",
	.description = "repeats the real frame",
	.begin = hold_begin,
	.show = hold_show,
};
