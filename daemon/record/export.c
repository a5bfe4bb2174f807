/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/record/export.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/record/half.h"
#include "daemon/record/image.h"
#include "daemon/record/pattern.h"
#include "daemon/record/recording.h"
#include "daemon/record/y4m.h"

struct export_job {
	const struct export_params *params;
	struct export_summary *summary;
	struct error *error;
	struct recording_reader *reader;
	struct y4m *video;
	uint32_t video_width, video_height;
};

/* ---- one plane ---- */

static uint8_t code_from_float(const struct pursuit_plane *plane, float value)
{
	if (plane->transfer.curve == PURSUIT_CURVE_LINEAR)
		return image_encode_srgb(value);
	return (uint8_t)(fminf(fmaxf(value, 0.0f), 1.0f) * 255.0f + 0.5f);
}

/* One pixel as BGRA8: 8-bit codes as they are, wider ones rounded, linear light with the sRGB curve. */
static void load_bgra(const struct pursuit_plane *plane, const uint8_t *from, uint8_t to[4])
{
	uint32_t packed;
	uint16_t halves[4];
	switch (plane->format) {
	case PURSUIT_FORMAT_BGRA8:
		memcpy(to, from, 4);
		return;
	case PURSUIT_FORMAT_RGBA8:
		to[0] = from[2];
		to[1] = from[1];
		to[2] = from[0];
		to[3] = from[3];
		return;
	case PURSUIT_FORMAT_RGB10A2:
		memcpy(&packed, from, sizeof(packed));
		for (unsigned c = 0; c < 3; c++)
			to[2 - c] = code_from_float(plane, (float)(packed >> 10 * c & 1023u) / 1023.0f);
		to[3] = (uint8_t)((packed >> 30) * 85);
		return;
	default:
		memcpy(halves, from, sizeof(halves));
		for (unsigned c = 0; c < 3; c++)
			to[2 - c] = code_from_float(plane, half_to_float(halves[c]));
		to[3] = (uint8_t)(fminf(fmaxf(half_to_float(halves[3]), 0.0f), 1.0f) * 255.0f + 0.5f);
	}
}

/* A colour plane, rows without gaps; the caller frees it. */
static uint8_t *plane_bgra(const struct frame *frame, int index)
{
	const struct pursuit_plane *plane = &frame->header.planes[index];
	const size_t bytes = pursuit_format_bytes(plane->format);
	uint8_t *bgra = malloc((size_t)plane->width * plane->height * 4);
	for (uint32_t y = 0; bgra && y < plane->height; y++)
		for (uint32_t x = 0; x < plane->width; x++)
			load_bgra(plane, frame->planes[index] + y * plane->stride + x * bytes,
					  bgra + 4 * ((size_t)y * plane->width + x));
	return bgra;
}

static void load_values(uint32_t format, const uint8_t *from, float *to)
{
	uint16_t halves[2];
	uint32_t whole;
	switch (format) {
	case PURSUIT_FORMAT_DEPTH16:
		memcpy(halves, from, 2);
		to[0] = (float)halves[0] / 65535.0f;
		return;
	case PURSUIT_FORMAT_DEPTH24:
		memcpy(&whole, from, 4);
		to[0] = (float)(whole & 0xffffffu) / 16777215.0f;
		return;
	case PURSUIT_FORMAT_RG16F:
		memcpy(halves, from, 4);
		to[0] = half_to_float(halves[0]);
		to[1] = half_to_float(halves[1]);
		return;
	default:
		memcpy(to, from, pursuit_format_bytes(format));
	}
}

static int out_of_memory(const struct export_job *job)
{
	return error_set(job->error, -ENOMEM, "%s: out of memory", job->params->path);
}

