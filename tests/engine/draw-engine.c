/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Writes what the engine makes of the synthetic layers as PNG files, to be looked at.
 *
 *   draw-engine FOLDER [WIDTH HEIGHT [METHOD [BLUR]]]
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"

static void save(struct engine *engine, const char *folder, const char *name, enum engine_show show, double phase)
{
	uint32_t width, height;
	engine_get_size(engine, &width, &height);
	uint8_t *pixels = malloc(4 * (size_t)width * height);
	struct engine_image image = {pixels, 4 * (size_t)width};
	struct engine_request request = {show, phase};
	struct error error;
	char path[512];
	snprintf(path, sizeof(path), "%s/%s.png", folder, name);
	if (engine_render(engine, &request, &image, &error) < 0 || !picture_write_png(path, pixels, width, height))
		fprintf(stderr, "%s: %s\n", path, error.text);
	free(pixels);
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	uint32_t width = argc > 3 ? (uint32_t)atoi(argv[2]) : 640, height = argc > 3 ? (uint32_t)atoi(argv[3]) : 360;
	struct engine_params params = {.method = argc > 4 ? argv[4] : NULL};
	params.blur = argc > 5 ? (enum engine_blur)atoi(argv[5]) : ENGINE_BLUR_DOUBTFUL;
	struct error error;
	struct engine *engine = engine_create(&params, &error);
	struct picture picture, truth;
	picture_init(&picture, width, height, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
	picture_draw_layers(&picture, 0.0);
	struct engine_begin_params begin = {.n = 3, .last_phase = -1.0};
	if (!engine || engine_begin(engine, &picture.frame, &begin, &error) < 0) {
		fprintf(stderr, "%s\n", error.text);
		return 1;
	}
	save(engine, argv[1], "plain", ENGINE_SHOW_PLAIN, 0.0);
	save(engine, argv[1], "real", ENGINE_SHOW_REAL, 0.0);
	save(engine, argv[1], "between1", ENGINE_SHOW_IN_BETWEEN, 1.0 / 3);
	save(engine, argv[1], "between2", ENGINE_SHOW_IN_BETWEEN, 2.0 / 3);
	picture_init(&truth, width, height, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
	picture_draw_layers(&truth, 2.0 / 3);
	engine_begin(engine, &truth.frame, &begin, &error);
	save(engine, argv[1], "truth2", ENGINE_SHOW_PLAIN, 0.0);
	char plan[600];
	engine_print_plan(engine, plan, sizeof(plan));
	printf("%s", plan);
	engine_destroy(&engine);
	picture_finish(&picture);
	picture_finish(&truth);
	return 0;
}
