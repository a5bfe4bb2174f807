/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/match.h"

#include <string.h>

static void drop_flip(struct match *match)
{
	match->flip_count--;
	memmove(&match->flips[0], &match->flips[1], match->flip_count * sizeof(match->flips[0]));
}

static void drop_edge(struct match *match)
{
	match->edge_count--;
	memmove(&match->edges[0], &match->edges[1], match->edge_count * sizeof(match->edges[0]));
}

void match_add_flip(struct match *match, uint64_t number, uint64_t flip_ns, enum match_want want)
{
	if (match->flip_count == MATCH_FLIPS) {
		drop_flip(match);
		match->overflowed++;
	}
	match->flips[match->flip_count++] = (struct match_flip){.number = number, .flip_ns = flip_ns, .want = want};
}

void match_add_edge(struct match *match, uint64_t time_ns, bool rising)
{
	if (match->accepted_ns != 0 && time_ns < match->accepted_ns + match->debounce_ns) {
		match->bounced++;
		return;
	}
	match->accepted_ns = time_ns;
	if (match->edge_count == MATCH_EDGES) {
		drop_edge(match);
		match->overflowed++;
	}
	match->edges[match->edge_count++] = (struct match_edge){time_ns, rising};
}

static bool wants(enum match_want want, bool rising)
{
	return want == MATCH_EITHER || want == (rising ? MATCH_RISING : MATCH_FALLING);
}

/* The newest flip that this edge can belong to, NULL none. */
static struct match_flip *cause_of(struct match *match, const struct match_edge *edge)
{
	for (uint32_t i = match->flip_count; i-- > 0;) {
		struct match_flip *flip = &match->flips[i];
		if (edge->time_ns >= flip->flip_ns + match->most_ns)
			return NULL;
		if (edge->time_ns >= flip->flip_ns + match->least_ns && wants(flip->want, edge->rising))
			return flip;
	}
	return NULL;
}

/* Can no flip that is still to come be the cause of an edge at this time? */
static bool flips_complete(const struct match *match, uint64_t edge_ns, uint64_t now_ns, uint64_t hold_ns)
{
	const bool newer = match->flip_count > 0 && match->flips[match->flip_count - 1].flip_ns + match->least_ns > edge_ns;
	return newer || now_ns >= edge_ns + hold_ns;
}

/* Gives the oldest edge to its flip; true with a result if it is stray. */
static bool settle_edge(struct match *match, struct match_result *result)
{
	const struct match_edge edge = match->edges[0];
	struct match_flip *flip = cause_of(match, &edge);
	drop_edge(match);
	if (flip && flip->edge_ns == 0) {
		flip->edge_ns = edge.time_ns;
		return false;
	}
	match->stray++;
	*result = (struct match_result){MATCH_STRAY, 0, edge.time_ns};
	return true;
}

/* The oldest flip, if no edge can come for it any more. */
static bool settle_flip(struct match *match, uint64_t now_ns, uint64_t hold_ns, struct match_result *result)
{
	const struct match_flip flip = match->flips[0];
	const bool over = now_ns >= flip.flip_ns + match->most_ns + hold_ns;
	const bool edge_waits = match->edge_count > 0 && match->edges[0].time_ns < flip.flip_ns + match->most_ns;
	/* One that has its edge waits too: a second edge must still find it. */
	if (flip.want != MATCH_NONE && (!over || edge_waits))
		return false;
	*result = (struct match_result){MATCH_HIT, flip.number, flip.edge_ns};
	if (flip.want == MATCH_NONE)
		result->fate = MATCH_SILENT;
	else if (flip.edge_ns == 0)
		result->fate = MATCH_LOST;
	match->hits += result->fate == MATCH_HIT;
	match->lost += result->fate == MATCH_LOST;
	drop_flip(match);
	return true;
}

bool match_next(struct match *match, uint64_t now_ns, uint64_t hold_ns, struct match_result *result)
{
	while (match->edge_count > 0 && flips_complete(match, match->edges[0].time_ns, now_ns, hold_ns))
		if (settle_edge(match, result))
			return true;
	return match->flip_count > 0 && settle_flip(match, now_ns, hold_ns, result);
}
