/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The contexts that a test of the engine runs in, by the names that its command line has. */
#ifndef PURSUIT_REFERENCE_ENGINE_CONTEXT_H
#define PURSUIT_REFERENCE_ENGINE_CONTEXT_H

#include "daemon/engine/engine.h"

#define ENGINE_CONTEXT_USAGE "surfaceless-gl | surfaceless-gles | device-gl | osmesa | cpu"

/* An engine in the context of that name, told on stdout. Ends the program, 77 if the machine has no such context. */
struct engine *engine_context_open(const char *name, const char *method);

#endif
