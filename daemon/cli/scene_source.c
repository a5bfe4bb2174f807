/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "scene_source.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "gl_context.h"
#include "pixel.h"

struct scene_source {
	struct scene_source_params params;
	struct gl_context *context;
	struct scene *scene;
	struct scene *fine;         /* of many samples a pixel, for colour and UI; NULL: `scene` serves */
	uint8_t *fine_pixels;       /* room for a picture of it */
	struct scene_pixels pixels; /* what is read back, packed */
	uint8_t *planes;            /* laid out as the header of the frame says */
	uint64_t planes_bytes;
	bool has_no_ui; /* as seen last: then colour needs `fine` alone */
};

uint64_t scene_source_time(const struct arg_rate *rate, uint64_t index)
{
	uint64_t whole = index / rate->numerator, rest = index % rate->numerator;
	uint64_t period = UINT64_C(1000000000) * rate->denominator;
	return whole * period + (uint64_t)((unsigned __int128)rest * period / rate->numerator);
}

void scene_source_names(const char *names[SCENE_SOURCE_NAMES])
{
	size_t count = 0;
	for (const struct scene_info *scene = scene_list(); scene->name; scene++) {
		assert(count + 1 < SCENE_SOURCE_NAMES);
		names[count++] = scene->name;
	}
	names[count] = NULL;
}

void scene_source_unknown(const char *name, struct error *error)
{
	size_t used = (size_t)snprintf(error->text, sizeof(error->text), "there is no scene %.60s; there are", name);
	for (const struct scene_info *scene = scene_list(); scene->name && used < sizeof(error->text); scene++)
		used += (size_t)snprintf(error->text + used, sizeof(error->text) - used, " %s", scene->name);
}

static bool allocate(struct scene_source *source)
{
	size_t pixels = (size_t)source->params.size.width * source->params.size.height;
	source->pixels.color = malloc(pixels * 4);
	source->pixels.ui = malloc(pixels * 4);
	source->pixels.depth = malloc(pixels * sizeof(float));
	float *motion = malloc(pixels * 2 * sizeof(float));
	*(source->params.forward ? &source->pixels.forward : &source->pixels.backward) = motion;
	if (source->params.object_id)
		source->pixels.object_id = malloc(pixels * sizeof(uint32_t));
	return source->pixels.color && source->pixels.ui && source->pixels.depth && motion &&
		   (!source->params.object_id || source->pixels.object_id);
}

static bool create_fine(struct scene_source *source, struct error *error)
{
	const struct scene_source_params *params = &source->params;
	const uint32_t width = params->size.width * params->antialias, height = params->size.height * params->antialias;
	if (params->antialias < 2)
		return true;
	source->fine = scene_create(params->scene, width, height, gl_context_get_lookup(source->context), error->text,
								sizeof(error->text));
	if (!source->fine)
		return false;
	source->fine_pixels = malloc(4 * (size_t)width * height);
	return source->fine_pixels || error_set(error, -ENOMEM, "out of memory for pictures of %ux%u", width, height) == 0;
}

static void release_pixels(struct scene_source *source)
{
	scene_pixels_finish(&source->pixels);
	free(source->fine_pixels);
	source->fine_pixels = NULL;
}

struct scene_source *scene_source_create(const struct scene_source_params *params, struct error *error)
{
	if (!scene_exists(params->scene)) {
		scene_source_unknown(params->scene, error);
		return NULL;
	}
	struct scene_source *source = calloc(1, sizeof(*source));
	if (!source) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	source->params = *params;
	source->params.color_format = params->color_format ? params->color_format : PURSUIT_FORMAT_BGRA8;
	source->params.depth_format = params->depth_format ? params->depth_format : PURSUIT_FORMAT_DEPTH32F;
	source->params.motion_format = params->motion_format ? params->motion_format : PURSUIT_FORMAT_RG16F;
	source->context = gl_context_create(error);
	if (source->context) {
		source->scene = scene_create(params->scene, params->size.width, params->size.height,
									 gl_context_get_lookup(source->context), error->text, sizeof(error->text));
		if (source->scene && allocate(source)) {
			if (create_fine(source, error))
				return source;
		} else if (source->scene)
			error_set(error, -ENOMEM, "out of memory for pictures of %ux%u", params->size.width, params->size.height);
	}
	scene_source_destroy(&source);
	return NULL;
}

void scene_source_destroy(struct scene_source **source)
{
	if (!source || !*source)
		return;
	struct scene_source *old = *source;
	if (old->scene && gl_context_make_current(old->context)) {
		scene_destroy(&old->scene);
		if (old->fine)
			scene_destroy(&old->fine);
	}
	gl_context_destroy(&old->context);
	release_pixels(old);
	free(old->planes);
	free(old);
	*source = NULL;
}

