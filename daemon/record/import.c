/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/record/import.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/record/half.h"
#include "daemon/record/image.h"
#include "daemon/record/pattern.h"
#include "daemon/record/recording.h"

#define SECOND UINT64_C(1000000000)

/* Nanoseconds that `frames` frames take, rounded. */
static uint64_t duration_ns(const struct rate *rate, uint64_t frames)
{
	const unsigned __int128 whole = (unsigned __int128)frames * rate->seconds * SECOND;
	return (uint64_t)((whole + rate->frames / 2) / rate->frames);
}

/* ---- one frame ---- */

#define MAX_PARTS 5

/* A frame while it is put together. */
struct assembly {
	const struct import_params *params;
	struct import_summary *summary;
	struct error *error;
	uint64_t number;
	struct frame frame;
	void *memory[MAX_PARTS];
};

static void assembly_finish(struct assembly *assembly)
{
	for (int i = 0; i < MAX_PARTS; i++)
		free(assembly->memory[i]);
}

/* Takes over `data`, rows without gaps. */
static void add_plane(struct assembly *assembly, uint32_t role, uint32_t format, const struct image *image, void *data)
{
	const uint32_t index = assembly->frame.header.plane_count++;
	const uint64_t stride = (uint64_t)image->width * pursuit_format_bytes(format);
	struct pursuit_plane *plane = &assembly->frame.header.planes[index];
	*plane = (struct pursuit_plane){
		.role = role,
		.format = format,
		.storage = PURSUIT_STORAGE_MEMORY,
		.width = image->width,
		.height = image->height,
		.stride = stride,
		.size = stride * image->height,
	};
	if (role == PURSUIT_ROLE_COLOR)
		plane->transfer.curve = PURSUIT_CURVE_SRGB;
	assembly->memory[index] = data;
	assembly->frame.planes[index] = data;
}

static int out_of_memory(const struct assembly *assembly)
{
	return error_set(assembly->error, -ENOMEM, "frame %" PRIu64 ": out of memory", assembly->number);
}

static int read_part(const struct assembly *assembly, const char *pattern, enum image_want want, struct image *image)
{
	char name[PATTERN_MAX_PATH];
	if (!pattern_name(pattern, assembly->number, name))
		return error_set(assembly->error, -EINVAL, "%s: number is %" PRIu64 ", must be at most %u", pattern,
						 assembly->number, PATTERN_MAX_NUMBER);
	return image_read(name, want, 0, image, assembly->error);
}

/* Colour, or a plane that must have its size. */
static int check_same_size(const struct assembly *assembly, const char *pattern, const struct image *image)
{
	char name[PATTERN_MAX_PATH];
	const struct import_summary *summary = assembly->summary;
	if (image->width == summary->width && image->height == summary->height)
		return 0;
	pattern_name(pattern, assembly->number, name);
	return error_set(assembly->error, -EINVAL, "%s: size is %ux%u, must be %ux%u as in the first colour image", name,
					 image->width, image->height, summary->width, summary->height);
}

static int add_color(struct assembly *assembly)
{
	struct image image;
	int result = read_part(assembly, assembly->params->color, IMAGE_BGRA, &image);
	if (result < 0)
		return result;
	if (assembly->summary->width == 0) {
		assembly->summary->width = image.width;
		assembly->summary->height = image.height;
	}
	result = check_same_size(assembly, assembly->params->color, &image);
	if (result == 0) {
		add_plane(assembly, PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8, &image, image.bgra);
		image.bgra = NULL;
	}
	image_finish(&image);
	return result;
}

static int add_ui(struct assembly *assembly)
{
	struct image image;
	int result = read_part(assembly, assembly->params->ui, IMAGE_BGRA, &image);
	if (result < 0)
		return result;
	for (size_t i = 0; !image.premultiplied && i < (size_t)image.width * image.height; i++)
		for (int c = 0; c < 3; c++)
			image.bgra[4 * i + c] = (uint8_t)((image.bgra[4 * i + c] * image.bgra[4 * i + 3] + 127) / 255);
	result = check_same_size(assembly, assembly->params->ui, &image);
	if (result == 0) {
		add_plane(assembly, PURSUIT_ROLE_UI, PURSUIT_FORMAT_BGRA8, &image, image.bgra);
		image.bgra = NULL;
	}
	image_finish(&image);
	return result;
}

/* First channel alone, as floats or as whole codes. */
static int add_single(struct assembly *assembly, const char *pattern, uint32_t role)
{
	struct image image;
	const int result = read_part(assembly, pattern, IMAGE_VALUES, &image);
	if (result < 0)
		return result;
	const size_t count = (size_t)image.width * image.height;
	uint32_t *data = malloc(count * sizeof(*data));
	for (size_t i = 0; data && i < count; i++) {
		const float value = image.values[i * image.channels];
		const float code = value * image.scale;
		if (role == PURSUIT_ROLE_DEPTH)
			memcpy(&data[i], &value, sizeof(value));
		else
			data[i] = code > 0.0f && code < 4294967040.0f ? (uint32_t)(code + 0.5f) : 0;
	}
	if (data)
		add_plane(assembly, role, role == PURSUIT_ROLE_DEPTH ? PURSUIT_FORMAT_DEPTH32F : PURSUIT_FORMAT_R32UI, &image,
				  data);
	image_finish(&image);
	return data ? 0 : out_of_memory(assembly);
}

