/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/presenter.h"

const struct presenter_impl presenter_glfw = {.name = "glfw", .description = "a window or full screen (not built in)"};
