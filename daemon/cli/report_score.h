/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The measures of one row of the report (a scene, a method, its settings),
 * gathered clip by clip. What each measure is: daemon/measure/.
 */
#ifndef PURSUIT_CLI_REPORT_SCORE_H
#define PURSUIT_CLI_REPORT_SCORE_H

#include <jansson.h>

#include "daemon/measure/energy.h"
#include "report_clip.h"

enum score_measure {
	SCORE_PERCEIVED_ERROR,
	SCORE_PERCEIVED_PSNR,
	SCORE_PERCEIVED_SSIM,
	SCORE_PERCEIVED_LAG,
	SCORE_ENERGY_ERROR,
	SCORE_ENERGY_BIAS,
	SCORE_RIPPLE,
	SCORE_TPSNR,
	SCORE_HIGH_FREQUENCY,
	SCORE_PSNR,
	SCORE_PSNR_MIN,
	SCORE_SSIM,
	SCORE_PSNR_MOVING,
	SCORE_PSNR_DISOCCLUDED,
	SCORE_MEASURES,
};

/* A row for each of enum score_measure. */
struct score_info {
	const char *name;  /* in JSON and CSV */
	const char *title; /* for a person, short */
	const char *unit;
	int digits;
	int better; /* 1: greater is better, -1: less is, 0: nearer to `best` */
	double best;
	const char *help;
};
extern const struct score_info score_table[SCORE_MEASURES];

/* Mean and spread of some samples; starts zeroed. */
struct running {
	uint32_t count;
	double mean, squares;
};
void running_add(struct running *running, double value);
/* Standard deviation of the samples; 0 with fewer than two. */
double running_spread(const struct running *running);

/* A part of a picture that is kept to be looked at. */
struct crop {
	uint32_t site, x, y, width, height;
};

struct score {
	uint32_t lag; /* real frames by which the method is late; what it shows is judged by what it then depicts */
	uint32_t clips, in_betweens, sites;
	struct running samples[SCORE_MEASURES]; /* of single pictures, windows, frames */
	struct squared_error perceived, moving, disoccluded;
	struct energy_error energy;
	double psnr_min, detail_in_between, detail_real;
	struct squared_error by_speed[CAMERA_SPEEDS];
	json_t *over_time, *perceived_over_time; /* [seconds, dB] */
};

/* False: out of memory. */
bool score_init(struct score *score);
void score_finish(struct score *score);

/* What scoring needs besides: one for all rows of a size. */
struct scorer;
struct scorer *scorer_create(double gamma, struct error *error);
void scorer_destroy(struct scorer **scorer);

/*
 * Adds a clip as a method displayed it (clip_play()). With a crop, `seen`
 * (4 x its width x its height bytes) gets what the pursuit camera saw there.
 */
int scorer_add(struct scorer *scorer, struct score *score, const struct clip *clip, uint8_t *const *pictures,
			   const struct crop *crop, uint8_t *seen, struct error *error);

/* NAN: nothing to say. */
double score_value(const struct score *score, enum score_measure measure);
double score_spread(const struct score *score, enum score_measure measure);

#endif
