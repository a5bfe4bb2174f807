/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "engine-context.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
	const char *name;
	enum engine_context_kind kind;
	bool gles;
} contexts[] = {
	{"surfaceless-gl", ENGINE_CONTEXT_EGL_SURFACELESS, false},
	{"surfaceless-gles", ENGINE_CONTEXT_EGL_SURFACELESS, true},
	{"device-gl", ENGINE_CONTEXT_EGL_DEVICE, false},
	{"osmesa", ENGINE_CONTEXT_OSMESA, false},
	{"cpu", ENGINE_CONTEXT_CPU, false},
};

struct engine *engine_context_open(const char *name, const char *method)
{
	struct engine_params params = {.method = method};
	struct error error = {""};
	size_t i = 0;
	while (i < sizeof(contexts) / sizeof(contexts[0]) && strcmp(contexts[i].name, name) != 0)
		i++;
	if (i == sizeof(contexts) / sizeof(contexts[0])) {
		fprintf(stderr, "context is %s, must be one of: " ENGINE_CONTEXT_USAGE "\n", name);
		exit(2);
	}
	params.context = contexts[i].kind;
	params.gles = contexts[i].gles;
	struct engine *engine = engine_create(&params, &error);
	if (!engine) {
		printf("skipped: %s\n", error.text);
		exit(77);
	}
	const struct engine_info *info = engine_get_info(engine);
	printf("%s, %s, %s\n", info->context, info->renderer, info->version);
	return engine;
}
