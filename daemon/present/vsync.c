/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/vsync.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WINDOW 64u /* vblanks that are judged together */
#define BAD_AT_FIRST 3
#define BAD_MOST 16
#define BOUNCE 0.125
#define OFF_VBLANK 0.25
#define RATE_DOUBT 0.025
#define JITTER 0.02
#define SILENT_VBLANKS 8.0
/* So many vblanks without becoming trusted: said, and learned from anew. */
#define PATIENCE 128u
#define QUIET_NS UINT64_C(2000000000)
/* What returns of calls and edges of one display may differ by, once so many are known. */
#define SAME_RATE 500e-6
#define SAME_STAMPS 128u
/* A call may seem to come back before its vblank by so much of a period: both are only known so well. */
#define EARLY 0.125

struct vsync {
	pthread_mutex_t lock;
	double period_ns, offset_ns;
	struct vblanks line;
	struct vsync_counts counts;
	uint64_t last_ns;                     /* of the edge that counted last since it is learned from; 0 none */
	uint64_t marks;                       /* of the last vblanks, a bit each, the newest lowest: bad */
	uint32_t judged;                      /* vblanks since it is learned from */
	uint32_t recent_extra, recent_missed; /* of these */
	uint64_t quiet_ns;                    /* when silence is said before any edge */
	bool news;                            /* state changed, and nobody has asked */
	char reason[96];                      /* why it is refused */
};

/* ---- judging ---- */

static void learn_anew(struct vsync *vsync)
{
	const uint64_t rate = (uint64_t)(1e15 / vsync->period_ns + 0.5);
	vblanks_init(&vsync->line, rate, 1000000, vsync->last_ns);
	vsync->last_ns = vsync->quiet_ns = 0;
	vsync->judged = vsync->recent_extra = vsync->recent_missed = 0;
	vsync->marks = 0;
}

static void refuse(struct vsync *vsync)
{
	vsync->news |= vsync->counts.state != VSYNC_REFUSED;
	vsync->counts.state = VSYNC_REFUSED;
	learn_anew(vsync);
}

static void mark(struct vsync *vsync, bool bad)
{
	vsync->marks = vsync->marks << 1 | bad;
	vsync->judged++;
}

static int count_bad(const struct vsync *vsync)
{
	return __builtin_popcountll(vsync->marks);
}

static bool has_rate(const struct vsync *vsync)
{
	return fabs(vsync->line.period_ns / vsync->period_ns - 1.0) <= RATE_DOUBT;
}

static void find_reason(struct vsync *vsync)
{
	const struct vblanks *line = &vsync->line;
	if (!has_rate(vsync))
		snprintf(vsync->reason, sizeof(vsync->reason), "its rate is %.2f Hz, the display's is %.2f Hz",
				 1e9 / line->period_ns, 1e9 / vsync->period_ns);
	else if (count_bad(vsync) > BAD_AT_FIRST)
		snprintf(vsync->reason, sizeof(vsync->reason), "%d of the last %u vblanks had %s", count_bad(vsync), WINDOW,
				 vsync->recent_extra > vsync->recent_missed ? "edges too many (doubled, or noise)" : "no edge");
	else
		snprintf(vsync->reason, sizeof(vsync->reason), "its edges jitter by %.0f us", line->spread_ns / 1e3);
}

static void judge(struct vsync *vsync)
{
	const struct vblanks *line = &vsync->line;
	const bool trusted = vsync->counts.state == VSYNC_TRUSTED;
	const bool good = vsync->judged >= WINDOW && count_bad(vsync) <= BAD_AT_FIRST && vblanks_known(line) &&
					  has_rate(vsync) && line->spread_ns <= JITTER * line->period_ns;
	if (!trusted && good) {
		vsync->counts.state = VSYNC_TRUSTED;
		vsync->counts.trusted++;
		vsync->news = true;
	} else if ((trusted && (count_bad(vsync) > BAD_MOST || !has_rate(vsync))) ||
			   (!trusted && vsync->judged >= PATIENCE)) {
		find_reason(vsync);
		refuse(vsync);
	}
}

