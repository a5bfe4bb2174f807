/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/presenter.h"

#include <errno.h>
#include <string.h>

#define NAME_BYTES 32

static const struct presenter_impl *const impls[] = {&presenter_headless, &presenter_glfw, &presenter_kms, NULL};

const char *presenter_time_source_name(enum presenter_time_source source)
{
	static const char *const names[] = {"estimated", "timer", "display server", "kernel", "external vsync"};
	return source < PRESENTER_TIME_SOURCES ? names[source] : "";
}

const struct presenter_impl *const *presenter_impls(void)
{
	return impls;
}

/* Takes the next name off the list; false at its end. */
static bool next_name(const char **list, char name[NAME_BYTES])
{
	*list += strspn(*list, ", ");
	const size_t length = strcspn(*list, ", ");
	if (length == 0)
		return false;
	snprintf(name, NAME_BYTES, "%.*s", (int)(length < NAME_BYTES ? length : NAME_BYTES - 1), *list);
	*list += length;
	return true;
}

static const struct presenter_impl *find(const char *name)
{
	for (size_t i = 0; impls[i]; i++)
		if (strcmp(impls[i]->name, name) == 0)
			return impls[i];
	return NULL;
}

static int explain_missing(const char *name, struct error *error)
{
	if (find(name))
		return error_set(
			error, -EINVAL,
			"present: %s is not built into this pursuitd; use headless, or install what it needs and build "
			"again with -D%s=enabled",
			name, name);
	return error_set(error, -EINVAL, "present: there is no presenter \"%s\"; there are headless, glfw and kms", name);
}

static bool is_built(const char *name)
{
	const struct presenter_impl *impl = find(name);
	return impl && impl->create;
}

int presenter_check_list(const char *list, struct error *error)
{
	char name[NAME_BYTES];
	bool any = false;
	while (next_name(&list, name)) {
		any = true;
		if (!is_built(name))
			return explain_missing(name, error);
	}
	return any ? 0 : error_set(error, -EINVAL, "present: the list is empty; there are headless, glfw and kms");
}

bool presenter_is_listed(const char *list, const struct presenter_impl *impl)
{
	char name[NAME_BYTES];
	while (next_name(&list, name))
		if (strcmp(name, impl->name) == 0)
			return true;
	return false;
}

struct presenter *presenter_create(const char *list, const struct presenter_params *params, struct error *error)
{
	return presenter_create_before(list, NULL, params, error);
}

struct presenter *presenter_create_before(const char *list, const struct presenter_impl *than,
										  const struct presenter_params *params, struct error *error)
{
	char name[NAME_BYTES];
	error_set(error, -EINVAL, "present: the list is empty");
	while (next_name(&list, name) && (!than || strcmp(name, than->name) != 0)) {
		struct presenter *presenter = is_built(name) ? find(name)->create(params, error) : NULL;
		if (presenter)
			return presenter;
		if (!is_built(name))
			explain_missing(name, error);
		else if (params->failed)
			params->failed(params->data);
		log_warning(params->log, "%s", error->text);
	}
	return NULL;
}

/* The next of those before `than` that can be looked for; NULL: no more. */
static const struct presenter_impl *next_better(const char **list, const struct presenter_impl *than)
{
	char name[NAME_BYTES];
	while (next_name(list, name) && strcmp(name, than->name) != 0)
		if (is_built(name) && find(name)->is_possible)
			return find(name);
	*list = "";
	return NULL;
}

bool presenter_has_better(const char *list, const struct presenter_impl *than)
{
	return next_better(&list, than) != NULL;
}

struct presenter *presenter_create_better(const char *list, const struct presenter_impl *than,
										  const struct presenter_params *params)
{
	const struct presenter_impl *impl;
	while ((impl = next_better(&list, than)) != NULL) {
		struct error error;
		struct presenter *presenter = impl->is_possible(params) ? impl->create(params, &error) : NULL;
		if (presenter)
			return presenter;
		if (params->failed)
			params->failed(params->data);
	}
	return NULL;
}

void presenter_destroy(struct presenter **presenter)
{
	if (*presenter)
		(*presenter)->impl->destroy(*presenter);
	*presenter = NULL;
}
