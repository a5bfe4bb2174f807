/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Exhaustive exploration of a model: from the first state every step that any
 * side can take is taken, in every order, until there is no state that was not
 * seen. A state is a block of bytes without padding; two are the same if their
 * bytes are.
 */
#ifndef PURSUIT_TESTS_EXPLORE_H
#define PURSUIT_TESTS_EXPLORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define EXPLORE_STATE_BYTES 40

struct explore_model {
	size_t bytes; /* of a state, at most EXPLORE_STATE_BYTES */
	unsigned steps;
	/* Takes step `step` in place; false: it cannot be taken now. *wrong is set to a sentence if a rule is broken. */
	bool (*take)(void *state, unsigned step, const void *rules, const char **wrong);
	/* Checks a state, `last`: no step can be taken from it. NULL or a sentence. */
	const char *(*check)(const void *state, bool last, const void *rules);
	const void *rules;
};

struct explore_result {
	uint64_t states, steps;
	const char *wrong; /* the first broken rule, NULL: none */
	bool out_of_memory;
};

void explore(const struct explore_model *model, const void *first, struct explore_result *result);

#endif