/* ---- edges ---- */

/* Is it where a vblank is expected? Before the line is known: not too soon. */
static bool is_expected(const struct vsync *vsync, uint64_t time_ns)
{
	const struct grid grid = vblanks_get_grid(&vsync->line);
	const double since = (double)(time_ns - vsync->last_ns);
	if (vsync->counts.state != VSYNC_TRUSTED)
		return since >= 0.5 * vsync->period_ns;
	const double vblanks = ((double)(int64_t)(time_ns - grid.epoch_ns)) / vsync->line.period_ns;
	return since >= 0.5 * vsync->period_ns && fabs(vblanks - round(vblanks)) <= OFF_VBLANK;
}

static void count_missed(struct vsync *vsync, uint64_t time_ns)
{
	const double vblanks = round((double)(time_ns - vsync->last_ns) / vsync->line.period_ns);
	for (double i = 1.0; i < fmin(vblanks, WINDOW); i++) {
		vsync->counts.missed++;
		vsync->recent_missed++;
		mark(vsync, true);
	}
}

static void add_edge(struct vsync *vsync, uint64_t time_ns)
{
	vsync->counts.edges++;
	if (vsync->last_ns == 0) {
		vsync->last_ns = time_ns;
		vblanks_add(&vsync->line, 0, time_ns);
		return;
	}
	if (time_ns <= vsync->last_ns || (double)(time_ns - vsync->last_ns) < BOUNCE * vsync->period_ns) {
		vsync->counts.bounced++;
		return;
	}
	if (is_expected(vsync, time_ns)) {
		count_missed(vsync, time_ns);
		mark(vsync, false);
		vblanks_add(&vsync->line, 0, time_ns);
		vsync->last_ns = time_ns;
	} else {
		vsync->counts.extra++;
		vsync->recent_extra++;
		mark(vsync, true);
	}
	judge(vsync);
}

void vsync_add_edge(struct vsync *vsync, uint64_t time_ns)
{
	pthread_mutex_lock(&vsync->lock);
	add_edge(vsync, time_ns);
	pthread_mutex_unlock(&vsync->lock);
}

/* ---- silence and news ---- */

static uint64_t silent_at(const struct vsync *vsync)
{
	return vsync->last_ns + (uint64_t)(SILENT_VBLANKS * vsync->period_ns);
}

/* Before Linux 5.7 edges bear the time of day. */
static bool is_ahead(const struct vsync *vsync, uint64_t now_ns)
{
	return vsync->last_ns > now_ns && vsync->last_ns - now_ns > QUIET_NS;
}

static void check_silence(struct vsync *vsync, uint64_t now_ns)
{
	const bool was_there = vsync->last_ns != 0;
	if (is_ahead(vsync, now_ns)) {
		snprintf(vsync->reason, sizeof(vsync->reason), "its edges bear times of another clock");
		refuse(vsync);
		return;
	}
	if (vsync->quiet_ns == 0)
		vsync->quiet_ns = now_ns + QUIET_NS;
	if (now_ns < (was_there ? silent_at(vsync) : vsync->quiet_ns))
		return;
	if (vsync->counts.state == VSYNC_REFUSED) {
		learn_anew(vsync);
		return;
	}
	snprintf(vsync->reason, sizeof(vsync->reason), "no edge comes");
	refuse(vsync);
}

bool vsync_check(struct vsync *vsync, uint64_t now_ns, char sentence[VSYNC_SENTENCE])
{
	pthread_mutex_lock(&vsync->lock);
	check_silence(vsync, now_ns);
	const bool news = vsync->news;
	vsync->news = false;
	if (vsync->counts.state == VSYNC_TRUSTED)
		snprintf(sentence, VSYNC_SENTENCE, "external vsync: vblanks follow it, %.3f Hz", 1e9 / vsync->line.period_ns);
	else if (vsync->counts.state == VSYNC_REFUSED)
		snprintf(sentence, VSYNC_SENTENCE, "external vsync: not used until it is plausible: %s", vsync->reason);
	else
		snprintf(sentence, VSYNC_SENTENCE, "external vsync: being learned");
	pthread_mutex_unlock(&vsync->lock);
	return news;
}

