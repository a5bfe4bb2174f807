/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The lab's thread: sleeps until a flip, an edge of an input or the next change
 * of a line, and does first what lines wait for. Rows are handed on only when
 * no change is due.
 */
#include <errno.h>
#include <poll.h>
#include <sched.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#include "daemon/lab/state.h"

/* A clock that stood still or jumped must not make a refresh of it. */
#define MOST_PERIOD_NS 1e9
#define PUBLISH_AGAIN_NS UINT64_C(1000000)

/* ---- flips ---- */

/* Everything that the render thread said before this flip was shown; its rows only for flips that were seen here. */
static void read_render(struct lab *lab)
{
	const struct queue_message *message;
	while ((message = queue_front(&lab->render))) {
		if (message->kind == QUEUE_PICTURE)
			lab->pictures[message->picture.serial % LAB_PICTURES] = message->picture;
		else if (message->points.vblank > lab->last_vblank)
			return;
		else
			rows_tell(&lab->rows, &message->points);
		queue_pop(&lab->render);
	}
}

/* Another presenter counts its vblanks anew: flips of the one before that were not seen up to here never come. */
static void forget_unseen(struct lab *lab)
{
	const struct queue_message *message;
	while ((message = queue_front(&lab->render))) {
		if (message->kind == QUEUE_PICTURE)
			lab->pictures[message->picture.serial % LAB_PICTURES] = message->picture;
		else if (message->points.vblank <= lab->last_vblank)
			return;
		queue_pop(&lab->render);
	}
}

/* What came on display, and its patch. */
static uint8_t look_up(struct lab *lab, const struct presenter_flip *flip)
{
	const struct lab_picture *picture = &lab->pictures[flip->serial % LAB_PICTURES];
	if (flip->shown == PRESENTER_KEPT || flip->serial == 0 || picture->serial != flip->serial)
		return POINTS_KEPT;
	lab->front_level = picture->level;
	lab->front_code = picture->code;
	return picture->show;
}

static void learn_period(struct lab *lab, const struct presenter_flip *flip)
{
	if (lab->last_vblank != 0 && flip->vblank > lab->last_vblank && flip->target_ns > lab->last_target_ns) {
		const double period =
			(double)(flip->target_ns - lab->last_target_ns) / (double)(flip->vblank - lab->last_vblank);
		if (period < MOST_PERIOD_NS)
			lab->period_ns = period;
	}
	lab->last_vblank = flip->vblank;
	lab->last_target_ns = flip->target_ns;
}

static void publish_settled(struct lab *lab, uint64_t now_ns, bool all);

static struct row *add_row(struct lab *lab, const struct presenter_flip *flip, uint64_t event_ns, uint8_t show)
{
	if (rows_full(&lab->rows))
		publish_settled(lab, event_ns, true);
	struct row *row = rows_add(&lab->rows);
	row->points.vblank = flip->vblank;
	row->points.show = show;
	row->points.late = flip->late;
	row->points.skipped = flip->skipped;
	row->points.source = (uint8_t)flip->time_source;
	row->points.level = lab->front_level;
	row->points.code = lab->front_code;
	row->points.time[POINT_TARGET] = flip->target_ns;
	row->points.time[POINT_FLIP] = flip->flip_ns;
	row->points.time[POINT_EVENT] = event_ns;
	return row;
}

static void handle_flip(struct lab *lab, const struct presenter_flip *flip, uint64_t event_ns, uint64_t now_ns)
{
	const bool level_before = lab->front_level;
	learn_period(lab, flip);
	const uint8_t show = look_up(lab, flip);
	const struct pattern_flip pattern_flip = {flip->vblank, flip->flip_ns, show, lab->front_level};
	const bool edge = outputs_flip(lab, &pattern_flip);
	struct row *row = add_row(lab, flip, event_ns, show);
	row->edge_open = edge;
	row->points.time[POINT_EDGE] = edge ? POINT_NOT_YET : POINT_UNKNOWN;
	outputs_work(lab, now_ns);
	inputs_flip(lab, row, lab->front_level != level_before);
}

static void read_flips(struct lab *lab, uint64_t now_ns)
{
	const struct queue_message *message;
	while ((message = queue_front(&lab->flips))) {
		const struct queue_message flip = *message;
		queue_pop(&lab->flips);
		read_render(lab);
		if (flip.flip.vblank < lab->last_vblank)
			forget_unseen(lab);
		handle_flip(lab, &flip.flip, flip.event_ns, now_ns > flip.event_ns ? now_ns : flip.event_ns);
	}
	read_render(lab);
}

/* ---- what others read ---- */

static void publish_lines(const struct lines *lines, char *text, bool *there)
{
	memcpy(text, lines->text, sizeof(lines->text));
	*there = lines->chip != NULL;
}

static void publish_state(struct lab *lab)
{
	struct lab_shared *shared = &lab->shared;
	publish_lines(&lab->marker, shared->marker, &shared->marker_there);
	publish_lines(&lab->strobe_lines, shared->strobe, &shared->strobe_there);
	publish_lines(&lab->photodiode, shared->photodiode, &shared->photodiode_there);
	publish_lines(&lab->trigger, shared->trigger, &shared->trigger_there);
	publish_lines(&lab->vsync_lines, shared->vsync, &shared->vsync_there);
	shared->edges = lab->edges;
	shared->late_changes = lab->late_changes;
	shared->schedule_dropped = lab->schedule.dropped;
	shared->stray_photons = lab->match.stray;
	shared->bounced = lab->match.bounced;
	shared->triggers = lab->triggers;
	shared->strobe_pulses = lab->strobe.pulses;
	shared->strobe_left_out = lab->strobe.left_out;
	shared->strobe_too_long = lab->strobe.too_long;
	shared->levels = lab->levels;
}

