/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The feedback ring (proto/shm.h), every interleaving of single loads and
 * stores: a writer that never waits, a reader that accepts an entry only if it
 * is whole. Stores of the writer become visible in any order but where a fence
 * or a release keeps them apart.
 */
#include "tests/race/explore.h"
#include "tests/test.h"

#define ENTRIES 2
#define FIELDS 2
#define REPORTS 5

enum fault {
	SOUND,
	NO_ODD_NUMBER, /* the entry is not marked while it is written */
	NO_FENCE,      /* fields may be seen before the mark */
	END_FREE,      /* the end mark may be seen before the fields: the count, which is released too, covers for it */
	NO_RELEASE,    /* end mark and count may be seen before the fields */
	NO_SECOND_LOOK,
	COUNT_FIRST, /* the reader skips what is not whole yet, and it is lost */
	FAULTS
};

/* Stores that are under way, in the order of the program; a barrier keeps what follows behind it. */
enum { MARK = 1, FIELD_0 = 2, FIELD_1 = 4, END = 8, COUNT = 16 };

struct rules {
	enum fault fault;
};

struct state {
	uint8_t sequence[ENTRIES], fields[ENTRIES][FIELDS], count;
	uint8_t writing, under_way;
	uint8_t reader_step, next, reading, first_look, copy[FIELDS], accepted;
};

static uint8_t must_wait_for(uint8_t store, enum fault fault)
{
	switch (store) {
	case FIELD_0:
	case FIELD_1:
		return fault == NO_FENCE ? 0 : MARK;
	case END:
		return fault == NO_RELEASE || fault == END_FREE ? MARK : MARK | FIELD_0 | FIELD_1;
	case COUNT:
		return fault == COUNT_FIRST ? 0 : fault == NO_RELEASE ? MARK | END : MARK | FIELD_0 | FIELD_1 | END;
	default:
		return 0;
	}
}

static bool start_report(struct state *s, enum fault fault)
{
	if (s->under_way || s->writing == REPORTS)
		return false;
	s->under_way = fault == NO_ODD_NUMBER ? FIELD_0 | FIELD_1 | END | COUNT : MARK | FIELD_0 | FIELD_1 | END | COUNT;
	s->writing++;
	return true;
}

static bool store(struct state *s, uint8_t which, enum fault fault)
{
	const uint8_t number = (uint8_t)(s->writing - 1), entry = number % ENTRIES;
	if (!(s->under_way & which) || s->under_way & must_wait_for(which, fault))
		return false;
	s->under_way &= (uint8_t)~which;
	if (which == MARK)
		s->sequence[entry] = (uint8_t)(2 * number + 1);
	else if (which == FIELD_0 || which == FIELD_1)
		s->fields[entry][which == FIELD_1] = s->writing;
	else if (which == END)
		s->sequence[entry] = (uint8_t)(2 * number + 2);
	else
		s->count = s->writing;
	return true;
}

static bool read_step(struct state *s, enum fault fault, const char **wrong)
{
	const uint8_t entry = s->next % ENTRIES, whole = (uint8_t)(2 * s->next + 2);
	switch (s->reader_step) {
	case 0:
		if (s->count <= s->next)
			return false;
		if (s->count - s->next > ENTRIES)
			s->next = (uint8_t)(s->count - ENTRIES);
		s->reader_step = 1;
		return true;
	case 1:
		s->first_look = s->sequence[entry];
		s->reader_step = 2;
		return true;
	case 2:
	case 3:
		s->copy[s->reader_step - 2] = s->fields[entry][s->reader_step - 2];
		s->reader_step++;
		return true;
	default:
		if (s->first_look == whole && (fault == NO_SECOND_LOOK || s->sequence[entry] == whole)) {
			if (s->copy[0] != s->next + 1 || s->copy[1] != s->next + 1)
				*wrong = "half a report was accepted";
			s->accepted++;
		}
		s->next++;
		s->reader_step = s->first_look = s->copy[0] = s->copy[1] = 0;
		return true;
	}
}

static bool step(void *state, unsigned number, const void *data, const char **wrong)
{
	const struct rules *rules = data;
	if (number == 0)
		return start_report(state, rules->fault);
	if (number == 1)
		return read_step(state, rules->fault, wrong);
	return store(state, (uint8_t)(1u << (number - 2)), rules->fault);
}

/* A reader that keeps up has lost nothing: at the end the newest report was accepted. */
static const char *check(const void *state, bool last, const void *data)
{
	const struct state *s = state;
	(void)data;
	return last && s->accepted == 0 ? "no report was ever accepted" : NULL;
}

static const char *run(enum fault fault, uint64_t *states)
{
	const struct rules rules = {fault};
	const struct state first = {.count = 0};
	struct explore_result result;
	const struct explore_model model = {sizeof(first), 7, step, check, &rules};
	explore(&model, &first, &result);
	CHECK(!result.out_of_memory);
	*states = result.states;
	return result.wrong;
}

static void test_ring(void)
{
	static const char *const names[] = {"sound",      "no odd number",  "no fence",   "end mark free",
										"no release", "no second look", "count first"};
	for (int fault = 0; fault < FAULTS; fault++) {
		uint64_t states;
		const char *wrong = run((enum fault)fault, &states);
		CHECK((wrong != NULL) == (fault != SOUND && fault != END_FREE));
		printf("       %-16s %6llu states: %s\n", names[fault], (unsigned long long)states, wrong ? wrong : "holds");
	}
}

int main(void)
{
	RUN(test_ring);
	return test_result();
}
