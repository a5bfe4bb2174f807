/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What check-stream says about a short stream that is right: nothing. Mistakes are planted in
 * tests/cli/test_check_stream.py. */
#include <math.h>
#include <stdlib.h>

#include "daemon/measure/inspect.h"
#include "tests/test.h"

#define WIDTH 320u
#define HEIGHT 180u
#define PIXELS (WIDTH * HEIGHT)
#define FRAMES 6u

struct memory {
	float luma[PIXELS], motion[2 * PIXELS];
};

/* A wave that moves evenly: what enters at one border is not what leaves at the other. */
static struct inspect_view draw(struct memory *memory, uint32_t number, float step, bool forward)
{
	for (uint32_t i = 0; i < PIXELS; i++) {
		const float along = (float)(i % WIDTH) - (float)number * step, y = (float)(i / WIDTH);
		memory->luma[i] = roundf(128.0f + 120.0f * sinf(along * 0.1f) * sinf(y * 0.1f)) / 255.0f;
		memory->motion[2 * i] = step;
		memory->motion[2 * i + 1] = 0.0f;
	}
	return (struct inspect_view){.width = WIDTH,
								 .height = HEIGHT,
								 .luma = memory->luma,
								 .motion = memory->motion,
								 .forward = forward,
								 .usable_motion = true,
								 .frame_id = number,
								 .time_ns = UINT64_C(25000000) * number,
								 .color_hash = number};
}

static uint32_t count_mistakes(uint32_t first, float step, bool forward)
{
	struct memory *memory = calloc(2, sizeof(*memory));
	struct inspect *inspect = calloc(1, sizeof(*inspect));
	struct inspect_view views[2];
	struct inspect_finding findings[INSPECT_FINDINGS];
	for (uint32_t i = 0; i < FRAMES; i++) {
		views[i % 2] = draw(&memory[i % 2], first + i, step, forward);
		inspect_add_frame(inspect, &views[i % 2]);
		if (i > 0)
			inspect_add_pair(inspect, &views[1 - i % 2], &views[i % 2]);
	}
	CHECK_INT(inspect->pairs, FRAMES - 1);
	uint32_t mistakes = 0;
	for (uint32_t count = inspect_findings(inspect, findings), i = 0; i < count; i++)
		if (findings[i].level == INSPECT_MISTAKE) {
			printf("frame %u, %g pixels: %s\n", first, (double)step, findings[i].code);
			mistakes++;
		}
	free(inspect);
	free(memory);
	return mistakes;
}

static void test_even_motion_is_right(void)
{
	const float steps[] = {-9.0f, -4.0f, 2.0f, 4.0f, 7.0f};
	for (uint32_t i = 0; i < sizeof(steps) / sizeof(steps[0]); i++)
		for (uint32_t first = 0; first < 16; first++)
			CHECK_INT(count_mistakes(first, steps[i], first % 2), 0);
}

int main(void)
{
	RUN(test_even_motion_is_right);
	return test_result();
}
