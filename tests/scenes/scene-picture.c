/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Writes a moment of a scene as pictures, to be looked at:
 *   scene-picture SCENE WIDTH HEIGHT TIME PREFIX [gl|es]
 * makes PREFIX-color.png (with the UI over it), -depth.png, -motion.png and -id.png.
 */
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client/scenes/scene.h"
#include "context.h"

static bool write_png(const char *prefix, const char *suffix, uint32_t width, uint32_t height, const uint8_t *bgra)
{
	char path[512];
	png_image image = {.version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_BGRA};
	snprintf(path, sizeof(path), "%s-%s.png", prefix, suffix);
	if (!png_image_write_to_file(&image, path, 0, bgra, 0, NULL)) {
		fprintf(stderr, "%s: %s\n", path, image.message);
		return false;
	}
	return true;
}

static uint8_t byte(double x)
{
	return (uint8_t)(x < 0.0 ? 0.0 : x > 255.0 ? 255.0 : x);
}

static void put(uint8_t *pixel, double r, double g, double b)
{
	pixel[0] = byte(b);
	pixel[1] = byte(g);
	pixel[2] = byte(r);
	pixel[3] = 255;
}

static void blend_ui(uint8_t *color, const uint8_t *ui, size_t count)
{
	for (size_t i = 0; i < count * 4; i++) {
		if (i % 4 != 3)
			color[i] = byte(ui[i] + color[i] * (255 - ui[i / 4 * 4 + 3]) / 255.0);
	}
}

int main(int argc, char **argv)
{
	if (argc < 6) {
		fprintf(stderr, "usage: scene-picture SCENE WIDTH HEIGHT TIME PREFIX [gl|es]\n");
		return 2;
	}
	uint32_t width = (uint32_t)atoi(argv[2]), height = (uint32_t)atoi(argv[3]);
	size_t count = (size_t)width * height;
	double time = atof(argv[4]);
	struct test_context context;
	char error[512] = "";
	if (!test_context_init(&context, argc > 6 && strcmp(argv[6], "es") == 0))
		return 1;
	struct scene *scene = scene_create(argv[1], width, height, test_context_lookup, error, sizeof(error));
	if (!scene) {
		fprintf(stderr, "%s\n", error);
		test_context_finish(&context);
		return 1;
	}
	struct scene_request request = {.time = time, .time_previous = time - 1.0 / 60.0, .time_next = time + 1.0 / 60.0};
	struct scene_textures textures;
	struct scene_pixels pixels = {malloc(count * 4), malloc(count * 4), malloc(count * 8), NULL,
								  malloc(count * 4), malloc(count * 4)};
	uint8_t *out = malloc(count * 4);
	bool ok = scene_render(scene, &request, &textures, NULL);
	struct scene_pixels wanted = pixels;
	if (!ok || !textures.ui)
		wanted.ui = NULL;
	ok = ok && scene_read(scene, &wanted);
	double most = 0.0, mean = 0.0;
	for (size_t i = 0; i < count && ok; i++) {
		double x = (double)pixels.backward[i * 2], y = (double)pixels.backward[i * 2 + 1];
		most = fmax(most, hypot(x, y));
		mean += hypot(x, y) / (double)count;
		put(out + i * 4, 128 + 8 * x, 128 + 8 * y, 128);
	}
	printf("%s at %g s: motion in a 60th of a second: mean %.2f, most %.2f pixels\n", argv[1], time, mean, most);
	ok = ok && write_png(argv[5], "motion", width, height, out);
	for (size_t i = 0; i < count && ok; i++) {
		double near = pow(1.0 - (double)pixels.depth[i], 0.35) * 255.0;
		put(out + i * 4, near, near, near);
	}
	ok = ok && write_png(argv[5], "depth", width, height, out);
	for (size_t i = 0; i < count && ok; i++) {
		uint32_t id = pixels.object_id[i] * 2654435761u;
		put(out + i * 4, id >> 24, (id >> 16) & 255, (id >> 8) & 255);
	}
	ok = ok && write_png(argv[5], "id", width, height, out);
	if (ok && wanted.ui)
		blend_ui(pixels.color, pixels.ui, count);
	ok = ok && write_png(argv[5], "color", width, height, pixels.color);
	scene_pixels_finish(&pixels);
	free(out);
	scene_destroy(&scene);
	test_context_finish(&context);
	return ok ? 0 : 1;
}
