/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A driver that hangs: it is given up, and the service manager does not take the daemon for dead meanwhile. */

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "daemon/engine_maker.h"
#include "tests/test.h"

static atomic_bool go_on, ended;

struct engine *__wrap_engine_create(const struct engine_params *params, struct error *error);
struct engine *__wrap_engine_create(const struct engine_params *params, struct error *error)
{
	(void)params;
	while (!atomic_load(&go_on))
		usleep(10000);
	error_set(error, -1, "it is back");
	atomic_store(&ended, true);
	return NULL;
}

/* Where the service manager listens. */
static int listen_as_manager(void)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path + 1, sizeof(address.sun_path) - 1, "pursuit-test-maker-%d", (int)getpid());
	const socklen_t length = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + strlen(address.sun_path + 1));
	char path[sizeof(address.sun_path)];
	CHECK_INT(bind(manager, (struct sockaddr *)&address, length), 0);
	snprintf(path, sizeof(path), "@%.100s", address.sun_path + 1);
	setenv("NOTIFY_SOCKET", path, 1);
	return manager;
}

static unsigned count_feedings(int manager)
{
	char state[64] = "";
	unsigned count = 0;
	while (recv(manager, state, sizeof(state) - 1, MSG_DONTWAIT) > 0)
		count += strcmp(state, "WATCHDOG=1") == 0;
	return count;
}

static void test_hanging_driver(void)
{
	const int manager = listen_as_manager();
	struct settings settings;
	struct error error = {""};
	struct log log;
	log_init(&log, LOG_LEVEL_ERROR);
	settings_defaults(&settings);
	CHECK(engine_maker_make(&settings, &log, &error) == NULL);
	CHECK(strstr(error.text, "the driver hangs") != NULL);
	CHECK(count_feedings(manager) >= 9);
	atomic_store(&go_on, true);
	for (int i = 0; i < 3000 && !atomic_load(&ended); i++)
		usleep(10000);
	CHECK(atomic_load(&ended));
	usleep(200000);
	CHECK(engine_maker_make(&settings, &log, &error) == NULL);
	CHECK_STRING(error.text, "it is back");
	close(manager);
}

int main(void)
{
	RUN(test_hanging_driver);
	return test_result();
}
