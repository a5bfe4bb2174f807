/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* OpenEXR fails, each call that a picture needs in turn: a sentence that names the file, and nothing is left open. */

#include <OpenEXR/openexr.h>
#include <dirent.h>

#include "daemon/record/image.h"
#include "tests/record/sample.h"
#include "tests/record/sample_exr.h"
#include "tests/test.h"

/* Which call fails, counted from 0; how many there were. */
static int failing, calls;

static bool fails(void)
{
	return calls++ == failing;
}

/* The linker sends the reader here (--wrap). */
#define WRAP(name, parameters, arguments)                                \
	exr_result_t __real_##name parameters;                               \
	exr_result_t __wrap_##name parameters;                               \
	exr_result_t __wrap_##name parameters                                \
	{                                                                    \
		return fails() ? EXR_ERR_INVALID_ATTR : __real_##name arguments; \
	}

WRAP(exr_get_channels, (exr_const_context_t context, int part, const exr_attr_chlist_t **list), (context, part, list))
WRAP(exr_get_data_window, (exr_const_context_t context, int part, exr_attr_box2i_t *box), (context, part, box))
WRAP(exr_get_display_window, (exr_const_context_t context, int part, exr_attr_box2i_t *box), (context, part, box))
WRAP(exr_get_storage, (exr_const_context_t context, int part, exr_storage_t *storage), (context, part, storage))
WRAP(exr_get_scanlines_per_chunk, (exr_const_context_t context, int part, int32_t *lines), (context, part, lines))
WRAP(exr_get_tile_descriptor,
	 (exr_const_context_t context, int part, uint32_t *width, uint32_t *height, exr_tile_level_mode_t *level,
	  exr_tile_round_mode_t *round),
	 (context, part, width, height, level, round))
WRAP(exr_decoding_initialize,
	 (exr_const_context_t context, int part, const exr_chunk_info_t *chunk, exr_decode_pipeline_t *pipeline),
	 (context, part, chunk, pipeline))
WRAP(exr_decoding_update,
	 (exr_const_context_t context, int part, const exr_chunk_info_t *chunk, exr_decode_pipeline_t *pipeline),
	 (context, part, chunk, pipeline))
WRAP(exr_decoding_run, (exr_const_context_t context, int part, exr_decode_pipeline_t *pipeline),
	 (context, part, pipeline))

static int open_files(void)
{
	int count = 0;
	DIR *folder = opendir("/proc/self/fd");
	while (folder && readdir(folder))
		count++;
	if (folder)
		closedir(folder);
	return count;
}

static void check_file(const char *path)
{
	const int files = open_files();
	bool fine = false;
	for (failing = 0; failing < 200 && !fine; failing++) {
		struct image image;
		struct error error = {""};
		calls = 0;
		fine = image_read(path, IMAGE_VALUES, 0, &image, &error) == 0;
		if (fine)
			image_finish(&image);
		else
			CHECK(strstr(error.text, path) != NULL);
		CHECK(fine == (calls <= failing));
	}
	CHECK(fine && failing > 4);
	CHECK_INT(open_files(), files);
}

static void test_each_call(void)
{
	static float values[16 * 40];
	const struct sample_exr_channel channel = {"Z", 2, values};
	struct sample_exr exr = {.width = 16, .height = 40, .compression = 3, .channels = &channel, .channel_count = 1};
	failing = -1;
	CHECK(sample_exr_write(sample_path("lines.exr"), &exr));
	check_file(sample_path("lines.exr"));
	failing = -1;
	exr.tile = 8;
	CHECK(sample_exr_write(sample_path("tiles.exr"), &exr));
	check_file(sample_path("tiles.exr"));
}

int main(void)
{
	CHECK(sample_folder() != NULL);
	RUN(test_each_call);
	sample_folder_remove();
	return test_result();
}