/* Depth (one channel) or motion (two) as PFM. */
static int write_values(const struct export_job *job, const struct frame *frame, int index, uint32_t channels,
						const char *name)
{
	const struct pursuit_plane *plane = &frame->header.planes[index];
	const size_t bytes = pursuit_format_bytes(plane->format);
	float *values = malloc(sizeof(float) * channels * plane->width * plane->height);
	if (!values)
		return out_of_memory(job);
	for (uint32_t y = 0; y < plane->height; y++)
		for (uint32_t x = 0; x < plane->width; x++)
			load_values(plane->format, frame->planes[index] + y * plane->stride + x * bytes,
						values + ((size_t)y * plane->width + x) * channels);
	const int result = image_write_pfm(name, values, plane->width, plane->height, channels, job->error);
	free(values);
	return result;
}

/* ---- one frame ---- */

static int write_plane(struct export_job *job, const struct frame *frame, const char *pattern, uint32_t role,
					   uint64_t number)
{
	char name[PATTERN_MAX_PATH];
	int result;
	const int index = frame_find_plane(&frame->header, role);
	if (!pattern || index < 0)
		return 0;
	if (!pattern_name(pattern, number, name))
		return error_set(job->error, -EINVAL, "%s: number is %" PRIu64 ", must be at most %u", pattern, number,
						 PATTERN_MAX_NUMBER);
	if (role == PURSUIT_ROLE_DEPTH || role == PURSUIT_ROLE_MOTION) {
		result = write_values(job, frame, index, role == PURSUIT_ROLE_DEPTH ? 1 : 2, name);
	} else {
		const struct pursuit_plane *plane = &frame->header.planes[index];
		uint8_t *bgra = plane_bgra(frame, index);
		result = bgra ? image_write_png(name, bgra, (size_t)plane->width * 4, plane->width, plane->height,
										role == PURSUIT_ROLE_UI, job->error)
					  : out_of_memory(job);
		free(bgra);
	}
	job->summary->files += result == 0;
	return result;
}

static uint64_t greatest_divisor(uint64_t a, uint64_t b)
{
	while (b) {
		const uint64_t rest = a % b;
		a = b;
		b = rest;
	}
	return a;
}

/* Frames a second: as INFO says, else from the interval of the frames. */
static void find_rate(const struct export_job *job, const struct frame *frame, struct y4m_params *video)
{
	char value[64], *end = NULL;
	uint64_t frames = 0, seconds = 1;
	if (recording_info_value(recording_reader_info(job->reader), "fps", value, sizeof(value))) {
		frames = strtoull(value, &end, 10);
		if (*end == '/')
			seconds = strtoull(end + 1, &end, 10);
	}
	if ((end && *end) || frames < 1 || frames > UINT32_MAX || seconds < 1 || seconds > UINT32_MAX) {
		const uint64_t interval = frame->header.real_interval_ns;
		frames = interval ? 1000000000 : 60;
		seconds = interval && interval <= UINT32_MAX ? interval : 1;
	}
	const uint64_t divisor = greatest_divisor(frames, seconds);
	video->rate = (uint32_t)(frames / divisor);
	video->rate_scale = (uint32_t)(seconds / divisor);
}

static int write_video(struct export_job *job, const struct frame *frame)
{
	const int index = frame_find_plane(&frame->header, PURSUIT_ROLE_COLOR);
	const struct pursuit_plane *plane = &frame->header.planes[index];
	if (!job->params->video)
		return 0;
	if (!job->video) {
		struct y4m_params params = {
			.path = job->params->video, .width = plane->width, .height = plane->height, .chroma = job->params->chroma};
		find_rate(job, frame, &params);
		job->video = y4m_create(&params, job->error);
		job->video_width = plane->width;
		job->video_height = plane->height;
	}
	if (!job->video)
		return -EIO;
	if (plane->width != job->video_width || plane->height != job->video_height)
		return error_set(job->error, -EINVAL,
						 "%s: frame %" PRIu64 ": size is %ux%u, must be %ux%u for one video: use --first and --last",
						 job->params->path, frame->header.frame_id, plane->width, plane->height, job->video_width,
						 job->video_height);
	uint8_t *bgra = plane_bgra(frame, index);
	const int result = bgra ? y4m_frame(job->video, bgra, (size_t)plane->width * 4, job->error) : out_of_memory(job);
	free(bgra);
	return result;
}

