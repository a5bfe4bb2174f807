/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report_clip.h"

/* Pictures a second of the truth that the pursuit camera sees. */
#define TRUTH_HZ 960.0

struct maker {
	struct scene_source *source;
	const struct clip_scene_params *params;
	struct clip *clip;
	struct light_transfer transfer;
	uint32_t *ids_here, *ids_there;
	float *motion_here;
	light_pixel *light, *seen;
	uint8_t *codes;
};

static int failed(struct error *error)
{
	return error_set(error, -EIO, "the scene could not be rendered");
}

static double time_of(const struct maker *maker, uint32_t shown)
{
	return ((double)maker->params->first * maker->params->n + shown) / maker->params->refresh_hz;
}

/* scene_read() gives position now minus then; here it is where the pixel goes. */
static void turn(float *motion, size_t pixels)
{
	for (size_t i = 0; i < 2 * pixels; i++)
		motion[i] = -motion[i];
}

static int read_moment(struct maker *maker, double time, double other, const struct scene_pixels *wanted,
					   struct error *error)
{
	const struct scene_request request = {.time = time, .time_previous = other, .time_next = other};
	if (!scene_source_moment(maker->source, &request, wanted))
		return failed(error);
	if (wanted->backward)
		turn(wanted->backward, (size_t)maker->clip->width * maker->clip->height);
	return 0;
}

/* Truth, and where each pixel of the real frame goes until then. */
static int make_in_between(struct maker *maker, struct clip_shown *shown, double real_time, struct error *error)
{
	struct clip *clip = maker->clip;
	shown->regions = clip_plane(clip, 1, error);
	shown->hidden = clip_plane(clip, 1, error);
	shown->motion = clip_plane(clip, 2 * sizeof(float), error);
	if (!shown->regions || !shown->hidden || !shown->motion)
		return -ENOMEM;
	const struct scene_pixels here = {
		.color = shown->truth, .backward = maker->motion_here, .object_id = maker->ids_here};
	const struct scene_pixels there = {.backward = shown->motion, .object_id = maker->ids_there};
	int result = read_moment(maker, shown->time, real_time, &here, error);
	if (result == 0)
		result = read_moment(maker, real_time, shown->time, &there, error);
	const struct region_view view_here = {maker->motion_here, maker->ids_here, NULL};
	const struct region_view view_there = {shown->motion, maker->ids_there, NULL};
	regions_find(&view_here, &view_there, clip->width, clip->height, shown->regions);
	regions_find(&view_there, &view_here, clip->width, clip->height, shown->hidden);
	return result;
}

static int make_shown(struct maker *maker, uint32_t index, struct error *error)
{
	struct clip *clip = maker->clip;
	struct clip_shown *shown = &clip->shown[index];
	uint32_t real = index / maker->params->n, k = index % maker->params->n;
	shown->time = time_of(maker, index);
	shown->request.show = k ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL;
	shown->request.phase = (double)k / maker->params->n;
	shown->scored = k && real > 0 && real + 1 < clip->real_count;
	shown->truth = clip_plane(clip, 4, error);
	if (!shown->truth)
		return -ENOMEM;
	if (k)
		return make_in_between(maker, shown, time_of(maker, index - k), error);
	return read_moment(maker, shown->time, shown->time, &(struct scene_pixels){.color = shown->truth}, error);
}

static int make_real(struct maker *maker, uint32_t index, struct error *error)
{
	struct clip_real *real = &maker->clip->reals[index];
	const struct clip_scene_params *params = maker->params;
	struct frame frame;
	if (!scene_source_frame(maker->source, params->first + index, &frame))
		return failed(error);
	if (index == 0)
		frame.header.flags |= PURSUIT_FRAME_CUT; /* whatever an engine played before */
	real->first_shown = index * params->n;
	real->shown_count = params->n;
	real->begin = (struct engine_begin_params){
		.n = params->n,
		.last_phase = (params->n - 1.0) / params->n,
		.real_interval_ns = frame.header.real_interval_ns,
	};
	int result = clip_keep_frame(real, &frame, error);
	for (uint32_t k = 0; k < params->n && result == 0; k++)
		result = make_shown(maker, index * params->n + k, error);
	return result;
}

