/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Plays display and photodiode: pulls an input line of gpio-sim to the level of
 * an alternating patch, 2 to 6 ms after each flip. Every 17th change is lost,
 * and with it the next one, since the line is there already; every 23rd bounces. What it did is written line by line:
 * vblank, then the times before and after the pull, 0 0 for a lost one.
 */
#ifndef PURSUIT_TESTS_LAB_RIG_PULL_H
#define PURSUIT_TESTS_LAB_RIG_PULL_H

#include "daemon/present/presenter.h"

struct rig_pull;

/* pull_path: the line's attribute in sysfs; truth_path: written. NULL if one cannot be opened. */
struct rig_pull *rig_pull_create(struct clock *clock, const char *pull_path, const char *truth_path);
/* Any thread; NULL accepted. */
void rig_pull_flip(struct rig_pull *pull, const struct presenter_flip *flip);
void rig_pull_destroy(struct rig_pull **pull);

#endif
