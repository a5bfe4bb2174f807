/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A sentence for a person about what went wrong: names the file, the field and
 * the value. Functions of daemon/ that can fail in more than one way take a
 * `struct error *` (never NULL) and fill it when they return a negative errno.
 */
#ifndef PURSUIT_DAEMON_ERROR_H
#define PURSUIT_DAEMON_ERROR_H

#include <stdarg.h>
#include <stdio.h>

struct error {
	char text[512];
};

/* Fills the sentence and gives `code` (a negative errno) back: return error_set(e, -EINVAL, "..."). */
__attribute__((format(printf, 3, 4))) static inline int error_set(struct error *error, int code, const char *format,
																  ...)
{
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(error->text, sizeof(error->text), format, arguments);
	va_end(arguments);
	return code;
}

#endif
