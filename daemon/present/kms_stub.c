/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/presenter.h"

const struct presenter_impl presenter_kms = {.name = "kms",
											 .description = "a display without any compositor (not built in)"};
