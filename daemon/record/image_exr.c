/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <OpenEXR/openexr.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/record/half.h"
#include "daemon/record/image_formats.h"
#include "proto/frame.h"

#define MAX_CHANNELS 4

/* OpenEXR asks for what a file says; no picture that we take needs more at once. */
#define MAX_ALLOCATION ((size_t)1 << 30)

struct exr_job {
	const char *path;
	struct error *error;
	exr_context_t context;
	exr_attr_box2i_t data, display; /* where there are pixels; what the picture shows */
	const exr_attr_chlist_t *list;
	int channels[MAX_CHANNELS]; /* indices in the list */
	int channel_count;
	uint8_t *block[MAX_CHANNELS]; /* one chunk of each channel */
	uint64_t block_pixels;
	exr_decode_pipeline_t pipeline;
	bool pipeline_ready;
	struct image *image;
};

static void *limited_alloc(size_t bytes)
{
	return bytes <= MAX_ALLOCATION ? malloc(bytes) : NULL;
}

/* Errors reach the person through struct error; the library would print to stderr. */
static void on_error(exr_const_context_t context, exr_result_t code, const char *message)
{
}

static int exr_failed(const struct exr_job *job, const char *what, exr_result_t code)
{
	const int result = code == EXR_ERR_OUT_OF_MEMORY ? -ENOMEM : -EBADMSG;
	return error_set(job->error, result, "%s: %s: %s", job->path, what, exr_get_default_error_message(code));
}

/* ---- channels ---- */

static int find_channel(const struct exr_job *job, const char *name)
{
	for (int i = 0; i < job->list->num_channels; i++)
		if (strcasecmp(job->list->entries[i].name.str, name) == 0)
			return i;
	return -1;
}

static void add_channel(struct exr_job *job, int index)
{
	if (index >= 0 && job->channel_count < MAX_CHANNELS)
		job->channels[job->channel_count++] = index;
}

/* First and second channel of numbers, by the names that programs give them. */
static void choose_value_channels(struct exr_job *job)
{
	static const char *const pairs[][2] = {{"R", "G"}, {"X", "Y"}, {"U", "V"}, {"Y", NULL}, {"Z", NULL}};
	for (size_t i = 0; i < sizeof(pairs) / sizeof(pairs[0]); i++) {
		const int first = find_channel(job, pairs[i][0]);
		if (first < 0)
			continue;
		add_channel(job, first);
		if (pairs[i][1])
			add_channel(job, find_channel(job, pairs[i][1]));
		return;
	}
	add_channel(job, 0);
	if (job->list->num_channels > 1)
		add_channel(job, 1);
}

static void choose_color_channels(struct exr_job *job)
{
	const int red = find_channel(job, "R"), green = find_channel(job, "G"), blue = find_channel(job, "B");
	if (red < 0 || green < 0 || blue < 0) {
		const int grey = find_channel(job, "Y");
		add_channel(job, grey >= 0 ? grey : 0);
		return;
	}
	add_channel(job, red);
	add_channel(job, green);
	add_channel(job, blue);
	add_channel(job, find_channel(job, "A"));
}

static int choose_channels(struct exr_job *job, enum image_want want)
{
	const exr_result_t code = exr_get_channels(job->context, 0, &job->list);
	if (code != EXR_ERR_SUCCESS)
		return exr_failed(job, "channels", code);
	if (job->list->num_channels < 1)
		return error_set(job->error, -EBADMSG, "%s: channels: there are 0, must be at least 1", job->path);
	if (want == IMAGE_BGRA)
		choose_color_channels(job);
	else
		choose_value_channels(job);
	for (int i = 0; i < job->channel_count; i++) {
		const exr_attr_chlist_entry_t *entry = &job->list->entries[job->channels[i]];
		if (entry->x_sampling != 1 || entry->y_sampling != 1)
			return error_set(job->error, -EBADMSG, "%s: channel %s: sampling is %dx%d, must be 1x1", job->path,
							 entry->name.str, entry->x_sampling, entry->y_sampling);
	}
	return 0;
}

/* ---- windows ---- */

static int64_t box_width(const exr_attr_box2i_t *box)
{
	return (int64_t)box->max.x - box->min.x + 1;
}

static int64_t box_height(const exr_attr_box2i_t *box)
{
	return (int64_t)box->max.y - box->min.y + 1;
}