bool scene_source_resize(struct scene_source *source, const struct arg_size *size, struct error *error)
{
	assert(!source->fine);
	source->params.size = *size;
	release_pixels(source);
	if (!gl_context_make_current(source->context))
		return error_set(error, -EIO, "the GL context of the scene is lost") == 0;
	if (!scene_resize(source->scene, size->width, size->height, error->text, sizeof(error->text)))
		return false;
	return allocate(source) ||
		   error_set(error, -ENOMEM, "out of memory for pictures of %ux%u", size->width, size->height) == 0;
}

static void add_plane(struct pursuit_frame_header *header, uint32_t role, uint32_t format, const struct arg_size *size)
{
	struct pursuit_plane *plane = &header->planes[header->plane_count++];
	plane->role = role;
	plane->format = format;
	plane->storage = PURSUIT_STORAGE_MEMORY;
	plane->width = size->width;
	plane->height = size->height;
	if (role == PURSUIT_ROLE_COLOR || role == PURSUIT_ROLE_UI)
		plane->transfer.curve = format == PURSUIT_FORMAT_RGBA16F ? PURSUIT_CURVE_LINEAR : PURSUIT_CURVE_SRGB;
}

static void describe(const struct scene_source *source, uint64_t index, const struct scene_camera *camera, bool has_ui,
					 struct pursuit_frame_header *header)
{
	const struct scene_source_params *params = &source->params;
	uint64_t time = scene_source_time(&params->rate, index);
	*header = (struct pursuit_frame_header){
		.frame_id = index + 1,
		.time_ns = SCENE_SOURCE_EPOCH_NS + time,
		.submit_ns = SCENE_SOURCE_EPOCH_NS + time,
		.real_interval_ns =
			index ? time - scene_source_time(&params->rate, index - 1) : scene_source_time(&params->rate, 1),
		.flags = PURSUIT_FRAME_MATRICES | (camera->cut && index ? PURSUIT_FRAME_CUT : 0u),
		.motion_kind = params->forward ? PURSUIT_MOTION_FORWARD : PURSUIT_MOTION_BACKWARD,
		.depth_kind = PURSUIT_DEPTH_DEVICE,
		.near_distance = camera->near_distance,
		.far_distance = camera->far_distance,
	};
	memcpy(header->view_projection, camera->view_projection, sizeof(header->view_projection));
	memcpy(header->previous_view_projection, camera->previous_view_projection,
		   sizeof(header->previous_view_projection));
	add_plane(header, PURSUIT_ROLE_COLOR, params->color_format, &params->size);
	add_plane(header, PURSUIT_ROLE_DEPTH, params->depth_format, &params->size);
	add_plane(header, PURSUIT_ROLE_MOTION, params->motion_format, &params->size);
	if (has_ui)
		add_plane(header, PURSUIT_ROLE_UI, PURSUIT_FORMAT_BGRA8, &params->size);
	if (params->object_id)
		add_plane(header, PURSUIT_ROLE_OBJECT_ID, PURSUIT_FORMAT_R32UI, &params->size);
}

static void write_row(const struct scene_source *source, const struct pursuit_plane *plane, uint32_t y, uint8_t *row)
{
	size_t at = (size_t)y * plane->width;
	const float *motion = source->params.forward ? source->pixels.forward : source->pixels.backward;
	switch (plane->role) {
	case PURSUIT_ROLE_COLOR:
		pixel_write_color(plane->format, source->pixels.color + 4 * at, plane->width, row);
		break;
	case PURSUIT_ROLE_DEPTH:
		pixel_write_depth(plane->format, source->pixels.depth + at, plane->width, row);
		break;
	case PURSUIT_ROLE_MOTION:
		pixel_write_motion(plane->format, motion + 2 * at, plane->width, row);
		break;
	case PURSUIT_ROLE_UI:
		memcpy(row, source->pixels.ui + 4 * at, 4 * (size_t)plane->width);
		break;
	default:
		memcpy(row, source->pixels.object_id + at, 4 * (size_t)plane->width);
	}
}

static bool render(struct scene_source *source, const struct scene_request *request, bool *has_ui,
				   struct scene_camera *camera)
{
	struct scene_textures textures;
	if (!gl_context_make_current(source->context))
		return false;
	if (!scene_render(source->scene, request, &textures, camera))
		return false;
	*has_ui = textures.ui != 0;
	return true;
}

/* Colour and UI of many samples instead of those that `scene` gave. */
static bool read_fine(struct scene_source *source, const struct scene_request *request,
					  const struct scene_pixels *wanted)
{
	const struct scene_request still = {.time = request->time, .time_previous = request->time};
	const struct scene_source_params *params = &source->params;
	if (!source->fine || !wanted->color)
		return true;
	if (!scene_render(source->fine, &still, NULL, NULL))
		return false;
	if (!scene_read(source->fine, &(struct scene_pixels){.color = source->fine_pixels}))
		return false;
	pixel_shrink(source->fine_pixels, params->antialias, params->size.width, params->size.height, wanted->color);
	if (!wanted->ui)
		return true;
	if (!scene_read(source->fine, &(struct scene_pixels){.ui = source->fine_pixels}))
		return false;
	pixel_shrink(source->fine_pixels, params->antialias, params->size.width, params->size.height, wanted->ui);
	return true;
}

