/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/measure/detail.h"
#include "report_score.h"

/* Rows of the picture that the search for the eye's lag looks at. */
#define LAG_ROWS 48u

struct scorer {
	struct light_transfer transfer;
	/* what follows is for one clip */
	const struct clip *clip;
	uint8_t *const *pictures;
	uint32_t late;        /* displayed pictures by which the method is late */
	light_pixel **lights; /* one a displayed picture, NULL: not made yet */
	light_pixel *seen;
	uint8_t *codes, *truth;
};

struct scorer *scorer_create(double gamma, struct error *error)
{
	struct scorer *scorer = calloc(1, sizeof(*scorer));
	if (scorer)
		light_transfer_init(&scorer->transfer, gamma);
	else
		error_set(error, -ENOMEM, "out of memory");
	return scorer;
}

void scorer_destroy(struct scorer **scorer)
{
	if (!scorer)
		return;
	free(*scorer);
	*scorer = NULL;
}

static struct picture wrap(const struct clip *clip, const uint8_t *data)
{
	return (struct picture){data, 4 * (size_t)clip->width, clip->width, clip->height};
}

static size_t pixels_of(const struct clip *clip)
{
	return (size_t)clip->width * clip->height;
}

/* The light of a displayed picture; NULL with a sentence. */
static const light_pixel *light_of(struct scorer *scorer, uint32_t shown, struct error *error)
{
	if (!scorer->lights[shown]) {
		const struct picture picture = wrap(scorer->clip, scorer->pictures[shown]);
		scorer->lights[shown] = clip_plane(scorer->clip, sizeof(light_pixel), error);
		if (scorer->lights[shown])
			light_from_picture(&scorer->transfer, &picture, scorer->lights[shown]);
	}
	return scorer->lights[shown];
}

static void forget_light(struct scorer *scorer, uint32_t before)
{
	for (uint32_t i = 0; i < before && i < scorer->clip->shown_count; i++) {
		free(scorer->lights[i]);
		scorer->lights[i] = NULL;
	}
}

/* ---- single pictures ---- */

static void score_in_between(struct score *score, const struct clip *clip, const struct clip_shown *shown,
							 const struct picture *picture)
{
	const struct picture truth = wrap(clip, shown->truth);
	const double psnr = measure_psnr(picture, &truth);
	running_add(&score->samples[SCORE_PSNR], psnr);
	running_add(&score->samples[SCORE_SSIM], measure_ssim(picture, &truth));
	score->psnr_min = score->in_betweens ? fmin(score->psnr_min, psnr) : psnr;
	score->in_betweens++;
	json_array_append_new(score->over_time, json_pack("[f, f]", shown->time, psnr));
	if (!shown->regions)
		return;
	struct squared_error moving = {0}, hidden = {0};
	squared_error_add(&moving, picture, &truth, shown->regions, REGION_MOVING);
	squared_error_add(&hidden, picture, &truth, shown->regions, REGION_HIDDEN);
	score->moving.sum += moving.sum;
	score->moving.count += moving.count;
	score->disoccluded.sum += hidden.sum;
	score->disoccluded.count += hidden.count;
	if (moving.count)
		running_add(&score->samples[SCORE_PSNR_MOVING], squared_error_psnr(&moving));
	if (hidden.count)
		running_add(&score->samples[SCORE_PSNR_DISOCCLUDED], squared_error_psnr(&hidden));
}

/* `now` depicts shown[now - late]. */
static void score_change(struct score *score, const struct clip *clip, uint8_t *const *pictures, uint32_t now,
						 uint32_t late)
{
	const struct clip_shown *shown = &clip->shown[now - late], *last = shown - 1;
	if (now == late || !shown->truth || !last->truth || !(shown->scored || last->scored))
		return;
	const struct picture a = wrap(clip, pictures[now - 1]), b = wrap(clip, pictures[now]);
	const struct picture c = wrap(clip, last->truth), d = wrap(clip, shown->truth);
	running_add(&score->samples[SCORE_TPSNR], measure_tpsnr(&a, &b, &c, &d));
}

static void score_detail(struct score *score, const struct clip *clip, const struct clip_real *real,
						 uint8_t *const *pictures)
{
	double in_betweens = 0.0;
	if (real->shown_count < 2 || clip->shown[real->first_shown].request.show != ENGINE_SHOW_REAL)
		return;
	for (uint32_t k = 0; k < real->shown_count; k++) {
		const struct picture picture = wrap(clip, pictures[real->first_shown + k]);
		const double energy = measure_high_frequency(&picture);
		if (k == 0)
			score->detail_real += energy;
		else
			in_betweens += energy / (real->shown_count - 1);
	}
	score->detail_in_between += in_betweens;
}

static bool is_scored(const struct clip *clip, const struct clip_real *real)
{
	for (uint32_t k = 0; k < real->shown_count; k++) {
		if (clip->shown[real->first_shown + k].scored)
			return true;
	}
	return false;
}

