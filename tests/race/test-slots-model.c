/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The exchange of slots and its wake-up (docs/protocol.md), every interleaving
 * of single loads and stores: a client that may die between any two of them,
 * whose ordinary stores become visible in any order until it releases them;
 * main, which turns the eventfd into a wake-up; the render thread.
 *
 * What must hold: every slot has one owner; a frame that was taken is whole and
 * the newest; nothing that was published by a living client stays untaken.
 */
#include "tests/race/explore.h"
#include "tests/test.h"

#define SLOTS_MOST 5
#define WORDS 4 /* of a frame: two of its planes, two of its header */

/* What is left out or turned round on purpose, to see that it is found. */
enum fault {
	SOUND,
	PUBLISH_WITHOUT_RELEASE, /* the exchange does not wait for the stores before it */
	PUBLISH_BEFORE_HEADER,
	LOAD_AND_STORE,    /* `latest` read and written in two steps by the daemon */
	READ_AFTER_GIVING, /* the daemon reads the planes after it has given the slot back */
	CLIENT_KEEPS_SLOT, /* fills the slot that it has published again */
	WAKE_BEFORE_PUBLISH,
	CLEAR_AFTER_LOOK, /* the render thread forgets the wake-up after it has looked */
	FAULTS
};

struct rules {
	enum fault fault;
	uint8_t slots, frames;
};

/* Bytes only: no padding. */
struct state {
	uint8_t words[SLOTS_MOST][WORDS]; /* ids, as everybody sees them */
	uint8_t latest, fresh;
	uint8_t alive, client_step, owned, filling, id;
	uint8_t pending; /* words of `filling` that only the client sees yet */
	uint8_t newest;  /* id that was exchanged last */
	uint8_t event, woken;
	uint8_t render_step, held, given, got, seen;
	uint8_t copy[WORDS];
};

static void begin(struct state *s, const struct rules *rules)
{
	memset(s, 0, sizeof(*s));
	s->latest = 1;
	s->alive = 1;
	s->owned = (uint8_t)((1u << rules->slots) - 4u);
	s->woken = 1;
}

/* ---- the client ---- */

enum client_step { PICK, FILL, PUBLISH, WAKE };

static void show_pending(struct state *s, uint8_t words)
{
	for (int i = 0; i < WORDS; i++)
		if (s->pending & words & 1 << i)
			s->words[s->filling][i] = s->id;
	s->pending &= (uint8_t)~words;
}

static void exchange(struct state *s, const struct rules *rules)
{
	const uint8_t before = s->latest;
	if (rules->fault != PUBLISH_WITHOUT_RELEASE && rules->fault != PUBLISH_BEFORE_HEADER)
		show_pending(s, 0xf);
	if (rules->fault == PUBLISH_BEFORE_HEADER)
		show_pending(s, 0x3);
	s->latest = s->filling;
	s->fresh = 1;
	s->newest = s->id;
	if (rules->fault != CLIENT_KEEPS_SLOT)
		s->owned &= (uint8_t) ~(1u << s->filling);
	s->owned |= (uint8_t)(1u << before);
}

/* Any of its slots may be the next one. */
static bool pick(struct state *s, const struct rules *rules, unsigned slot)
{
	if (!s->alive || s->client_step != PICK || s->id == rules->frames || s->pending || !(s->owned & 1u << slot))
		return false;
	s->id++;
	s->filling = (uint8_t)slot;
	s->client_step = FILL;
	return true;
}

static bool client(struct state *s, const struct rules *rules)
{
	if (!s->alive)
		return false;
	switch (s->client_step) {
	case PICK:
		return false;
	case FILL:
		s->pending = 0xf;
		s->client_step = rules->fault == WAKE_BEFORE_PUBLISH ? WAKE : PUBLISH;
		return true;
	case PUBLISH:
		exchange(s, rules);
		s->client_step = rules->fault == WAKE_BEFORE_PUBLISH ? PICK : WAKE;
		return true;
	default:
		s->event = 1;
		s->client_step = rules->fault == WAKE_BEFORE_PUBLISH ? PUBLISH : PICK;
		return true;
	}
}

/* One of the client's stores becomes visible. */
static bool drain(struct state *s, unsigned word)
{
	if (!(s->pending & 1u << word))
		return false;
	show_pending(s, (uint8_t)(1u << word));
	return true;
}

static bool die(struct state *s)
{
	if (!s->alive)
		return false;
	s->alive = 0;
	return true;
}

/* ---- the daemon ---- */

static bool mainloop(struct state *s)
{
	if (!s->event)
		return false;
	s->event = 0;
	s->woken = 1;
	return true;
}

enum render_step { SLEEP, LOOK, CLEAR, EXCHANGE, STORE, COPY, COPY_END = COPY + WORDS };

static const char *check_copy(struct state *s)
{
	for (int i = 1; i < WORDS; i++)
		if (s->copy[i] != s->copy[0])
			return "a torn frame was taken";
	if (s->copy[0] != s->got)
		return "the frame taken is not the newest one";
	if (s->got <= s->seen)
		return "time ran backwards";
	s->seen = s->got;
	return NULL;
}