bool scene_source_render(struct scene_source *source, double time, double time_previous,
						 struct scene_textures *textures, struct scene_camera *camera)
{
	const struct scene_request request = {.time = time, .time_previous = time_previous, .time_next = time};
	return gl_context_make_current(source->context) && scene_render(source->scene, &request, textures, camera);
}

void scene_source_key(struct scene_source *source, double time, int key)
{
	scene_key(source->scene, time, key);
	if (source->fine)
		scene_key(source->fine, time, key);
}

bool scene_source_get_score(const struct scene_source *source, double time, struct scene_score *score)
{
	return scene_get_score(source->scene, time, score);
}

scene_gl_lookup scene_source_lookup(const struct scene_source *source)
{
	return gl_context_get_lookup(source->context);
}

const char *scene_source_renderer(struct scene_source *source, bool *software)
{
	gl_context_make_current(source->context);
	return gl_context_renderer(source->context, software);
}

bool scene_source_frame(struct scene_source *source, uint64_t index, struct frame *frame)
{
	const struct arg_rate *rate = &source->params.rate;
	double step = (double)rate->denominator / (double)rate->numerator, time = (double)index * step;
	struct scene_request request = {time, time - step, time + step, source->params.forward};
	struct scene_camera camera;
	bool has_ui;
	if (!render(source, &request, &has_ui, &camera))
		return false;
	struct scene_pixels wanted = source->pixels;
	wanted.ui = has_ui ? wanted.ui : NULL;
	if (!scene_read(source->scene, &wanted) || !read_fine(source, &request, &wanted))
		return false;
	*frame = (struct frame){.intake_ns = 0};
	describe(source, index, &camera, has_ui, &frame->header);
	uint64_t bytes = frame_layout(&frame->header);
	if (bytes > source->planes_bytes) {
		free(source->planes);
		source->planes = aligned_alloc(64, (bytes + 63) / 64 * 64);
		source->planes_bytes = source->planes ? bytes : 0;
	}
	if (!bytes || !source->planes)
		return false;
	memset(source->planes, 0, bytes);
	for (uint32_t i = 0; i < frame->header.plane_count; i++) {
		const struct pursuit_plane *plane = &frame->header.planes[i];
		frame->planes[i] = source->planes + plane->offset;
		for (uint32_t y = 0; y < plane->height; y++)
			write_row(source, plane, y, source->planes + plane->offset + y * plane->stride);
	}
	return true;
}

static void put_ui(const struct scene_source *source, size_t pixel, const struct scene_pixels *wanted)
{
	if (wanted->color)
		pixel_composite(wanted->color + 4 * pixel, source->pixels.ui + 4 * pixel, 1);
	if (source->pixels.ui[4 * pixel + 3] < 128)
		return;
	if (wanted->backward)
		memset(wanted->backward + 2 * pixel, 0, 2 * sizeof(float));
	if (wanted->forward)
		memset(wanted->forward + 2 * pixel, 0, 2 * sizeof(float));
	if (wanted->object_id)
		wanted->object_id[pixel] = SCENE_SOURCE_UI_OBJECT;
}

bool scene_source_moment(struct scene_source *source, const struct scene_request *request,
						 const struct scene_pixels *wanted)
{
	struct scene_camera camera;
	struct scene_pixels read = *wanted;
	bool has_ui;
	const bool geometry = wanted->depth || wanted->backward || wanted->forward || wanted->object_id;
	if (source->fine && !geometry && source->has_no_ui)
		return gl_context_make_current(source->context) && read_fine(source, request, wanted);
	if (!render(source, request, &has_ui, &camera))
		return false;
	source->has_no_ui = !has_ui;
	read.ui = has_ui ? source->pixels.ui : NULL;
	if (!scene_read(source->scene, &read) || !read_fine(source, request, &read))
		return false;
	size_t pixels = (size_t)source->params.size.width * source->params.size.height;
	for (size_t i = 0; has_ui && i < pixels; i++)
		put_ui(source, i, wanted);
	for (size_t i = 0; wanted->color && i < pixels; i++)
		wanted->color[4 * i + 3] = 255;
	return true;
}

bool scene_source_truth(struct scene_source *source, double time, uint8_t *picture)
{
	const struct scene_request request = {.time = time, .time_previous = time, .time_next = time};
	return scene_source_moment(source, &request, &(struct scene_pixels){.color = picture});
}