static void score_pictures(struct score *score, const struct clip *clip, uint8_t *const *pictures, uint32_t late)
{
	for (uint32_t i = late; i < clip->shown_count; i++) {
		const struct picture picture = wrap(clip, pictures[i]);
		if (clip->shown[i - late].scored)
			score_in_between(score, clip, &clip->shown[i - late], &picture);
		score_change(score, clip, pictures, i, late);
	}
	for (uint32_t i = 0; i < clip->real_count; i++) {
		if (is_scored(clip, &clip->reals[i]))
			score_detail(score, clip, &clip->reals[i], pictures);
	}
}

/* ---- the light of one real frame ---- */

static int score_energy(struct scorer *scorer, struct score *score, const struct clip_real *real, struct error *error)
{
	const struct clip *clip = scorer->clip;
	struct energy_picture pictures[8];
	double luminances[8];
	const struct clip_shown *shown = &clip->shown[real->first_shown];
	const uint32_t first = real->first_shown + scorer->late;
	if (real->shown_count > 8 || !shown->truth || real->shown_count < 2 ||
		first + real->shown_count > clip->shown_count)
		return 0;
	for (uint32_t k = 0; k < real->shown_count; k++) {
		const light_pixel *light = light_of(scorer, first + k, error);
		if (!light)
			return -ENOMEM;
		luminances[k] = light_mean_luminance(light, pixels_of(clip));
		pictures[k] = (struct energy_picture){light, shown[k].motion, shown[k].hidden, REGION_HIDDEN};
	}
	const struct picture truth = wrap(clip, shown->truth);
	light_from_picture(&scorer->transfer, &truth, scorer->seen);
	energy_error_add(&score->energy, scorer->seen, pictures, real->shown_count, clip->width, clip->height);
	running_add(&score->samples[SCORE_RIPPLE], light_ripple(luminances, real->shown_count));
	forget_light(scorer, real->first_shown);
	return 0;
}

/* ---- the pursuit camera ---- */

/* Lets the eye trail the scene by `lag` samples; *used: the last picture it looks at. */
static int see(struct scorer *scorer, const struct clip_site *site, uint32_t lag, uint32_t row_step,
			   struct error *error)
{
	const struct clip *clip = scorer->clip;
	const uint32_t samples = (uint32_t)lround(site->window_s * clip->refresh_hz) * clip->samples;
	memset(scorer->seen, 0, pixels_of(clip) * sizeof(*scorer->seen));
	for (uint32_t i = 0; i < samples; i++) {
		const light_pixel *light = light_of(scorer, site->first_shown + (i + lag) / clip->samples, error);
		if (!light)
			return -ENOMEM;
		const float moment = 2.0f * ((float)i + 0.5f) / (float)samples - 1.0f;
		const struct camera_exposure exposure = {light, moment, 1.0f / (float)samples, row_step};
		camera_expose(&site->path, &exposure, scorer->seen);
	}
	return 0;
}

/* Squared error over some rows of all windows, at one lag. */
static int try_lag(struct scorer *scorer, uint32_t lag, double *sum, struct error *error)
{
	const struct clip *clip = scorer->clip;
	const uint32_t step = clip->height / LAG_ROWS + 1;
	*sum = 0.0;
	for (uint32_t i = 0; i < clip->site_count; i++) {
		const struct clip_site *site = &clip->sites[i];
		struct squared_error rows = {0};
		int result = see(scorer, site, lag, step, error);
		if (result < 0)
			return result;
		for (uint32_t y = 0; y < clip->height; y += step) {
			const size_t at = (size_t)y * clip->width;
			light_to_codes(&scorer->transfer, scorer->seen + at, clip->width, scorer->codes);
			const struct picture seen = {scorer->codes, 0, clip->width, 1},
								 truth = {site->truth + 4 * at, 0, clip->width, 1};
			squared_error_add(&rows, &seen, &truth, site->valid + at, 1);
		}
		*sum += rows.sum;
	}
	return 0;
}

/* The eye finds what it follows: the lag, in samples, at which it sees the display best. */
static int find_lag(struct scorer *scorer, uint32_t *lag, struct error *error)
{
	const struct clip *clip = scorer->clip;
	const struct clip_site *last = &clip->sites[clip->site_count - 1];
	const uint32_t window = (uint32_t)lround(last->window_s * clip->refresh_hz);
	const uint32_t most = (clip->shown_count - last->first_shown - window) * clip->samples;
	const uint32_t coarse = clip->samples > 1 ? clip->samples / 2 : 1;
	double least, sum;
	*lag = coarse;
	int result = try_lag(scorer, coarse, &least, error);
	for (uint32_t step = coarse; step > 0 && result == 0; step /= 2) {
		const uint32_t middle = *lag, reach = step == coarse ? most : step;
		const uint32_t first = middle > reach ? middle - reach : middle % step;
		const uint32_t end = middle + reach < most ? middle + reach : most;
		for (uint32_t candidate = first; candidate <= end && result == 0; candidate += step) {
			if (candidate == middle)
				continue;
			result = try_lag(scorer, candidate, &sum, error);
			if (result == 0 && sum < least * 0.999) {
				least = sum;
				*lag = candidate;
			}
		}
	}
	return result;
}

