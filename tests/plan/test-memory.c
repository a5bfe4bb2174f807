/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* No allocation in the steady state; planes that change under the reader. */
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>

#include "daemon/engine/analysis/levels.h"
#include "fixture.h"
#include "tests/test.h"

static atomic_int allocations;
static atomic_int fails_at; /* the allocation, counted from 1, that fails; 0: none */

/* The linker sends the analysis here (--wrap). */
void *__real_malloc(size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

void *__wrap_malloc(size_t size)
{
	return atomic_fetch_add(&allocations, 1) + 1 == atomic_load(&fails_at) ? NULL : __real_malloc(size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
	bool fails = atomic_fetch_add(&allocations, 1) + 1 == atomic_load(&fails_at);
	return fails ? NULL : __real_aligned_alloc(alignment, size);
}

static const struct fixture_spec big = {200, 150, .motion_format = PURSUIT_FORMAT_RG32F,
										.depth_format = PURSUIT_FORMAT_DEPTH32F};

static void test_no_allocation_in_the_steady_state(void)
{
	static const uint32_t sizes[][2] = {{200, 150}, {100, 75}, {1, 1}, {199, 150}, {200, 150}};
	struct plan_params params = {.last_phase = 0.5f, .display_width_mm = 1};
	struct plan plan = {0};
	struct error error;
	for (int i = 0; i < 5; i++)
		for (int field = FIELD_COUNT - 1; field >= 0; field--) {
			struct fixture_spec spec = big;
			spec.width = sizes[i][0];
			spec.height = sizes[i][1];
			struct fixture fixture;
			fixture_make(&fixture, &spec);
			fixture_fill(&fixture, (enum fixture_field)field, 1);
			fixture.frame.volatile_memory = true;
			int before = atomic_load(&allocations);
			CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
			int first = i == 0 && field == FIELD_COUNT - 1;
			CHECK_INT(atomic_load(&allocations) - before, first ? 4 : 0);
			fixture_finish(&fixture);
		}
	plan_finish(&plan);
	CHECK(!plan.vertices && !plan.indices && !plan.scratch && plan.scratch_bytes == 0);
	plan_finish(&plan);
	plan_finish(NULL);
}

static void test_still_frames_have_no_grid(void)
{
	struct plan_params params = {0};
	struct plan plan = {0};
	struct fixture fixture;
	struct error error;
	fixture_make(&fixture, &big);
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	CHECK(plan.rest == PLAN_STILL && !plan.columns && !plan.rows && !plan.index_count);
	plan_finish(&plan);
	fixture_finish(&fixture);
}

static void test_no_memory_is_said(void)
{
	struct plan_params params = {.last_phase = 0.5f, .display_width_mm = 1};
	struct plan plan = {0};
	struct fixture fixture;
	struct error error;
	fixture_make(&fixture, &big);
	fixture_fill(&fixture, FIELD_LAYERS, 1);
	for (int i = 1; i <= 4; i++) {
		error.text[0] = '\0';
		atomic_store(&fails_at, atomic_load(&allocations) + i);
		CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), -ENOMEM);
		CHECK(strstr(error.text, "200 x 150") != NULL);
		CHECK(plan.columns == 0 && plan.rows == 0 && plan.index_count == 0);
		plan_finish(&plan);
	}
	atomic_store(&fails_at, 0);
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	/* A bigger one that does not fit, then one that does. */
	params.cell = 4;
	atomic_store(&fails_at, atomic_load(&allocations) + 2);
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), -ENOMEM);
	atomic_store(&fails_at, 0);
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	CHECK_INT(plan.columns, 52);
	plan_finish(&plan);
	fixture_finish(&fixture);
}

struct scribbler {
	uint8_t *memory;
	size_t bytes;
	atomic_bool stop;
};

static void *scribble(void *data)
{
	struct scribbler *scribbler = data;
	uint32_t state = 1;
	while (!atomic_load(&scribbler->stop))
		for (size_t i = 0; i + 4 <= scribbler->bytes; i += 4 + 4 * (random_next(&state) % 7)) {
			/* Numbers, zeros and bits that are none. */
			uint32_t bits = random_next(&state), kind = bits % 4;
			float number = (float)random_quarter(&state, 9);
			if (kind == 0)
				bits = 0;
			else if (kind == 1)
				memcpy(&bits, &number, 4);
			__atomic_store_n((uint32_t *)(void *)(scribbler->memory + i), bits, __ATOMIC_RELAXED);
		}
	return NULL;
}

