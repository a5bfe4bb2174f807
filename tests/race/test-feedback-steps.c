/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The reading end of the feedback ring itself, not a model of it (test-feedback-model.c): before each of its machine
 * instructions in turn, the daemon writes over the entry that it is about to read, wholly or by half. What it gives
 * must be one report, whole.
 */
#include <signal.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/feedback.h"
#include "tests/client/fake_daemon.h"
#include "tests/test.h"

#define ENTRIES ((uint64_t)PURSUIT_FEEDBACK_ENTRIES)
#define MOST_RUNS 100
#define MOST_STEPS 200000
#define NO_PTRACE 77

enum stage { BEFORE, READING, AFTER };

static struct shared {
	struct pursuit_shm_control control;
	_Atomic enum stage stage; /* of the reader */
} * shared;
static struct fake_daemon fake;

static bool is_whole(const struct pursuit_feedback_report *report)
{
	const uint64_t id = report->frame_id;
	return id >= 1 && id <= ENTRIES + 1 && report->flip_ns == 1000 + id && report->shown == PURSUIT_SHOWN;
}

static pid_t start_reader(void)
{
	fflush(NULL);
	const pid_t child = fork();
	if (child != 0)
		return child;
	struct shim_feedback feedback = {0};
	struct pursuit_feedback_report report;
	if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) < 0)
		_exit(NO_PTRACE);
	shim_feedback_poll(&feedback, &shared->control,
					   &report); /* or finding the functions that it calls would be steps */
	feedback.next = 0;
	raise(SIGSTOP);
	shared->stage = READING;
	const bool got = shim_feedback_poll(&feedback, &shared->control, &report);
	shared->stage = AFTER;
	_exit(got && is_whole(&report) ? 0 : 1);
}

/* One instruction. False: it has ended. */
static bool let_step(pid_t child, int *status)
{
	return ptrace(PTRACE_SINGLESTEP, child, NULL, NULL) == 0 && waitpid(child, status, 0) == child &&
		   WIFSTOPPED(*status);
}

static void fill_ring(void)
{
	memset(shared, 0, sizeof(*shared));
	fake = (struct fake_daemon){.control = &shared->control};
	for (uint64_t id = 1; id <= ENTRIES; id++)
		fake_report(&fake, id, PURSUIT_FEEDBACK_SHOWN);
}

/* Over the oldest report. By half: as it is while the daemon writes. */
static void write_over(bool half)
{
	struct pursuit_feedback *entry = &shared->control.feedback[0];
	if (!half) {
		fake_report(&fake, ENTRIES + 1, PURSUIT_FEEDBACK_SHOWN);
		return;
	}
	entry->sequence = 2 * ENTRIES + 1;
	entry->frame_id = ENTRIES + 1;
}

/* How it ended, with the ring written over after so many instructions. */
static int run(int steps, bool half)
{
	int status = 0;
	fill_ring();
	const pid_t child = start_reader();
	waitpid(child, &status, 0);
	for (int i = 0; i < steps && WIFSTOPPED(status); i++)
		let_step(child, &status);
	write_over(half);
	while (WIFSTOPPED(status) && ptrace(PTRACE_CONT, child, NULL, NULL) == 0)
		waitpid(child, &status, 0);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The instructions between which it reads, undisturbed. */
static int find_reading(int *first, int *last)
{
	int status = 0, step = 0;
	fill_ring();
	const pid_t child = start_reader();
	waitpid(child, &status, 0);
	for (*first = *last = 0; WIFSTOPPED(status) && step < MOST_STEPS; step++) {
		if (shared->stage == BEFORE)
			*first = step;
		if (shared->stage != AFTER)
			*last = step;
		let_step(child, &status);
	}
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void test_each_instruction(void)
{
	int first, last, wrong = 0, runs = 0;
	const int undisturbed = find_reading(&first, &last);
	if (undisturbed == NO_PTRACE)
		SKIP("no child can be traced here");
	CHECK_INT(undisturbed, 0);
	CHECK(last > first + 20);
	/* With a sanitizer there are too many to try each. */
	for (int at = first; at <= last; at += 1 + (last - first) / MOST_RUNS)
		for (int half = 0; half < 2; half++, runs++)
			wrong += run(at, half != 0) != 0;
	CHECK_INT(wrong, 0);
	printf("       %d instructions, %d runs\n", last - first, runs);
}

int main(void)
{
	shared = mmap(NULL, sizeof(*shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	CHECK(shared != MAP_FAILED);
	RUN(test_each_instruction);
	return test_result();
}
