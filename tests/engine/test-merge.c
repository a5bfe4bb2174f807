/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Triangles merged with what is remembered of the frames before are those of a merge that knows nothing. */
#include "tests/test.h"

#include <string.h>

#include "daemon/engine/merge.h"
#include "tests/engine/picture.h"

#define COLUMNS 39u
#define ROWS 30u
#define CELL 8u
#define INDICES (6u * (COLUMNS - 1u) * (ROWS - 1u))
#define TOLERANCE 0.03f

struct grid {
	struct plan_vertex vertices[COLUMNS * ROWS];
	uint32_t indices[INDICES];
	struct plan plan;
};

static float along(uint32_t i, uint32_t count, uint32_t size)
{
	const uint32_t end = i * CELL < size ? i * CELL : size;
	return i == 0 ? 0.0f : i + 1 == count ? (float)size : 0.5f * (float)((i - 1) * CELL + end);
}

static void put_vertices(struct grid *grid, uint32_t width, uint32_t height)
{
	for (uint32_t j = 0; j < ROWS; j++)
		for (uint32_t i = 0; i < COLUMNS; i++)
			grid->vertices[j * COLUMNS + i] =
				(struct plan_vertex){.x = along(i, COLUMNS, width), .y = along(j, ROWS, height), .z = 0.5f};
	for (uint32_t i = 0; i < INDICES; i++)
		grid->indices[i] = i;
	grid->plan = (struct plan){.width = width,
							   .height = height,
							   .cell = CELL,
							   .columns = COLUMNS,
							   .rows = ROWS,
							   .vertices = grid->vertices,
							   .indices = grid->indices,
							   .index_count = INDICES};
}

/* Something happens somewhere, or ends there. */
static void change(struct grid *grid, uint32_t *seed)
{
	const uint32_t left = picture_random(seed) >> 8, top = picture_random(seed) >> 8, what = picture_random(seed) >> 8;
	const float depth = (float)(picture_random(seed) >> 24) / 256.0f;
	for (uint32_t j = top % ROWS; j < top % ROWS + 1 + top % 7 && j < ROWS; j++)
		for (uint32_t i = left % COLUMNS; i < left % COLUMNS + 1 + left % 9 && i < COLUMNS; i++) {
			struct plan_vertex *vertex = &grid->vertices[j * COLUMNS + i];
			switch (what % 5) {
			case 0:
				vertex->ux = (float)(i % 3);
				break;
			case 1:
				vertex->snapped = 1.0f;
				break;
			case 2:
				vertex->z = depth;
				break;
			default:
				vertex->ux = vertex->snapped = 0.0f;
				vertex->z = what % 5 == 3 ? 0.5f : vertex->z;
				break;
			}
		}
	grid->plan.folded = what >> 4 & 1;
}

static void test_as_anew(void)
{
	static struct grid grid;
	static uint32_t kept[INDICES], anew[INDICES];
	struct merge merge = {0};
	uint32_t seed = 5, most = 0, least = INDICES;
	int wrong = 0;
	for (uint32_t round = 0; round < 3000; round++) {
		struct merge fresh = {0};
		if (round % 500 == 0)
			put_vertices(&grid, CELL * (COLUMNS - 2) - round / 500 % 2 * 5, CELL * (ROWS - 2) - round / 1000);
		change(&grid, &seed);
		const uint32_t count = merge_find(&merge, &grid.plan, TOLERANCE, NULL);
		wrong += merge_find(&fresh, &grid.plan, TOLERANCE, NULL) != count;
		merge_write(&merge, &grid.plan, NULL, kept);
		merge_write(&fresh, &grid.plan, NULL, anew);
		wrong += memcmp(kept, anew, count * sizeof(*kept)) != 0;
		most = count > most ? count : most;
		least = count < least ? count : least;
		merge_finish(&fresh);
	}
	CHECK_INT(wrong, 0);
	CHECK(least < INDICES / 3 && most > INDICES / 2);
	merge_finish(&merge);
}

int main(void)
{
	RUN(test_as_anew);
	return test_result();
}
