/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A thread that ends, ends in the midst, hangs for a while, hangs for ever; what it did before its end is seen. */

#include <pthread.h>
#include <semaphore.h>
#include <time.h>

#include "daemon/worker.h"
#include "tests/test.h"

#define PATIENCE UINT64_C(60000000000)
#define SHORT UINT64_C(20000000)

struct job {
	sem_t go, gone;
	bool waits, exits;
	int done; /* plain: ThreadSanitizer sees whether it is ordered */
};

static void work(void *data)
{
	struct job *job = data;
	if (job->waits)
		sem_wait(&job->go);
	job->done = 1;
	if (job->exits)
		pthread_exit(NULL);
	job->done = 2;
}

static void say_gone(void *data)
{
	struct job *job = data;
	job->done += 10;
	sem_post(&job->gone);
}

static void start(struct job *job, struct worker **worker)
{
	sem_init(&job->go, 0, 0);
	sem_init(&job->gone, 0, 0);
	CHECK_INT(worker_create(worker, work, job), 0);
	CHECK(*worker != NULL);
}

static void finish(struct job *job)
{
	sem_destroy(&job->go);
	sem_destroy(&job->gone);
}

static void test_ends(void)
{
	for (int exits = 0; exits < 2; exits++) {
		struct job job = {.exits = exits};
		struct worker *worker;
		start(&job, &worker);
		CHECK(worker_destroy(&worker, PATIENCE, say_gone));
		CHECK(worker == NULL);
		CHECK_INT(job.done, exits ? 1 : 2);
		finish(&job);
	}
	struct worker *none = NULL;
	CHECK(worker_destroy(&none, 0, NULL));
}

/* It is waited for as long as was said, and not longer than it lasts. */
static void test_patience(void)
{
	struct job job = {.waits = true};
	struct worker *worker;
	struct timespec before, after;
	start(&job, &worker);
	clock_gettime(CLOCK_MONOTONIC, &before);
	CHECK(!worker_destroy(&worker, 3 * SHORT, say_gone));
	clock_gettime(CLOCK_MONOTONIC, &after);
	CHECK((after.tv_sec - before.tv_sec) * 1000000000 + after.tv_nsec - before.tv_nsec >= 3 * (int64_t)SHORT);
	CHECK(worker == NULL);
	CHECK(sem_trywait(&job.gone) < 0);
	sem_post(&job.go);
	sem_wait(&job.gone);
	CHECK_INT(job.done, 12);
	finish(&job);
}

/* Ends just when the patience does: it is one or the other, and gone() is called in the one case only. */
static void test_at_the_same_time(void)
{
	int left = 0;
	for (int i = 0; i < 300; i++) {
		struct job job = {.waits = true};
		struct worker *worker;
		start(&job, &worker);
		sem_post(&job.go);
		const bool ended = worker_destroy(&worker, (uint64_t)i * 300, say_gone);
		if (!ended)
			sem_wait(&job.gone);
		left += !ended;
		CHECK_INT(job.done, ended ? 2 : 12);
		finish(&job);
	}
	printf("       %d of 300 were left\n", left);
}

static void test_left_for_ever(void)
{
	static struct job job = {.waits = true};
	struct worker *worker;
	start(&job, &worker);
	CHECK(!worker_destroy(&worker, SHORT, NULL));
	sem_post(&job.go);
}

int main(void)
{
	RUN(test_ends);
	RUN(test_patience);
	RUN(test_at_the_same_time);
	RUN(test_left_for_ever);
	return test_result();
}
