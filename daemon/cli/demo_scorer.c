/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "demo_scorer.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* Before the JSON text of the rows. */
struct reply {
	int result;
	struct error error;
	struct quality quality;
	uint32_t first_row, row_count;
	size_t bytes;
};

static bool read_all(int fd, void *data, size_t size)
{
	for (size_t done = 0; done < size;) {
		const ssize_t got = read(fd, (char *)data + done, size - done);
		if (got == 0 || (got < 0 && errno != EINTR))
			return false;
		done += got > 0 ? (size_t)got : 0;
	}
	return true;
}

static bool write_all(int fd, const void *data, size_t size)
{
	for (size_t done = 0; done < size;) {
		const ssize_t put = write(fd, (const char *)data + done, size - done);
		if (put < 0 && errno != EINTR)
			return false;
		done += put > 0 ? (size_t)put : 0;
	}
	return true;
}

/* ---- in the process ---- */

static int score(struct demo_score_params *params, const char *scene, const struct demo_scorer_request *request,
				 struct demo_score *score, struct error *error)
{
	const struct scene_source_params source = {.scene = scene, .size = request->size, .rate = request->rate};
	params->source = scene_source_create(&source, error);
	params->size = request->size;
	params->epoch_ns = request->epoch_ns;
	params->title = request->title;
	const int result = params->source ? demo_score(params, score, error) : -ENOTSUP;
	scene_source_destroy(&params->source);
	return result;
}

static void serve(int from, int to, struct demo_score_params *params, const char *scene)
{
	struct demo_scorer_request request;
	struct timeline timeline = {.rows = NULL};
	struct demo_score found = {.row_count = 0};
	struct reply reply = {.result = -ENOMEM};
	if (!read_all(from, &request, sizeof(request)) || !read_all(from, &timeline.count, sizeof(timeline.count)))
		return;
	error_set(&reply.error, -ENOMEM, "out of memory");
	timeline.rows = calloc(timeline.count + 1u, sizeof(*timeline.rows));
	if (timeline.rows && !read_all(from, timeline.rows, timeline.count * sizeof(*timeline.rows)))
		return;
	params->timeline = &timeline;
	if (timeline.rows)
		reply.result = score(params, scene, &request, &found, &reply.error);
	char *rows = found.scored ? json_dumps(found.scored, JSON_COMPACT) : NULL;
	reply.quality = found.quality;
	reply.first_row = found.first_row;
	reply.row_count = found.row_count;
	reply.bytes = rows ? strlen(rows) : 0;
	if (write_all(to, &reply, sizeof(reply)) && rows)
		write_all(to, rows, reply.bytes);
}

/* Ctrl-C is for the demo, which still wants its score then. */
static void become_scorer(pid_t parent)
{
	signal(SIGINT, SIG_IGN);
	signal(SIGTERM, SIG_IGN);
	signal(SIGHUP, SIG_IGN);
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(1);
}

/* ---- in the demo ---- */

int demo_scorer_start(struct demo_scorer *scorer, const char *scene, const struct settings *settings,
					  const char *recording, const char *contact, struct error *error)
{
	int requests[2], replies[2];
	const pid_t parent = getpid();
	*scorer = (struct demo_scorer){.pid = 0};
	if (pipe2(requests, O_CLOEXEC) < 0)
		return error_set(error, -errno, "no pipe: %s", strerror(errno));
	const int result = pipe2(replies, O_CLOEXEC) < 0 ? -errno : 0;
	scorer->pid = result == 0 ? fork() : -1;
	if (scorer->pid == 0) {
		struct demo_score_params params = {.recording = recording, .settings = settings, .contact = contact};
		close(requests[1]);
		close(replies[0]);
		become_scorer(parent);
		serve(requests[0], replies[1], &params, scene);
		_exit(0);
	}
	close(requests[0]);
	if (result == 0)
		close(replies[1]);
	*scorer = (struct demo_scorer){.pid = scorer->pid, .to = requests[1], .from = result == 0 ? replies[0] : -1};
	if (scorer->pid > 0)
		return 0;
	close(scorer->to);
	if (scorer->from >= 0)
		close(scorer->from);
	scorer->pid = 0;
	return error_set(error, -EAGAIN, "no process that scores: %s", strerror(errno));
}

static int take_reply(struct demo_scorer *scorer, struct demo_score *score, struct error *error)
{
	struct reply reply;
	if (!read_all(scorer->from, &reply, sizeof(reply)))
		return error_set(error, -ECHILD, "the process that scores ended before its time");
	char *rows = calloc(reply.bytes + 1, 1);
	if (!rows || !read_all(scorer->from, rows, reply.bytes)) {
		free(rows);
		return error_set(error, -ECHILD, "the process that scores ended in the middle of its answer");
	}
	*score = (struct demo_score){
		.quality = reply.quality,
		.scored = json_loads(rows, 0, NULL),
		.first_row = reply.first_row,
		.row_count = reply.row_count,
	};
	free(rows);
	*error = reply.error;
	return reply.result;
}

int demo_scorer_ask(struct demo_scorer *scorer, const struct demo_scorer_request *request,
					const struct timeline *timeline, struct demo_score *score, struct error *error)
{
	struct sigaction ignored = {.sa_handler = SIG_IGN}, before;
	sigaction(SIGPIPE, &ignored, &before);
	const bool sent = write_all(scorer->to, request, sizeof(*request)) &&
					  write_all(scorer->to, &timeline->count, sizeof(timeline->count)) &&
					  write_all(scorer->to, timeline->rows, timeline->count * sizeof(*timeline->rows));
	sigaction(SIGPIPE, &before, NULL);
	if (!sent)
		return error_set(error, -ECHILD, "the process that scores is gone");
	return take_reply(scorer, score, error);
}

void demo_scorer_finish(struct demo_scorer *scorer)
{
	if (scorer->pid <= 0)
		return;
	close(scorer->to);
	close(scorer->from);
	while (waitpid(scorer->pid, NULL, 0) < 0 && errno == EINTR)
		;
	scorer->pid = 0;
}
