/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#ifndef PURSUIT_ENGINE_WARM_UP_H
#define PURSUIT_ENGINE_WARM_UP_H

#include "daemon/engine/engine.h"

/*
 * Shows a small frame that needs every pass. Renderers translate a shader when it is first drawn with, not when it is
 * compiled; llvmpipe takes a third of a second for all of them.
 */
int warm_up(struct engine *engine, struct error *error);

#endif
