/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What every test program uses: checks that name file, line and values, go on
 * after a failure, and an exit status for meson (0 passed, 1 failed, 77 skipped).
 *
 *   int main(void) { RUN(test_one); RUN(test_two); return test_result(); }
 */
#ifndef PURSUIT_TEST_H
#define PURSUIT_TEST_H

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* One a program, in which all its files, threads and forked children count: the linker merges, the page is shared. */
struct test_state {
	atomic_int failed, checks;
};

__attribute__((weak)) struct test_state *test_state;

__attribute__((constructor)) static void test_state_init(void)
{
	if (test_state)
		return;
	void *page = mmap(NULL, sizeof(*test_state), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (page == MAP_FAILED) {
		perror("mmap");
		exit(1);
	}
	test_state = page;
}

/* Checks that have failed up to now. */
static inline int test_failed(void)
{
	return test_state->failed;
}

#define CHECK(condition)                                                                            \
	do {                                                                                            \
		test_state->checks++;                                                                       \
		if (!(condition)) {                                                                         \
			test_state->failed++;                                                                   \
			fprintf(stderr, "%s:%d: %s: not true: %s\n", __FILE__, __LINE__, __func__, #condition); \
		}                                                                                           \
	} while (0)

#define CHECK_INT(got, want)                                                                                       \
	do {                                                                                                           \
		long long got_ = (long long)(got), want_ = (long long)(want);                                              \
		test_state->checks++;                                                                                      \
		if (got_ != want_) {                                                                                       \
			test_state->failed++;                                                                                  \
			fprintf(stderr, "%s:%d: %s: %s is %lld, not %lld\n", __FILE__, __LINE__, __func__, #got, got_, want_); \
		}                                                                                                          \
	} while (0)

#define CHECK_NEAR(got, want, tolerance)                                                                               \
	do {                                                                                                               \
		double got_ = (double)(got), want_ = (double)(want), tolerance_ = (double)(tolerance);                         \
		test_state->checks++;                                                                                          \
		if (!(fabs(got_ - want_) <= tolerance_)) {                                                                     \
			test_state->failed++;                                                                                      \
			fprintf(stderr, "%s:%d: %s: %s is %.9g, not %.9g within %.3g\n", __FILE__, __LINE__, __func__, #got, got_, \
					want_, tolerance_);                                                                                \
		}                                                                                                              \
	} while (0)

#define CHECK_STRING(got, want)                                                                          \
	do {                                                                                                 \
		const char *got_ = (got), *want_ = (want);                                                       \
		test_state->checks++;                                                                            \
		if (!got_ || strcmp(got_, want_) != 0) {                                                         \
			test_state->failed++;                                                                        \
			fprintf(stderr, "%s:%d: %s: %s is \"%s\", not \"%s\"\n", __FILE__, __LINE__, __func__, #got, \
					got_ ? got_ : "(null)", want_);                                                      \
		}                                                                                                \
	} while (0)

#define RUN(function)                                                                 \
	do {                                                                              \
		const int before_ = test_failed();                                            \
		function();                                                                   \
		printf("%s %s\n", test_failed() == before_ ? "ok    " : "FAILED", #function); \
		fflush(stdout);                                                               \
	} while (0)

/* Ends the program as skipped: something that the machine lacks, said plainly. What had failed before has failed. */
#define SKIP(reason)                     \
	do {                                 \
		printf("skipped: %s\n", reason); \
		exit(test_failed() ? 1 : 77);    \
	} while (0)

static inline int test_result(void)
{
	printf("%d checks, %d failed\n", (int)test_state->checks, test_failed());
	return test_failed() ? 1 : 0;
}

#endif
