/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/owners.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "daemon/aside.h"
#include "daemon/lab/chip.h"
#include "daemon/lab/latency_log.h"
#include "daemon/open_at_once.h"
#include "daemon/seccomp.h"
#include "daemon/tee.h"
#include "daemon/version.h"

/* ---- what lies where files are to be written ---- */

static bool is_new(const char *path, const char *before)
{
	return *path && (!before || strcmp(path, before) != 0);
}

int owners_keep_files(const struct settings *now, const struct settings *fresh, const struct log *log,
					  struct aside *asides, struct error *error)
{
	const bool is_tee = is_new(fresh->tee, now ? now->tee : NULL), is_video = is_tee && !strchr(fresh->tee, '%');
	char times[TEE_TIMES_BYTES];
	int result = 0;
	tee_times_path(fresh->tee, times);
	const struct {
		const char *option, *path;
		bool is_new;
	} files[OWNERS_FILES] = {
		{"latency-log", fresh->lab.latency_log, is_new(fresh->lab.latency_log, now ? now->lab.latency_log : NULL)},
		{"record", fresh->record, is_new(fresh->record, now ? now->record : NULL)},
		{"tee", fresh->tee, is_video},
		{"tee", times, is_tee},
	};
	for (unsigned i = 0; i < OWNERS_FILES && result == 0; i++)
		if (files[i].is_new)
			result = aside_put(files[i].option, files[i].path, log, asides ? &asides[i] : NULL, error);
	return result;
}

static void commit_files(void *data, const struct settings *fresh)
{
	struct owners *owners = data;
	(void)fresh;
	memset(owners->asides, 0, sizeof(owners->asides));
}

static void abandon_files(void *data)
{
	struct owners *owners = data;
	for (unsigned i = 0; i < OWNERS_FILES; i++)
		aside_take_back(&owners->asides[i], owners->log);
}

static int prepare_files(void *data, const struct settings *now, const struct settings *fresh, struct error *error)
{
	struct owners *owners = data;
	const int result = owners_keep_files(now, fresh, owners->log, owners->asides, error);
	if (result < 0)
		abandon_files(owners);
	return result;
}

/* ---- the socket ---- */

static int prepare_socket(void *data, const struct settings *now, const struct settings *fresh, struct error *error)
{
	struct owners *owners = data;
	(void)now;
	return server_prepare(owners->server, fresh->socket, error);
}

static void commit_socket(void *data, const struct settings *fresh)
{
	struct owners *owners = data;
	(void)fresh;
	server_commit(owners->server);
}

static void abandon_socket(void *data)
{
	struct owners *owners = data;
	server_abandon(owners->server);
}

/* ---- the file of the statistics, which is written at the end ---- */

/* Could it be written? It is not there afterwards if it was not before. */
static int prepare_stats(void *data, const struct settings *now, const struct settings *fresh, struct error *error)
{
	(void)data;
	if (!*fresh->stats || strcmp(now->stats, fresh->stats) == 0)
		return 0;
	const bool was_there = access(fresh->stats, F_OK) == 0;
	const int fd = open_at_once("stats", fresh->stats, 0, error);
	if (fd < 0)
		return fd;
	close(fd);
	if (!was_there)
		unlink(fresh->stats);
	return 0;
}

static void commit_nothing(void *data, const struct settings *fresh)
{
	(void)data;
	(void)fresh;
}

static void abandon_nothing(void *data)
{
	(void)data;
}

/* ---- what the kernel refuses ---- */

/* Last of all, since there is no way back. */
static int prepare_seccomp(void *data, const struct settings *now, const struct settings *fresh, struct error *error)
{
	(void)data;
	if (now->seccomp && !fresh->seccomp)
		return error_set(error, -EINVAL,
						 "seccomp: \"no\": the kernel never takes such a filter back from a process; restart pursuitd "
						 "without it");
	return fresh->seccomp && !now->seccomp ? seccomp_apply(error) : 0;
}

/* ---- the lab ---- */

static double period_of(const struct settings *settings)
{
	return 1e9 * (double)settings->refresh_denominator / (double)settings->refresh_numerator;
}

/* What tells how a latency log came to be; the caller frees it. NULL: out of memory. */
static char *print_header(const struct settings *settings)
{
	char *header = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&header, &size);
	if (!out)
		return NULL;
	fprintf(out, "program: pursuitd %s\ngpio library: %s\n", PURSUITD_VERSION, chip_library());
	settings_print(settings, "setting ", " = ", out);
	fclose(out);
	return header;
}

struct lab *owners_create_lab(const struct settings *settings, struct clock *clock, const struct log *log,
							  struct error *error)
{
	char *header = print_header(settings);
	const struct lab_params params = {
		.settings = &settings->lab, .clock = clock, .log = log, .period_ns = period_of(settings), .header = header};
	struct lab *lab = lab_create(&params, error);
	free(header);
	return lab;
}

static int prepare_lab(void *data, const struct settings *now, const struct settings *fresh, struct error *error)
{
	struct owners *owners = data;
	const double period_ns = period_of(fresh);
	owners->lab_changes = memcmp(&now->lab, &fresh->lab, sizeof(now->lab)) != 0 || period_of(now) != period_ns;
	if (!owners->lab_changes)
		return 0;
	char *header = print_header(fresh);
	const int result = lab_prepare(owners->lab, &fresh->lab, period_of(now) != period_ns ? period_ns : 0.0,
								   header ? header : "", error);
	free(header);
	return result;
}

static void close_log(void *log)
{
	struct latency_log *self = log;
	latency_log_destroy(&self);
}

static void commit_lab(void *data, const struct settings *fresh)
{
	struct owners *owners = data;
	(void)fresh;
	struct latency_log *log = owners->lab_changes ? lab_commit(owners->lab) : NULL;
	if (log)
		closer_add(owners->closer, close_log, log);
}

static void abandon_lab(void *data)
{
	struct owners *owners = data;
	if (owners->lab_changes)
		lab_abandon(owners->lab);
}

/* ---- the output ---- */

static int prepare_output(void *data, const struct settings *now, const struct settings *fresh, struct error *error)
{
	struct owners *owners = data;
	return output_prepare(owners->output, now, fresh, error);
}

static void commit_output(void *data, const struct settings *fresh)
{
	struct owners *owners = data;
	output_commit(owners->output, fresh);
}

static void abandon_output(void *data)
{
	struct owners *owners = data;
	output_abandon(owners->output);
}

void owners_add(struct live *live, struct owners *owners)
{
	const struct live_owner all[] = {
		{prepare_stats, commit_nothing, abandon_nothing, owners},
		{prepare_files, commit_files, abandon_files, owners},
		{prepare_socket, commit_socket, abandon_socket, owners},
		{capture_prepare, capture_commit, capture_abandon, owners->capture},
		{prepare_lab, commit_lab, abandon_lab, owners},
		{prepare_output, commit_output, abandon_output, owners},
		/* After the output, which does without main until the end of the second step: an answer may take its time. */
		{admission_prepare, admission_commit, admission_abandon, owners->admission},
		{prepare_seccomp, commit_nothing, abandon_nothing, owners},
	};
	for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
		live_add_owner(live, &all[i]);
}
