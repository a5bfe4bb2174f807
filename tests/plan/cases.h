/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The frames that every implementation of the analysis is checked on: sizes, formats, fields, cells, depths. */
#ifndef PURSUIT_TESTS_CASES_H
#define PURSUIT_TESTS_CASES_H

#include "daemon/engine/plan.h"
#include "fixture.h"

typedef void cases_check(const struct fixture_spec *spec, const struct plan_params *params, enum fixture_field field,
						 uint32_t seed);

/* Every field in sizes from one pixel up. */
void cases_of_sizes(cases_check *check);
/* Cells and thresholds. */
void cases_of_cells(cases_check *check);
/* Kinds, formats and distances of depth. */
void cases_of_depths(cases_check *check);
/* Motion and depth of other sizes than the colour's, and than each other's. */
void cases_of_planes(cases_check *check);

#endif
