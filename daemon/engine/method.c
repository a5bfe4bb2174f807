/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/method.h"

#include <errno.h>
#include <string.h>

static const struct method *const methods[] = {
	&method_hold,    &method_black, &method_blur_hold,     &method_mcif,    &method_interpolate,
	&method_scatter, &method_grid,  &method_adaptive_grid, &method_pursuit,
};

#define METHOD_COUNT (sizeof(methods) / sizeof(methods[0]))

const struct engine_method_info *engine_methods(void)
{
	/* Filled with the same values whoever comes first. */
	static struct engine_method_info infos[METHOD_COUNT + 1];
	for (size_t i = 0; i < METHOD_COUNT; i++)
		infos[i] = (struct engine_method_info){methods[i]->name, methods[i]->description, methods[i]->lag};
	return infos;
}

const struct method *method_find(const char *name, struct error *error)
{
	if (!name)
		return &method_pursuit;
	char list[256] = "";
	for (size_t i = 0; i < METHOD_COUNT; i++) {
		if (strcmp(methods[i]->name, name) == 0)
			return methods[i];
		size_t used = strlen(list);
		snprintf(list + used, sizeof(list) - used, "%s%s", i ? ", " : "", methods[i]->name);
	}
	error_set(error, -EINVAL, "method is \"%.64s\", must be one of: %s", name, list);
	return NULL;
}
