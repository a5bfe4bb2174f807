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

	bool can_be_better;          /* there is one before it in the list */
	unsigned better_in;          /* it works after so many looks; 0: not */
	struct presenter_params own; /* of the better one */
	struct presenter better;
	bool loses_better; /* right after it was made */
} fake;

static struct presenter_impl fake_impl = {.name = "fake"}, better_impl = {.name = "better"};

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

struct presenter *presenter_create_before(const char *list, const struct presenter_impl *than,
										  const struct presenter_params *params, struct error *error)
{
	(void)list;
	(void)than;
	(void)params;
	error_set(error, -ENODEV, "fake: there is no other");
	return NULL;
}

bool presenter_is_listed(const char *list, const struct presenter_impl *impl)
{
	return strstr(list, impl->name) != NULL;
}

bool presenter_has_better(const char *list, const struct presenter_impl *than)
{
	CHECK_STRING(list, "fake");
	return fake.can_be_better && than == &fake_impl;
}

struct presenter *presenter_create_better(const char *list, const struct presenter_impl *than,
										  const struct presenter_params *params)
{
	CHECK(presenter_has_better(list, than));
	CHECK_INT(fake.living, 1); /* the other one shows meanwhile */
	fake.attempts++;
	if (fake.better_in == 0 || --fake.better_in > 0)
		return NULL;
	fake.living++;
	fake.own = *params;
	fake.better.impl = &better_impl;
	if (fake.loses_better)
		params->lost(params->data, "gone again");
	return &fake.better;
}

void presenter_destroy(struct presenter **presenter)
{
	if (*presenter)
		fake.living--;
	*presenter = NULL;
}

struct user {
	struct display *display; /* is let go of at once; NULL: when the test says so */
	struct presenter *presenter;
	unsigned changes;
	bool waits; /* there is none, and another was promised */
};

static void on_change(void *data, struct presenter *presenter, bool lost)
{
	struct user *user = data;
	const bool had_one = user->presenter != NULL;
	CHECK(!lost || !presenter);
	user->presenter = presenter;
	user->waits = !presenter && !lost;
	user->changes++;
	if (user->display && had_one)
		display_let_go(user->display);
}