static void take(struct state *s, const struct rules *rules)
{
	s->got = s->newest;
	s->given = s->held;
	s->held = s->latest;
	if (rules->fault == LOAD_AND_STORE) {
		s->render_step = STORE;
		return;
	}
	s->latest = s->given;
	s->fresh = 0;
	s->render_step = COPY;
}

static bool copy_word(struct state *s, const struct rules *rules, const char **wrong)
{
	const int word = s->render_step - COPY;
	const uint8_t slot = rules->fault == READ_AFTER_GIVING && word < 2 ? s->given : s->held;
	s->copy[word] = s->words[slot][word];
	/* A reader that is one exchange behind sees the frame before; that it may be another's by now is the fault. */
	if (rules->fault == READ_AFTER_GIVING && word < 2 && s->copy[word] <= s->seen)
		s->copy[word] = s->got;
	if (++s->render_step < COPY_END)
		return true;
	s->render_step = LOOK;
	*wrong = check_copy(s);
	memset(s->copy, 0, sizeof(s->copy));
	return true;
}

static bool render(struct state *s, const struct rules *rules, const char **wrong)
{
	const bool late_clear = rules->fault == CLEAR_AFTER_LOOK;
	switch (s->render_step) {
	case SLEEP:
		if (!s->woken)
			return false;
		s->woken = late_clear;
		s->render_step = LOOK;
		return true;
	case LOOK:
		s->render_step = s->fresh ? EXCHANGE : late_clear ? CLEAR : SLEEP;
		return true;
	case CLEAR:
		s->woken = 0;
		s->render_step = SLEEP;
		return true;
	case EXCHANGE:
		take(s, rules);
		return true;
	case STORE:
		s->latest = s->given;
		s->fresh = 0;
		s->render_step = COPY;
		return true;
	default:
		return copy_word(s, rules, wrong);
	}
}

/* ---- both ---- */

#define STEPS (4 + WORDS + SLOTS_MOST)

static bool step(void *state, unsigned number, const void *data, const char **wrong)
{
	const struct rules *rules = data;
	struct state *s = state;
	switch (number) {
	case 0:
		return client(s, rules);
	case 1:
		return die(s);
	case 2:
		return mainloop(s);
	case 3:
		return render(s, rules, wrong);
	default:
		return number < 4 + WORDS ? drain(s, number - 4) : pick(s, rules, number - 4 - WORDS);
	}
}

static const char *check(const void *state, bool last, const void *data)
{
	const struct rules *rules = data;
	const struct state *s = state;
	const unsigned away = 1u << s->latest | 1u << s->held, all = (1u << rules->slots) - 1;
	if (s->render_step == STORE)
		return NULL; /* in the midst of what should be one step */
	if (s->latest == s->held || s->owned & away)
		return "a slot has two owners";
	if ((s->owned | away) != all)
		return "a slot is lost";
	/* All that can still happen is the client's death. */
	const bool quiet = s->id == rules->frames && s->client_step == PICK && !s->pending && !s->event && !s->woken;
	(void)last;
	if (quiet && s->alive && s->render_step == SLEEP && s->seen != rules->frames)
		return "a published frame was never taken";
	return NULL;
}

static uint64_t run(const struct rules *rules, const char **wrong)
{
	struct explore_result result;
	struct state first;
	const struct explore_model model = {sizeof(first), STEPS, step, check, rules};
	_Static_assert(sizeof(struct state) <= EXPLORE_STATE_BYTES, "a state fits");
	begin(&first, rules);
	explore(&model, &first, &result);
	CHECK(!result.out_of_memory);
	*wrong = result.wrong;
	return result.states;
}

static void test_sound(void)
{
	for (uint8_t slots = 3; slots <= SLOTS_MOST; slots++) {
		const struct rules rules = {SOUND, slots, slots == SLOTS_MOST ? 4 : 5};
		const char *wrong;
		const uint64_t states = run(&rules, &wrong);
		if (wrong)
			fprintf(stderr, "%d slots: %s\n", slots, wrong);
		CHECK(wrong == NULL);
		CHECK(states > 1000);
		printf("       %d slots, %d frames: %llu states\n", slots, rules.frames, (unsigned long long)states);
	}
}

/* Each is found; a model that accepts one of them proves nothing. */
static void test_planted_faults(void)
{
	static const char *const names[FAULTS] = {
		[PUBLISH_WITHOUT_RELEASE] = "publish without release",
		[PUBLISH_BEFORE_HEADER] = "publish before the header",
		[LOAD_AND_STORE] = "load and store instead of an exchange",
		[READ_AFTER_GIVING] = "read after the slot was given back",
		[CLIENT_KEEPS_SLOT] = "client keeps its slot",
		[WAKE_BEFORE_PUBLISH] = "wake before publish",
		[CLEAR_AFTER_LOOK] = "wake-up cleared after the look",
	};
	for (int fault = SOUND + 1; fault < FAULTS; fault++) {
		const struct rules rules = {(enum fault)fault, 4, 4};
		const char *wrong;
		run(&rules, &wrong);
		CHECK(wrong != NULL);
		printf("       %-38s %s\n", names[fault], wrong ? wrong : "NOT FOUND");
	}
}

int main(void)
{
	RUN(test_sound);
	RUN(test_planted_faults);
	return test_result();
}
