/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/reload.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include "daemon/clock.h"

/* After the last change of a burst, but not later than this after its first one. */
#define QUIET_NS UINT64_C(100000000)
#define LONGEST_NS UINT64_C(1000000000)

/* Of the folder itself: it is not where it was. */
#define GONE (IN_DELETE_SELF | IN_MOVE_SELF | IN_UNMOUNT | IN_IGNORED)
#define CHANGES \
	(IN_CLOSE_WRITE | IN_MOVED_TO | IN_MOVED_FROM | IN_DELETE | IN_CREATE | IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR)

/* ---- places ---- */

/* Cuts `path` to the folder that holds its last name, which it gives. "a", "a/": "./"; "/a": "/". */
static void split(char *path, char *folder, char *name)
{
	size_t length = strlen(path);
	while (length > 1 && path[length - 1] == '/')
		path[--length] = 0;
	const char *slash = strrchr(path, '/');
	snprintf(name, NAME_MAX + 1, "%s", slash ? slash + 1 : path);
	snprintf(folder, PATH_MAX, "%.*s", slash ? (int)(slash - path) + 1 : 2, slash ? path : "./");
}

static void set_timer(struct reload *reload);

/* Where the folder is missing, the nearest one above it is watched for it to come. */
static void watch_place(struct reload *reload, struct reload_place *place, const char *file)
{
	char path[PATH_MAX], folder[PATH_MAX];
	struct stat found;
	bool missing = false;
	snprintf(path, sizeof(path), "%s", file);
	for (;; missing = true) {
		split(path, folder, place->name);
		place->watch = inotify_add_watch(reload->watch_fd, folder, CHANGES);
		const bool top = strcmp(folder, "./") == 0 || strcmp(folder, "/") == 0;
		if (place->watch >= 0 || top || (errno != ENOENT && errno != ENOTDIR))
			break;
		snprintf(path, sizeof(path), "%s", folder);
	}
	if (place->watch < 0)
		log_warning(reload->log, "%s: changes are not noticed (%s); SIGHUP has it read again", file, strerror(errno));
	else if (missing && stat(path, &found) == 0 && S_ISDIR(found.st_mode))
		set_timer(reload); /* it came before the one above was watched */
}

static bool is_above(const struct reload *reload, int watch)
{
	for (unsigned i = 0; i < reload->above_count; i++)
		if (reload->above[i] == watch)
			return true;
	return false;
}

/* Those above the folder of the file, the root apart, which stays. One that may not be watched is left out. */
static void watch_above(struct reload *reload, const char *file)
{
	char path[PATH_MAX], folder[PATH_MAX], name[NAME_MAX + 1];
	snprintf(path, sizeof(path), "%s", file);
	split(path, folder, name);
	while (reload->above_count < RELOAD_ABOVE) {
		snprintf(path, sizeof(path), "%s", folder);
		split(path, folder, name);
		if (strcmp(folder, "./") == 0 || strcmp(folder, "/") == 0)
			break;
		const int watch = inotify_add_watch(reload->watch_fd, folder, IN_MOVE_SELF | IN_ONLYDIR | IN_MASK_ADD);
		if (watch >= 0 && !is_above(reload, watch)) /* files share most of them */
			reload->above[reload->above_count++] = watch;
	}
}

static void add_place(struct reload *reload, const char *path)
{
	const char *slash = strrchr(path, '/');
	if (reload->place_count == RELOAD_PLACES || strlen(slash ? slash + 1 : path) > NAME_MAX || strlen(path) >= PATH_MAX)
		return;
	watch_place(reload, &reload->places[reload->place_count++], path);
	watch_above(reload, path);
}

static bool is_watched(const struct reload *reload, int watch)
{
	for (unsigned i = 0; i < reload->place_count; i++)
		if (reload->places[i].watch == watch)
			return true;
	return is_above(reload, watch);
}

/* Links may lead elsewhere by now, folders may have come: at each reading anew. The kernel knows watches it has. */
static void watch_files(struct reload *reload)
{
	int before[RELOAD_PLACES + RELOAD_ABOVE];
	unsigned count = 0;
	for (unsigned i = 0; i < reload->place_count; i++)
		before[count++] = reload->places[i].watch;
	for (unsigned i = 0; i < reload->above_count; i++)
		before[count++] = reload->above[i];
	reload->place_count = reload->above_count = 0;
	for (unsigned i = 0; i < reload->file_count; i++) {
		char *real = realpath(reload->files[i], NULL);
		add_place(reload, reload->files[i]);
		if (real && strcmp(real, reload->files[i]) != 0)
			add_place(reload, real);
		free(real);
	}
	for (unsigned i = 0; i < count; i++)
		if (before[i] >= 0 && !is_watched(reload, before[i]))
			inotify_rm_watch(reload->watch_fd, before[i]);
}

