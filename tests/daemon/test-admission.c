/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Who may be a client while names are looked up: a directory that hangs holds nobody but the thread that asks it, and
 * until it has answered nobody is let in or turned away who was not before.
 */
#include <errno.h>
#include <pthread.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "daemon/admission.h"
#include "tests/test.h"

#define ALICE 54321u
#define BOB 54322u
#define SOON UINT64_C(1)
#define EVER UINT64_C(60000000000)

/* ---- the directory ---- */

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t change = PTHREAD_COND_INITIALIZER;
static bool hangs;
static unsigned asked, answered;

int __wrap_getpwnam_r(const char *name, struct passwd *entry, char *room, size_t size, struct passwd **found);

/* It knows two, but needs more room than most have for it. */
int __wrap_getpwnam_r(const char *name, struct passwd *entry, char *room, size_t size, struct passwd **found)
{
	(void)room;
	pthread_mutex_lock(&lock);
	asked++;
	pthread_cond_broadcast(&change);
	while (hangs)
		pthread_cond_wait(&change, &lock);
	answered++;
	pthread_cond_broadcast(&change);
	pthread_mutex_unlock(&lock);
	*found = NULL;
	if (strcmp(name, "broken") == 0)
		return EIO;
	if (size < 5000)
		return ERANGE;
	entry->pw_uid = strcmp(name, "alice") == 0 ? ALICE : BOB;
	if (strcmp(name, "alice") == 0 || strcmp(name, "bob") == 0)
		*found = entry;
	return 0;
}

static void let_hang(bool hang)
{
	pthread_mutex_lock(&lock);
	hangs = hang;
	pthread_cond_broadcast(&change);
	pthread_mutex_unlock(&lock);
}

static unsigned get(const unsigned *count)
{
	pthread_mutex_lock(&lock);
	const unsigned value = *count;
	pthread_mutex_unlock(&lock);
	return value;
}

static void wait_until_asked(unsigned more_than)
{
	pthread_mutex_lock(&lock);
	while (asked <= more_than)
		pthread_cond_wait(&change, &lock);
	pthread_mutex_unlock(&lock);
}

/* ---- the daemon's side ---- */

static struct {
	struct log log;
	struct loop *loop;
	struct settings settings;
	struct admission *admission;
} world;

static int begin(const char *users, uint64_t patience_ns)
{
	const struct admission_params params = {&world.log, &world.settings, patience_ns};
	struct error error = {""};
	settings_defaults(&world.settings);
	CHECK_INT(settings_set(&world.settings, "allow-users", users, &error), 0);
	world.log = (struct log){.fd = memfd_create("log", MFD_CLOEXEC), .level = LOG_LEVEL_INFO};
	world.loop = loop_create(&error);
	world.admission = admission_create(&params, &error);
	if (!world.admission) {
		printf("       %s\n", error.text);
		return -1;
	}
	return admission_watch(world.admission, world.loop, &error);
}

static void end(void)
{
	let_hang(false);
	admission_destroy(&world.admission);
	loop_destroy(&world.loop);
	close(world.log.fd);
}

static bool is_in(uid_t uid)
{
	const struct peer peer = {1, uid, uid};
	return admission_allows(world.admission, &peer, -1);
}

/* As live.c does it; `others` can make what they need, too. */
static int set(const char *users, bool others, struct error *error)
{
	struct settings fresh = world.settings;
	CHECK_INT(settings_set(&fresh, "allow-users", users, error), 0);
	const int result = admission_prepare(world.admission, &world.settings, &fresh, error);
	if (result < 0)
		return result;
	if (!others) {
		admission_abandon(world.admission);
		return 0;
	}
	admission_commit(world.admission, &fresh);
	world.settings = fresh;
	return 0;
}

static bool is_logged(const char *text)
{
	static char content[8192];
	const ssize_t got = pread(world.log.fd, content, sizeof(content) - 1, 0);
	content[got > 0 ? got : 0] = 0;
	return strstr(content, text) != NULL;
}

/* The loop runs until the log says so. */
static void wait_for_log(const char *text)
{
	struct error error;
	for (int i = 0; i < 600 && !is_logged(text); i++)
		CHECK_INT(loop_step(world.loop, 100, &error), 0);
	CHECK(is_logged(text));
}

/* ---- tests ---- */

