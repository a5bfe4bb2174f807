/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include "daemon/record/export.h"
#include "daemon/record/half.h"
#include "daemon/record/image.h"
#include "daemon/record/import.h"
#include "daemon/record/pattern.h"
#include "daemon/record/recording.h"
#include "daemon/record/y4m.h"
#include "tests/record/sample.h"
#include "tests/record/sample_exr.h"
#include "tests/test.h"

#define WIDTH 20u
#define HEIGHT 10u
#define PIXELS ((size_t)WIDTH * HEIGHT)

/* ---- patterns ---- */

static void test_pattern_check(void)
{
	static const char *const good[] = {"c_%04d.png", "%d", "a%%b%dc", "/x/%09d/y", "%%%d"};
	static const char *const bad[] = {"",     "c.png", "%s",   "%n",   "%d%d", "%04d_%d", "%",   "%%", "c_%4d",
									  "%00d", "%010d", "%-4d", "%04x", "%1$d", "%ld",     "%*d", "%d%"};
	struct error error = {""};
	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++)
		CHECK_INT(pattern_check("--color", good[i], &error), 0);
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		CHECK_INT(pattern_check("--color", bad[i], &error), -EINVAL);
		CHECK(strstr(error.text, "--color") != NULL);
	}
	char *longest = malloc(5001);
	memset(longest, 'a', 5000);
	memcpy(longest, "%d", 2);
	longest[5000] = '\0';
	CHECK_INT(pattern_check("--color", longest, &error), -EINVAL);
	free(longest);
}

static void test_pattern_name(void)
{
	char name[PATTERN_MAX_PATH];
	CHECK(pattern_name("c_%04d.png", 7, name));
	CHECK_STRING(name, "c_0007.png");
	CHECK(pattern_name("c_%04d.png", 123456, name));
	CHECK_STRING(name, "c_123456.png");
	CHECK(pattern_name("100%%/%d%%", 0, name));
	CHECK_STRING(name, "100%/0%");
	CHECK(!pattern_name("%d", (uint64_t)PATTERN_MAX_NUMBER + 1, name));
	CHECK(!pattern_name("none", 1, name));
}

static void test_pattern_range(void)
{
	static const char *const files[] = {"r_0012.x",  "r_0009.x", "r_0100.x",  "r_99.x",
										"r_00001.x", "r_.x",     "r_0013.xy", "s_0001.x"};
	struct error error = {""};
	char pattern[1100];
	uint64_t first = 0, last = 0;
	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++)
		sample_write_file(sample_path(files[i]), "", 0);
	snprintf(pattern, sizeof(pattern), "%s", sample_path("r_%04d.x"));
	CHECK_INT(pattern_range(pattern, &first, &last, &error), 0);
	CHECK_INT(first, 9);
	CHECK_INT(last, 100);
	snprintf(pattern, sizeof(pattern), "%s", sample_path("q_%04d.x"));
	CHECK_INT(pattern_range(pattern, &first, &last, &error), -ENOENT);
	CHECK_INT(pattern_range("/tmp/%d/x.png", &first, &last, &error), -EINVAL);
	CHECK(strstr(error.text, "--first") != NULL);
	CHECK_INT(pattern_range("/no/such/folder/%d.png", &first, &last, &error), -ENOENT);
}

/* ---- import ---- */

static uint8_t color_at(uint64_t number, size_t i)
{
	return (uint8_t)(number * 31 + i * 7);
}

static void write_color(const char *name)
{
	for (uint64_t number = 3; number <= 9; number++) {
		char path[PATTERN_MAX_PATH];
		uint8_t data[PIXELS * 4];
		struct error error;
		for (size_t i = 0; i < sizeof(data); i++)
			data[i] = i % 4 == 3 ? 255 : color_at(number, i);
		pattern_name(sample_path(name), number, path);
		CHECK_INT(image_write_png(path, data, (size_t)WIDTH * 4, WIDTH, HEIGHT, false, &error), 0);
	}
}

static float motion_at(uint64_t number, size_t i, int c, bool half)
{
	const float value = (float)(i % 16) * 0.5f - (float)number + (c ? 0.25f : 0.0f);
	return half ? value : value + 1e-4f;
}

