/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* B and E, in the blocks that have a blur weight (docs/method.md, 5 and 6). */
#include "daemon/engine/cpu/executor_cpu.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define BLOCKS_OF_ITEM 32u
#define TRIANGLES_OF_ITEM 64u

static int reserve(struct weights *weights, uint32_t width, uint32_t height, struct error *error)
{
	size_t bytes = (size_t)width * height * sizeof(*weights->values);
	weights->width = width;
	weights->height = height;
	if (bytes <= weights->capacity)
		return 0;
	free(weights->values);
	weights->values = malloc(bytes);
	weights->capacity = weights->values ? bytes : 0;
	return weights->values ? 0 : error_set(error, -ENOMEM, "out of memory for the weights of %u x %u", width, height);
}

static void clear_blocks(void *context, uint32_t item, uint32_t thread)
{
	struct executor_cpu *executor = context;
	const struct weights *weights = &executor->weights;
	uint32_t end = (item + 1) * BLOCKS_OF_ITEM;
	for (uint32_t i = item * BLOCKS_OF_ITEM; i < end && i < executor->layers.count; i++) {
		const struct block *block = &executor->layers.blocks[i];
		uint32_t width = weights->width - block->x < BLOCK_SIZE ? weights->width - block->x : BLOCK_SIZE;
		for (uint32_t y = block->y; y < block->y + BLOCK_SIZE && y < weights->height; y++)
			memset(weights->values + (size_t)y * weights->width + block->x, 0, width * sizeof(*weights->values));
	}
}

/* Triangles do not overlap where they are not displaced. */
static void put_triangles(void *context, uint32_t item, uint32_t thread)
{
	const struct engine *engine = context;
	const struct warp_mesh *mesh = &engine->mesh;
	const uint32_t *lists = mesh->lists + mesh->doubtful.first;
	uint32_t end = 3 * (item + 1) * TRIANGLES_OF_ITEM;
	for (uint32_t i = 3 * item * TRIANGLES_OF_ITEM; i < end && i < mesh->doubtful.count; i += 3) {
		struct weights_corner corners[3];
		for (uint32_t k = 0; k < 3; k++) {
			const struct plan_vertex *vertex = &mesh->plan->vertices[lists[i + k]];
			corners[k] = (struct weights_corner){(double)vertex->x, (double)vertex->y};
		}
		double weight = warp_mesh_weight(mesh, lists + i, (float)engine->last_phase);
		weights_put(&cpu_of(engine)->weights, corners, (uint16_t)(65535.0 * weight + 0.5));
	}
}

static void read_weights(const struct weights *weights, const struct block *block, float out[BLOCK_PIXELS])
{
	for (uint32_t row = 0; row < BLOCK_SIZE; row++)
		for (uint32_t i = 0; i < BLOCK_SIZE; i++) {
			uint32_t x = block->x + i, y = block->y + row;
			bool inside = x < weights->width && y < weights->height;
			uint16_t value = inside ? weights->values[(size_t)y * weights->width + x] : 0;
			out[row * BLOCK_SIZE + i] = (float)value * (1.0f / 65535.0f);
		}
}

static void make_blocks(void *context, uint32_t item, uint32_t thread)
{
	struct engine *engine = context;
	struct executor_cpu *executor = cpu_of(engine);
	struct layers *layers = &executor->layers;
	uint32_t end = (item + 1) * BLOCKS_OF_ITEM;
	for (uint32_t i = item * BLOCKS_OF_ITEM; i < end && i < layers->count; i++) {
		const struct block *block = &layers->blocks[i];
		size_t at = (size_t)i * BLOCK_BYTES;
		uint8_t original[BLOCK_BYTES], low[BLOCK_BYTES];
		float weights[BLOCK_PIXELS];
		layers_take_block(block, &executor->pictures[PICTURE_ORIGINAL], original);
		layers_take_block(block, &executor->pictures[PICTURE_LOW], low);
		if (engine->params.blur == ENGINE_BLUR_EVERYWHERE)
			for (uint32_t k = 0; k < BLOCK_PIXELS; k++)
				weights[k] = 1.0f;
		else
			read_weights(&executor->weights, block, weights);
		executor->kernels->compensate(&executor->light, original, low, weights, BLOCK_PIXELS, layers->pixels[1] + at,
									  layers->pixels[0] + at);
	}
}

static int run(struct engine *engine, struct error *error)
{
	struct executor_cpu *executor = cpu_of(engine);
	struct light *light = &executor->light;
	light_prepare(light, engine->params.curve, engine->params.gamma);
	light->count = (float)engine->n;
	light->boost = (float)engine->boost;
	light->mix_only = engine->params.no_compensation;
	const bool everywhere = engine->params.blur == ENGINE_BLUR_EVERYWHERE;
	int result = layers_begin(&executor->layers, &engine->mesh.low, error);
	if (result == 0 && !everywhere)
		result = reserve(&executor->weights, engine->width, engine->height, error);
	if (result < 0)
		return result;
	const uint64_t real = engine_new_number(engine);
	contents_layer(&executor->contents, &engine->mesh.low, real, engine_new_number(engine));
	uint32_t items = (executor->layers.count + BLOCKS_OF_ITEM - 1) / BLOCKS_OF_ITEM;
	if (!everywhere) {
		uint32_t triangles = engine->mesh.doubtful.count / 3;
		pool_run(executor->base.pool, clear_blocks, executor, items);
		pool_run(executor->base.pool, put_triangles, engine, (triangles + TRIANGLES_OF_ITEM - 1) / TRIANGLES_OF_ITEM);
	}
	pool_run(executor->base.pool, make_blocks, engine, items);
	return 0;
}

const struct pass cpu_pass_compensate = {.run = run};