static int get_windows(struct exr_job *job, uint64_t memory_limit)
{
	exr_result_t code = exr_get_data_window(job->context, 0, &job->data);
	if (code != EXR_ERR_SUCCESS)
		return exr_failed(job, "dataWindow", code);
	code = exr_get_display_window(job->context, 0, &job->display);
	if (code != EXR_ERR_SUCCESS)
		return exr_failed(job, "displayWindow", code);
	const int64_t width = box_width(&job->display), height = box_height(&job->display);
	/* Values, and twice as much while they become colour; the blocks are small beside that. */
	int result = image_check_size(job->path, width > 0 ? (uint64_t)width : 0, height > 0 ? (uint64_t)height : 0,
								  4 * (uint64_t)job->channel_count, memory_limit, job->error);
	if (result < 0)
		return result;
	const int64_t data_width = box_width(&job->data), data_height = box_height(&job->data);
	result = image_check_size(job->path, data_width > 0 ? (uint64_t)data_width : 0,
							  data_height > 0 ? (uint64_t)data_height : 0, 4 * (uint64_t)job->channel_count,
							  memory_limit, job->error);
	if (result < 0)
		return result;
	job->image->width = (uint32_t)width;
	job->image->height = (uint32_t)height;
	job->image->channels = (uint32_t)job->channel_count;
	/* Zero where the display window has no data. */
	job->image->values = calloc((size_t)width * (size_t)height, sizeof(float) * (size_t)job->channel_count);
	return job->image->values ? 0 : image_out_of_memory(job->path, job->error);
}

static int reserve_blocks(struct exr_job *job, uint64_t pixels)
{
	job->block_pixels = pixels;
	if (pixels > (uint64_t)PURSUIT_MAX_SIZE * PURSUIT_MAX_SIZE)
		return error_set(job->error, -EBADMSG, "%s: chunk size is %llu pixels, must be at most 2^28", job->path,
						 (unsigned long long)pixels);
	for (int i = 0; i < job->channel_count; i++) {
		job->block[i] = malloc(pixels * 4);
		if (!job->block[i])
			return image_out_of_memory(job->path, job->error);
	}
	return 0;
}

/* ---- pixels ---- */

static float load_pixel(const uint8_t *from, exr_pixel_type_t type)
{
	uint16_t half;
	uint32_t whole;
	float value;
	switch (type) {
	case EXR_PIXEL_HALF:
		memcpy(&half, from, sizeof(half));
		return half_to_float(half);
	case EXR_PIXEL_UINT:
		memcpy(&whole, from, sizeof(whole));
		return (float)whole;
	default:
		memcpy(&value, from, sizeof(value));
		return value;
	}
}

/* One channel of one chunk, at (x0, y0) of the data, into the picture as far as it is shown. */
static void place(const struct exr_job *job, int channel, const exr_chunk_info_t *chunk, int64_t x0, int64_t y0)
{
	const exr_pixel_type_t type = job->list->entries[job->channels[channel]].pixel_type;
	const size_t bytes = type == EXR_PIXEL_HALF ? 2 : 4;
	const int64_t dx = x0 - job->display.min.x, dy = y0 - job->display.min.y;
	for (int64_t y = 0; y < chunk->height; y++) {
		if (y + dy < 0 || y + dy >= job->image->height)
			continue;
		const uint8_t *from = job->block[channel] + (size_t)(y * chunk->width) * bytes;
		float *row = job->image->values + (size_t)(y + dy) * job->image->width * job->image->channels;
		for (int64_t x = 0; x < chunk->width; x++)
			if (x + dx >= 0 && x + dx < job->image->width)
				row[(size_t)(x + dx) * job->image->channels + (size_t)channel] =
					load_pixel(from + (size_t)x * bytes, type);
	}
}

static int prepare_pipeline(struct exr_job *job, const exr_chunk_info_t *chunk)
{
	exr_result_t code;
	if (job->pipeline_ready) {
		code = exr_decoding_update(job->context, 0, chunk, &job->pipeline);
	} else {
		code = exr_decoding_initialize(job->context, 0, chunk, &job->pipeline);
		job->pipeline_ready = code == EXR_ERR_SUCCESS;
	}
	if (code != EXR_ERR_SUCCESS)
		return exr_failed(job, "chunk", code);
	/* Each channel as it is stored, planar and without gaps: the simplest thing that the library can be asked for. */
	for (int i = 0; i < job->channel_count; i++) {
		if (job->channels[i] >= job->pipeline.channel_count)
			return exr_failed(job, "channels", EXR_ERR_INVALID_ATTR);
		exr_coding_channel_info_t *channel = &job->pipeline.channels[job->channels[i]];
		if (channel->width != chunk->width || channel->height != chunk->height)
			return exr_failed(job, "chunk", EXR_ERR_BAD_CHUNK_LEADER);
		channel->decode_to_ptr = job->block[i];
		channel->user_data_type = channel->data_type;
		channel->user_bytes_per_element = channel->bytes_per_element;
		channel->user_pixel_stride = channel->bytes_per_element;
		channel->user_line_stride = channel->bytes_per_element * channel->width;
	}
	code = exr_decoding_choose_default_routines(job->context, 0, &job->pipeline);
	return code == EXR_ERR_SUCCESS ? 0 : exr_failed(job, "chunk", code);
}

