/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <png.h>

#include "daemon/record/half.h"
#include "daemon/record/image.h"
#include "tests/record/sample.h"
#include "tests/record/sample_exr.h"
#include "tests/test.h"

#define WIDTH 19u
#define HEIGHT 13u
#define PIXELS ((size_t)WIDTH * HEIGHT)

static uint32_t random_state = 1;

static uint32_t random_next(void)
{
	random_state = random_state * 1664525u + 1013904223u;
	return random_state >> 8;
}

/* ---- half ---- */

static void test_half(void)
{
	static const struct {
		float value;
		uint16_t half;
	} known[] = {
		{0.0f, 0x0000},         {-0.0f, 0x8000},           {1.0f, 0x3c00},
		{-2.0f, 0xc000},        {65504.0f, 0x7bff},        {65519.99f, 0x7bff},
		{65520.0f, 0x7c00},     {INFINITY, 0x7c00},        {-INFINITY, 0xfc00},
		{0x1p-24f, 0x0001},     {0x1p-25f, 0x0000},        {0x1.8p-25f, 0x0001},
		{0x1p-14f, 0x0400},     {0x1.ff8p-15f, 0x03ff},    {0x1.8p-24f, 0x0002},
		{0x1.4p-23f, 0x0002},   {1.0f + 0x1p-11f, 0x3c00}, {1.0f + 0x1.8p-10f, 0x3c02},
		{0x1.fffp-15f, 0x0400},
	};
	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
		CHECK_INT(half_from_float(known[i].value), known[i].half);
	for (uint32_t half = 0; half < 0x10000; half++) {
		const float value = half_to_float((uint16_t)half);
		if (isnan(value))
			CHECK(isnan(half_to_float(half_from_float(value))));
		else
			CHECK_INT(half_from_float(value), half);
	}
	CHECK(half_to_float(0x3555) == 0.333251953125f);
	CHECK(half_to_float(0x0001) == 0x1p-24f);
	CHECK(isinf(half_to_float(0x7c00)));
}

/* ---- PNG ---- */

static int write_png(const char *name, int color_type, int depth, const uint8_t *rows, size_t stride, bool interlaced)
{
	FILE *file = fopen(sample_path(name), "wb");
	png_struct *png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
	png_info *info = png_create_info_struct(png);
	png_byte **pointers = malloc(sizeof(*pointers) * HEIGHT);
	static const png_color palette[4] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 8, 7}};
	static const png_byte alpha[2] = {0, 128};
	for (uint32_t y = 0; y < HEIGHT; y++)
		pointers[y] = (png_byte *)(uintptr_t)rows + y * stride;
	png_init_io(png, file);
	png_set_IHDR(png, info, WIDTH, HEIGHT, depth, color_type, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
				 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	if (color_type == PNG_COLOR_TYPE_PALETTE) {
		png_set_PLTE(png, info, palette, 4);
		png_set_tRNS(png, info, alpha, 2, NULL);
	}
	png_write_info(png, info);
	png_write_image(png, pointers);
	png_write_end(png, NULL);
	png_destroy_write_struct(&png, &info);
	free(pointers);
	return fclose(file);
}

static void fill_random(uint8_t *data, size_t size)
{
	for (size_t i = 0; i < size; i++)
		data[i] = (uint8_t)random_next();
}

