/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Whole conversations with the daemon: server, clients, streams and control
 * requests, without GL. Input: steps, each a byte for what, a byte for which of
 * four connections, and what the step needs. Afterwards all is closed, and
 * nothing may be left: no client, no stream, no descriptor.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "daemon/control.h"
#include "tests/fuzz/fake-output.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/talker.h"

#define TALKERS 4
#define MOST_STEPS 48

struct world {
	struct settings settings;
	struct clock_virtual clock;
	struct loop *loop;
	struct output *output;
	struct live live;
	struct reload reload;
	struct control *control;
	struct server *server;
	struct talker talkers[TALKERS];
};

static const char *socket_path(void)
{
	static char path[64];
	if (!*path)
		snprintf(path, sizeof(path), "/tmp/pursuit-fuzz-%d", (int)getpid());
	return path;
}

static void create(struct world *world)
{
	struct error error = {""};
	memset(world, 0, sizeof(*world));
	settings_defaults(&world->settings);
	snprintf(world->settings.socket, sizeof(world->settings.socket), "%s", socket_path());
	world->settings.max_clients = 3;
	world->settings.max_frame_mb = 1;
	clock_init_virtual(&world->clock, 1000000000);
	world->loop = loop_create(&error);
	world->output = fake_output_create(&world->clock.clock);
	struct arguments arguments;
	char *argv[] = {NULL};
	FUZZ_EXPECT(arguments_read(&arguments, 0, argv, &error) == 0);
	live_init(&world->live, &world->settings, &arguments.profiles, NULL);
	reload_init(&world->reload, &world->live, NULL, &arguments, 0, argv);
	const struct control_params control_params = {.loop = world->loop,
												  .clock = &world->clock.clock,
												  .settings = &world->settings,
												  .output = world->output,
												  .live = &world->live,
												  .reload = &world->reload};
	world->control = control_create(&control_params, &error);
	const struct server_params server_params = {.loop = world->loop,
												.clock = &world->clock.clock,
												.settings = &world->settings,
												.output = world->output,
												.control = control_handle,
												.data = world->control};
	world->server = server_create(&server_params, &error);
	if (!world->server)
		fprintf(stderr, "%s\n", error.text);
	FUZZ_EXPECT(world->loop && world->control && world->server);
	control_set_server(world->control, world->server);
	for (int i = 0; i < TALKERS; i++)
		talker_init(&world->talkers[i]);
}

/* Until nothing is due, and a recording that is being closed is. */
static void settle(struct world *world)
{
	struct error error;
	for (int i = 0; i < 8; i++)
		FUZZ_EXPECT(loop_step(world->loop, 0, &error) == 0);
}

static void destroy(struct world *world, bool clients_first)
{
	for (int i = 0; clients_first && i < TALKERS; i++)
		talker_finish(&world->talkers[i]);
	settle(world);
	if (clients_first)
		FUZZ_EXPECT(server_client_count(world->server) == 0 && fake_output_stream_count(world->output) == 0);
	control_set_server(world->control, NULL);
	server_destroy(&world->server);
	control_destroy(&world->control);
	reload_finish(&world->reload);
	live_finish(&world->live);
	fake_output_destroy(&world->output);
	loop_destroy(&world->loop);
	for (int i = 0; i < TALKERS; i++)
		talker_finish(&world->talkers[i]);
}

static void do_step(struct world *world, struct fuzz_input *input)
{
	struct error error;
	const uint8_t step = fuzz_u8(input), who = fuzz_u8(input);
	struct talker *talker = &world->talkers[who % TALKERS];
	switch (step % 8) {
	case 0:
		FUZZ_EXPECT(loop_step(world->loop, 0, &error) == 0);
		return;
	case 1:
		fake_output_take(world->output);
		return;
	case 2:
		clock_wait_until(&world->clock.clock, clock_now(&world->clock.clock) + UINT64_C(20000000) * fuzz_u8(input));
		return;
	case 3:
		talker_finish(talker);
		return;
	case 4:
		if (talker->socket < 0)
			talker_connect(talker, socket_path());
		if (who & 0x80)
			talker_greet(talker);
		return;
	default:
		talker_act(talker, input);
	}
}

int fuzz_one(const uint8_t *data, size_t size)
{
	struct fuzz_input input = {data, size};
	struct world world;
	const int open_fds = fuzz_open_fds();
	create(&world);
	const bool clients_first = fuzz_u8(&input) & 1;
	for (int i = 0; i < MOST_STEPS && input.size > 0; i++)
		do_step(&world, &input);
	destroy(&world, clients_first);
	FUZZ_EXPECT(fuzz_open_fds() == open_fds);
	return 0;
}
