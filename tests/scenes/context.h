/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A GL or GLES context without a surface, for the tests of the scenes. */
#ifndef PURSUIT_TESTS_SCENES_CONTEXT_H
#define PURSUIT_TESTS_SCENES_CONTEXT_H

#include <stdbool.h>

struct test_context {
	void *display;
	void *context;
};

/* Makes it current; false with the reason printed. es: GLES 3.1, else GL 3.3 core. */
bool test_context_init(struct test_context *context, bool es);
void test_context_finish(struct test_context *context);
void *test_context_lookup(const char *name);

#endif