static void test_png_color_types(void)
{
	uint8_t data[PIXELS * 8];
	struct error error = {""};
	struct image image;
	fill_random(data, sizeof(data));
	for (int interlaced = 0; interlaced < 2; interlaced++) {
		CHECK_INT(write_png("rgb.png", PNG_COLOR_TYPE_RGB, 8, data, WIDTH * 3, interlaced), 0);
		CHECK_INT(image_read(sample_path("rgb.png"), IMAGE_BGRA, 0, &image, &error), 0);
		CHECK(image.width == WIDTH && image.height == HEIGHT && image.channels == 4 && !image.has_alpha);
		for (size_t i = 0; i < PIXELS; i++)
			CHECK(image.bgra[4 * i] == data[3 * i + 2] && image.bgra[4 * i + 1] == data[3 * i + 1] &&
				  image.bgra[4 * i + 2] == data[3 * i] && image.bgra[4 * i + 3] == 255);
		image_finish(&image);
		CHECK_INT(write_png("rgba.png", PNG_COLOR_TYPE_RGB_ALPHA, 8, data, WIDTH * 4, interlaced), 0);
		CHECK_INT(image_read(sample_path("rgba.png"), IMAGE_BGRA, 0, &image, &error), 0);
		CHECK(image.has_alpha && !image.premultiplied);
		for (size_t i = 0; i < PIXELS; i++)
			CHECK(image.bgra[4 * i] == data[4 * i + 2] && image.bgra[4 * i + 3] == data[4 * i + 3]);
		image_finish(&image);
	}
	CHECK_INT(write_png("grey.png", PNG_COLOR_TYPE_GRAY, 8, data, WIDTH, false), 0);
	CHECK_INT(image_read(sample_path("grey.png"), IMAGE_BGRA, 0, &image, &error), 0);
	for (size_t i = 0; i < PIXELS; i++)
		CHECK(image.bgra[4 * i] == data[i] && image.bgra[4 * i + 2] == data[i] && image.bgra[4 * i + 3] == 255);
	image_finish(&image);
	for (size_t i = 0; i < PIXELS; i++)
		data[i] &= 3;
	CHECK_INT(write_png("palette.png", PNG_COLOR_TYPE_PALETTE, 8, data, WIDTH, false), 0);
	CHECK_INT(image_read(sample_path("palette.png"), IMAGE_BGRA, 0, &image, &error), 0);
	static const uint8_t colors[4][4] = {{0, 0, 255, 0}, {0, 255, 0, 128}, {255, 0, 0, 255}, {7, 8, 9, 255}};
	CHECK(image.has_alpha);
	for (size_t i = 0; i < PIXELS; i++)
		CHECK(memcmp(&image.bgra[4 * i], colors[data[i]], 4) == 0);
	image_finish(&image);
}

/* 16-bit codes keep their value as numbers, whatever gamma a viewer would apply. */
static void test_png_values(void)
{
	uint8_t data[PIXELS * 2];
	struct error error = {""};
	struct image image;
	fill_random(data, sizeof(data));
	CHECK_INT(write_png("grey16.png", PNG_COLOR_TYPE_GRAY, 16, data, WIDTH * 2, false), 0);
	CHECK_INT(image_read(sample_path("grey16.png"), IMAGE_VALUES, 0, &image, &error), 0);
	CHECK(image.channels == 1 && image.scale == 65535.0f);
	for (size_t i = 0; i < PIXELS; i++)
		CHECK_INT(lrintf(image.values[i] * image.scale), data[2 * i] << 8 | data[2 * i + 1]);
	image_finish(&image);
	CHECK_INT(write_png("grey8.png", PNG_COLOR_TYPE_GRAY, 8, data, WIDTH, false), 0);
	CHECK_INT(image_read(sample_path("grey8.png"), IMAGE_VALUES, 0, &image, &error), 0);
	for (size_t i = 0; i < PIXELS; i++)
		CHECK_INT(lrintf(image.values[i] * image.scale), data[i]);
	image_finish(&image);
}

static void test_png_round_trip(void)
{
	uint8_t data[HEIGHT][WIDTH * 4 + 20];
	struct error error = {""};
	struct image image;
	fill_random(data[0], sizeof(data));
	for (int alpha = 0; alpha < 2; alpha++) {
		CHECK_INT(image_write_png(sample_path("out.png"), data[0], sizeof(data[0]), WIDTH, HEIGHT, alpha, &error), 0);
		CHECK_INT(image_read(sample_path("out.png"), IMAGE_BGRA, 0, &image, &error), 0);
		for (uint32_t y = 0; y < HEIGHT; y++)
			for (uint32_t x = 0; x < WIDTH; x++) {
				const uint8_t *got = image.bgra + 4 * (y * WIDTH + x), *want = data[y] + 4 * (size_t)x;
				CHECK(memcmp(got, want, 3) == 0 && got[3] == (alpha ? want[3] : 255));
			}
		image_finish(&image);
	}
	CHECK_INT(image_write_png("/dev/full", data[0], sizeof(data[0]), WIDTH, HEIGHT, false, &error), -ENOSPC);
	CHECK(strstr(error.text, "/dev/full") != NULL);
	CHECK_INT(image_write_png("/no/folder/x.png", data[0], sizeof(data[0]), WIDTH, HEIGHT, false, &error), -ENOENT);
}

static void test_png_small(void)
{
	uint8_t data[HEIGHT][WIDTH * 4];
	struct error error = {""};
	struct image image;
	fill_random(data[0], sizeof(data));
	for (int differences = 0; differences < 2; differences++) {
		CHECK_INT(image_write_png_small(sample_path("out.png"), data[0], WIDTH, HEIGHT, differences, &error), 0);
		CHECK_INT(image_read(sample_path("out.png"), IMAGE_BGRA, 0, &image, &error), 0);
		for (size_t i = 0; i < sizeof(data); i++)
			CHECK_INT(image.bgra[i], i % 4 == 3 ? 255 : data[i / (WIDTH * 4)][i % (WIDTH * 4)]);
		image_finish(&image);
	}
	CHECK_INT(image_write_png_small("/no/folder/x.png", data[0], WIDTH, HEIGHT, true, &error), -ENOENT);
}

