/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_score.h"

#include <math.h>
#include <string.h>

const struct score_info score_table[SCORE_MEASURES] = {
	[SCORE_PERCEIVED_ERROR] = {"perceived_error", "perceived error", "code values", 2, -1, 0,
							   "root mean square difference between what a pursuing eye sees of the display and of "
							   "the scene at 960 Hz"},
	[SCORE_PERCEIVED_PSNR] = {"perceived_psnr", "perceived PSNR", "dB", 2, 1, 0, "the same as PSNR"},
	[SCORE_PERCEIVED_SSIM] = {"perceived_ssim", "perceived SSIM", "", 4, 1, 0, "SSIM of the same two pictures"},
	[SCORE_PERCEIVED_LAG] = {"perceived_lag_ms", "lag", "ms", 1, -1, 0,
							 "by how much the eye trails the scene where it sees the display best; half a vblank is "
							 "what a display that shows the truth has"},
	[SCORE_ENERGY_ERROR] = {"energy_error", "energy error", "", 4, -1, 0,
							"mean light of the pictures shown for a real frame, along the true motion, against its "
							"own, over blocks of 8x8 pixels without occlusion, as a share of the mean light"},
	[SCORE_ENERGY_BIAS] = {"energy_bias", "energy bias", "", 4, 0, 0, "the same with its sign: light gained or lost"},
	[SCORE_RIPPLE] = {"ripple", "ripple", "", 4, -1, 0,
					  "Michelson contrast of the mean luminances of the pictures shown for one real frame"},
	[SCORE_TPSNR] = {"tpsnr", "tPSNR", "dB", 2, 1, 0,
					 "PSNR of the change from one displayed picture to the next: flicker lowers it"},
	[SCORE_HIGH_FREQUENCY] = {"high_frequency_ratio", "fine detail", "", 3, 0, 1,
							  "high-frequency energy of the in-betweens over that of the real frames, as displayed"},
	[SCORE_PSNR] = {"psnr", "PSNR", "dB", 2, 1, 0, "of in-betweens, as displayed, against the truth"},
	[SCORE_PSNR_MIN] = {"psnr_min", "least PSNR", "dB", 2, 1, 0, "of a single in-between"},
	[SCORE_SSIM] = {"ssim", "SSIM", "", 4, 1, 0, "of in-betweens against the truth"},
	[SCORE_PSNR_MOVING] = {"psnr_moving", "PSNR, moving", "dB", 2, 1, 0, "on moving pixels alone"},
	[SCORE_PSNR_DISOCCLUDED] = {"psnr_disoccluded", "PSNR, disoccluded", "dB", 2, 1, 0,
								"on pixels alone that the real frame does not show"},
};

void running_add(struct running *running, double value)
{
	const double from_old = value - running->mean;
	running->count++;
	running->mean += from_old / running->count;
	running->squares += from_old * (value - running->mean);
}

double running_spread(const struct running *running)
{
	return running->count < 2 ? 0.0 : sqrt(running->squares / (running->count - 1));
}

bool score_init(struct score *score)
{
	*score = (struct score){.over_time = json_array(), .perceived_over_time = json_array()};
	return score->over_time && score->perceived_over_time;
}

void score_finish(struct score *score)
{
	json_decref(score->over_time);
	json_decref(score->perceived_over_time);
	*score = (struct score){0};
}

double score_value(const struct score *score, enum score_measure measure)
{
	switch (measure) {
	case SCORE_PERCEIVED_ERROR:
		return squared_error_root(&score->perceived);
	case SCORE_PERCEIVED_PSNR:
		return squared_error_psnr(&score->perceived);
	case SCORE_ENERGY_ERROR:
		return energy_error_root(&score->energy);
	case SCORE_ENERGY_BIAS:
		return energy_error_bias(&score->energy);
	case SCORE_HIGH_FREQUENCY:
		return score->detail_real > 0.0 ? score->detail_in_between / score->detail_real : (double)NAN;
	case SCORE_PSNR_MIN:
		return score->in_betweens ? score->psnr_min : (double)NAN;
	case SCORE_PSNR_MOVING:
		return squared_error_psnr(&score->moving);
	case SCORE_PSNR_DISOCCLUDED:
		return squared_error_psnr(&score->disoccluded);
	default:
		return score->samples[measure].count ? score->samples[measure].mean : (double)NAN;
	}
}

double score_spread(const struct score *score, enum score_measure measure)
{
	return running_spread(&score->samples[measure]);
}
