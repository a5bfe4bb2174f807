/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/bins.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/pool.h"

/* Triangles are counted and filled in by chunks, as many as keep all threads busy; each chunk counts for each tile. */
#define CHUNKS_OF_THREAD 2u
#define LEAST_TRIANGLES 1024u
#define VERTICES_OF_ITEM 4096u

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

/* A sort under way: the chunks' triangles, one after another in drawing order. */
struct sort {
	struct scene *scene;
	uint32_t triangles, chunks;
};

static uint32_t begin_of(const struct sort *sort, uint32_t chunk)
{
	return (uint32_t)((uint64_t)sort->triangles * chunk / sort->chunks);
}

static uint32_t *cursors_of(const struct sort *sort, uint32_t chunk)
{
	return sort->scene->bins.cursors + (size_t)chunk * scene_tiles(sort->scene);
}

/* How many of its triangles each tile gets. */
static void count_chunk(void *context, uint32_t chunk, uint32_t thread)
{
	const struct sort *sort = context;
	const struct scene *scene = sort->scene;
	const struct bins *bins = &scene->bins;
	uint32_t *counts = cursors_of(sort, chunk);
	memset(counts, 0, scene_tiles(scene) * sizeof(*counts));
	for (uint32_t i = begin_of(sort, chunk); i < begin_of(sort, chunk + 1); i++) {
		struct bin_range range = range_of(scene, scene->mesh->lists + 3 * (size_t)i);
		bins->ranges[i] = range;
		for (uint32_t row = range.top; row < range.bottom; row++)
			for (uint32_t column = range.left; column < range.right; column++)
				counts[row * bins->columns + column]++;
	}
}

/* Where the triangles of each tile begin, and in them those of each chunk; how many there are. */
static size_t place(const struct sort *sort)
{
	struct bins *bins = &sort->scene->bins;
	const uint32_t tiles = scene_tiles(sort->scene);
	uint32_t at = 0;
	for (uint32_t tile = 0; tile < tiles; tile++) {
		bins->starts[tile] = at;
		for (uint32_t chunk = 0; chunk < sort->chunks; chunk++) {
			uint32_t *cursor = cursors_of(sort, chunk) + tile;
			const uint32_t count = *cursor;
			*cursor = at;
			at += count;
		}
	}
	bins->starts[tiles] = at;
	return at;
}

static void fill_chunk(void *context, uint32_t chunk, uint32_t thread)
{
	const struct sort *sort = context;
	const struct bins *bins = &sort->scene->bins;
	uint32_t *cursors = cursors_of(sort, chunk);
	for (uint32_t i = begin_of(sort, chunk); i < begin_of(sort, chunk + 1); i++) {
		struct bin_range range = bins->ranges[i];
		for (uint32_t row = range.top; row < range.bottom; row++)
			for (uint32_t column = range.left; column < range.right; column++)
				bins->triangles[cursors[row * bins->columns + column]++] = 3 * i;
	}
}

static void displace_some(void *context, uint32_t item, uint32_t thread)
{
	const struct scene *scene = context;
	const struct plan *plan = scene->mesh->plan;
	const size_t count = (size_t)plan->columns * plan->rows, end = (item + 1) * (size_t)VERTICES_OF_ITEM;
	float *x = scene->positions, *y = x + count;
	for (size_t i = item * (size_t)VERTICES_OF_ITEM; i < end && i < count; i++) {
		const struct plan_vertex *vertex = &plan->vertices[i];
		x[i] = vertex->x + scene->phase * vertex->ux;
		y[i] = vertex->y + scene->phase * vertex->uy;
	}
}

static bool displace(struct scene *scene)
{
	const struct plan *plan = scene->mesh->plan;
	const uint32_t count = plan->columns * plan->rows;
	if (!reserve((void **)&scene->positions, &scene->position_bytes, 2 * (size_t)count * sizeof(float)))
		return false;
	scene->x = scene->positions;
	scene->y = scene->positions + count;
	pool_run(scene->mesh->pool, displace_some, scene, (count + VERTICES_OF_ITEM - 1) / VERTICES_OF_ITEM);
	return true;
}

static uint32_t count_chunks(const struct scene *scene, uint32_t triangles)
{
	const uint32_t threads = pool_threads(scene->mesh->pool), most = triangles / LEAST_TRIANGLES;
	const uint32_t count = threads > 1 ? CHUNKS_OF_THREAD * threads : 1;
	return count < most ? count : most ? most : 1;
}

static bool sort(struct scene *scene)
{
	struct bins *bins = &scene->bins;
	const struct warp_mesh *mesh = scene->mesh;
	/* With the order kept, what is folded and torn stands among the folded. */
	const uint32_t triangles = (mesh->keep_order ? mesh->folded_torn.first : mesh->list_count) / 3;
	struct sort sort = {scene, triangles, count_chunks(scene, triangles)};
	bins->columns = (scene->width + TILE_WIDTH - 1) / TILE_WIDTH;
	bins->rows = (scene->height + TILE_HEIGHT - 1) / TILE_HEIGHT;
	const size_t tile_bytes = ((size_t)scene_tiles(scene) + 1) * sizeof(uint32_t);
	if (!reserve((void **)&bins->starts, &bins->start_bytes, tile_bytes) ||
		!reserve((void **)&bins->cursors, &bins->cursor_bytes, sort.chunks * tile_bytes) ||
		!reserve((void **)&bins->ranges, &bins->range_bytes, triangles * sizeof(*bins->ranges)))
		return false;
	pool_run(mesh->pool, count_chunk, &sort, sort.chunks);
	const size_t sum = place(&sort);
	if (!reserve((void **)&bins->triangles, &bins->triangle_bytes, sum * sizeof(uint32_t)))
		return false;
	pool_run(mesh->pool, fill_chunk, &sort, sort.chunks);
	return true;
}

int scene_prepare(struct scene *scene, struct error *error)
{
	scene->tears = scene->mesh->torn.count > 0 || scene->mesh->folded_torn.count > 0;
	if (displace(scene) && sort(scene))
		return 0;
	return error_set(error, -ENOMEM, "out of memory for %u triangles", scene->mesh->list_count / 3);
}

uint64_t scene_bytes(const struct scene *scene)
{
	const struct bins *bins = &scene->bins;
	return scene->position_bytes + bins->start_bytes + bins->cursor_bytes + bins->triangle_bytes + bins->range_bytes;
}

void scene_finish(struct scene *scene)
{
	free(scene->positions);
	free(scene->bins.starts);
	free(scene->bins.cursors);
	free(scene->bins.triangles);
	free(scene->bins.ranges);
	*scene = (struct scene){0};
}
