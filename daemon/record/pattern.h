/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Names of numbered files, 'c_%04d.png'. A pattern comes from a command line,
 * so it is checked and filled in here and never reaches printf.
 */
#ifndef PURSUIT_PATTERN_H
#define PURSUIT_PATTERN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"

#define PATTERN_MAX_PATH 4096
#define PATTERN_MAX_NUMBER 999999999u

/*
 * Exactly one %d or %0Nd (N is 1 to 9); %% stands for a percent sign. 0 or
 * -EINVAL with a sentence that names `option`.
 */
int pattern_check(const char *option, const char *pattern, struct error *error);

/* The same for images that are written in one format, whose names end in `ending`, ".png", in either case. */
int pattern_check_written(const char *option, const char *pattern, const char *ending, struct error *error);

/* The name for a number, of a pattern that was checked; false if it is too long for a path. */
bool pattern_name(const char *pattern, uint64_t number, char name[PATTERN_MAX_PATH]);

bool pattern_exists(const char *pattern, uint64_t number);

/*
 * All numbers of which there is a file, rising; to be freed, *numbers NULL if there is none. 0 or a negative errno with
 * a sentence: folders that are numbered themselves (-EINVAL) cannot be searched.
 */
int pattern_list(const char *pattern, uint64_t **numbers, size_t *count, struct error *error);

/* Lowest and highest number of which there is a file. 0 or a negative errno with a sentence. */
int pattern_range(const char *pattern, uint64_t *first, uint64_t *last, struct error *error);

#endif
