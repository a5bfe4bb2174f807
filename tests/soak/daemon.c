/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <signal.h>
#include <stdio.h>

#include "daemon/control.h"
#include "daemon/output.h"
#include "daemon/server.h"
#include "tests/soak/code.h"
#include "tests/soak/soak.h"

/* ---- the presenter, looked over its shoulder: the linker puts this in the place of presenter_create() ---- */

struct presenter *__real_presenter_create(const char *list, const struct presenter_params *params, struct error *error);
struct presenter *__wrap_presenter_create(const char *list, const struct presenter_params *params, struct error *error);

static struct {
	struct soak *soak;
	const struct presenter_impl *real;
	struct presenter_impl impl;
} watched;

static void check_picture(const struct presenter_image *image)
{
	uint32_t client, frame;
	if (code_read(image->data, image->stride, image->width, image->height, &client, &frame)) {
		atomic_fetch_add(&watched.soak->verified, 1);
		return;
	}
	atomic_store(&watched.soak->spoilt_client, client);
	atomic_store(&watched.soak->spoilt_frame, frame);
	atomic_fetch_add(&watched.soak->spoilt, 1);
}

static int present(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank, uint64_t group,
				   uint64_t serial)
{
	check_picture(image);
	return watched.real->present(presenter, image, vblank, group, serial);
}

static void set_standby(struct presenter *presenter, const struct presenter_image *image, uint64_t group,
						uint64_t serial)
{
	check_picture(image);
	watched.real->set_standby(presenter, image, group, serial);
}

struct presenter *__wrap_presenter_create(const char *list, const struct presenter_params *params, struct error *error)
{
	struct presenter *presenter = __real_presenter_create(list, params, error);
	if (!presenter)
		return NULL;
	watched.real = presenter->impl;
	watched.impl = *presenter->impl;
	watched.impl.present = present;
	watched.impl.set_standby = set_standby;
	presenter->impl = &watched.impl;
	return presenter;
}

/* ---- the rest of it, as in pursuitd.c ---- */

static void on_signal(void *data, int number)
{
	(void)number;
	loop_quit(data);
}

int soak_daemon(struct soak *soak)
{
	static const int signals[] = {SIGTERM};
	struct settings settings;
	struct clock clock;
	struct log log;
	struct error error = {""};
	struct profiles profiles = {NULL, 0};
	struct live live;
	struct reload reload = {.watch_fd = -1, .timer_fd = -1};
	struct output *output = NULL;
	struct control *control = NULL;
	struct server *server = NULL;

	watched.soak = soak;
	signal(SIGPIPE, SIG_IGN);
	settings_defaults(&settings);
	settings_set(&settings, "method", "hold", &error);
	settings_set(&settings, "socket", soak->socket, &error);
	log_init(&log, LOG_LEVEL_ERROR);
	live_init(&live, &settings, &profiles, &log);
	clock_init_real(&clock);
	struct loop *loop = loop_create(&error);
	if (loop && loop_add_signals(loop, signals, 1, on_signal, loop, &error) == 0) {
		const struct output_params output_params = {.loop = loop, .settings = &settings, .clock = &clock, .log = &log};
		output = output_create(&output_params, &error);
	}
	if (output) {
		live.output = output;
		const struct control_params params = {.loop = loop,
											  .log = &log,
											  .clock = &clock,
											  .settings = &settings,
											  .output = output,
											  .live = &live,
											  .reload = &reload};
		control = control_create(&params, &error);
	}
	if (control) {
		const struct server_params params = {.loop = loop,
											 .log = &log,
											 .clock = &clock,
											 .settings = &settings,
											 .output = output,
											 .control = control_handle,
											 .data = control};
		server = server_create(&params, &error);
	}
	if (server)
		control_set_server(control, server);
	const int status = server && loop_run(loop, &error) == 0 ? 0 : 1;
	if (status != 0)
		fprintf(stderr, "%s\n", error.text);
	if (control)
		control_set_server(control, NULL);
	server_destroy(&server);
	control_destroy(&control);
	output_destroy(&output);
	loop_destroy(&loop);
	return status;
}