static bool half_is_exact(const float *values, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		const float back = half_to_float(half_from_float(values[i]));
		if (back != values[i] && !(isnan(back) && isnan(values[i])))
			return false;
	}
	return true;
}

static void motion_in_pixels(const struct assembly *assembly, const struct image *image, float *motion)
{
	const bool ndc = assembly->params->motion_in_ndc;
	/* Normalised device coordinates are 2 across the picture, and their y runs up. */
	const float x_scale = ndc ? (float)assembly->summary->width / 2.0f : 1.0f;
	const float y_scale = ndc ? -(float)assembly->summary->height / 2.0f : 1.0f;
	for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
		motion[2 * i] = image->values[i * image->channels] * x_scale;
		motion[2 * i + 1] = image->values[i * image->channels + 1] * y_scale;
	}
}

static int add_motion(struct assembly *assembly)
{
	struct image image;
	int result = read_part(assembly, assembly->params->motion, IMAGE_VALUES, &image);
	if (result < 0)
		return result;
	const size_t count = 2 * (size_t)image.width * image.height;
	float *motion = malloc(count * sizeof(*motion));
	if (image.channels < 2) {
		result = error_set(assembly->error, -EINVAL, "%s: frame %" PRIu64 ": channels is %u, must be 2 (x and y)",
						   assembly->params->motion, assembly->number, image.channels);
	} else if (!motion) {
		result = out_of_memory(assembly);
	} else {
		motion_in_pixels(assembly, &image, motion);
		const bool half = half_is_exact(motion, count);
		/* In place: a half is written where its float was read, or before. */
		for (size_t i = 0; half && i < count; i++) {
			const uint16_t value = half_from_float(motion[i]);
			memcpy((uint8_t *)motion + 2 * i, &value, sizeof(value));
		}
		assembly->summary->half_motion += half;
		add_plane(assembly, PURSUIT_ROLE_MOTION, half ? PURSUIT_FORMAT_RG16F : PURSUIT_FORMAT_RG32F, &image, motion);
		motion = NULL;
	}
	free(motion);
	image_finish(&image);
	return result;
}

static bool given(const char *pattern, uint64_t number)
{
	return pattern && pattern_exists(pattern, number);
}

/* Planes that exist for this number. A frame of which none but colour exists, though others do, is truth only. */
static int add_planes(struct assembly *assembly)
{
	const struct import_params *params = assembly->params;
	struct pursuit_frame_header *header = &assembly->frame.header;
	const bool depth = given(params->depth, assembly->number), motion = given(params->motion, assembly->number);
	int result = add_color(assembly);

	if (result == 0 && depth) {
		header->depth_kind = params->depth_kind ? params->depth_kind : PURSUIT_DEPTH_DEVICE;
		result = add_single(assembly, params->depth, PURSUIT_ROLE_DEPTH);
	}
	if (result == 0 && motion) {
		header->motion_kind = params->motion_kind ? params->motion_kind : PURSUIT_MOTION_BACKWARD;
		result = add_motion(assembly);
	}
	if (result == 0 && given(params->ui, assembly->number))
		result = add_ui(assembly);
	if (result == 0 && given(params->object_id, assembly->number))
		result = add_single(assembly, params->object_id, PURSUIT_ROLE_OBJECT_ID);
	if ((params->depth || params->motion) && !depth && !motion)
		header->flags |= PURSUIT_FRAME_TRUTH_ONLY;
	return result;
}

/* ---- the sequence ---- */

static int write_frame(struct recording_writer *writer, struct assembly *assembly, uint64_t *previous_real_ns)
{
	const struct import_params *params = assembly->params;
	struct import_summary *summary = assembly->summary;
	struct pursuit_frame_header *header = &assembly->frame.header;
	const uint32_t span = params->motion_span ? params->motion_span : 1;
	/* Only for frame_validate(): the planes are not in one block. */
	struct pursuit_frame_header laid_out;

	header->frame_id = assembly->number - summary->first + 1;
	header->time_ns = SECOND + duration_ns(&params->rate, assembly->number - summary->first);
	header->real_interval_ns = *previous_real_ns ? header->time_ns - *previous_real_ns : 0;
	header->near_distance = params->near_distance;
	header->far_distance = params->far_distance;
	int result = add_planes(assembly);
	if (result < 0)
		return result;
	header->motion_interval_ns = header->motion_kind ? duration_ns(&params->rate, span) : 0;
	laid_out = *header;
	const uint64_t bytes = frame_layout(&laid_out);
	result = frame_validate(&laid_out, bytes, NULL, NULL, assembly->error);
	if (result == 0)
		result = recording_writer_frame(writer, &assembly->frame, header->time_ns, assembly->error);
	if (header->flags & PURSUIT_FRAME_TRUTH_ONLY)
		summary->truth_only++;
	else
		*previous_real_ns = header->time_ns;
	summary->frames++;
	return result;
}

