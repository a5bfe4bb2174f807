/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Plays the vsync wire of a display: pulls an input line of gpio-sim up at each
 * vblank and down a millisecond later. Of each five seconds one is silent (the
 * third), and one has a second pulse within each period (the fifth). The times
 * of the vblanks' edges are written line by line.
 */
#ifndef PURSUIT_TESTS_LAB_RIG_WIRE_H
#define PURSUIT_TESTS_LAB_RIG_WIRE_H

#include <stdint.h>

#include "daemon/clock.h"

struct rig_wire;

/* pull_path: the line's attribute in sysfs; truth_path: written. NULL if one cannot be opened. */
struct rig_wire *rig_wire_create(struct clock *clock, const char *pull_path, const char *truth_path,
								 uint64_t period_ns);
void rig_wire_destroy(struct rig_wire **wire);

#endif
