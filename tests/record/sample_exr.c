/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/record/sample_exr.h"

#include <OpenEXR/openexr.h>

static uint32_t pixel_bytes(int type)
{
	return type == EXR_PIXEL_HALF ? 2 : 4;
}

/* One chunk whose first pixel is (x, y) of the data. */
static exr_result_t encode_chunk(exr_context_t context, const struct sample_exr *exr, const exr_chunk_info_t *chunk,
								 uint32_t x, uint32_t y)
{
	exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
	exr_result_t code = exr_encoding_initialize(context, 0, chunk, &pipeline);
	if (code != EXR_ERR_SUCCESS)
		return code;
	for (int i = 0; i < pipeline.channel_count; i++) {
		exr_coding_channel_info_t *channel = &pipeline.channels[i];
		const uint32_t bytes = pixel_bytes(exr->channels[i].type);
		channel->user_data_type = channel->data_type;
		channel->user_bytes_per_element = (int16_t)bytes;
		channel->user_pixel_stride = (int32_t)bytes;
		channel->user_line_stride = (int32_t)(bytes * exr->width);
		channel->encode_from_ptr = (const uint8_t *)exr->channels[i].data + ((uint64_t)y * exr->width + x) * bytes;
	}
	code = exr_encoding_choose_default_routines(context, 0, &pipeline);
	if (code == EXR_ERR_SUCCESS)
		code = exr_encoding_run(context, 0, &pipeline);
	exr_encoding_destroy(context, &pipeline);
	return code;
}

static exr_attr_box2i_t box(int32_t x, int32_t y, uint32_t width, uint32_t height)
{
	exr_attr_box2i_t box;
	box.min.x = x;
	box.min.y = y;
	box.max.x = x + (int32_t)width - 1;
	box.max.y = y + (int32_t)height - 1;
	return box;
}

static exr_result_t describe(exr_context_t context, const struct sample_exr *exr)
{
	int part;
	const exr_attr_box2i_t data = box(exr->x, exr->y, exr->width, exr->height);
	const exr_attr_box2i_t display = exr->display_width ? box(0, 0, exr->display_width, exr->display_height) : data;
	exr_result_t code = exr_add_part(context, "picture", exr->tile ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &part);
	if (code == EXR_ERR_SUCCESS)
		code = exr_initialize_required_attr_simple(context, 0, (int32_t)exr->width, (int32_t)exr->height,
												   (exr_compression_t)exr->compression);
	if (code == EXR_ERR_SUCCESS)
		code = exr_set_data_window(context, 0, &data);
	if (code == EXR_ERR_SUCCESS)
		code = exr_set_display_window(context, 0, &display);
	for (unsigned i = 0; code == EXR_ERR_SUCCESS && i < exr->channel_count; i++)
		code = exr_add_channel(context, 0, exr->channels[i].name, (exr_pixel_type_t)exr->channels[i].type,
							   EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
	if (code == EXR_ERR_SUCCESS && exr->tile)
		code = exr_set_tile_descriptor(context, 0, exr->tile, exr->tile, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN);
	return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

static exr_result_t encode(exr_context_t context, const struct sample_exr *exr)
{
	exr_chunk_info_t chunk;
	exr_result_t code = describe(context, exr);
	int32_t lines = 1;
	if (code == EXR_ERR_SUCCESS && !exr->tile)
		code = exr_get_scanlines_per_chunk(context, 0, &lines);
	for (uint32_t y = 0; code == EXR_ERR_SUCCESS && !exr->tile && y < exr->height; y += (uint32_t)lines) {
		code = exr_write_scanline_chunk_info(context, 0, exr->y + (int32_t)y, &chunk);
		if (code == EXR_ERR_SUCCESS)
			code = encode_chunk(context, exr, &chunk, 0, y);
	}
	for (uint32_t y = 0; code == EXR_ERR_SUCCESS && exr->tile && y * exr->tile < exr->height; y++)
		for (uint32_t x = 0; code == EXR_ERR_SUCCESS && x * exr->tile < exr->width; x++) {
			code = exr_write_tile_chunk_info(context, 0, (int)x, (int)y, 0, 0, &chunk);
			if (code == EXR_ERR_SUCCESS)
				code = encode_chunk(context, exr, &chunk, x * exr->tile, y * exr->tile);
		}
	return code;
}

bool sample_exr_write(const char *path, const struct sample_exr *exr)
{
	exr_context_t context = NULL;
	const exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
	if (exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &options) != EXR_ERR_SUCCESS)
		return false;
	const exr_result_t code = encode(context, exr);
	const exr_result_t finished = exr_finish(&context);
	return code == EXR_ERR_SUCCESS && finished == EXR_ERR_SUCCESS;
}
