/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The life of a display: a lost presenter is taken away, buried once it is let go, and the list is tried again. */

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/display.h"
#include "tests/test.h"

/* What presenter_create() will do, and what was done. */
static struct {
	struct presenter_params params;
	struct presenter presenter;
	unsigned failures; /* of the next attempts */
	bool loses;        /* the first of the list, which then fails */
	unsigned attempts, living;
} fake;

static struct presenter_impl fake_impl = {.name = "fake"};

struct presenter *presenter_create(const char *list, const struct presenter_params *params, struct error *error)
{
	CHECK_STRING(list, "fake");
	fake.attempts++;
	if (fake.failures > 0) {
		fake.failures--;
		error_set(error, -ENODEV, "fake: there is none now");
		return NULL;
	}
	CHECK_INT(fake.living, 0);
	if (fake.loses) {
		params->lost(params->data, "the display server went away");
		params->failed(params->data);
	}
	fake.living++;
	fake.params = *params;
	fake.presenter.impl = &fake_impl;
	return &fake.presenter;
}

void presenter_destroy(struct presenter **presenter)
{
	if (*presenter)
		fake.living--;
	*presenter = NULL;
}

struct user {
	struct presenter *presenter;
	unsigned changes;
};

static void on_change(void *data, struct presenter *presenter)
{
	struct user *user = data;
	user->presenter = presenter;
	user->changes++;
}

static void on_flip(void *data, const struct presenter_flip *flip)
{
	(void)data;
	(void)flip;
}

static void on_key(void *data, const struct presenter_key *key)
{
	(void)data;
	(void)key;
}

struct fixture {
	struct log log;
	struct clock clock;
	struct settings settings;
	struct loop *loop;
	struct user user;
	struct display *display;
};

static struct display *create(struct fixture *fixture, struct error *error)
{
	const struct display_params params = {.loop = fixture->loop,
										  .log = &fixture->log,
										  .clock = &fixture->clock,
										  .settings = &fixture->settings,
										  .flip = on_flip,
										  .key = on_key,
										  .change = on_change,
										  .data = &fixture->user};
	return display_create(&params, error);
}

static void fixture_init(struct fixture *fixture)
{
	struct error error;
	memset(fixture, 0, sizeof(*fixture));
	memset(&fake, 0, sizeof(fake));
	log_init(&fixture->log, LOG_LEVEL_ERROR);
	clock_init_real(&fixture->clock);
	settings_defaults(&fixture->settings);
	snprintf(fixture->settings.present, sizeof(fixture->settings.present), "fake");
	fixture->loop = loop_create(&error);
	CHECK(fixture->loop);
}

static void fixture_finish(struct fixture *fixture)
{
	display_destroy(&fixture->display);
	CHECK_INT(fake.living, 0);
	loop_destroy(&fixture->loop);
}

static void step(struct fixture *fixture, int timeout_ms)
{
	struct error error;
	CHECK_INT(loop_step(fixture->loop, timeout_ms, &error), 0);
}

/* Steps until change() was called so often. */
static void step_until_changes(struct fixture *fixture, unsigned changes)
{
	for (int i = 0; i < 100 && fixture->user.changes < changes; i++)
		step(fixture, 1000);
	CHECK_INT(fixture->user.changes, changes);
}

static void test_lost_and_found(void)
{
	struct fixture fixture;
	struct error error;
	fixture_init(&fixture);
	fixture.display = create(&fixture, &error);
	CHECK(fixture.display);
	CHECK(fixture.user.presenter == &fake.presenter);
	CHECK_STRING(fake.params.options.monitor, "");

	fake.params.lost(fake.params.data, "unplugged");
	fake.params.lost(fake.params.data, "again"); /* said twice: no matter */
	step_until_changes(&fixture, 2);
	CHECK(!fixture.user.presenter);
	step(&fixture, 0);
	CHECK_INT(fake.living, 1); /* it is in use still */

	fake.failures = 1;
	display_let_go(fixture.display);
	step_until_changes(&fixture, 3);
	CHECK(fixture.user.presenter == &fake.presenter);
	CHECK_INT(fake.attempts, 3);
	fixture_finish(&fixture);
}

static void test_destroyed_while_lost(void)
{
	struct fixture fixture;
	struct error error;
	fixture_init(&fixture);
	fixture.display = create(&fixture, &error);
	CHECK(fixture.display);
	fake.params.lost(fake.params.data, "unplugged");
	step_until_changes(&fixture, 2);
	fixture_finish(&fixture);
}

/* What the first of the list said before it failed is not about the second, which works. */
static void test_failed_one_was_lost(void)
{
	struct fixture fixture;
	struct error error;
	fixture_init(&fixture);
	fake.loses = true;
	fixture.display = create(&fixture, &error);
	CHECK(fixture.display);
	for (int i = 0; i < 5; i++)
		step(&fixture, 10);
	CHECK_INT(fixture.user.changes, 1);
	CHECK(fixture.user.presenter == &fake.presenter);
	fixture_finish(&fixture);
}

static void test_none_works(void)
{
	struct fixture fixture;
	struct error error = {""};
	fixture_init(&fixture);
	fake.failures = 1;
	CHECK(!create(&fixture, &error));
	CHECK_STRING(error.text, "fake: there is none now");
	CHECK_INT(fixture.user.changes, 0);
	fixture_finish(&fixture);
}

int main(void)
{
	RUN(test_lost_and_found);
	RUN(test_destroyed_while_lost);
	RUN(test_failed_one_was_lost);
	RUN(test_none_works);
	return test_result();
}