/* Depth and motion of every `step`th number; motion of odd ones does not fit a half. */
static void write_planes(unsigned step)
{
	for (uint64_t number = 3; number <= 9; number += step) {
		char path[PATTERN_MAX_PATH];
		float depth[PIXELS], x[PIXELS], y[PIXELS];
		struct error error;
		for (size_t i = 0; i < PIXELS; i++) {
			depth[i] = (float)(i + number) / 1000.0f;
			x[i] = motion_at(number, i, 0, number % 2 == 0);
			y[i] = motion_at(number, i, 1, number % 2 == 0);
		}
		pattern_name(sample_path("d_%d.pfm"), number, path);
		CHECK_INT(image_write_pfm(path, depth, WIDTH, HEIGHT, 1, &error), 0);
		pattern_name(sample_path("m_%03d.exr"), number, path);
		const struct sample_exr_channel channels[] = {{"G", 2, y}, {"R", 2, x}};
		const struct sample_exr exr = {
			.width = WIDTH, .height = HEIGHT, .compression = 3, .channels = channels, .channel_count = 2};
		CHECK(sample_exr_write(path, &exr));
	}
}

static struct recording_reader *import(struct import_params *params, struct import_summary *summary)
{
	struct error error = {""};
	const struct recording_reader_params reader = {.path = params->path};
	const int result = import_run(params, summary, &error);
	CHECK_STRING(error.text, "");
	CHECK_INT(result, 0);
	return recording_reader_create(&reader, &error);
}

static float load(const struct frame *frame, int plane, size_t i, int c)
{
	const struct pursuit_plane *p = &frame->header.planes[plane];
	const uint8_t *from = frame->planes[plane] + i / WIDTH * p->stride + i % WIDTH * pursuit_format_bytes(p->format);
	uint16_t half;
	float value;
	if (p->format == PURSUIT_FORMAT_RG16F) {
		memcpy(&half, from + 2 * c, sizeof(half));
		return half_to_float(half);
	}
	memcpy(&value, from + 4 * c, sizeof(value));
	return value;
}

static void check_frame(const struct frame *frame, uint64_t number)
{
	const int depth = frame_find_plane(&frame->header, PURSUIT_ROLE_DEPTH);
	const int motion = frame_find_plane(&frame->header, PURSUIT_ROLE_MOTION);
	unsigned wrong = 0;
	CHECK(depth >= 0 && motion >= 0);
	CHECK_INT(frame->header.planes[motion].format, number % 2 ? PURSUIT_FORMAT_RG32F : PURSUIT_FORMAT_RG16F);
	for (size_t i = 0; i < PIXELS; i++) {
		const uint8_t *bgra = frame->planes[0] + i / WIDTH * frame->header.planes[0].stride + i % WIDTH * 4;
		for (size_t c = 0; c < 3; c++)
			wrong += bgra[c] != color_at(number, 4 * i + c);
		wrong += bgra[3] != 255;
		wrong += load(frame, depth, i, 0) != (float)(i + number) / 1000.0f;
		wrong += load(frame, motion, i, 0) != motion_at(number, i, 0, number % 2 == 0);
		wrong += load(frame, motion, i, 1) != motion_at(number, i, 1, number % 2 == 0);
	}
	CHECK_INT(wrong, 0);
}

static void test_import_all(void)
{
	char color[1100], depth[1100], motion[1100], value[32];
	struct import_summary summary;
	struct error error = {""};
	struct frame frame;
	snprintf(color, sizeof(color), "%s", sample_path("c_%04d.png"));
	snprintf(depth, sizeof(depth), "%s", sample_path("d_%d.pfm"));
	snprintf(motion, sizeof(motion), "%s", sample_path("m_%03d.exr"));
	write_color("c_%04d.png");
	write_planes(1);
	struct import_params params = {.path = sample_path("all.pursuit"),
								   .color = color,
								   .depth = depth,
								   .motion = motion,
								   .rate = {30000, 1001},
								   .near_distance = 0.5f};
	struct recording_reader *reader = import(&params, &summary);
	CHECK_INT(summary.frames, 7);
	CHECK_INT(summary.first, 3);
	CHECK_INT(summary.last, 9);
	CHECK_INT(summary.truth_only, 0);
	CHECK_INT(summary.half_motion, 3);
	CHECK(recording_info_value(recording_reader_info(reader), "number_offset", value, sizeof(value)));
	CHECK_STRING(value, "3");
	CHECK(recording_info_value(recording_reader_info(reader), "fps", value, sizeof(value)));
	CHECK_STRING(value, "30000/1001");
	for (uint64_t i = 0; i < 7; i++) {
		CHECK_INT(recording_reader_frame(reader, i, 0, &frame, NULL, &error), 0);
		check_frame(&frame, i + 3);
		CHECK_INT(frame.header.frame_id, i + 1);
		CHECK_INT(frame.header.time_ns, 1000000000 + llround((double)i * 1001e6 / 30.0));
		CHECK_INT(frame.header.motion_interval_ns, 33366667);
		CHECK_INT(frame.header.motion_kind, PURSUIT_MOTION_BACKWARD);
		CHECK_INT(frame.header.depth_kind, PURSUIT_DEPTH_DEVICE);
		CHECK_INT(frame.header.flags, 0);
		CHECK(frame.header.near_distance == 0.5f);
		CHECK_INT(frame.header.planes[0].transfer.curve, PURSUIT_CURVE_SRGB);
	}
	recording_reader_destroy(&reader);
}

