/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "json_out.h"

#include <stdio.h>

#include "args.h"

int json_out(const char *verb, json_t *object)
{
	if (!object)
		return args_failed(verb, "out of memory, or a name is no UTF-8 and JSON cannot hold it");
	const bool done = json_dumpf(object, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) == 0;
	json_decref(object);
	putchar('\n');
	return done && fflush(stdout) == 0 ? STATUS_DONE : args_failed(verb, "standard output cannot be written");
}