/* A file that was just made is still being written; a link and a folder are whole at once. */
static bool is_whole(const struct reload *reload, const struct inotify_event *event)
{
	struct stat file;
	if (!(event->mask & IN_CREATE) || event->mask & IN_ISDIR)
		return true;
	for (unsigned i = 0; i < reload->file_count; i++)
		if (lstat(reload->files[i], &file) == 0 && (S_ISLNK(file.st_mode) || file.st_nlink > 1))
			return true;
	return false;
}

static bool concerns_us(const struct reload *reload, const struct inotify_event *event)
{
	if (event->mask & IN_Q_OVERFLOW)
		return true;
	for (unsigned i = 0; i < reload->place_count; i++) {
		if (reload->places[i].watch != event->wd)
			continue;
		if (event->mask & GONE)
			return true;
		if (event->len > 0 && strcmp(reload->places[i].name, event->name) == 0)
			return is_whole(reload, event);
	}
	return event->mask & GONE && is_above(reload, event->wd);
}

/* ---- events ---- */

static void set_timer(struct reload *reload)
{
	const uint64_t now = clock_monotonic_ns();
	reload->first_ns = reload->first_ns ? reload->first_ns : now;
	const uint64_t latest = reload->first_ns + LONGEST_NS, wished = now + QUIET_NS;
	const uint64_t then = wished < latest ? wished : latest;
	const struct itimerspec timer = {
		.it_value = {(time_t)(then / UINT64_C(1000000000)), (long)(then % UINT64_C(1000000000))}};
	timerfd_settime(reload->timer_fd, TFD_TIMER_ABSTIME, &timer, NULL);
}

static void on_change(void *data, uint32_t events)
{
	struct reload *reload = data;
	_Alignas(struct inotify_event) char buffer[4096];
	bool changed = false;
	(void)events;
	for (ssize_t got; (got = read(reload->watch_fd, buffer, sizeof(buffer))) > 0;) {
		const struct inotify_event *event;
		for (ssize_t at = 0; at < got; at += (ssize_t)(sizeof(*event) + event->len)) {
			event = (const struct inotify_event *)(const void *)(buffer + at);
			changed |= concerns_us(reload, event);
		}
	}
	if (changed)
		set_timer(reload);
}

static void on_timer(void *data, uint32_t events)
{
	struct reload *reload = data;
	struct error error;
	uint64_t count;
	(void)events;
	if (read(reload->timer_fd, &count, sizeof(count)) < 0)
		return;
	reload_now(reload, "the configuration has changed", &error);
}

/* ---- life ---- */

void reload_init(struct reload *reload, struct live *live, struct log *log, const struct arguments *arguments, int argc,
				 char **argv)
{
	*reload = (struct reload){.live = live, .log = log, .argc = argc, .argv = argv, .watch_fd = -1, .timer_fd = -1};
	memcpy(reload->files, arguments->files, sizeof(reload->files));
	reload->file_count = arguments->file_count;
}

void reload_watch(struct reload *reload, struct loop *loop)
{
	if (reload->file_count == 0)
		return;
	reload->watch_fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
	reload->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (reload->watch_fd >= 0 && reload->timer_fd >= 0) {
		reload->watch_source = loop_add(loop, reload->watch_fd, EPOLLIN, on_change, reload);
		reload->timer_source = loop_add(loop, reload->timer_fd, EPOLLIN, on_timer, reload);
	}
	if (!reload->watch_source || !reload->timer_source)
		log_warning(reload->log, "changes of the configuration are not noticed (%s); SIGHUP has it read again",
					strerror(errno));
	else
		watch_files(reload);
}

void reload_finish(struct reload *reload)
{
	loop_remove(&reload->watch_source);
	loop_remove(&reload->timer_source);
	if (reload->watch_fd >= 0)
		close(reload->watch_fd);
	if (reload->timer_fd >= 0)
		close(reload->timer_fd);
	reload->watch_fd = reload->timer_fd = -1;
}

int reload_now(struct reload *reload, const char *why, struct error *error)
{
	struct arguments fresh;
	reload->first_ns = 0;
	if (reload->timer_source)
		watch_files(reload);
	int result = arguments_read(&fresh, reload->argc, reload->argv, error);
	if (result < 0) {
		log_error(reload->log, "%s: %s; the settings stay as they are", why, error->text);
		reload->mistake = *error;
	} else {
		result = (int)live_reload(reload->live, &fresh, &reload->mistake);
		log_info(reload->log, "%s: settings read again, %d changed", why, result);
		*error = reload->mistake;
		result = *error->text ? -EINVAL : result;
	}
	arguments_finish(&fresh);
	return result;
}