/* Depth and motion on every third number: the others are truth only. */
static void test_import_truth_only(void)
{
	char color[1100], depth[1100], motion[1100], path[PATTERN_MAX_PATH];
	struct import_summary summary;
	struct error error = {""};
	struct frame frame;
	snprintf(color, sizeof(color), "%s", sample_path("c_%04d.png"));
	snprintf(depth, sizeof(depth), "%s", sample_path("d_%d.pfm"));
	snprintf(motion, sizeof(motion), "%s", sample_path("m_%03d.exr"));
	for (uint64_t number = 3; number <= 9; number++)
		for (int p = 0; p < 2; p++)
			if (pattern_name(p ? motion : depth, number, path))
				unlink(path);
	write_planes(3);
	struct import_params params = {.path = sample_path("truth.pursuit"),
								   .color = color,
								   .depth = depth,
								   .motion = motion,
								   .rate = {120, 1},
								   .motion_kind = PURSUIT_MOTION_FORWARD,
								   .depth_kind = PURSUIT_DEPTH_LINEAR,
								   .motion_span = 3};
	struct recording_reader *reader = import(&params, &summary);
	CHECK_INT(summary.frames, 7);
	CHECK_INT(summary.truth_only, 4);
	for (uint64_t i = 0; i < 7; i++) {
		CHECK_INT(recording_reader_frame(reader, i, 0, &frame, NULL, &error), 0);
		const bool real = i % 3 == 0;
		CHECK_INT(frame.header.flags, real ? 0 : PURSUIT_FRAME_TRUTH_ONLY);
		CHECK_INT(frame.header.plane_count, real ? 3 : 1);
		CHECK_INT(frame.header.motion_interval_ns, real ? 25000000 : 0);
		CHECK_INT(frame.header.motion_kind, real ? PURSUIT_MOTION_FORWARD : PURSUIT_MOTION_NONE);
		CHECK_INT(frame.header.depth_kind, real ? PURSUIT_DEPTH_LINEAR : PURSUIT_DEPTH_NONE);
		if (real) {
			check_frame(&frame, i + 3);
			CHECK_INT(frame.header.real_interval_ns, i ? 25000000 : 0);
		}
	}
	recording_reader_destroy(&reader);
}

/* Half the width is 1 in normalised device coordinates, and their y runs up. */
static void test_import_ndc(void)
{
	char color[1100], motion[1100];
	struct import_summary summary;
	struct error error = {""};
	struct frame frame;
	float values[PIXELS * 3];
	for (size_t i = 0; i < PIXELS; i++) {
		values[3 * i] = 0.5f;
		values[3 * i + 1] = 0.25f;
		values[3 * i + 2] = 9.0f;
	}
	CHECK_INT(image_write_pfm(sample_path("n_4.pfm"), values, WIDTH, HEIGHT, 3, &error), 0);
	snprintf(color, sizeof(color), "%s", sample_path("c_%04d.png"));
	snprintf(motion, sizeof(motion), "%s", sample_path("n_%d.pfm"));
	struct import_params params = {.path = sample_path("ndc.pursuit"),
								   .color = color,
								   .motion = motion,
								   .rate = {30, 1},
								   .has_range = true,
								   .first = 4,
								   .last = 4,
								   .motion_in_ndc = true};
	struct recording_reader *reader = import(&params, &summary);
	CHECK_INT(recording_reader_frame(reader, 0, 0, &frame, NULL, &error), 0);
	CHECK(load(&frame, 1, 5, 0) == 5.0f && load(&frame, 1, 5, 1) == -1.25f);
	recording_reader_destroy(&reader);
}