/* ---- PFM ---- */

static void test_pfm_round_trip(void)
{
	float values[PIXELS * 3];
	struct error error = {""};
	struct image image;
	for (size_t i = 0; i < PIXELS * 3; i++)
		values[i] = (float)random_next() / 1000.0f - 5000.0f;
	values[4] = INFINITY;
	for (uint32_t channels = 1; channels <= 3; channels++) {
		CHECK_INT(image_write_pfm(sample_path("a.pfm"), values, WIDTH, HEIGHT, channels, &error), 0);
		CHECK_INT(image_read(sample_path("a.pfm"), IMAGE_VALUES, 0, &image, &error), 0);
		CHECK_INT(image.channels, channels == 1 ? 1 : 3);
		for (size_t i = 0; i < PIXELS; i++)
			for (uint32_t c = 0; c < image.channels; c++)
				CHECK(image.values[i * image.channels + c] == (c < channels ? values[i * channels + c] : 0.0f));
		image_finish(&image);
	}
	/* Two rows, big-endian: the first in the file is the lower one. */
	static const uint8_t big[] = "Pf\n1 2\n1.0\n\x3f\x80\x00\x00\x40\x00\x00\x00";
	sample_write_file(sample_path("big.pfm"), big, sizeof(big) - 1);
	CHECK_INT(image_read(sample_path("big.pfm"), IMAGE_VALUES, 0, &image, &error), 0);
	CHECK(image.values[0] == 2.0f && image.values[1] == 1.0f);
	image_finish(&image);
	CHECK_INT(image_read(sample_path("big.pfm"), IMAGE_BGRA, 0, &image, &error), 0);
	CHECK_INT(image.bgra[4], 255);
	image_finish(&image);
}

static void test_pfm_refusals(void)
{
	static const struct {
		const char *text, *sentence;
	} bad[] = {
		{"PF\n0 2\n-1.0\nabcdefgh", "width is 0"},
		{"PF\n2 99999\n-1.0\nabcdefgh", "height is 99999"},
		{"PF\n-2 2\n-1.0\nabcdefgh", "size is -2x2"},
		{"PF\n2.5 2\n-1.0\nabcdefgh", "size is 2.5x2"},
		{"PF\nnan 2\n-1.0\nabcdefgh", "width is 'nan'"},
		{"PF\n1e300 2\n-1.0\nabcdefgh", "size is 1e+300"},
		{"PF\nx 2\n-1.0\nabcdefgh", "width is 'x'"},
		{"PF\n1 2\n0\nabcdefgh", "scale is 0"},
		{"PF\n1 2\n-1\nabcdefgh", "cut off"},
		{"PF\n1 2            ", "scale is missing"},
		{"PFx\n1 2\n-1.0\nabcd", "magic is"},
		{"PF\n16384 16384\n-1\nabcd", "memory limit"},
		{"PX\n16384 16384\n-1\nabcd", "format is unknown"},
		{"PF", "length is 2 bytes"},
	};
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct error error = {""};
		struct image image;
		sample_write_file(sample_path("bad.pfm"), bad[i].text, strlen(bad[i].text));
		CHECK(image_read(sample_path("bad.pfm"), IMAGE_VALUES, 1 << 20, &image, &error) < 0);
		CHECK(strstr(error.text, "bad.pfm: ") != NULL);
		if (!strstr(error.text, bad[i].sentence))
			CHECK_STRING(error.text, bad[i].sentence);
	}
}

/* ---- OpenEXR ---- */

struct channels {
	uint16_t half[PIXELS];
	float single[PIXELS];
	uint32_t whole[PIXELS];
};

static void fill_channels(struct channels *channels)
{
	for (size_t i = 0; i < PIXELS; i++) {
		channels->half[i] = half_from_float((float)i * 0.25f - 20.0f);
		channels->single[i] = (float)random_next() / 7.0f - 1000.0f;
		channels->whole[i] = random_next() & 0xffffff;
	}
}

