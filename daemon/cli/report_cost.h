/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The engine's time against the share of the picture that moves and against pixels, with straight lines through them.
 */
#ifndef PURSUIT_CLI_REPORT_COST_H
#define PURSUIT_CLI_REPORT_COST_H

#include <stdio.h>

#include "report.h"

/* Measures with the engine of the plain `pursuit`, else of the last plain variant; nothing if the report has no scene.
 * 0 or a negative errno with a sentence. */
int report_measure_cost(struct report *report, struct error *error);

/* null if it was not measured; the caller's. */
json_t *report_cost_json(const struct report *report);

/* Its section of the page, but for the plot; and the plot, if it was measured. */
void report_put_cost(const struct report *report, FILE *out);
void report_write_cost_plot(const struct report *report, FILE *script);

#endif
