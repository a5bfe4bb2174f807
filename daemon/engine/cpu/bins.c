/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/bins.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct bin_range {
	uint16_t left, right, top, bottom; /* tiles; right and bottom excluded */
};

static bool reserve(void **memory, size_t *capacity, size_t bytes)
{
	if (bytes <= *capacity)
		return true;
	free(*memory);
	/* Room to grow, so that it soon does not any more. */
	bytes += bytes / 4;
	*memory = malloc(bytes);
	*capacity = *memory ? bytes : 0;
	return *memory != NULL;
}

static float clamp(float value, float most)
{
	return value > 0.0f ? value < most ? value : most : 0.0f;
}

/* Tiles along one axis that an interval meets; none if it lies outside. */
static void meet(float from, float to, uint32_t size, uint32_t tile, uint16_t *first, uint16_t *end)
{
	*first = *end = 0;
	if (to < 0.0f || from > (float)size)
		return;
	uint32_t last = (uint32_t)clamp(to, (float)size) / tile, most = (size - 1) / tile;
	*first = (uint16_t)((uint32_t)clamp(from, (float)size) / tile);
	*end = (uint16_t)((last < most ? last : most) + 1);
}

static struct bin_range range_of(const struct scene *scene, const uint32_t *index)
{
	const float *x = scene->x, *y = scene->y;
	uint32_t a = index[0], b = index[1], c = index[2];
	float left = x[a] < x[b] ? x[a] : x[b], right = x[a] > x[b] ? x[a] : x[b];
	float top = y[a] < y[b] ? y[a] : y[b], bottom = y[a] > y[b] ? y[a] : y[b];
	struct bin_range range;
	meet(left < x[c] ? left : x[c], right > x[c] ? right : x[c], scene->width, TILE_WIDTH, &range.left, &range.right);
	meet(top < y[c] ? top : y[c], bottom > y[c] ? bottom : y[c], scene->height, TILE_HEIGHT, &range.top, &range.bottom);
	return range;
}

/* How many triangles each tile gets, at starts[tile + 1]; how many that makes. */
static size_t count_all(struct scene *scene, uint32_t triangles)
{
	struct bins *bins = &scene->bins;
	size_t sum = 0;
	memset(bins->starts, 0, ((size_t)scene_tiles(scene) + 1) * sizeof(*bins->starts));
	for (uint32_t i = 0; i < triangles; i++) {
		struct bin_range range = range_of(scene, scene->mesh->lists + 3 * (size_t)i);
		bins->ranges[i] = range;
		for (uint32_t row = range.top; row < range.bottom; row++)
			for (uint32_t column = range.left; column < range.right; column++, sum++)
				bins->starts[row * bins->columns + column + 1]++;
	}
	return sum;
}

/* The triangles behind each other, tile by tile, each tile's in drawing order. */
static void fill_all(struct bins *bins, uint32_t triangles)
{
	uint32_t tiles = bins->columns * bins->rows;
	for (uint32_t i = 0; i < tiles; i++) {
		bins->ends[i] = bins->starts[i];
		bins->starts[i + 1] += bins->starts[i];
	}
	for (uint32_t i = 0; i < triangles; i++) {
		struct bin_range range = bins->ranges[i];
		for (uint32_t row = range.top; row < range.bottom; row++)
			for (uint32_t column = range.left; column < range.right; column++)
				bins->triangles[bins->ends[row * bins->columns + column]++] = 3 * i;
	}
}

static bool displace(struct scene *scene)
{
	const struct plan *plan = scene->mesh->plan;
	size_t count = (size_t)plan->columns * plan->rows;
	if (!reserve((void **)&scene->positions, &scene->position_bytes, 2 * count * sizeof(float)))
		return false;
	float *x = scene->positions, *y = x + count;
	for (size_t i = 0; i < count; i++) {
		const struct plan_vertex *vertex = &plan->vertices[i];
		x[i] = vertex->x + scene->phase * vertex->ux;
		y[i] = vertex->y + scene->phase * vertex->uy;
	}
	scene->x = x;
	scene->y = y;
	return true;
}

static bool sort(struct scene *scene)
{
	struct bins *bins = &scene->bins;
	const struct warp_mesh *mesh = scene->mesh;
	/* With the order kept, what is folded and torn stands among the folded. */
	uint32_t triangles = (mesh->keep_order ? mesh->folded_torn.first : mesh->list_count) / 3;
	bins->columns = (scene->width + TILE_WIDTH - 1) / TILE_WIDTH;
	bins->rows = (scene->height + TILE_HEIGHT - 1) / TILE_HEIGHT;
	size_t tile_bytes = ((size_t)scene_tiles(scene) + 1) * sizeof(uint32_t);
	if (!reserve((void **)&bins->starts, &bins->start_bytes, tile_bytes) ||
		!reserve((void **)&bins->ends, &bins->end_bytes, tile_bytes) ||
		!reserve((void **)&bins->ranges, &bins->range_bytes, triangles * sizeof(*bins->ranges)))
		return false;
	size_t sum = count_all(scene, triangles);
	if (!reserve((void **)&bins->triangles, &bins->triangle_bytes, sum * sizeof(uint32_t)))
		return false;
	fill_all(bins, triangles);
	return true;
}

int scene_prepare(struct scene *scene, struct error *error)
{
	scene->tears = scene->mesh->torn.count > 0 || scene->mesh->folded_torn.count > 0;
	if (displace(scene) && sort(scene))
		return 0;
	return error_set(error, -ENOMEM, "out of memory for %u triangles", scene->mesh->list_count / 3);
}

void scene_finish(struct scene *scene)
{
	free(scene->positions);
	free(scene->bins.starts);
	free(scene->bins.ends);
	free(scene->bins.triangles);
	free(scene->bins.ranges);
	*scene = (struct scene){0};
}