static int find_range(const struct import_params *params, struct import_summary *summary, struct error *error)
{
	summary->first = params->first;
	summary->last = params->last;
	if (!params->has_range)
		return pattern_range(params->color, &summary->first, &summary->last, error);
	if (params->last < params->first || params->last > PATTERN_MAX_NUMBER)
		return error_set(error, -EINVAL, "last is %" PRIu64 ", must be %" PRIu64 " (first) to %u", params->last,
						 params->first, PATTERN_MAX_NUMBER);
	return 0;
}

/* A pattern that fits no file at all is a slip, not a sequence without depth. */
static int check_any_exists(const char *pattern, const struct import_summary *summary, struct error *error)
{
	if (!pattern)
		return 0;
	for (uint64_t number = summary->first; number <= summary->last; number++)
		if (pattern_exists(pattern, number))
			return 0;
	return error_set(error, -ENOENT,
					 "%s: no such file with a number from %" PRIu64 " to %" PRIu64 ": check the pattern", pattern,
					 summary->first, summary->last);
}

static int check_params(const struct import_params *params, struct import_summary *summary, struct error *error)
{
	const char *const patterns[] = {params->color, params->depth, params->motion, params->ui, params->object_id};
	static const char *const options[] = {"--color", "--depth", "--motion", "--ui", "--object-id"};
	int result = 0;
	for (size_t i = 0; result == 0 && i < sizeof(patterns) / sizeof(patterns[0]); i++)
		if (patterns[i])
			result = pattern_check(options[i], patterns[i], error);
	if (result == 0)
		result = find_range(params, summary, error);
	for (size_t i = 1; result == 0 && i < sizeof(patterns) / sizeof(patterns[0]); i++)
		result = check_any_exists(patterns[i], summary, error);
	return result;
}

static struct recording_writer *create_writer(const struct import_params *params, const struct import_summary *summary,
											  const char *path, struct error *error)
{
	char info[256];
	snprintf(info, sizeof(info),
			 "program=pursuit import\nfps=%" PRIu64 "/%" PRIu64 "\nnumber_offset=%" PRIu64 "\nmotion_span=%u\n",
			 params->rate.frames, params->rate.seconds, summary->first, params->motion_span ? params->motion_span : 1);
	const struct recording_writer_params writer = {.path = path, .info = info};
	return recording_writer_create(&writer, error);
}

/* Where it is written until it is whole: beside its place, unless that is a pipe or a device. To be freed. */
static char *unfinished_path(const char *path)
{
	struct stat stat;
	const bool is_file = lstat(path, &stat) < 0 || S_ISREG(stat.st_mode);
	char *unfinished = NULL;
	return asprintf(&unfinished, "%s%s", path, is_file ? ".part" : "") < 0 ? NULL : unfinished;
}

static void remove_regular(const char *path)
{
	struct stat stat;
	if (lstat(path, &stat) == 0 && S_ISREG(stat.st_mode))
		unlink(path);
}

static int write_all(const struct import_params *params, const char *path, struct import_summary *summary,
					 struct error *error)
{
	uint64_t previous_real_ns = 0, frames;
	struct error closing = {""};
	int result = 0;
	struct recording_writer *writer = create_writer(params, summary, path, error);
	if (!writer)
		return -EIO;
	for (uint64_t number = summary->first; result == 0 && number <= summary->last; number++) {
		struct assembly assembly = {.params = params, .summary = summary, .error = error, .number = number};
		result = write_frame(writer, &assembly, &previous_real_ns);
		assembly_finish(&assembly);
	}
	recording_writer_counts(writer, &summary->bytes, &frames);
	const int closed = recording_writer_close(&writer, result < 0 ? &closing : error);
	result = result < 0 ? result : closed;
	if (result < 0)
		remove_regular(path);
	return result;
}

int import_run(const struct import_params *params, struct import_summary *summary, struct error *error)
{
	*summary = (struct import_summary){0};
	int result = check_params(params, summary, error);
	if (result < 0)
		return result;
	char *path = unfinished_path(params->path);
	if (!path)
		return error_set(error, -ENOMEM, "%s: out of memory", params->path);
	result = write_all(params, path, summary, error);
	if (result == 0 && strcmp(path, params->path) != 0 && rename(path, params->path) < 0)
		result = error_set(error, -errno, "%s: cannot be renamed to %s: %s", path, params->path, strerror(errno));
	free(path);
	return result;
}