/* What the camera sees of the truth: a picture for each of its samples. */
static int see_truth(struct maker *maker, struct clip_site *site, struct error *error)
{
	struct clip *clip = maker->clip;
	const size_t pixels = (size_t)clip->width * clip->height;
	const uint32_t samples = clip->samples * maker->params->n;
	const struct picture picture = {maker->codes, 4 * (size_t)clip->width, clip->width, clip->height};
	memset(maker->seen, 0, pixels * sizeof(*maker->seen));
	for (uint32_t i = 0; i < samples; i++) {
		const double part = (i + 0.5) / samples;
		if (!scene_source_truth(maker->source, site->time + part * site->window_s, maker->codes))
			return failed(error);
		light_from_picture(&maker->transfer, &picture, maker->light);
		const struct camera_exposure exposure = {maker->light, (float)(2.0 * part - 1.0), 1.0f / (float)samples, 1};
		camera_expose(&site->path, &exposure, maker->seen);
	}
	light_to_codes(&maker->transfer, maker->seen, pixels, site->truth);
	return 0;
}

static int make_site(struct maker *maker, uint32_t index, struct error *error)
{
	struct clip *clip = maker->clip;
	struct clip_site *site = &clip->sites[index];
	site->first_shown = (index + 1) * maker->params->n;
	site->time = time_of(maker, site->first_shown);
	site->window_s = maker->params->n / maker->params->refresh_hz;
	site->path = (struct camera_path){clip->width, clip->height, clip_plane(clip, 2 * sizeof(float), error),
									  clip_plane(clip, 2 * sizeof(float), error)};
	site->valid = clip_plane(clip, 1, error);
	site->truth = clip_plane(clip, 4, error);
	if (!site->path.before || !site->path.after || !site->valid || !site->truth)
		return -ENOMEM;
	const double middle = site->time + site->window_s / 2;
	int result = read_moment(maker, middle, site->time, &(struct scene_pixels){.backward = site->path.before}, error);
	if (result == 0)
		result = read_moment(maker, middle, site->time + site->window_s,
							 &(struct scene_pixels){.backward = site->path.after}, error);
	if (result < 0)
		return result;
	camera_path_damp(&site->path, site->window_s, maker->params->degrees_per_pixel);
	camera_path_valid(&site->path, site->valid);
	return see_truth(maker, site, error);
}

static bool maker_init(struct maker *maker, struct error *error)
{
	const struct clip *clip = maker->clip;
	light_transfer_init(&maker->transfer, maker->params->gamma);
	maker->ids_here = clip_plane(clip, 4, error);
	maker->ids_there = clip_plane(clip, 4, error);
	maker->motion_here = clip_plane(clip, 8, error);
	maker->light = clip_plane(clip, sizeof(light_pixel), error);
	maker->seen = clip_plane(clip, sizeof(light_pixel), error);
	maker->codes = clip_plane(clip, 4, error);
	return maker->ids_here && maker->ids_there && maker->motion_here && maker->light && maker->seen && maker->codes;
}

static void maker_finish(struct maker *maker)
{
	free(maker->ids_here);
	free(maker->ids_there);
	free(maker->motion_here);
	free(maker->light);
	free(maker->seen);
	free(maker->codes);
	free(maker);
}

static int make_all(struct maker *maker, struct error *error)
{
	int result = 0;
	for (uint32_t i = 0; i < maker->clip->real_count && result == 0; i++)
		result = make_real(maker, i, error);
	for (uint32_t i = 0; i < maker->clip->site_count && result == 0; i++)
		result = make_site(maker, i, error);
	return result;
}

struct clip *clip_of_scene(struct scene_source *source, const struct arg_size *size,
						   const struct clip_scene_params *params, struct error *error)
{
	struct maker *maker = calloc(1, sizeof(*maker));
	if (!maker) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	maker->source = source;
	maker->params = params;
	maker->clip =
		clip_create(size->width, size->height, params->reals, params->reals * params->n, params->reals - 3, error);
	if (maker->clip) {
		maker->clip->refresh_hz = params->refresh_hz;
		maker->clip->samples = (uint32_t)fmax(1.0, round(TRUTH_HZ / params->refresh_hz));
		if (!maker_init(maker, error) || make_all(maker, error) < 0)
			clip_destroy(&maker->clip);
	}
	struct clip *clip = maker->clip;
	maker_finish(maker);
	return clip;
}
