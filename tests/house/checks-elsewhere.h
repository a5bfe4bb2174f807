/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A check in another file than main's, for test-checks.c. */
#ifndef PURSUIT_TESTS_CHECKS_ELSEWHERE_H
#define PURSUIT_TESTS_CHECKS_ELSEWHERE_H

#include <stdbool.h>

void check_elsewhere(bool holds);

#endif
