/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Values of settings from text and back. Private to options.c. */
#ifndef PURSUIT_OPTION_VALUE_H
#define PURSUIT_OPTION_VALUE_H

#include "daemon/options.h"

/* Sets the row's field. 0 or -EINVAL with a sentence that names the setting and the value. */
int option_value_set(struct settings *settings, const struct option_row *row, const char *value, struct error *error);

/* Bytes of the row's field; equal values are equal bytes. */
size_t option_value_size(const struct option_row *row);

/* Writes the present value as option_value_set() would take it. Truncates. */
void option_value_print(const struct settings *settings, const struct option_row *row, char *value, size_t size);

/* A choice of the setting context, with a number where it says INDEX. 0 or -EINVAL with a sentence. */
int option_value_context(const char *text, enum engine_context_kind *kind, uint32_t *device, struct error *error);

#endif
