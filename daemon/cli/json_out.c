/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "json_out.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "args.h"

bool json_print(const json_t *object)
{
	const bool whole = json_dumpf(object, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) == 0;
	putchar('\n');
	return whole || ferror(stdout);
}

int json_out(const char *verb, json_t *object)
{
	if (!object)
		return args_failed(verb, "out of memory, or a name is no UTF-8 and JSON cannot hold it");
	const bool whole = json_print(object);
	json_decref(object);
	return whole ? STATUS_DONE : args_failed(verb, "out of memory");
}

int json_write(const json_t *object, const char *path, struct error *error)
{
	FILE *file = fopen(path, "w");
	if (!file)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	bool wrong = json_dumpf(object, file, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) != 0 || fputc('\n', file) == EOF;
	wrong |= fclose(file) != 0;
	return wrong ? error_set(error, -EIO, "%s: not written whole: %s", path, strerror(errno)) : 0;
}