/* Every storage and compression that we care about: values come back exactly. */
static void test_exr_storage(void)
{
	static const int compressions[] = {0, 1, 2, 3, 4};
	static const uint32_t tiles[] = {0, 8, 16, 64};
	struct channels data;
	fill_channels(&data);
	const struct sample_exr_channel channels[] = {{"G", 2, data.single}, {"Q", 0, data.whole}, {"R", 1, data.half}};
	for (size_t c = 0; c < 5; c++)
		for (size_t t = 0; t < 4; t++) {
			struct error error = {""};
			struct image image;
			const struct sample_exr exr = {.width = WIDTH,
										   .height = HEIGHT,
										   .compression = compressions[c],
										   .tile = tiles[t],
										   .channels = channels,
										   .channel_count = 3};
			CHECK(sample_exr_write(sample_path("s.exr"), &exr));
			const int result = image_read(sample_path("s.exr"), IMAGE_VALUES, 0, &image, &error);
			CHECK_STRING(error.text, "");
			CHECK_INT(result, 0);
			if (result < 0)
				continue;
			CHECK(image.width == WIDTH && image.height == HEIGHT && image.channels == 2);
			unsigned wrong = 0;
			for (size_t i = 0; i < PIXELS; i++)
				wrong +=
					image.values[2 * i] != half_to_float(data.half[i]) || image.values[2 * i + 1] != data.single[i];
			CHECK_INT(wrong, 0);
			image_finish(&image);
		}
}

/* Which channel becomes x (or depth) and which y, by the names that programs give them. */
static void test_exr_channel_names(void)
{
	static const struct {
		const char *names[3];
		unsigned count, channels, first, second;
	} cases[] = {
		{{"Y"}, 1, 1, 0, 0},       {{"Z"}, 1, 1, 0, 0},
		{{"depth.V"}, 1, 1, 0, 0}, {{"X", "Y"}, 2, 2, 0, 1},
		{{"u", "v"}, 2, 2, 0, 1},  {{"A", "G", "R"}, 3, 2, 2, 1},
		{{"A", "Z"}, 2, 1, 1, 0},  {{"foo.x", "foo.y", "foo.z"}, 3, 2, 0, 1},
	};
	float data[3][PIXELS];
	for (size_t i = 0; i < PIXELS; i++)
		for (int c = 0; c < 3; c++)
			data[c][i] = (float)i + 1000.0f * (float)c;
	for (size_t n = 0; n < sizeof(cases) / sizeof(cases[0]); n++) {
		struct sample_exr_channel channels[3];
		struct error error = {""};
		struct image image;
		for (unsigned c = 0; c < cases[n].count; c++)
			channels[c] = (struct sample_exr_channel){cases[n].names[c], 2, data[c]};
		const struct sample_exr exr = {
			.width = WIDTH, .height = HEIGHT, .channels = channels, .channel_count = cases[n].count};
		CHECK(sample_exr_write(sample_path("n.exr"), &exr));
		CHECK_INT(image_read(sample_path("n.exr"), IMAGE_VALUES, 0, &image, &error), 0);
		CHECK_INT(image.channels, cases[n].channels);
		CHECK(image.values[7 * image.channels] == data[cases[n].first][7]);
		if (image.channels == 2)
			CHECK(image.values[7 * 2 + 1] == data[cases[n].second][7]);
		image_finish(&image);
	}
}

/* Data that is larger or smaller than what is shown: the picture is what is shown, zero where there is nothing. */
static void test_exr_windows(void)
{
	float data[PIXELS];
	struct error error = {""};
	struct image image;
	for (size_t i = 0; i < PIXELS; i++)
		data[i] = (float)i + 1.0f;
	const struct sample_exr_channel channel = {"Y", 2, data};
	for (uint32_t tile = 0; tile < 16; tile += 8)
		for (int side = 0; side < 2; side++) {
			const int32_t x = side ? 3 : -4, y = side ? 2 : -5;
			const struct sample_exr exr = {.width = WIDTH,
										   .height = HEIGHT,
										   .x = x,
										   .y = y,
										   .display_width = 17,
										   .display_height = 12,
										   .tile = tile,
										   .channels = &channel,
										   .channel_count = 1};
			CHECK(sample_exr_write(sample_path("w.exr"), &exr));
			CHECK_INT(image_read(sample_path("w.exr"), IMAGE_VALUES, 0, &image, &error), 0);
			CHECK(image.width == 17 && image.height == 12);
			unsigned wrong = 0;
			for (int32_t j = 0; j < 12; j++)
				for (int32_t i = 0; i < 17; i++) {
					const bool inside = i >= x && j >= y && i - x < (int32_t)WIDTH && j - y < (int32_t)HEIGHT;
					const float want = inside ? data[(j - y) * (int32_t)WIDTH + i - x] : 0.0f;
					wrong += image.values[j * 17 + i] != want;
				}
			CHECK_INT(wrong, 0);
			image_finish(&image);
		}
}

