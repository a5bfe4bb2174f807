/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The photodiode patch: a black or white square in a corner of the picture,
 * drawn into its memory after everything else. Pure; any thread.
 */
#ifndef PURSUIT_LAB_PATCH_H
#define PURSUIT_LAB_PATCH_H

#include <stdbool.h>

#include "daemon/present/presenter.h"

/* Corner: 0 top left, 1 top right, 2 bottom left, 3 bottom right. Cut to what the picture has. */
void patch_draw(const struct presenter_image *image, uint32_t corner, uint32_t size, bool white);

#endif