static void keep_crop(const struct clip *clip, const struct crop *crop, const uint8_t *picture, uint8_t *kept)
{
	for (uint32_t y = 0; y < crop->height; y++)
		memcpy(kept + 4 * (size_t)y * crop->width, picture + 4 * ((size_t)(crop->y + y) * clip->width + crop->x),
			   4 * (size_t)crop->width);
}

/* What cannot be judged is made equal. */
static void blank_invalid(const struct clip *clip, const struct clip_site *site, uint8_t *seen, uint8_t *truth)
{
	memcpy(truth, site->truth, 4 * pixels_of(clip));
	for (size_t i = 0; i < pixels_of(clip); i++) {
		if (!site->valid[i])
			memcpy(seen + 4 * i, truth + 4 * i, 4);
	}
}

static int score_site(struct scorer *scorer, struct score *score, uint32_t index, uint32_t lag, const struct crop *crop,
					  uint8_t *kept, struct error *error)
{
	const struct clip *clip = scorer->clip;
	const struct clip_site *site = &clip->sites[index];
	struct squared_error one = {0};
	int result = see(scorer, site, lag, 1, error);
	if (result < 0)
		return result;
	light_to_codes(&scorer->transfer, scorer->seen, pixels_of(clip), scorer->codes);
	if (crop && crop->site == index)
		keep_crop(clip, crop, scorer->codes, kept);
	blank_invalid(clip, site, scorer->codes, scorer->truth);
	const struct picture seen = wrap(clip, scorer->codes), truth = wrap(clip, scorer->truth);
	squared_error_add(&one, &seen, &truth, site->valid, 1);
	if (!one.count)
		return 0;
	score->perceived.sum += one.sum;
	score->perceived.count += one.count;
	score->sites++;
	running_add(&score->samples[SCORE_PERCEIVED_ERROR], squared_error_root(&one));
	running_add(&score->samples[SCORE_PERCEIVED_PSNR], squared_error_psnr(&one));
	running_add(&score->samples[SCORE_PERCEIVED_SSIM], measure_ssim(&seen, &truth));
	json_array_append_new(score->perceived_over_time, json_pack("[f, f]", site->time, squared_error_psnr(&one)));
	camera_errors_by_speed(&site->path, site->window_s, site->valid, &seen, &truth, score->by_speed);
	return 0;
}

static int score_camera(struct scorer *scorer, struct score *score, const struct crop *crop, uint8_t *kept,
						struct error *error)
{
	const struct clip *clip = scorer->clip;
	uint32_t lag;
	if (clip->site_count == 0)
		return 0;
	int result = find_lag(scorer, &lag, error);
	for (uint32_t i = 0; i < clip->site_count && result == 0; i++)
		result = score_site(scorer, score, i, lag, crop, kept, error);
	if (result == 0)
		running_add(&score->samples[SCORE_PERCEIVED_LAG], 1e3 * lag / (clip->samples * clip->refresh_hz));
	return result;
}

/* ---- a clip ---- */

static int score_all(struct scorer *scorer, struct score *score, const struct crop *crop, uint8_t *seen,
					 struct error *error)
{
	const struct clip *clip = scorer->clip;
	scorer->lights = calloc(clip->shown_count, sizeof(*scorer->lights));
	scorer->seen = clip_plane(clip, sizeof(light_pixel), error);
	scorer->codes = clip_plane(clip, 4, error);
	scorer->truth = clip_plane(clip, 4, error);
	if (!scorer->lights || !scorer->seen || !scorer->codes || !scorer->truth)
		return error_set(error, -ENOMEM, "out of memory");
	score_pictures(score, clip, scorer->pictures, scorer->late);
	int result = score_camera(scorer, score, crop, seen, error);
	for (uint32_t i = 0; i < clip->real_count && result == 0; i++) {
		if (is_scored(clip, &clip->reals[i]))
			result = score_energy(scorer, score, &clip->reals[i], error);
	}
	return result;
}

int scorer_add(struct scorer *scorer, struct score *score, const struct clip *clip, uint8_t *const *pictures,
			   const struct crop *crop, uint8_t *seen, struct error *error)
{
	scorer->clip = clip;
	scorer->pictures = pictures;
	scorer->late = score->lag * clip->reals[0].shown_count;
	int result = score_all(scorer, score, crop, seen, error);
	for (uint32_t i = 0; scorer->lights && i < clip->shown_count; i++)
		free(scorer->lights[i]);
	free(scorer->lights);
	free(scorer->seen);
	free(scorer->codes);
	free(scorer->truth);
	*scorer = (struct scorer){.transfer = scorer->transfer};
	score->clips += result == 0;
	return result;
}