static void test_exr_color(void)
{
	const float light[4] = {0.5f, 0.0f, 1.5f, 0.25f}; /* A, B, G, R */
	struct error error = {""};
	struct image image;
	const struct sample_exr_channel channels[] = {
		{"A", 2, &light[0]}, {"B", 2, &light[1]}, {"G", 2, &light[2]}, {"R", 2, &light[3]}};
	const struct sample_exr exr = {.width = 1, .height = 1, .channels = channels, .channel_count = 4};
	CHECK(sample_exr_write(sample_path("c.exr"), &exr));
	CHECK_INT(image_read(sample_path("c.exr"), IMAGE_BGRA, 0, &image, &error), 0);
	CHECK(image.has_alpha && image.premultiplied);
	CHECK_INT(image.bgra[0], 0);
	CHECK_INT(image.bgra[1], 255);
	CHECK_INT(image.bgra[2], 137); /* 0.25 of light is 0.5371 in sRGB codes */
	CHECK_INT(image.bgra[3], 128);
	image_finish(&image);
}

/* ---- damage, every format ---- */

static void read_damaged(const char *path, bool must_fail)
{
	for (int want = 0; want < 2; want++) {
		struct error error = {""};
		struct image image;
		const int result = image_read(path, (enum image_want)want, 1 << 24, &image, &error);
		CHECK(result == 0 || strstr(error.text, path));
		if (must_fail)
			CHECK(result < 0);
		if (result == 0)
			image_finish(&image);
	}
}

static void test_damaged_files(void)
{
	static const char *const names[] = {"rgba.png", "palette.png", "a.pfm", "s.exr", "piz.exr", "tiles.exr"};
	struct channels data;
	fill_channels(&data);
	const struct sample_exr_channel channels[] = {{"G", 2, data.single}, {"Q", 0, data.whole}, {"R", 1, data.half}};
	struct sample_exr exr = {
		.width = WIDTH, .height = HEIGHT, .compression = 4, .channels = channels, .channel_count = 3};
	CHECK(sample_exr_write(sample_path("piz.exr"), &exr));
	exr.tile = 8;
	exr.compression = 3;
	CHECK(sample_exr_write(sample_path("tiles.exr"), &exr));
	for (size_t n = 0; n < sizeof(names) / sizeof(names[0]); n++) {
		size_t size;
		uint8_t *whole = sample_read_file(sample_path(names[n]), &size);
		CHECK(size > 100);
		for (size_t length = 0; length < size; length += 1 + length / 200) {
			sample_write_file(sample_path("damaged"), whole, length);
			read_damaged(sample_path("damaged"), length + 12 < size);
		}
		for (int i = 0; i < 2000; i++) {
			const size_t at = i < 600 ? (size_t)i % size : random_next() % size;
			const uint8_t before = whole[at];
			const uint32_t noise = random_next();
			whole[at] = (uint8_t)(i % 3 ? before ^ (1u << noise % 8) : noise);
			sample_write_file(sample_path("damaged"), whole, size);
			read_damaged(sample_path("damaged"), false);
			whole[at] = before;
		}
		free(whole);
	}
}

static void test_memory_limit(void)
{
	static const char *const names[] = {"rgba.png", "a.pfm", "s.exr"};
	for (size_t n = 0; n < 3; n++) {
		struct error error = {""};
		struct image image;
		CHECK_INT(image_read(sample_path(names[n]), IMAGE_BGRA, 100, &image, &error), -ENOMEM);
		CHECK(strstr(error.text, "size is 19x13") && strstr(error.text, "memory limit"));
	}
	struct error error = {""};
	struct image image;
	CHECK_INT(image_read(sample_path("missing.png"), IMAGE_BGRA, 0, &image, &error), -ENOENT);
	CHECK_INT(image_read(sample_folder(), IMAGE_BGRA, 0, &image, &error), -EINVAL);
}

int main(void)
{
	RUN(test_half);
	RUN(test_png_color_types);
	RUN(test_png_values);
	RUN(test_png_round_trip);
	RUN(test_png_small);
	RUN(test_pfm_round_trip);
	RUN(test_pfm_refusals);
	RUN(test_exr_storage);
	RUN(test_exr_channel_names);
	RUN(test_exr_windows);
	RUN(test_exr_color);
	RUN(test_damaged_files);
	RUN(test_memory_limit);
	sample_folder_remove();
	return test_result();
}
