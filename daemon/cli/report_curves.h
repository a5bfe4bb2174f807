/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#ifndef PURSUIT_CLI_REPORT_CURVES_H
#define PURSUIT_CLI_REPORT_CURVES_H

#include <jansson.h>
#include <stdio.h>

/*
 * Curves of another program as a picture in the page (SVG): {x, y: names of the axes, curves: [{name, points: [[x, y],
 * ...]}]}, "steps": true to draw steps. Points must rise in x. What is no such plot writes nothing.
 */
void curves_write(const json_t *plot, const char *title, FILE *out);

#endif
