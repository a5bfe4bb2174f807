/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "record_daemon.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "args.h"
#include "control.h"
#include "daemon/clock.h"
#include "interrupt.h"

#define STEP_NS 50000000L

static void wait_until_over(double seconds)
{
	struct timespec step = {0, STEP_NS};
	const uint64_t start_ns = clock_monotonic_ns();
	while (!interrupt_seen() && (seconds <= 0 || (double)(clock_monotonic_ns() - start_ns) / 1e9 < seconds))
		nanosleep(&step, NULL);
}

static json_int_t number_of(const json_t *reply, const char *name)
{
	return json_integer_value(json_object_get(reply, name));
}

/* Asks for the end. */
static int stop(struct control *control, const char *verb, const char *path, json_t **written, struct error *error)
{
	json_t *reply = NULL;
	int result = control_end_recording(control, &reply, error);
	if (result < 0)
		return result;
	if (number_of(reply, "frames") == 0)
		fprintf(stderr, "pursuit %s: no frame came; does a client run? `pursuit status` says\n", verb);
	*written = json_pack("{s:s, s:I, s:I, s:I}", "recording", path, "frames", number_of(reply, "frames"), "dropped",
						 number_of(reply, "dropped"), "bytes", number_of(reply, "bytes"));
	json_decref(reply);
	return 0;
}

int record_daemon(const char *verb, const char *otherwise, const char *path, const char *socket, double seconds,
				  json_t **written)
{
	struct control control;
	struct error error = {{0}};
	if (control_open(&control, socket, &error) < 0)
		return args_failed(verb, "%s%s", error.text, otherwise);
	*written = NULL;
	/* What it holds is the daemon's to cut off, should it say yes. */
	int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666), result;
	if (fd < 0) {
		result = error_set(&error, -errno, "%s: %s", path, strerror(errno));
	} else {
		interrupt_watch();
		result = control_ask(&control, "record", fd, NULL, &error);
		close(fd);
		if (result == 0) {
			if (isatty(STDERR_FILENO))
				fprintf(stderr, "recording until %s\n", seconds > 0 ? "the time is over, or Ctrl-C" : "Ctrl-C");
			wait_until_over(seconds);
			result = stop(&control, verb, path, written, &error);
		}
	}
	control_close(&control);
	return result < 0 ? args_failed(verb, "%s", error.text) : STATUS_DONE;
}
