/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/admission.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "daemon/clock.h"
#include "daemon/notify.h"
#include "daemon/worker.h"

#define SECOND UINT64_C(1000000000)
#define PATIENCE_NS (5 * SECOND)

struct question {
	char users[sizeof(((struct settings *)0)->allow_users)];
	char groups[sizeof(((struct settings *)0)->allow_groups)];
};

struct answer {
	int result; /* 0, or a negative errno with the sentence */
	struct peer_list list;
	struct error error;
};

/* The thread's until it has ended. */
struct desk {
	pthread_mutex_t lock; /* for all but event_fd */
	pthread_cond_t asks, answers;
	bool stop;
	uint64_t asked, answered; /* numbers of questions; the newest counts */
	struct question question;
	struct answer answer; /* to the question `answered` */
	int event_fd;
};

struct admission {
	const struct log *log;
	uint64_t patience_ns;
	struct peer_list list; /* in force */
	struct loop_source *source;
	struct desk *desk;
	struct worker *worker;     /* NULL: not needed so far */
	uint64_t pending;          /* number of the question that the settings in force wait for, 0 none */
	struct question to_repeat; /* the pending one */
	struct {
		bool changes, known;
		struct question question;
		struct answer answer; /* if known */
		uint64_t number;      /* of the question, 0: nothing was asked */
	} prepared;
};

/* ---- the thread ---- */

static void run(void *data)
{
	struct desk *desk = data;
	const uint64_t one = 1;
	pthread_setname_np(pthread_self(), "pursuit-names");
	pthread_mutex_lock(&desk->lock);
	while (!desk->stop) {
		if (desk->answered == desk->asked) {
			pthread_cond_wait(&desk->asks, &desk->lock);
			continue;
		}
		const uint64_t number = desk->asked;
		const struct question question = desk->question;
		struct answer answer = {.result = 0};
		pthread_mutex_unlock(&desk->lock);
		answer.result = peer_look_up(question.users, question.groups, &answer.list, &answer.error);
		pthread_mutex_lock(&desk->lock);
		desk->answer = answer;
		desk->answered = number;
		pthread_cond_signal(&desk->answers);
		if (write(desk->event_fd, &one, sizeof(one)) < 0)
			continue; /* it is full: that wakes as well */
	}
	pthread_mutex_unlock(&desk->lock);
}

static void free_desk(void *data)
{
	struct desk *desk = data;
	pthread_cond_destroy(&desk->asks);
	pthread_cond_destroy(&desk->answers);
	pthread_mutex_destroy(&desk->lock);
	close(desk->event_fd);
	free(desk);
}

static struct desk *make_desk(void)
{
	struct desk *desk = calloc(1, sizeof(*desk));
	if (!desk)
		return NULL;
	desk->event_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	pthread_mutex_init(&desk->lock, NULL);
	clock_cond_init(&desk->asks);
	clock_cond_init(&desk->answers);
	if (desk->event_fd >= 0)
		return desk;
	free_desk(desk);
	return NULL;
}

/* ---- questions ---- */

/* Its number, or a negative errno with a sentence. */
static int ask(struct admission *admission, const struct question *question, uint64_t *number, struct error *error)
{
	struct desk *desk = admission->desk;
	const int result = admission->worker ? 0 : worker_create(&admission->worker, run, desk);
	if (result < 0)
		return error_set(error, result, "allow-users, allow-groups: no thread to look names up on: %s",
						 strerror(-result));
	pthread_mutex_lock(&desk->lock);
	desk->question = *question;
	*number = ++desk->asked;
	pthread_cond_signal(&desk->asks);
	pthread_mutex_unlock(&desk->lock);
	return 0;
}

/* Until then. Is it there? */
static bool get_answer(struct desk *desk, uint64_t number, uint64_t until_ns, struct answer *answer)
{
	pthread_mutex_lock(&desk->lock);
	while (desk->answered != number && clock_cond_wait(&desk->answers, &desk->lock, until_ns))
		;
	const bool there = desk->answered == number;
	if (there)
		*answer = desk->answer;
	pthread_mutex_unlock(&desk->lock);
	return there;
}

/* Main waits here, and not for long: what watches it is told each second. */
static bool wait_for_answer(const struct admission *admission, uint64_t number, struct answer *answer)
{
	const uint64_t end_ns = clock_monotonic_ns() + admission->patience_ns;
	bool there = false;
	for (uint64_t now_ns; !there && (now_ns = clock_monotonic_ns()) < end_ns;) {
		notify_send(admission->log, "WATCHDOG=1");
		there = get_answer(admission->desk, number, now_ns + SECOND < end_ns ? now_ns + SECOND : end_ns, answer);
	}
	return there;
}

