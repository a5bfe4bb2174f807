/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#ifndef PURSUIT_ENGINE_PARAMS_H
#define PURSUIT_ENGINE_PARAMS_H

#include "daemon/engine/engine.h"

/* Fills in the defaults and checks the ranges. 0, or -EINVAL with a sentence that names the field. */
int params_resolve(struct engine_params *params, struct error *error);

#endif
