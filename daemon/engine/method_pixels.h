/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the methods that work pixel by pixel share. */
#ifndef PURSUIT_ENGINE_METHOD_PIXELS_H
#define PURSUIT_ENGINE_METHOD_PIXELS_H

#include "daemon/engine/method.h"

/* Displacement and colour of the frame; notes why nothing moves, if nothing does. As `begin` of a method. */
int pixels_begin(struct engine *engine, struct error *error);

/* Runs `paint` and hands what it made over to the executor as *picture. */
int pixels_show(struct engine *engine, int (*paint)(struct engine *engine, struct error *error), double phase,
				enum picture_id *picture, struct error *error);

#endif
