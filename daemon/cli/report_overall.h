/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Figures over several rows: what the plots and the overall tables show. */
#ifndef PURSUIT_CLI_REPORT_OVERALL_H
#define PURSUIT_CLI_REPORT_OVERALL_H

#include "report.h"

/* Does anything in this scene move? False for recordings, about which it is not known. */
bool report_moves(const struct report *report, const struct report_work *work);

/* A variant in the plane of run time and error. */
struct report_point {
	const struct report_variant *variant;
	double ms, ms_low, ms_high; /* per displayed frame: median, quartiles */
	double error;               /* perceived error; of a recording the error of in-betweens; code values */
};

/* Points of one work, or means over all scenes that move, of the first N and size; how many. */
uint32_t report_points(const struct report *report, const struct report_work *work, struct report_point *points);

/* Mean over the scenes that move, of the first N and size; NAN if there are none. */
double report_mean(const struct report *report, const struct report_variant *variant, enum score_measure measure);
double report_mean_ms(const struct report *report, const struct report_variant *variant, double percentile);

/* Perceived errors by speed, over all scenes of the first N; false: none. */
bool report_speed_bins(const struct report *report, const struct report_variant *variant,
					   struct squared_error bins[CAMERA_SPEEDS]);

/* NULL if there is none. */
const struct report_row *report_find_row(const struct report *report, const struct report_work *work,
										 const struct report_variant *variant);

/* Name of a work's plot, without folder and ending. */
void report_plot_name(char name[REPORT_NAME], const char *kind, const struct report *report, uint32_t work);

#endif