static void check_sane(const struct plan *plan)
{
	uint32_t vertices = plan->columns * plan->rows;
	int wrong = 0;
	for (uint32_t i = 0; i < plan->index_count; i++)
		wrong += plan->indices[i] >= vertices;
	for (uint32_t i = 0; i < vertices; i++) {
		const struct plan_vertex *v = &plan->vertices[i];
		wrong += !(v->x >= 0 && v->x <= (float)plan->width && v->y >= 0 && v->y <= (float)plan->height);
		wrong += !(fabsf(v->ux) <= 16384 && fabsf(v->uy) <= 16384 && v->z >= 0 && v->z <= 1);
	}
	for (uint32_t i = 0; i < plan->index_count; i += 3) {
		const struct plan_vertex *a = &plan->vertices[plan->indices[i]], *b = &plan->vertices[plan->indices[i + 1]];
		const struct plan_vertex *c = &plan->vertices[plan->indices[i + 2]];
		wrong += !((b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x) > 0);
	}
	CHECK_INT(wrong, 0);
	CHECK(plan->invalid_pixels <= (uint64_t)plan->width * plan->height);
}

static void scribbled(const struct fixture_spec *spec)
{
	struct fixture fixture;
	struct plan plan = {0};
	struct error error;
	pthread_t thread;
	fixture_make(&fixture, spec);
	fixture.frame.volatile_memory = true;
	struct scribbler scribbler = {.memory = fixture.memory, .bytes = fixture.bytes};
	pthread_create(&thread, NULL, scribble, &scribbler);
	for (int i = 0; i < 40; i++) {
		struct plan_params params = {
			.last_phase = 0.5f, .cell = 4 + (uint32_t)i % 13, .display_width_mm = i % 2 ? 1 : 500};
		for (int level = 0; level < PLAN_LEVEL_COUNT; level++) {
			const struct plan_kernels *kernels = plan_level_kernels((enum plan_level)level);
			if (!kernels)
				continue;
			CHECK_INT(plan_make_with(&plan, &fixture.frame, &params, kernels, &error), 0);
			check_sane(&plan);
		}
	}
	atomic_store(&scribbler.stop, true);
	pthread_join(thread, NULL);
	plan_finish(&plan);
	fixture_finish(&fixture);
}

static void test_planes_that_change_under_the_reader(void)
{
	struct fixture_spec spec = big;
	scribbled(&spec);
	spec.motion_format = PURSUIT_FORMAT_RG16F;
	spec.depth_format = PURSUIT_FORMAT_DEPTH24;
	scribbled(&spec);
	spec.depth_format = PURSUIT_FORMAT_DEPTH16;
	spec.motion_width = 77;
	spec.motion_height = 301;
	spec.depth_width = 400;
	spec.depth_height = 33;
	scribbled(&spec);
}

/* Rows end where the allocation ends, at any alignment: for the sanitizer. */
static void test_nothing_is_read_beyond_the_planes(void)
{
	struct plan_params params = {.last_phase = 0.5f, .display_width_mm = 1};
	struct plan plan = {0};
	struct error error;
	for (uint32_t shift = 0; shift < 4; shift++)
		for (uint32_t width = 1; width < 40; width++) {
			struct fixture_spec spec = {width, 9, .motion_format = PURSUIT_FORMAT_RG32F};
			struct fixture fixture;
			fixture_make(&fixture, &spec);
			fixture_fill(&fixture, FIELD_RANDOM, width);
			size_t bytes = (size_t)width * 8 * 9;
			uint8_t *tight = malloc(bytes + shift);
			for (uint32_t y = 0; y < 9; y++)
				memcpy(tight + shift + y * width * 8, fixture.motion + y * fixture.motion_plane->stride, width * 8);
			fixture.frame.header.planes[1].stride = width * 8;
			fixture.frame.planes[1] = tight + shift;
			CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
			CHECK_INT(plan.rest, PLAN_MOVES);
			free(tight);
			fixture_finish(&fixture);
		}
	plan_finish(&plan);
}

int main(void)
{
	RUN(test_no_allocation_in_the_steady_state);
	RUN(test_still_frames_have_no_grid);
	RUN(test_no_memory_is_said);
	RUN(test_planes_that_change_under_the_reader);
	RUN(test_nothing_is_read_beyond_the_planes);
	return test_result();
}