static void test_import_ui_and_ids(void)
{
	char color[1100], ui[1100], ids[1100];
	struct import_summary summary;
	struct error error = {""};
	struct frame frame;
	uint8_t data[PIXELS * 4];
	uint32_t whole[PIXELS];
	for (size_t i = 0; i < PIXELS; i++) {
		data[4 * i] = data[4 * i + 1] = data[4 * i + 2] = 200;
		data[4 * i + 3] = (uint8_t)i;
		whole[i] = (uint32_t)i * 70000;
	}
	CHECK_INT(image_write_png(sample_path("u_4.png"), data, WIDTH * 4, WIDTH, HEIGHT, true, &error), 0);
	const struct sample_exr_channel channel = {"id", 0, whole};
	const struct sample_exr exr = {.width = WIDTH, .height = HEIGHT, .channels = &channel, .channel_count = 1};
	CHECK(sample_exr_write(sample_path("i_4.exr"), &exr));
	snprintf(color, sizeof(color), "%s", sample_path("c_%04d.png"));
	snprintf(ui, sizeof(ui), "%s", sample_path("u_%d.png"));
	snprintf(ids, sizeof(ids), "%s", sample_path("i_%d.exr"));
	struct import_params params = {.path = sample_path("ui.pursuit"),
								   .color = color,
								   .ui = ui,
								   .object_id = ids,
								   .rate = {30, 1},
								   .has_range = true,
								   .first = 4,
								   .last = 4};
	struct recording_reader *reader = import(&params, &summary);
	CHECK_INT(recording_reader_frame(reader, 0, 0, &frame, NULL, &error), 0);
	CHECK_INT(frame.header.planes[1].role, PURSUIT_ROLE_UI);
	CHECK_INT(frame.header.planes[2].format, PURSUIT_FORMAT_R32UI);
	CHECK_INT(frame.header.flags, 0);
	const uint8_t *row = frame.planes[1] + 6 * frame.header.planes[1].stride; /* pixels 120 up */
	CHECK_INT(row[4 * 8 + 3], 128);
	CHECK_INT(row[4 * 8], 100); /* 200 x 128 / 255 */
	uint32_t id;
	memcpy(&id, frame.planes[2] + 6 * frame.header.planes[2].stride + 4 * 8, 4);
	CHECK_INT(id, 128 * 70000);
	recording_reader_destroy(&reader);
}

static void test_import_refusals(void)
{
	char color[1100], depth[1100], other[1100];
	struct import_summary summary;
	struct error error = {""};
	uint8_t small[4] = {0};
	snprintf(color, sizeof(color), "%s", sample_path("c_%04d.png"));
	snprintf(depth, sizeof(depth), "%s", sample_path("none_%d.pfm"));
	snprintf(other, sizeof(other), "%s", sample_path("e_%d.png"));
	struct import_params params = {.path = sample_path("bad.pursuit"), .color = color, .depth = depth, .rate = {30, 1}};
	CHECK_INT(import_run(&params, &summary, &error), -ENOENT);
	CHECK(strstr(error.text, "none_%d.pfm: no such file") != NULL);
	params.depth = "%s%n";
	CHECK_INT(import_run(&params, &summary, &error), -EINVAL);
	CHECK(strstr(error.text, "--depth") != NULL);
	params.depth = NULL;
	params.has_range = true;
	params.first = 8;
	params.last = 10;
	CHECK_INT(import_run(&params, &summary, &error), -ENOENT);
	CHECK(strstr(error.text, "c_0010.png: cannot be opened") != NULL);
	CHECK(access(sample_path("bad.pursuit"), F_OK) != 0);
	/* A picture of another size in the middle. */
	CHECK_INT(image_write_png(sample_path("e_2.png"), small, 4, 1, 1, false, &error), 0);
	size_t size;
	uint8_t *data = sample_read_file(sample_path("c_0004.png"), &size);
	sample_write_file(sample_path("e_1.png"), data, size);
	free(data);
	params.color = other;
	params.has_range = false;
	CHECK_INT(import_run(&params, &summary, &error), -EINVAL);
	CHECK(strstr(error.text, "e_2.png: size is 1x1, must be 20x10") != NULL);
	params.path = "/dev/full";
	CHECK(import_run(&params, &summary, &error) < 0);
	CHECK(strstr(error.text, "/dev/full") && access("/dev/full", F_OK) == 0);
}