uint64_t vsync_next(struct vsync *vsync)
{
	pthread_mutex_lock(&vsync->lock);
	uint64_t next = vsync->last_ns ? silent_at(vsync) : vsync->quiet_ns;
	if (vsync->last_ns == 0 && vsync->counts.state == VSYNC_REFUSED)
		next = UINT64_MAX;
	pthread_mutex_unlock(&vsync->lock);
	return next;
}

struct vsync_counts vsync_get_counts(struct vsync *vsync)
{
	pthread_mutex_lock(&vsync->lock);
	struct vsync_counts counts = vsync->counts;
	counts.period_ns = vsync->line.period_ns;
	counts.jitter_ns = vsync->line.spread_ns;
	pthread_mutex_unlock(&vsync->lock);
	return counts;
}

void vsync_restart(struct vsync *vsync, double offset_ns)
{
	pthread_mutex_lock(&vsync->lock);
	vsync->offset_ns = offset_ns;
	vsync->counts.state = VSYNC_LEARNING;
	vsync->last_ns = 0;
	vsync->news = false;
	learn_anew(vsync);
	pthread_mutex_unlock(&vsync->lock);
}

/* ---- presenters ---- */

void vsync_expect(struct vsync *vsync, double period_ns)
{
	if (!vsync || !(period_ns > 0.0))
		return;
	pthread_mutex_lock(&vsync->lock);
	if (fabs(period_ns / vsync->period_ns - 1.0) > RATE_DOUBT) {
		vsync->period_ns = period_ns;
		vsync->counts.state = VSYNC_LEARNING;
		learn_anew(vsync);
	}
	pthread_mutex_unlock(&vsync->lock);
}

/* With the lock. */
static bool find_grid(const struct vsync *vsync, uint64_t now_ns, struct grid *grid)
{
	if (vsync->counts.state != VSYNC_TRUSTED || now_ns > silent_at(vsync) || is_ahead(vsync, now_ns))
		return false;
	*grid = vblanks_get_grid(&vsync->line);
	grid->epoch_ns = (uint64_t)((int64_t)grid->epoch_ns + (int64_t)vsync->offset_ns);
	return true;
}

uint64_t vsync_get_grid(struct vsync *vsync, uint64_t now_ns, struct grid *grid)
{
	if (!vsync)
		return 0;
	pthread_mutex_lock(&vsync->lock);
	const uint64_t trust = find_grid(vsync, now_ns, grid) ? vsync->counts.trusted : 0;
	pthread_mutex_unlock(&vsync->lock);
	return trust;
}

bool vsync_date_back(struct vsync *vsync, const struct vblanks *display, uint64_t *time_ns, uint64_t *sequence)
{
	struct grid grid;
	if (vsync_get_grid(vsync, *time_ns, &grid) == 0)
		return false;
	const double period_ns = grid_period_ns(&grid);
	if (display->memory >= SAME_STAMPS && fabs(display->period_ns / period_ns - 1.0) > SAME_RATE)
		return false;
	const uint64_t vblank = grid_at_or_after(&grid, *time_ns + (uint64_t)(EARLY * period_ns) + 1) - 1;
	*time_ns = grid_time(&grid, vblank);
	*sequence = vblank + 1;
	return true;
}

/* ---- life ---- */

struct vsync *vsync_create(double period_ns, double offset_ns)
{
	pthread_mutexattr_t attributes;
	struct vsync *vsync = calloc(1, sizeof(*vsync));
	if (!vsync)
		return NULL;
	pthread_mutexattr_init(&attributes);
	pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
	pthread_mutex_init(&vsync->lock, &attributes);
	pthread_mutexattr_destroy(&attributes);
	vsync->period_ns = period_ns;
	vsync->offset_ns = offset_ns;
	learn_anew(vsync);
	return vsync;
}

void vsync_destroy(struct vsync **vsync)
{
	struct vsync *self = *vsync;
	*vsync = NULL;
	if (!self)
		return;
	pthread_mutex_destroy(&self->lock);
	free(self);
}