/* Later than main waited. */
static void on_answer(void *data, uint32_t events)
{
	struct admission *admission = data;
	struct answer answer;
	uint64_t count;
	(void)events;
	if (read(admission->desk->event_fd, &count, sizeof(count)) < 0 || admission->pending == 0 ||
		!get_answer(admission->desk, admission->pending, 0, &answer))
		return;
	admission->pending = 0;
	if (answer.result < 0) {
		log_error(admission->log, "%s; who may be a client stays as it was", answer.error.text);
		return;
	}
	admission->list = answer.list;
	log_info(admission->log, "allow-users, allow-groups: the names are known now, and hold");
}

/* ---- life ---- */

static struct question question_of(const struct settings *settings)
{
	struct question question;
	memcpy(question.users, settings->allow_users, sizeof(question.users));
	memcpy(question.groups, settings->allow_groups, sizeof(question.groups));
	return question;
}

struct admission *admission_create(const struct admission_params *params, struct error *error)
{
	struct admission *admission = calloc(1, sizeof(*admission));
	struct desk *desk = make_desk();
	if (!admission || !desk) {
		error_set(error, -ENOMEM, "allow-users, allow-groups: out of memory or file descriptors");
	} else if (peer_look_up(params->settings->allow_users, params->settings->allow_groups, &admission->list, error) ==
			   0) {
		admission->log = params->log;
		admission->patience_ns = params->patience_ns ? params->patience_ns : PATIENCE_NS;
		admission->desk = desk;
		return admission;
	}
	if (desk)
		free_desk(desk);
	free(admission);
	return NULL;
}

void admission_destroy(struct admission **admission)
{
	struct admission *self = *admission;
	*admission = NULL;
	if (!self)
		return;
	struct desk *desk = self->desk;
	loop_remove(&self->source);
	pthread_mutex_lock(&desk->lock);
	desk->stop = true;
	pthread_cond_signal(&desk->asks);
	pthread_mutex_unlock(&desk->lock);
	if (worker_destroy(&self->worker, SECOND, free_desk))
		free_desk(desk);
	free(self);
}

int admission_watch(struct admission *admission, struct loop *loop, struct error *error)
{
	admission->source = loop_add(loop, admission->desk->event_fd, EPOLLIN, on_answer, admission);
	return admission->source ? 0
							 : error_set(error, -errno, "allow-users, allow-groups: cannot wait: %s", strerror(errno));
}

bool admission_allows(const struct admission *admission, const struct peer *peer, int socket)
{
	return peer_allowed(peer, socket, &admission->list);
}

/* ---- other settings ---- */

/* What was asked in between has taken the place of the question that was waited for. */
static void repeat_pending(struct admission *admission)
{
	struct error error;
	if (admission->pending == 0 || admission->prepared.number == 0)
		return;
	if (ask(admission, &admission->to_repeat, &admission->pending, &error) < 0)
		log_error(admission->log, "%s", error.text);
}

int admission_prepare(void *data, const struct settings *now, const struct settings *fresh, struct error *error)
{
	struct admission *admission = data;
	const struct question before = question_of(now), question = question_of(fresh);
	struct answer *answer = &admission->prepared.answer;
	admission->prepared.question = question;
	admission->prepared.number = 0;
	admission->prepared.changes =
		strcmp(before.users, question.users) != 0 || strcmp(before.groups, question.groups) != 0;
	admission->prepared.known = !peer_has_names(question.users) && !peer_has_names(question.groups);
	if (!admission->prepared.changes)
		return 0;
	if (admission->prepared.known)
		return peer_look_up(question.users, question.groups, &answer->list, error);
	const int result = ask(admission, &question, &admission->prepared.number, error);
	if (result < 0)
		return result;
	const bool there = wait_for_answer(admission, admission->prepared.number, answer);
	if (there && answer->result < 0) {
		repeat_pending(admission);
		*error = answer->error;
		return answer->result;
	}
	admission->prepared.known = there;
	return 0;
}

void admission_commit(void *data, const struct settings *fresh)
{
	struct admission *admission = data;
	(void)fresh;
	if (!admission->prepared.changes)
		return;
	admission->prepared.changes = false;
	admission->pending = 0;
	if (admission->prepared.known) {
		admission->list = admission->prepared.answer.list;
		return;
	}
	admission->pending = admission->prepared.number;
	admission->to_repeat = admission->prepared.question;
	log_warning(admission->log,
				"allow-users, allow-groups: the names are still being looked up; who may be a client stays as it was "
				"until they are known");
}

void admission_abandon(void *data)
{
	struct admission *admission = data;
	if (admission->prepared.changes)
		repeat_pending(admission);
	admission->prepared.changes = false;
}