static int decode_chunk(struct exr_job *job, const exr_chunk_info_t *chunk, int64_t x0, int64_t y0)
{
	if (chunk->width < 1 || chunk->height < 1 || (uint64_t)chunk->width * (uint64_t)chunk->height > job->block_pixels ||
		chunk->unpacked_size > MAX_ALLOCATION)
		return error_set(job->error, -EBADMSG, "%s: chunk at %lld,%lld: size is %dx%d, must fit its window", job->path,
						 (long long)x0, (long long)y0, chunk->width, chunk->height);
	const int result = prepare_pipeline(job, chunk);
	if (result < 0)
		return result;
	const exr_result_t code = exr_decoding_run(job->context, 0, &job->pipeline);
	if (code != EXR_ERR_SUCCESS)
		return error_set(job->error, -EBADMSG, "%s: chunk at %lld,%lld: %s", job->path, (long long)x0, (long long)y0,
						 exr_get_default_error_message(code));
	for (int i = 0; i < job->channel_count; i++)
		place(job, i, chunk, x0, y0);
	return 0;
}

static int read_scanlines(struct exr_job *job)
{
	int32_t lines = 0;
	exr_result_t code = exr_get_scanlines_per_chunk(job->context, 0, &lines);
	if (code != EXR_ERR_SUCCESS || lines < 1)
		return exr_failed(job, "lines in a chunk", code != EXR_ERR_SUCCESS ? code : EXR_ERR_INVALID_ATTR);
	int result = reserve_blocks(job, (uint64_t)lines * (uint64_t)box_width(&job->data));
	for (int64_t y = job->data.min.y; result == 0 && y <= job->data.max.y; y += lines) {
		exr_chunk_info_t chunk;
		code = exr_read_scanline_chunk_info(job->context, 0, (int)y, &chunk);
		if (code != EXR_ERR_SUCCESS)
			return exr_failed(job, "scanline", code);
		result = decode_chunk(job, &chunk, job->data.min.x, y);
	}
	return result;
}

static int read_tiles(struct exr_job *job)
{
	uint32_t width = 0, height = 0;
	exr_tile_level_mode_t level;
	exr_tile_round_mode_t round;
	exr_result_t code = exr_get_tile_descriptor(job->context, 0, &width, &height, &level, &round);
	if (code != EXR_ERR_SUCCESS || width < 1 || height < 1)
		return exr_failed(job, "tiles", code != EXR_ERR_SUCCESS ? code : EXR_ERR_INVALID_ATTR);
	int result = reserve_blocks(job, (uint64_t)width * height);
	for (int64_t y = 0; result == 0 && y * height < box_height(&job->data); y++)
		for (int64_t x = 0; result == 0 && x * width < box_width(&job->data); x++) {
			exr_chunk_info_t chunk;
			code = exr_read_tile_chunk_info(job->context, 0, (int)x, (int)y, 0, 0, &chunk);
			if (code != EXR_ERR_SUCCESS)
				return exr_failed(job, "tile", code);
			result = decode_chunk(job, &chunk, job->data.min.x + x * width, job->data.min.y + y * height);
		}
	return result;
}

static int read_part(struct exr_job *job, enum image_want want, uint64_t memory_limit)
{
	exr_storage_t storage;
	const exr_result_t code = exr_get_storage(job->context, 0, &storage);
	if (code != EXR_ERR_SUCCESS)
		return exr_failed(job, "storage", code);
	if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
		return error_set(job->error, -EBADMSG, "%s: storage is deep (%d), must be scanlines or tiles", job->path,
						 (int)storage);
	int result = choose_channels(job, want);
	if (result == 0)
		result = get_windows(job, memory_limit);
	if (result < 0)
		return result;
	return storage == EXR_STORAGE_SCANLINE ? read_scanlines(job) : read_tiles(job);
}

int image_read_exr(const char *path, enum image_want want, uint64_t memory_limit, struct image *image,
				   struct error *error)
{
	struct exr_job job = {.path = path, .error = error, .image = image};
	exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
	options.error_handler_fn = on_error;
	options.alloc_fn = limited_alloc;
	options.free_fn = free;
	options.max_image_width = options.max_tile_width = (int)PURSUIT_MAX_SIZE;
	options.max_image_height = options.max_tile_height = (int)PURSUIT_MAX_SIZE;
	const exr_result_t code = exr_start_read(&job.context, path, &options);
	if (code != EXR_ERR_SUCCESS)
		return exr_failed(&job, "OpenEXR", code);
	const int result = read_part(&job, want, memory_limit);
	if (job.pipeline_ready)
		exr_decoding_destroy(job.context, &job.pipeline);
	for (int i = 0; i < MAX_CHANNELS; i++)
		free(job.block[i]);
	exr_finish(&job.context);
	return result;
}