static void test_start(void)
{
	CHECK_INT(begin("alice,7", EVER), 0);
	CHECK(is_in(ALICE) && is_in(7) && !is_in(BOB));
	end();
	CHECK_INT(begin("alice,carol", EVER), -1);
	end();
	CHECK_INT(begin("broken", EVER), -1);
	end();
}

static void *create(void *data)
{
	*(int *)data = begin("alice", EVER);
	return NULL;
}

/* At the start there is no list of before: nobody is let in or turned away until there is one. */
static void test_start_waits(void)
{
	const unsigned before = get(&asked);
	pthread_t thread;
	int result = -1;
	let_hang(true);
	CHECK_INT(pthread_create(&thread, NULL, create, &result), 0);
	wait_until_asked(before);
	CHECK(world.admission == NULL);
	let_hang(false);
	pthread_join(thread, NULL);
	CHECK_INT(result, 0);
	CHECK(is_in(ALICE) && !is_in(BOB));
	end();
}

static void test_quick_answers(void)
{
	struct error error = {""};
	CHECK_INT(begin("", EVER), 0);
	CHECK(is_in(BOB));
	CHECK_INT(set("alice", true, &error), 0);
	CHECK(is_in(ALICE) && !is_in(BOB));
	CHECK_INT(set("alice,bob", false, &error), 0);
	CHECK(!is_in(BOB));
	CHECK_INT(set("bob,carol", true, &error), -EINVAL);
	CHECK_STRING(error.text, "allow-users: there is no user \"carol\"");
	CHECK_INT(set("broken", true, &error), -EIO);
	CHECK_STRING(error.text, "allow-users: the user \"broken\" cannot be looked up: Input/output error");
	CHECK(is_in(ALICE) && !is_in(BOB));
	CHECK_INT(set("bob", true, &error), 0);
	CHECK(!is_in(ALICE) && is_in(BOB));
	CHECK_INT(set("", true, &error), 0);
	CHECK(is_in(ALICE));
	end();
}

/* The list of before holds until the answer comes, which may say that there is no such name. */
static void test_hangs(void)
{
	struct error error = {""};
	CHECK_INT(begin("alice", SOON), 0);
	let_hang(true);
	CHECK_INT(set("bob", true, &error), 0);
	CHECK(is_logged("still being looked up; who may be a client stays as it was"));
	CHECK(is_in(ALICE) && !is_in(BOB));
	let_hang(false);
	wait_for_log("the names are known now, and hold");
	CHECK(!is_in(ALICE) && is_in(BOB));
	let_hang(true);
	CHECK_INT(set("alice,carol", true, &error), 0);
	let_hang(false);
	wait_for_log("allow-users: there is no user \"carol\"; who may be a client stays as it was");
	CHECK(!is_in(ALICE) && is_in(BOB));
	end();
}

/* What comes after what hangs counts; what nobody waits for any more does not. */
static void test_changes_while_it_hangs(void)
{
	struct error error = {""};
	CHECK_INT(begin("alice", SOON), 0);
	let_hang(true);
	unsigned before = get(&asked);
	CHECK_INT(set("bob", true, &error), 0);
	wait_until_asked(before);
	CHECK_INT(set("7", true, &error), 0); /* needs no directory */
	CHECK(is_in(7) && !is_in(ALICE) && !is_in(BOB));
	CHECK_INT(set("alice", true, &error), 0);
	CHECK_INT(set("bob,7", true, &error), 0);
	before = get(&answered);
	let_hang(false);
	wait_for_log("the names are known now");
	CHECK(is_in(7) && !is_in(ALICE) && is_in(BOB));
	CHECK(get(&answered) - before >= 2);
	end();
}

/* What was waited for is asked again if what was asked since is not to be. */
static void test_abandoned_while_it_hangs(void)
{
	struct error error = {""};
	CHECK_INT(begin("7", SOON), 0);
	let_hang(true);
	CHECK_INT(set("bob", true, &error), 0);
	CHECK_INT(set("alice", false, &error), 0);
	CHECK_INT(set("8", false, &error), 0);
	CHECK(is_in(7) && !is_in(8) && !is_in(BOB));
	let_hang(false);
	wait_for_log("the names are known now");
	CHECK(is_in(BOB) && !is_in(ALICE) && !is_in(7));
	end();
}

int main(void)
{
	RUN(test_start);
	RUN(test_start_waits);
	RUN(test_quick_answers);
	RUN(test_hangs);
	RUN(test_changes_while_it_hangs);
	RUN(test_abandoned_while_it_hangs);
	return test_result();
}
