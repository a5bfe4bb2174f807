/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/capture.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/open_at_once.h"
#include "daemon/printable.h"
#include "daemon/version.h"

/* One that a client has ended and waits for. */
struct closing {
	pthread_t thread;
	bool running;
	struct recorder *recorder;
	struct recorder_stats stats;
	struct error error;
	int result;
	int done_fd; /* eventfd */
	struct loop_source *source;
	void (*done)(void *data, uint64_t client_id, uint32_t serial, int result, const char *text);
	void *data;
	uint64_t client_id;
	uint32_t serial;
};

struct capture {
	struct capture_params params;
	struct recorder *recorder; /* the output's, while it runs; owned here */
	bool is_clients;           /* the file is a client's */
	struct closing closing;
	struct {
		bool other;
		struct recorder *recorder; /* NULL: none */
	} prepared;
};

/* One that nobody waits for. */
struct leftover {
	struct recorder *recorder;
	const struct log *log;
};

/* ---- beginning ---- */

char *capture_settings_text(const struct settings *settings, const char *equals)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		return NULL;
	settings_print(settings, "", equals, out);
	fclose(out);
	return text;
}

/* The fd is taken over; the path (NULL: none) is its name. NULL with a sentence. */
static struct recorder *make_recorder(const char *path, int fd, struct error *error)
{
	const struct recorder_params params = {
		.writer = {.path = path, .fd = fd, .info = "program=pursuitd " PURSUITD_VERSION "\n"},
	};
	return recorder_create(&params, error);
}

/* A pipe or a device could keep main and the recorder's thread for ever. */
static bool is_regular(int fd)
{
	struct stat status;
	return fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
}

static struct recorder *open_recorder(const char *path, struct error *error)
{
	const int fd = open_at_once("record", path, 0, error);
	if (fd >= 0 && !is_regular(fd)) {
		close(fd);
		error_set(error, -EINVAL, "record: %.300s: must be a regular file", path);
		return NULL;
	}
	return fd < 0 ? NULL : make_recorder(path, fd, error);
}

/* Frames go there from now on. Gives the one before back. */
static struct recorder *use(struct capture *capture, struct recorder *recorder, const struct settings *settings)
{
	if (recorder) {
		char *text = capture_settings_text(settings, "=");
		if (text)
			recorder_settings(recorder, text, clock_now(capture->params.clock));
		free(text);
	}
	struct recorder *before = capture->recorder;
	capture->recorder = recorder;
	output_set_recorder(capture->params.output, recorder);
	return before;
}

static const char *unfit(int fd)
{
	const int flags = fcntl(fd, F_GETFL);
	if (fd < 0)
		return "record: there is no file with the request";
	if (!is_regular(fd))
		return "record: the file is no regular file";
	if ((flags & O_ACCMODE) == O_RDONLY || (flags & O_PATH))
		return "record: the file is not open for writing";
	return NULL;
}

int capture_begin(struct capture *capture, int fd, struct error *error)
{
	const char *why = unfit(fd);
	const bool busy = capture->recorder || capture->closing.running;
	if (why || busy) {
		if (fd >= 0)
			close(fd);
		return error_set(error, why ? -EINVAL : -EBUSY, "%s", why ? why : "record: a recording is running already");
	}
	struct recorder *recorder = make_recorder(NULL, fd, error);
	if (!recorder)
		return -EIO;
	use(capture, recorder, capture->params.settings);
	capture->is_clients = true;
	log_info(capture->params.log, "recording into a client's file");
	return 0;
}

/* ---- ending ---- */

static void log_end(const struct log *log, const struct recorder_stats *stats, int result, const struct error *error)
{
	log_info(log, "recording ended: %" PRIu64 " frames, %" PRIu64 " dropped, %" PRIu64 " bytes", stats->frames_written,
			 stats->frames_dropped, stats->bytes_written);
	if (result < 0)
		log_error(log, "recording: %s", error->text);
}

static void close_recorder(struct recorder *recorder, const struct log *log)
{
	struct recorder_stats stats = {0};
	struct error error = {""};
	const int result = recorder_destroy(&recorder, &stats, &error);
	log_end(log, &stats, result, &error);
}

static void close_leftover(void *data)
{
	const struct leftover leftover = *(struct leftover *)data;
	free(data);
	close_recorder(leftover.recorder, leftover.log);
}

/* Nobody waits for it. */
static void let_go(struct capture *capture, struct recorder *recorder)
{
	if (!recorder)
		return;
	struct leftover *leftover = capture->params.closer ? malloc(sizeof(*leftover)) : NULL;
	if (!leftover) {
		close_recorder(recorder, capture->params.log);
		return;
	}
	*leftover = (struct leftover){recorder, capture->params.log};
	closer_add(capture->params.closer, close_leftover, leftover);
}

static void *run(void *data)
{
	struct closing *closing = data;
	const uint64_t one = 1;
	closing->result = recorder_destroy(&closing->recorder, &closing->stats, &closing->error);
	while (write(closing->done_fd, &one, sizeof(one)) < 0 && errno == EINTR)
		;
	return NULL;
}

