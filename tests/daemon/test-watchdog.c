/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The watchdog against loops that work, idle, spin, or are in one long step; the presentation loop is this test's. */

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "daemon/notify.h"
#include "tests/daemon/fixture.h"

#define LOOK_MS 50 /* a third of the interval */

static uint64_t beats, rounds;
static bool beating = true, going = true;
static struct loop *loop;
static int manager = -1;

uint64_t output_beats(const struct output *output)
{
	(void)output;
	return beats += beating;
}

uint64_t output_rounds(const struct output *output)
{
	(void)output;
	return rounds += going;
}

void output_wake(struct output *output)
{
	(void)output;
}

static bool was_fed(void)
{
	char state[256];
	ssize_t got;
	bool fed = false;
	while ((got = recv(manager, state, sizeof(state) - 1, MSG_DONTWAIT)) > 0) {
		state[got] = 0;
		fed |= strstr(state, "WATCHDOG=1") != NULL;
	}
	return fed;
}

static void run_for(unsigned ms)
{
	struct error error;
	for (const uint64_t end = now_ns() + ms * UINT64_C(1000000); now_ns() < end;)
		loop_step(loop, 1, &error);
}

/* Nobody takes what is there: it is ready at once again. */
static void on_ready(void *data, uint32_t events)
{
	uint64_t *calls = data;
	(void)events;
	(*calls)++;
}

/* The same, but each time is work. */
static void on_message(void *data, uint32_t events)
{
	on_ready(data, events);
	loop_add_work(loop, 1);
}

/* Is there some while, a few looks long, in which it was fed in no look? A busy machine may spin too slowly in others.
 */
static bool starves(void)
{
	bool fed = true;
	for (int i = 0; i < 100 && fed; i++) {
		run_for(2 * LOOK_MS);
		was_fed();
		run_for(4 * LOOK_MS);
		fed = was_fed();
	}
	return !fed;
}

static bool is_fed(void)
{
	bool fed = false;
	was_fed();
	for (int i = 0; i < 100 && !fed; i++) {
		run_for(4 * LOOK_MS);
		fed = was_fed();
	}
	return fed;
}

static void test_main_loop(void)
{
	const int fd = eventfd(1, EFD_CLOEXEC);
	uint64_t calls = 0;
	CHECK(is_fed()); /* idle */
	struct loop_source *busy = loop_add(loop, fd, EPOLLIN, on_message, &calls);
	CHECK(is_fed());
	loop_remove(&busy);
	struct loop_source *spinning = loop_add(loop, fd, EPOLLIN, on_ready, &calls);
	CHECK(starves());
	loop_remove(&spinning);
	CHECK(is_fed());
	CHECK(calls > WATCHDOG_ROUNDS * 6 * LOOK_MS / 1000);
	close(fd);
}

static void *burn(void *data)
{
	atomic_bool *stop = data;
	while (!atomic_load(stop))
		continue;
	return NULL;
}

/* So many looks, of which the first may count what was before. */
static bool is_fed_within(int looks)
{
	run_for(LOOK_MS * 3 / 2);
	was_fed();
	run_for((unsigned)looks * LOOK_MS);
	return was_fed();
}

/* The presentation loop stands; `moves`: but goes round, with a presenter that shows nothing. */
static bool is_fed_without_beat(bool moves)
{
	beating = true;
	is_fed();
	beating = false;
	going = moves;
	const bool fed = is_fed_within(6);
	beating = going = true;
	return fed;
}

static void test_long_step(void)
{
	atomic_bool stop = false;
	pthread_t worker;
	CHECK(!is_fed_without_beat(false));
	CHECK(!is_fed_without_beat(true));
	pthread_create(&worker, NULL, burn, &stop);
	bool fed = false; /* where it is let work enough */
	for (int i = 0; i < 100 && !fed; i++)
		fed = is_fed_without_beat(false);
	CHECK(fed);
	CHECK(!is_fed_without_beat(true));
	beating = going = false; /* for ever */
	run_for(LOOK_MS * 3 * (WATCHDOG_LONGEST + 1));
	CHECK(!is_fed_within(6));
	beating = going = true;
	CHECK(is_fed());
	atomic_store(&stop, true);
	pthread_join(worker, NULL);
}

int main(void)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	struct watchdog *watchdog = NULL;
	struct error error = {""};
	struct log log;
	char folder[] = "/tmp/pursuit-watchdog-XXXXXX", interval[32];
	CHECK(mkdtemp(folder) != NULL);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s/notify", folder);
	snprintf(interval, sizeof(interval), "%d", 3 * LOOK_MS * 1000);
	manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	CHECK_INT(bind(manager, (struct sockaddr *)&address, sizeof(address)), 0);
	setenv("NOTIFY_SOCKET", address.sun_path, 1);
	setenv("WATCHDOG_USEC", interval, 1);
	log_init(&log, LOG_LEVEL_ERROR);
	loop = loop_create(&error);
	CHECK_INT(watchdog_create(&watchdog, loop, &log, NULL, &error), 0);
	CHECK(watchdog != NULL);
	RUN(test_main_loop);
	RUN(test_long_step);
	watchdog_destroy(&watchdog);
	loop_destroy(&loop);
	close(manager);
	unlink(address.sun_path);
	rmdir(folder);
	return test_result();
}
