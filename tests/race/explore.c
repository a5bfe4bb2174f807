/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/race/explore.h"

#include <stdlib.h>
#include <string.h>

#define FIRST_ROOM ((uint64_t)1 << 16)

struct state {
	uint8_t bytes[EXPLORE_STATE_BYTES];
};

/* All states seen, in the order of their discovery, and where each is by its hash. */
struct table {
	struct state *states;
	uint64_t count, room;
	uint64_t *places; /* index + 1, 0: free; twice as many as there is room for states */
};

static uint64_t hash_of(const struct state *state)
{
	uint64_t hash = UINT64_C(14695981039346656037);
	for (size_t i = 0; i < sizeof(state->bytes); i++)
		hash = (hash ^ state->bytes[i]) * UINT64_C(1099511628211);
	return hash ^ hash >> 29;
}

static uint64_t *place_of(const struct table *table, const struct state *state)
{
	const uint64_t mask = 2 * table->room - 1;
	uint64_t at = hash_of(state) & mask;
	while (table->places[at] && memcmp(&table->states[table->places[at] - 1], state, sizeof(*state)) != 0)
		at = (at + 1) & mask;
	return &table->places[at];
}

static bool grow(struct table *table)
{
	const uint64_t room = table->room ? table->room * 2 : FIRST_ROOM;
	struct state *states = realloc(table->states, room * sizeof(*states));
	uint64_t *places = calloc(2 * room, sizeof(*places));
	if (states)
		table->states = states;
	if (!states || !places) {
		free(places);
		return false;
	}
	free(table->places);
	table->places = places;
	table->room = room;
	for (uint64_t i = 0; i < table->count; i++)
		*place_of(table, &table->states[i]) = i + 1;
	return true;
}

static bool add(struct table *table, const struct state *state)
{
	if (table->count == table->room && !grow(table))
		return false;
	uint64_t *place = place_of(table, state);
	if (*place)
		return true;
	table->states[table->count++] = *state;
	*place = table->count;
	return true;
}

void explore(const struct explore_model *model, const void *first, struct explore_result *result)
{
	struct table table = {0};
	struct state state = {{0}};
	*result = (struct explore_result){0};
	memcpy(&state, first, model->bytes);
	result->out_of_memory = !add(&table, &state);
	for (uint64_t i = 0; i < table.count && !result->wrong && !result->out_of_memory; i++) {
		bool last = true;
		for (unsigned step = 0; step < model->steps && !result->wrong; step++) {
			state = table.states[i];
			if (!model->take(&state, step, model->rules, &result->wrong))
				continue;
			last = false;
			result->steps++;
			result->out_of_memory |= !add(&table, &state);
		}
		if (!result->wrong)
			result->wrong = model->check(&table.states[i], last, model->rules);
	}
	result->states = table.count;
	free(table.states);
	free(table.places);
}
