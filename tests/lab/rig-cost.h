/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What threads of this program cost: the processor's time of each, and beside the lab's own a bare thread of the same
 * priority that is woken by the same flips and does nothing: what a wake-up costs on this machine as it is now.
 */
#ifndef PURSUIT_TESTS_LAB_RIG_COST_H
#define PURSUIT_TESTS_LAB_RIG_COST_H

#include <jansson.h>
#include <stdint.h>

struct rig_cost;

/* Starts the bare thread. NULL: it cannot be. */
struct rig_cost *rig_cost_create(uint32_t priority);
/* Any thread; NULL accepted. */
void rig_cost_flip(struct rig_cost *cost);
void rig_cost_destroy(struct rig_cost **cost);

/* {"pursuit-lab": us of processor's time a flip, ...}, of all threads that there are now. */
json_t *rig_cost_threads(uint64_t flips);

#endif