/* With the lock. */
static void publish(struct lab *lab, const struct points *points)
{
	struct lab_shared *shared = &lab->shared;
	shared->ring[shared->row_count++ % LAB_RING] = *points;
	spans_add(&shared->spans, points);
	latency_log_push(lab->latency_log, points);
}

/* Who reads copies much: rows can wait for that, edges cannot. */
static void publish_settled(struct lab *lab, uint64_t now_ns, bool all)
{
	struct points points;
	if (all) {
		pthread_mutex_lock(&lab->shared.lock);
	} else if (pthread_mutex_trylock(&lab->shared.lock) != 0) {
		/* Asked for without a pause, whoever reads might never get this core. */
		lab->publish_ns = now_ns + PUBLISH_AGAIN_NS;
		return;
	}
	lab->publish_ns = 0;
	while (rows_take(&lab->rows, now_ns, all, &points))
		publish(lab, &points);
	publish_state(lab);
	pthread_mutex_unlock(&lab->shared.lock);
}

/* ---- the loop ---- */

static uint64_t next_time(const struct lab *lab)
{
	uint64_t next = outputs_next(lab);
	if (inputs_next(lab) < next)
		next = inputs_next(lab);
	const uint64_t rows_ns = rows_next(&lab->rows) > lab->publish_ns ? rows_next(&lab->rows) : lab->publish_ns;
	return rows_ns < next ? rows_ns : next;
}

static int fd_of(const struct lines *lines)
{
	return lines->chip ? chip_fd(lines->chip) : -1;
}

/* The wake-up is taken back only now: the line came first. Who woke us before that has left a message. */
static bool has_more(struct lab *lab)
{
	uint64_t count;
	if (lab->woken && read(lab->wake_fd, &count, sizeof(count)) < 0)
		log_debug(lab->params.log, "lab: eventfd: %s", strerror(errno));
	lab->woken = false;
	return queue_front(&lab->flips) || atomic_load(&lab->stop) || atomic_load(&lab->park);
}

static void wait_for_work(struct lab *lab)
{
	struct lines *const inputs[] = {&lab->photodiode, &lab->trigger, &lab->vsync_lines};
	struct pollfd fds[4] = {{.fd = lab->wake_fd, .events = POLLIN}};
	for (int i = 0; i < 3; i++) {
		fds[1 + i] = (struct pollfd){.fd = fd_of(inputs[i]), .events = POLLIN};
		inputs[i]->readable = false;
	}
	if (has_more(lab))
		return;
	const uint64_t next_ns = next_time(lab), now_ns = clock_now(lab->params.clock);
	const uint64_t span = next_ns > now_ns ? next_ns - now_ns : 0;
	const struct timespec timeout = {(time_t)(span / UINT64_C(1000000000)), (long)(span % UINT64_C(1000000000))};
	const int ready = ppoll(fds, 4, next_ns == LAB_NEVER ? NULL : &timeout, NULL);
	if (ready < 0 && errno != EINTR)
		log_error(lab->params.log, "lab: poll: %s", strerror(errno));
	lab->woken = ready > 0 && fds[0].revents;
	for (int i = 0; i < 3; i++)
		inputs[i]->readable = ready > 0 && fds[1 + i].revents;
}

/* Main has the lab to itself meanwhile. */
static void stand_still(struct lab *lab)
{
	if (!atomic_load(&lab->park))
		return;
	sem_post(&lab->parked);
	while (sem_wait(&lab->go_on) < 0)
		;
}

void lab_set_priority(struct lab *lab, pthread_t thread)
{
	const bool wanted = lab->settings.priority > 0;
	const struct sched_param priority = {.sched_priority = (int)lab->settings.priority};
	if (!wanted && !atomic_load(&lab->realtime))
		return;
	const int result = pthread_setschedparam(thread, wanted ? SCHED_FIFO : SCHED_OTHER, &priority);
	atomic_store(&lab->realtime, wanted && result == 0);
	if (result != 0)
		log_warning(lab->params.log,
					"lab: no real-time priority (%s): under load, edges come later; docs/lab.md says how to permit it",
					strerror(result));
}

void *lab_run(void *data)
{
	struct lab *lab = data;
	pthread_setname_np(pthread_self(), "pursuit-lab");
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	lab_set_priority(lab, pthread_self());
	while (!atomic_load(&lab->stop)) {
		stand_still(lab);
		const uint64_t now_ns = clock_now(lab->params.clock);
		outputs_work(lab, now_ns);
		read_flips(lab, now_ns);
		inputs_work(lab, now_ns);
		publish_settled(lab, now_ns, false);
		wait_for_work(lab);
	}
	const uint64_t end_ns = clock_now(lab->params.clock);
	lab->photodiode.readable = lab->trigger.readable = true;
	read_flips(lab, end_ns);
	outputs_finish(lab);
	inputs_work(lab, end_ns);
	inputs_finish(lab);
	publish_settled(lab, end_ns, true);
	return NULL;
}
