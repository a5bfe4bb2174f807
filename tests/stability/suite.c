/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct engine_begin_params begin_params = {.n = 3, .last_phase = -1.0};

void suite_method(struct suite *suite, const char *method, uint32_t width)
{
	const struct engine_params forget = {.method = strcmp(method, "hold") == 0 ? "grid" : "hold"};
	const struct engine_params params = {.method = method, .display_width_mm = input_display_mm(width)};
	struct error error = {""};
	if (engine_set_params(suite->engine, &forget, &error) < 0 ||
		engine_set_params(suite->engine, &params, &error) < 0) {
		fprintf(stderr, "%s: %s\n", method, error.text);
		abort();
	}
}

static int render(struct suite *suite, const struct frame *frame, enum engine_show show, double phase, uint8_t fill,
				  uint8_t **pixels)
{
	struct error error = {""};
	uint32_t width, height;
	*pixels = NULL;
	int result = frame ? engine_begin(suite->engine, frame, &begin_params, &error) : 0;
	if (result == 0) {
		engine_get_size(suite->engine, &width, &height);
		*pixels = reference_alloc((size_t)width * height, 4);
		memset(*pixels, fill, 4 * (size_t)width * height);
		result = engine_render(suite->engine, &(struct engine_request){show, phase},
							   &(struct engine_image){*pixels, 4 * (size_t)width}, &error);
	}
	if (result < 0)
		fprintf(stderr, "the engine says: %s\n", error.text);
	return result;
}

uint8_t *suite_render(struct suite *suite, const struct frame *frame, enum engine_show show, double phase,
					  uint32_t *width, uint32_t *height)
{
	uint8_t *pixels;
	*width = *height = 0;
	if (render(suite, frame, show, phase, 0x5a, &pixels) < 0) {
		free(pixels);
		return NULL;
	}
	engine_get_size(suite->engine, width, height);
	return pixels;
}

void suite_against_reference(struct suite *suite, const char *name, const struct frame *frame,
							 const struct engine_params *params, double last_phase)
{
	const struct engine_request requests[] = {{ENGINE_SHOW_REAL, 0.0},
											  {ENGINE_SHOW_REAL, last_phase / 3.0},
											  {ENGINE_SHOW_IN_BETWEEN, last_phase / 2.0},
											  {ENGINE_SHOW_IN_BETWEEN, last_phase},
											  {ENGINE_SHOW_PLAIN, last_phase}};
	struct engine_case what = {.name = name,
							   .params = *params,
							   .begin = {.n = 3, .last_phase = last_phase},
							   .requests = requests,
							   .request_count = sizeof(requests) / sizeof(requests[0])};
	struct case_totals totals = {0};
	if (!what.params.method)
		what.params.method = "grid";
	if (!(what.params.display_width_mm > 0.0f))
		what.params.display_width_mm = input_display_mm(frame->header.planes[0].width);
	const bool good = engine_case_run(suite->engine, frame, &what, &totals);
	double worst = 0.0;
	uint64_t outside = 0;
	for (int show = 0; show < 3; show++) {
		worst = totals.reports[show].worst > worst ? totals.reports[show].worst : worst;
		outside += totals.reports[show].outside;
	}
	char where[TABLE_TEXT];
	snprintf(where, sizeof(where), "%llu pixels outside the reference", (unsigned long long)outside);
	table_add(&suite->table, name, good ? worst : worst > 0.0 ? worst : 255.0, where, 0.0);
}

/* Pixels that depend on what was in the image, or have no alpha. */
static uint64_t count_undefined(struct suite *suite, const struct frame *frame, enum engine_show show, double phase)
{
	uint8_t *one, *other;
	uint32_t width, height;
	uint64_t wrong = 0;
	const int failed = render(suite, frame, show, phase, 0x00, &one) | render(suite, NULL, show, phase, 0xff, &other);
	engine_get_size(suite->engine, &width, &height);
	for (size_t i = 0; i < (size_t)width * height && !failed; i++)
		wrong += memcmp(one + 4 * i, other + 4 * i, 4) != 0 || one[4 * i + 3] != 255;
	free(one);
	free(other);
	return failed ? UINT64_MAX : wrong;
}

void suite_all_methods(struct suite *suite, const char *name, const struct frame *frame)
{
	for (const struct engine_method_info *method = engine_methods(); method->name; method++) {
		suite_method(suite, method->name, frame->header.planes[0].width);
		double wrong = 0.0;
		wrong += (double)count_undefined(suite, frame, ENGINE_SHOW_REAL, 0.0);
		wrong += (double)count_undefined(suite, NULL, ENGINE_SHOW_REAL, 0.3);
		wrong += (double)count_undefined(suite, NULL, ENGINE_SHOW_IN_BETWEEN, 2.0 / 3.0);
		/* Again, now that there is a frame before. */
		wrong += (double)count_undefined(suite, frame, ENGINE_SHOW_IN_BETWEEN, 1.0 / 3.0);
		table_add(&suite->table, name, wrong, method->name, 0.0);
	}
}

uint8_t *suite_plane(const struct input *input, uint32_t role, const struct pursuit_plane **plane)
{
	const int index = frame_find_plane(&input->frame.header, role);
	if (index < 0)
		abort();
	*plane = &input->frame.header.planes[index];
	return input->memory + (input->frame.planes[index] - input->memory);
}

void suite_move(const struct input *input, void (*motion)(void *context, double x, double y, double m[2]),
				void *context)
{
	const struct pursuit_plane *plane;
	uint8_t *data = suite_plane(input, PURSUIT_ROLE_MOTION, &plane);
	for (uint32_t j = 0; j < plane->height; j++)
		for (uint32_t i = 0; i < plane->width; i++) {
			double m[2] = {0.0, 0.0};
			motion(context, i + 0.5, j + 0.5, m);
			const float singles[2] = {(float)m[0], (float)m[1]};
			memcpy(data + j * plane->stride + i * sizeof(singles), singles, sizeof(singles));
		}
}