/* An import that fails leaves what was there before, and nothing else. */
static void test_import_failure_keeps_the_old(void)
{
	char other[1100];
	struct import_summary summary;
	struct error error = {""};
	size_t size = 0;
	snprintf(other, sizeof(other), "%s", sample_path("e_%d.png"));
	sample_write_file(sample_path("old.pursuit"), (const uint8_t *)"old", 3);
	const struct import_params params = {.path = sample_path("old.pursuit"), .color = other, .rate = {30, 1}};
	CHECK_INT(import_run(&params, &summary, &error), -EINVAL);
	uint8_t *data = sample_read_file(sample_path("old.pursuit"), &size);
	CHECK(size == 3 && memcmp(data, "old", 3) == 0);
	free(data);
	CHECK(access(sample_path("old.pursuit.part"), F_OK) != 0);
}

/* ---- export ---- */

static void test_export_round_trip(void)
{
	char color[1100], motion[1100], name[PATTERN_MAX_PATH];
	struct export_summary summary;
	struct error error = {""};
	struct image image;
	snprintf(color, sizeof(color), "%s", sample_path("out_%03d.png"));
	snprintf(motion, sizeof(motion), "%s", sample_path("out_%03d.pfm"));
	const struct export_params params = {.path = sample_path("all.pursuit"),
										 .color = color,
										 .motion = motion,
										 .video = sample_path("out.y4m"),
										 .chroma = 444,
										 .has_first = true,
										 .first = 5,
										 .has_last = true,
										 .last = 8};
	CHECK_INT(export_run(&params, &summary, &error), 0);
	CHECK_INT(summary.frames, 4);
	CHECK_INT(summary.files, 8);
	for (uint64_t number = 3; number <= 9; number++) {
		CHECK_INT(pattern_exists(color, number), number >= 5 && number <= 8);
		if (!pattern_exists(color, number) || !pattern_name(color, number, name))
			continue;
		unsigned wrong = 0;
		CHECK_INT(image_read(name, IMAGE_BGRA, 0, &image, &error), 0);
		for (size_t i = 0; i < PIXELS * 4; i++)
			wrong += i % 4 < 3 && image.bgra[i] != color_at(number, i);
		image_finish(&image);
		pattern_name(motion, number, name);
		CHECK_INT(image_read(name, IMAGE_VALUES, 0, &image, &error), 0);
		for (size_t i = 0; i < PIXELS; i++)
			wrong += image.values[3 * i] != motion_at(number, i, 0, number % 2 == 0);
		image_finish(&image);
		CHECK_INT(wrong, 0);
	}
	size_t size;
	static const char head[] = "YUV4MPEG2 W20 H10 F30000:1001 Ip A1:1 C444 XCOLORRANGE=LIMITED XMATRIX=BT601\nFRAME\n";
	uint8_t *video = sample_read_file(sample_path("out.y4m"), &size);
	CHECK_INT(size, sizeof(head) - 1 - 6 + 4 * (6 + 3 * PIXELS));
	CHECK(memcmp(video, head, sizeof(head) - 1) == 0);
	free(video);
}

static void count_damage(void *data, const char *sentence)
{
	++*(int *)data;
	CHECK(strstr(sentence, "chunk") != NULL);
}

/* One damaged frame is named and left out; the numbers of the others stay. */
static void test_export_damaged(void)
{
	char color[1100];
	struct export_summary summary;
	struct error error = {""};
	size_t size;
	int told = 0;

	uint8_t *data = sample_read_file(sample_path("all.pursuit"), &size);
	uint64_t at = sizeof(struct pursuit_recording_header);
	for (int chunk = 0; chunk < 3; chunk++) {
		struct pursuit_chunk_header header;
		memcpy(&header, data + at, sizeof(header));
		if (chunk == 2)
			data[at + sizeof(header) + 50] ^= 1;
		at = (at + sizeof(header) + header.stored_bytes + 7) / 8 * 8;
	}
	sample_write_file(sample_path("hurt.pursuit"), data, size);
	free(data);
	snprintf(color, sizeof(color), "%s", sample_path("hurt_%d.png"));
	const struct export_params params = {
		.path = sample_path("hurt.pursuit"), .color = color, .on_damage = count_damage, .data = &told};
	CHECK_INT(export_run(&params, &summary, &error), 0);
	CHECK_INT(summary.frames, 6);
	CHECK_INT(summary.damaged, 1);
	CHECK_INT(told, 1);
	CHECK(pattern_exists(color, 3) && !pattern_exists(color, 4) && pattern_exists(color, 5) &&
		  pattern_exists(color, 9));
}

