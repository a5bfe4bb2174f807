/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pictures of odd sizes, and cells that fit none of them. */
#include <stdio.h>
#include <stdlib.h>

#include "suite.h"

static void check_small(struct suite *suite)
{
	static const uint32_t sizes[][2] = {{1, 1}, {1, 37}, {37, 1}, {7, 5}, {2, 2}, {65, 3}, {63, 64}, {129, 31}};
	static const uint32_t cells[] = {0, 4, 5, 13, 63, 64};
	char name[TABLE_TEXT];
	for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++)
		for (size_t c = 0; c < sizeof(cells) / sizeof(cells[0]); c++) {
			struct input input;
			input_make(&input, &(struct input_spec){.width = sizes[s][0],
													.height = sizes[s][1],
													.field = (s + c) % 2 ? INPUT_LAYERS : INPUT_ROTATE,
													.image = INPUT_EDGES,
													.seed = 1 + s});
			snprintf(name, sizeof(name), "size %u x %u, all cells: steps off the reference", sizes[s][0], sizes[s][1]);
			suite_against_reference(suite, name, &input.frame, &(struct engine_params){.cell = cells[c]}, 2.0 / 3.0);
			snprintf(name, sizeof(name), "size %u x %u: undefined pixels", sizes[s][0], sizes[s][1]);
			if (!c)
				suite_all_methods(suite, name, &input.frame);
			input_finish(&input);
		}
}

static void check_large(struct suite *suite)
{
	const uint32_t sizes[][2] = {{8191, 3}, {3, 8191}, {4096, 4096}};
	char name[TABLE_TEXT];
	for (size_t s = 0; s < (suite->complete ? 3u : 2u); s++) {
		struct input input;
		input_make(
			&input,
			&(struct input_spec){
				.width = sizes[s][0], .height = sizes[s][1], .field = INPUT_LAYERS, .image = INPUT_EDGES, .seed = 3});
		snprintf(name, sizeof(name), "size %u x %u: undefined pixels", sizes[s][0], sizes[s][1]);
		suite_all_methods(suite, name, &input.frame);
		if (s < 2) {
			snprintf(name, sizeof(name), "size %u x %u: steps off the reference", sizes[s][0], sizes[s][1]);
			suite_against_reference(suite, name, &input.frame, &(struct engine_params){0}, 2.0 / 3.0);
		}
		input_finish(&input);
	}
}

void sizes_run(struct suite *suite)
{
	check_small(suite);
	check_large(suite);
}