static void on_flip(void *data, const struct presenter *presenter, const struct presenter_flip *flip)
{
	(void)data;
	(void)presenter;
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

/* While none works, or the user has not let go of the one before: settings of others are nothing to wait for. */
static void test_others_settings_while_none_works(void)
{
	struct fixture fixture;
	struct error error = {""};
	fixture_init(&fixture);
	fixture.display = create(&fixture, &error);
	fake.failures = 1;
	fake.params.lost(fake.params.data, "unplugged");
	step_until_changes(&fixture, 2);
	struct settings fresh = fixture.settings;
	for (unsigned i = 0; i < 2; i++) {
		const unsigned attempts = fake.attempts;
		snprintf(fresh.record, sizeof(fresh.record), "%u", i);
		CHECK_INT(display_prepare(fixture.display, &fresh, &error), 0);
		display_commit(fixture.display);
		CHECK_INT(display_prepare(fixture.display, &fresh, &error), 0);
		display_abandon(fixture.display);
		CHECK_INT(fake.attempts, attempts);
		display_let_go(fixture.display);
		step(&fixture, 0);
	}
	/* Its own are tried. */
	snprintf(fresh.monitor, sizeof(fresh.monitor), "another");
	fresh.refresh_numerator = 60;
	CHECK(display_prepare(fixture.display, &fresh, &error) < 0);
	step_until_changes(&fixture, 3);
	CHECK(fixture.user.presenter == &fake.presenter);
	fixture_finish(&fixture);
}

/* Settings that are changed again and again do not keep one that is better from being looked for. */
static void test_better_one_among_changes(void)
{
	struct fixture fixture;
	struct error error;
	fixture_init(&fixture);
	fake.can_be_better = true;
	fake.better_in = 1;
	fixture.display = create(&fixture, &error);
	struct settings fresh = fixture.settings;
	for (unsigned i = 0; i < 200 && fixture.user.changes < 2; i++) {
		snprintf(fresh.record, sizeof(fresh.record), "%u", i);
		CHECK_INT(display_prepare(fixture.display, &fresh, &error), 0);
		display_commit(fixture.display);
		step(&fixture, 20);
	}
	CHECK_INT(fixture.user.changes, 2);
	CHECK(fixture.user.presenter == &fake.better);
	display_let_go(fixture.display);
	step(&fixture, 10);
	fixture_finish(&fixture);
}

/* One that stands before it in the list works again: it takes over, without a moment that nobody could show in. */
static void test_better_one(void)
{
	struct fixture fixture;
	struct error error;
	fixture_init(&fixture);
	fake.can_be_better = true;
	fake.better_in = 2;
	fixture.display = create(&fixture, &error);
	CHECK(fixture.display);
	step_until_changes(&fixture, 2);
	CHECK(fixture.user.presenter == &fake.better);
	CHECK_INT(fake.living, 2);
	fake.params.lost(fake.params.data, "which nobody cares for any more");
	step(&fixture, 100);
	CHECK_INT(fixture.user.changes, 2);
	CHECK_INT(fake.living, 2); /* it is in use still */

	display_let_go(fixture.display);
	for (int i = 0; i < 5; i++)
		step(&fixture, 10);
	CHECK_INT(fake.living, 1);
	CHECK_INT(fixture.user.changes, 2);

	/* And the list from its start when that is lost. */
	fake.own.lost(fake.own.data, "unplugged");
	step_until_changes(&fixture, 3);
	CHECK(!fixture.user.presenter);
	display_let_go(fixture.display);
	step_until_changes(&fixture, 4);
	CHECK(fixture.user.presenter == &fake.presenter);
	fixture_finish(&fixture);
}

/* It was lost before it was used. */
static void test_better_one_lost(void)
{
	struct fixture fixture;
	struct error error;
	fixture_init(&fixture);
	fake.can_be_better = fake.loses_better = true;
	fake.better_in = 1;
	fixture.display = create(&fixture, &error);
	step_until_changes(&fixture, 2);
	display_let_go(fixture.display);
	step_until_changes(&fixture, 3);
	CHECK(!fixture.user.presenter);
	display_let_go(fixture.display);
	step_until_changes(&fixture, 4);
	CHECK(fixture.user.presenter == &fake.presenter);
	fixture_finish(&fixture);
}

/* Of windows there can be but one: it goes first, and comes back if the other cannot be made. */
static void test_other_settings(void)
{
	struct fixture fixture;
	struct error error = {""};
	struct settings fresh;
	fixture_init(&fixture);
	fake_impl.kind = PRESENTER_WINDOW;
	fixture.display = create(&fixture, &error);
	fixture.user.display = fixture.display;
	fresh = fixture.settings;

	/* What does not concern a window changes nothing. */
	snprintf(fresh.connector, sizeof(fresh.connector), "DP-1");
	CHECK_INT(display_prepare(fixture.display, &fresh, &error), 0);
	display_commit(fixture.display);
	CHECK_INT(fixture.user.changes, 1);

	for (unsigned i = 0; i < 100; i++) {
		const unsigned changes = fixture.user.changes;
		snprintf(fresh.monitor, sizeof(fresh.monitor), "%u", i);
		CHECK_INT(display_prepare(fixture.display, &fresh, &error), 0);
		CHECK_INT(fixture.user.changes, changes + 2); /* none, and the other one */
		CHECK(!fixture.user.waits);
		display_commit(fixture.display);
		CHECK_STRING(fake.params.options.monitor, fresh.monitor);
		CHECK_INT(fake.living, 1);

		/* It cannot be made: the old one is back. */
		struct settings wrong = fresh;
		snprintf(wrong.monitor, sizeof(wrong.monitor), "wrong");
		fake.failures = 1;
		CHECK(display_prepare(fixture.display, &wrong, &error) < 0);
		CHECK_STRING(error.text, "fake: there is none now");
		CHECK_STRING(fake.params.options.monitor, fresh.monitor);
		CHECK_INT(fake.living, 1);

		/* It was made, and somebody else could not make his: the old one is back, too. */
		CHECK_INT(display_prepare(fixture.display, &wrong, &error), 0);
		CHECK_STRING(fake.params.options.monitor, "wrong");
		display_abandon(fixture.display);
		CHECK_STRING(fake.params.options.monitor, fresh.monitor);
		CHECK(fixture.user.presenter == &fake.presenter);
		CHECK_INT(fake.living, 1);
		step(&fixture, 0);
	}
	/* And when it is lost, it comes back with the settings that were taken last. */
	fixture.user.display = NULL;
	fake.params.lost(fake.params.data, "unplugged");
	const unsigned changes = fixture.user.changes;
	step_until_changes(&fixture, changes + 1);
	display_let_go(fixture.display);
	step_until_changes(&fixture, changes + 2);
	CHECK_STRING(fake.params.options.monitor, "99");
	fake_impl.kind = PRESENTER_MEMORY;
	fixture_finish(&fixture);
}

/* Neither the other one nor that of before: the user is told not to wait. */
static void test_neither_works(void)
{
	struct fixture fixture;
	struct error error = {""};
	struct settings fresh;
	fixture_init(&fixture);
	fake_impl.kind = PRESENTER_WINDOW;
	fixture.display = create(&fixture, &error);
	fixture.user.display = fixture.display;
	fresh = fixture.settings;
	snprintf(fresh.monitor, sizeof(fresh.monitor), "1");
	fake.failures = 2;
	CHECK(display_prepare(fixture.display, &fresh, &error) < 0);
	CHECK_INT(fixture.user.changes, 3); /* it goes, and no other comes */
	CHECK(!fixture.user.presenter && !fixture.user.waits);
	step_until_changes(&fixture, 4);
	CHECK(fixture.user.presenter == &fake.presenter);
	CHECK_STRING(fake.params.options.monitor, "");

	/* One that is let go of too late to wait for it. */
	fixture.user.display = NULL;
	CHECK_INT(display_prepare(fixture.display, &fresh, &error), -ETIMEDOUT);
	CHECK_INT(fixture.user.changes, 5);
	CHECK(!fixture.user.presenter && fixture.user.waits);
	fake.failures = 1;
	display_let_go(fixture.display);
	step_until_changes(&fixture, 6);
	CHECK(!fixture.user.presenter && !fixture.user.waits);
	step_until_changes(&fixture, 7);
	CHECK(fixture.user.presenter == &fake.presenter);
	fake_impl.kind = PRESENTER_MEMORY;
	fixture_finish(&fixture);
}

int main(void)
{
	RUN(test_lost_and_found);
	RUN(test_destroyed_while_lost);
	RUN(test_failed_one_was_lost);
	RUN(test_none_works);
	RUN(test_others_settings_while_none_works);
	RUN(test_better_one_among_changes);
	RUN(test_better_one);
	RUN(test_better_one_lost);
	RUN(test_other_settings);
	RUN(test_neither_works);
	return test_result();
}
