/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The user interface of the scene `hud`: what a busy game shows, as a function of time. */
#ifndef PURSUIT_SCENES_HUD_LAYOUT_H
#define PURSUIT_SCENES_HUD_LAYOUT_H

#include "overlay.h"

/* Figures change at 15 Hz at most, as people can read no faster. */
void hud_layout(struct overlay *ui, double time);

#endif
