/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 *   test-stability CONTEXT GROUP [--json FILE] [--complete]
 *
 * The stability suite in one context, one group of cases. --complete adds what
 * takes minutes: 4096 x 4096 pixels, 100,000 frames.
 */
#include <stdio.h>
#include <string.h>

#include "suite.h"
#include "tests/reference/engine-context.h"

static const struct {
	const char *name;
	void (*run)(struct suite *suite);
} groups[] = {{"compensation", compensation_run}, {"motion", motion_run},
			  {"geometry", geometry_run},         {"sizes", sizes_run},
			  {"numbers", numbers_run},           {"time", time_run}};
#define GROUPS (sizeof(groups) / sizeof(groups[0]))

static int usage(const char *program)
{
	fprintf(stderr,
			"usage: %s CONTEXT GROUP [--json FILE] [--complete]\n  CONTEXT  " ENGINE_CONTEXT_USAGE "\n  GROUP    all",
			program);
	for (size_t i = 0; i < GROUPS; i++)
		fprintf(stderr, " | %s", groups[i].name);
	fprintf(stderr, "\n");
	return 2;
}

int main(int argc, char **argv)
{
	struct suite suite = {0};
	uint32_t ran = 0;
	if (argc < 3)
		return usage(argv[0]);
	for (int i = 3; i < argc; i++)
		suite.complete |= strcmp(argv[i], "--complete") == 0;
	suite.engine = engine_context_open(argv[1], "grid");
	table_init(&suite.table, argv[2], argv[1]);
	for (size_t i = 0; i < GROUPS; i++)
		if (strcmp(argv[2], "all") == 0 || strcmp(argv[2], groups[i].name) == 0) {
			groups[i].run(&suite);
			ran++;
		}
	engine_destroy(&suite.engine);
	const bool good = table_finish(&suite.table, argc, argv);
	return !ran ? usage(argv[0]) : good ? 0 : 1;
}