static json_t *stats_object(const struct recorder_stats *stats, const char *error)
{
	char clean[sizeof(((struct error *)NULL)->text)]; /* it may have been cut within a character */
	printable_copy(clean, sizeof(clean), error);
	return json_pack("{s:I, s:I, s:I, s:s}", "frames", (json_int_t)stats->frames_written, "dropped",
					 (json_int_t)stats->frames_dropped, "bytes", (json_int_t)stats->bytes_written, "error", clean);
}

static void on_closed(void *data, uint32_t events)
{
	struct capture *capture = data;
	struct closing *closing = &capture->closing;
	uint64_t count;
	(void)events;
	if (read(closing->done_fd, &count, sizeof(count)) < 0 || !closing->running)
		return;
	pthread_join(closing->thread, NULL);
	closing->running = false;
	log_end(capture->params.log, &closing->stats, closing->result, &closing->error);
	json_t *object = stats_object(&closing->stats, closing->result < 0 ? closing->error.text : "");
	char *text = object ? json_dumps(object, JSON_COMPACT) : NULL;
	closing->done(closing->data, closing->client_id, closing->serial, closing->result, text ? text : "{}");
	free(text);
	json_decref(object);
}

int capture_end(struct capture *capture,
				void (*done)(void *data, uint64_t client_id, uint32_t serial, int result, const char *text), void *data,
				uint64_t client_id, uint32_t serial, struct error *error)
{
	struct closing *closing = &capture->closing;
	if (!capture->recorder || closing->running)
		return error_set(error, -EINVAL, "record-stop: nothing is being recorded");
	closing->done = done;
	closing->data = data;
	closing->client_id = client_id;
	closing->serial = serial;
	closing->error.text[0] = 0;
	closing->recorder = use(capture, NULL, NULL);
	const int result = pthread_create(&closing->thread, NULL, run, closing);
	closing->running = result == 0;
	if (result == 0)
		return 0;
	recorder_destroy(&closing->recorder, &closing->stats, &closing->error);
	return error_set(error, -result, "record-stop: no thread to close the file");
}

json_t *capture_json(const struct capture *capture)
{
	struct recorder_stats stats;
	if (!capture->recorder)
		return NULL;
	recorder_stats(capture->recorder, &stats);
	return stats_object(&stats, stats.text);
}

/* ---- the setting ---- */

int capture_prepare(void *data, const struct settings *now, const struct settings *fresh, struct error *error)
{
	struct capture *capture = data;
	capture->prepared.other = strcmp(now->record, fresh->record) != 0;
	capture->prepared.recorder = NULL;
	if (!capture->prepared.other || !*fresh->record)
		return 0;
	if (capture->recorder && capture->is_clients)
		return error_set(
			error, -EBUSY,
			"record: a client records into a file of its own; `pursuit record` ends it, then set it again");
	capture->prepared.recorder = open_recorder(fresh->record, error);
	return capture->prepared.recorder ? 0 : -EIO;
}

void capture_commit(void *data, const struct settings *fresh)
{
	struct capture *capture = data;
	struct recorder *recorder = capture->prepared.recorder;
	capture->prepared.recorder = NULL;
	if (!capture->prepared.other || (capture->recorder && capture->is_clients))
		return;
	if (recorder)
		log_info(capture->params.log, "recording %s", fresh->record);
	capture->is_clients = false;
	let_go(capture, use(capture, recorder, fresh));
}

void capture_abandon(void *data)
{
	struct capture *capture = data;
	let_go(capture, capture->prepared.recorder);
	capture->prepared.recorder = NULL;
}

/* ---- life ---- */

static int start(struct capture *capture, struct error *error)
{
	const char *path = capture->params.settings->record;
	struct closing *closing = &capture->closing;
	closing->done_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	if (closing->done_fd >= 0)
		closing->source = loop_add(capture->params.loop, closing->done_fd, EPOLLIN, on_closed, capture);
	if (!closing->source)
		return error_set(error, -errno, "record: %s", strerror(errno));
	if (!*path)
		return 0;
	struct recorder *recorder = open_recorder(path, error);
	if (!recorder)
		return -EIO;
	log_info(capture->params.log, "recording %s", path);
	use(capture, recorder, capture->params.settings);
	return 0;
}

struct capture *capture_create(const struct capture_params *params, struct error *error)
{
	struct capture *capture = calloc(1, sizeof(*capture));
	if (!capture) {
		error_set(error, -ENOMEM, "record: out of memory");
		return NULL;
	}
	capture->params = *params;
	capture->closing.done_fd = -1;
	if (start(capture, error) < 0)
		capture_destroy(&capture);
	return capture;
}

void capture_destroy(struct capture **capture)
{
	struct capture *self = *capture;
	*capture = NULL;
	if (!self)
		return;
	struct closing *closing = &self->closing;
	if (closing->running) {
		pthread_join(closing->thread, NULL);
		log_end(self->params.log, &closing->stats, closing->result, &closing->error);
	}
	self->params.closer = NULL;
	if (self->recorder)
		let_go(self, use(self, NULL, NULL));
	loop_remove(&closing->source);
	if (closing->done_fd >= 0)
		close(closing->done_fd);
	free(self);
}
