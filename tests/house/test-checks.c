/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The checks of tests/test.h count wherever they stand. The program runs itself once for each place with a check
 * there that does not hold, and wants it to fail; what it finds is not told by the checks that it is about.
 */
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/house/checks-elsewhere.h"
#include "tests/test.h"

#define THREADS 4
#define CHECKS_A_THREAD 1000000

struct crowd {
	pthread_barrier_t start;
	bool holds;
};

static void *check_in_thread(void *data)
{
	struct crowd *crowd = data;
	pthread_barrier_wait(&crowd->start);
	for (int i = 0; i < CHECKS_A_THREAD; i++)
		check_elsewhere(crowd->holds || i != CHECKS_A_THREAD / 2);
	return NULL;
}

static void in_threads(bool holds)
{
	struct crowd crowd = {.holds = holds};
	pthread_t threads[THREADS];
	pthread_barrier_init(&crowd.start, NULL, THREADS);
	for (int i = 0; i < THREADS; i++)
		if (pthread_create(&threads[i], NULL, check_in_thread, &crowd) != 0)
			abort();
	for (int i = 0; i < THREADS; i++)
		pthread_join(threads[i], NULL);
	pthread_barrier_destroy(&crowd.start);
}

static void in_child(void)
{
	const pid_t child = fork();
	if (child == 0) {
		check_elsewhere(false);
		_exit(0);
	}
	waitpid(child, NULL, 0);
}

static void before_skip(void)
{
	check_elsewhere(false);
	SKIP("asked for");
}

static int check_at(const char *place)
{
	if (strcmp(place, "nowhere") == 0)
		check_elsewhere(true);
	else if (strcmp(place, "file") == 0)
		check_elsewhere(false);
	else if (strcmp(place, "thread") == 0)
		in_threads(false);
	else if (strcmp(place, "child") == 0)
		in_child();
	else if (strcmp(place, "skip") == 0)
		before_skip();
	else
		return 2;
	return test_result();
}

/* Exit status of this program with a check that does not hold at `place`, what it prints thrown away. */
static int status_with(char *program, const char *place)
{
	char *const arguments[] = {program, (char *)(uintptr_t)place, NULL};
	posix_spawn_file_actions_t actions;
	int status = -1;
	pid_t child;
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
	posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
	if (posix_spawn(&child, "/proc/self/exe", &actions, NULL, arguments, environ) == 0)
		waitpid(child, &status, 0);
	posix_spawn_file_actions_destroy(&actions);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int main(int argc, char **argv)
{
	static const struct {
		const char *place;
		int want;
	} runs[] = {{"nowhere", 0}, {"file", 1}, {"thread", 1}, {"child", 1}, {"skip", 1}};
	int wrong = 0;
	if (argc > 1)
		return check_at(argv[1]);
	for (size_t i = 0; i < sizeof(runs) / sizeof(runs[0]); i++) {
		const int status = status_with(argv[0], runs[i].place);
		printf("%s a check that fails: %s: exit status %d\n", status == runs[i].want ? "ok    " : "FAILED",
			   runs[i].place, status);
		wrong += status != runs[i].want;
	}
	in_threads(true);
	printf("%d of %d checks of %d threads counted\n", (int)test_state->checks, THREADS * CHECKS_A_THREAD, THREADS);
	wrong += test_state->checks != THREADS * CHECKS_A_THREAD || test_failed() != 0;
	return wrong ? 1 : 0;
}