static int export_frame(struct export_job *job, const struct frame *frame, uint64_t number)
{
	const struct export_params *params = job->params;
	int result = write_plane(job, frame, params->color, PURSUIT_ROLE_COLOR, number);
	if (result == 0)
		result = write_plane(job, frame, params->ui, PURSUIT_ROLE_UI, number);
	if (result == 0)
		result = write_plane(job, frame, params->depth, PURSUIT_ROLE_DEPTH, number);
	if (result == 0)
		result = write_plane(job, frame, params->motion, PURSUIT_ROLE_MOTION, number);
	if (result == 0)
		result = write_video(job, frame);
	job->summary->frames += result == 0;
	return result;
}

/* ---- the recording ---- */

static int check_patterns(const struct export_params *params, struct error *error)
{
	const char *const patterns[] = {params->color, params->ui, params->depth, params->motion};
	static const char *const options[] = {"--color", "--ui", "--depth", "--motion"};
	int result = 0;
	for (size_t i = 0; result == 0 && i < sizeof(patterns) / sizeof(patterns[0]); i++)
		if (patterns[i])
			result = pattern_check(options[i], patterns[i], error);
	return result;
}

/* Frames of an import and of a scene have numbers (docs/recording.md); others are counted from 0. */
struct numbering {
	bool by_id;
	uint64_t offset;
};

static struct numbering find_numbering(const struct export_job *job)
{
	char value[32];
	struct numbering numbering = {0};
	if (!recording_info_value(recording_reader_info(job->reader), "number_offset", value, sizeof(value)))
		return numbering;
	numbering.offset = strtoull(value, NULL, 10);
	numbering.by_id = numbering.offset <= PATTERN_MAX_NUMBER;
	return numbering;
}

static int export_at(struct export_job *job, const struct numbering *numbering, uint64_t index)
{
	const struct export_params *params = job->params;
	struct frame frame;
	const int result = recording_reader_frame(job->reader, index, 0, &frame, NULL, job->error);
	if (result == -EBADMSG) {
		job->summary->damaged++;
		if (params->on_damage)
			params->on_damage(params->data, job->error->text);
		return 0;
	}
	if (result < 0)
		return result;
	const uint64_t number = numbering->by_id ? numbering->offset + frame.header.frame_id - 1 : index;
	if ((params->has_first && number < params->first) || (params->has_last && number > params->last))
		return 0;
	return export_frame(job, &frame, number);
}

static int export_frames(struct export_job *job)
{
	const struct numbering numbering = find_numbering(job);
	const uint64_t count = recording_reader_frame_count(job->reader);
	int result = 0;
	for (uint64_t i = 0; result == 0 && i < count; i++)
		result = export_at(job, &numbering, i);
	if (result == 0 && job->summary->frames == 0)
		result = error_set(job->error, -ENODATA,
						   "%s: no frame to export: it holds %" PRIu64 " frames, %" PRIu64
						   " damaged, numbered from %" PRIu64,
						   job->params->path, count, job->summary->damaged, numbering.offset);
	return result;
}

int export_run(const struct export_params *params, struct export_summary *summary, struct error *error)
{
	struct export_job job = {.params = params, .summary = summary, .error = error};
	struct error closing = {""};
	*summary = (struct export_summary){0};
	int result = check_patterns(params, error);
	if (result < 0)
		return result;
	job.reader = recording_reader_create(&(struct recording_reader_params){.path = params->path}, error);
	if (!job.reader)
		return -EIO;
	const struct recording_summary *found = recording_reader_summary(job.reader);
	if (found->damage[0] && params->on_damage)
		params->on_damage(params->data, found->damage);
	summary->damaged = found->damaged_chunks;
	result = export_frames(&job);
	const int closed = y4m_destroy(&job.video, result < 0 ? &closing : error);
	recording_reader_destroy(&job.reader);
	return result < 0 ? result : closed;
}