/* Known colours in both matrices, and chroma of a picture with odd sides. */
static void test_y4m_codes(void)
{
	static const struct {
		uint32_t matrix;
		uint8_t bgr[3], ycbcr[3];
	} known[] = {
		{601, {255, 255, 255}, {235, 128, 128}}, {709, {255, 255, 255}, {235, 128, 128}},
		{601, {0, 0, 0}, {16, 128, 128}},        {601, {0, 0, 255}, {81, 90, 240}},
		{709, {0, 0, 255}, {63, 102, 240}},      {601, {255, 0, 0}, {41, 240, 110}},
		{709, {0, 255, 0}, {173, 42, 26}},       {601, {0, 255, 0}, {145, 54, 34}},
	};
	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
		for (int chroma = 420; chroma <= 444; chroma += 24) {
			struct error error = {""};
			uint8_t bgra[3 * 3 * 4];
			for (int p = 0; p < 9; p++)
				memcpy(bgra + 4 * p, known[i].bgr, 3);
			const struct y4m_params params = {.path = sample_path("k.y4m"),
											  .width = 3,
											  .height = 3,
											  .rate = 25,
											  .rate_scale = 1,
											  .chroma = (uint32_t)chroma,
											  .matrix = known[i].matrix};
			struct y4m *y4m = y4m_create(&params, &error);
			CHECK_INT(y4m_frame(y4m, bgra, 12, &error), 0);
			CHECK_INT(y4m_destroy(&y4m, &error), 0);
			size_t size;
			uint8_t *data = sample_read_file(sample_path("k.y4m"), &size);
			const size_t samples = chroma == 444 ? 9 : 4, begin = size - 9 - 2 * samples;
			CHECK(memcmp(data + begin - 6, "FRAME\n", 6) == 0);
			CHECK_INT(data[begin + 8], known[i].ycbcr[0]);
			CHECK_INT(data[begin + 9 + samples - 1], known[i].ycbcr[1]);
			CHECK_INT(data[begin + 9 + 2 * samples - 1], known[i].ycbcr[2]);
			free(data);
		}
}

static void test_y4m_failures(void)
{
	struct error error = {""};
	uint8_t bgra[64 * 64 * 4] = {0};
	struct y4m_params params = {.path = "/dev/full", .width = 64, .height = 64, .rate = 25, .rate_scale = 1};
	struct y4m *y4m = y4m_create(&params, &error);
	CHECK(y4m != NULL);
	int result = y4m_frame(y4m, bgra, 256, &error);
	const int closed = y4m_destroy(&y4m, &error);
	CHECK(result == -ENOSPC || closed == -ENOSPC);
	/* A reader that goes away. */
	int ends[2];
	char path[32];
	signal(SIGPIPE, SIG_IGN);
	CHECK_INT(pipe2(ends, O_CLOEXEC), 0);
	snprintf(path, sizeof(path), "/dev/fd/%d", ends[1]);
	params.path = path;
	y4m = y4m_create(&params, &error);
	CHECK(y4m != NULL);
	close(ends[0]);
	result = y4m_frame(y4m, bgra, 256, &error);
	CHECK_INT(result < 0 ? result : y4m_destroy(&y4m, &error), -EPIPE);
	CHECK(strstr(error.text, "gone away") != NULL);
	y4m_destroy(&y4m, &error);
	close(ends[1]);
}

int main(void)
{
	RUN(test_pattern_check);
	RUN(test_pattern_name);
	RUN(test_pattern_range);
	RUN(test_import_all);
	RUN(test_export_round_trip);
	RUN(test_export_damaged);
	RUN(test_import_truth_only);
	RUN(test_import_ndc);
	RUN(test_import_ui_and_ids);
	RUN(test_import_refusals);
	RUN(test_import_failure_keeps_the_old);
	RUN(test_y4m_codes);
	RUN(test_y4m_failures);
	sample_folder_remove();
	return test_result();
}
