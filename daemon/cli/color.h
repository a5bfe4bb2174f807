/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Whether what is printed may be coloured: https://no-color.org. */
#ifndef PURSUIT_CLI_COLOR_H
#define PURSUIT_CLI_COLOR_H

#include <stdbool.h>

/* Standard output is a terminal that can, and nobody has said NO_COLOR. */
bool color_is_wanted(void);

#endif
