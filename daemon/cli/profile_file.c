/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "profile_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/setting_check.h"

#define MOST_LINES 100000u
#define NONE SIZE_MAX

/* ---- lines ---- */

/* Takes the text over. */
static int insert(struct profile_file *file, size_t at, char *text)
{
	char **lines = text ? realloc(file->lines, (file->count + 1) * sizeof(*lines)) : NULL;
	if (!lines) {
		free(text);
		return -ENOMEM;
	}
	file->lines = lines;
	memmove(&lines[at + 1], &lines[at], (file->count - at) * sizeof(*lines));
	lines[at] = text;
	file->count++;
	return 0;
}

__attribute__((format(printf, 3, 4))) static int insert_text(struct profile_file *file, size_t at, const char *format,
															 ...)
{
	char *text;
	va_list arguments;
	va_start(arguments, format);
	const int length = vasprintf(&text, format, arguments);
	va_end(arguments);
	return insert(file, at, length < 0 ? NULL : text);
}

static void erase(struct profile_file *file, size_t at)
{
	free(file->lines[at]);
	file->count--;
	memmove(&file->lines[at], &file->lines[at + 1], (file->count - at) * sizeof(*file->lines));
}

/* What the line is; `copy` holds what name and value point to, to be freed. */
static enum configuration_line parse(const struct profile_file *file, size_t at, char **copy, char **name, char **value)
{
	*copy = strdup(file->lines[at]);
	*name = *value = NULL;
	return *copy ? configuration_parse(*copy, name, value) : CONFIGURATION_EMPTY;
}

/* A section of this name (kind SECTION) or a setting, from `at` on; a setting only up to the next section. */
static size_t find(const struct profile_file *file, size_t at, enum configuration_line kind, const char *wanted)
{
	for (; at < file->count; at++) {
		char *copy, *name, *value;
		const enum configuration_line is = parse(file, at, &copy, &name, &value);
		const bool same = is == kind && strcmp(name, wanted) == 0;
		free(copy);
		if (same)
			return at;
		if (is == CONFIGURATION_SECTION && kind == CONFIGURATION_SETTING)
			break;
	}
	return NONE;
}

/* Behind the last setting of the section that begins at `at`: comments that follow may belong to the next one. */
static size_t section_end(const struct profile_file *file, size_t at)
{
	size_t end = at + 1;
	for (size_t i = at + 1; i < file->count; i++) {
		char *copy, *name, *value;
		const enum configuration_line is = parse(file, i, &copy, &name, &value);
		free(copy);
		if (is == CONFIGURATION_SECTION)
			break;
		if (is == CONFIGURATION_SETTING)
			end = i + 1;
	}
	return end;
}

/* ---- changes ---- */

static size_t begin_section(struct profile_file *file, const char *application)
{
	if (file->count > 0 && *file->lines[file->count - 1] && insert_text(file, file->count, "%s", "") < 0)
		return NONE;
	return insert_text(file, file->count, "[application %s]", application) < 0 ? NONE : file->count - 1;
}

int profile_file_set(struct profile_file *file, const char *application, const char *name, const char *value)
{
	size_t section = find(file, 0, CONFIGURATION_SECTION, application);
	if (section == NONE)
		section = begin_section(file, application);
	if (section == NONE)
		return -ENOMEM;
	const size_t first = find(file, section + 1, CONFIGURATION_SETTING, name);
	/* Of several the last one holds. */
	for (size_t at = first; at != NONE; at = find(file, section + 1, CONFIGURATION_SETTING, name))
		erase(file, at);
	return insert_text(file, first == NONE ? section_end(file, section) : first, "%s = %s", name, value);
}

bool profile_file_unset(struct profile_file *file, const char *application, const char *name)
{
	const size_t section = find(file, 0, CONFIGURATION_SECTION, application);
	bool found = false;
	if (section == NONE)
		return false;
	for (size_t at; (at = find(file, section + 1, CONFIGURATION_SETTING, name)) != NONE; found = true)
		erase(file, at);
	return found;
}

bool profile_file_remove(struct profile_file *file, const char *application)
{
	const size_t section = find(file, 0, CONFIGURATION_SECTION, application);
	if (section == NONE)
		return false;
	for (size_t lines = section_end(file, section) - section; lines > 0; lines--)
		erase(file, section);
	while (section < file->count && section > 0 && !*file->lines[section] && !*file->lines[section - 1])
		erase(file, section);
	return true;
}

/* ---- reading ---- */

static int read_lines(struct profile_file *file, FILE *in, struct error *error)
{
	char *line = NULL;
	size_t size = 0;
	ssize_t length;
	int result = 0;
	while (result == 0 && (length = getline(&line, &size, in)) >= 0) {
		line[strcspn(line, "\n")] = 0;
		result = file->count < MOST_LINES ? insert(file, file->count, strdup(line)) : -EFBIG;
	}
	free(line);
	return result < 0 ? error_set(error, result, "%s: %s", file->path, strerror(-result)) : 0;
}

static int read_file(struct profile_file *file, struct error *error)
{
	struct settings settings;
	struct stat status;
	FILE *in = fopen(file->path, "re");
	if (!in)
		return errno == ENOENT ? 0 : error_set(error, -errno, "%s: %s", file->path, strerror(errno));
	settings_defaults(&settings);
	int result = configuration_read(&settings, &file->profiles, in, file->path, setting_check, error);
	if (result == 0 && (fstat(fileno(in), &status) < 0 || fseek(in, 0, SEEK_SET) < 0))
		result = error_set(error, -errno, "%s: %s", file->path, strerror(errno));
	if (result == 0)
		result = read_lines(file, in, error);
	if (result == 0) {
		file->there = true;
		file->mode = status.st_mode & 07777;
		file->uid = status.st_uid;
		file->gid = status.st_gid;
	}
	fclose(in);
	return result;
}

/* ---- folders ---- */

static int make_folders(const char *path, struct error *error)
{
	char folder[PATH_MAX];
	snprintf(folder, sizeof(folder), "%s", path);
	for (char *slash = strchr(folder + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = 0;
		if (mkdir(folder, 0755) < 0 && errno != EEXIST)
			return error_set(error, -errno, "%s: %s", folder, strerror(errno));
		*slash = '/';
	}
	return 0;
}

/* A file system without locks does without. */
static int lock_folder(struct profile_file *file, struct error *error)
{
	char folder[PATH_MAX];
	const char *slash = strrchr(file->path, '/');
	snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(slash - file->path) + 1 : 2, slash ? file->path : "./");
	file->folder_fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (file->folder_fd < 0)
		return error_set(error, -errno, "%s: %s", folder, strerror(errno));
	while (flock(file->folder_fd, LOCK_EX) < 0 && errno == EINTR)
		;
	return 0;
}

int profile_file_open(struct profile_file *file, const char *path, bool change, struct error *error)
{
	struct stat status;
	*file = (struct profile_file){.folder_fd = -1};
	char *real = realpath(path, NULL);
	if (!real && errno == ENOENT && lstat(path, &status) == 0)
		return error_set(error, -ENOENT, "%.400s is a link that leads nowhere", path);
	const int length = snprintf(file->path, sizeof(file->path), "%s", real ? real : path);
	free(real);
	if (length >= (int)sizeof(file->path))
		return error_set(error, -ENAMETOOLONG, "%.64s...: the path is too long", path);
	int result = change ? make_folders(file->path, error) : 0;
	if (result == 0 && change)
		result = lock_folder(file, error);
	return result == 0 ? read_file(file, error) : result;
}

void profile_file_close(struct profile_file *file)
{
	while (file->count > 0)
		erase(file, file->count - 1);
	free(file->lines);
	file->lines = NULL;
	profiles_finish(&file->profiles);
	if (file->folder_fd >= 0)
		close(file->folder_fd);
	file->folder_fd = -1;
}

/* ---- writing ---- */

/* Would the daemon take it? A stream of nothing cannot be opened, and is fine. */
static int check_text(const struct profile_file *file, char *text, size_t size, struct error *error)
{
	struct settings settings;
	struct profiles profiles = {NULL, 0};
	FILE *in = size ? fmemopen(text, size, "r") : NULL;
	int result = 0;
	settings_defaults(&settings);
	if (in)
		result = configuration_read(&settings, &profiles, in, file->path, setting_check, error);
	else if (size)
		result = error_set(error, -errno, "out of memory");
	profiles_finish(&profiles);
	if (in)
		fclose(in);
	return result;
}

static int write_all(int fd, const char *text, size_t size)
{
	while (size > 0) {
		const ssize_t wrote = write(fd, text, size);
		if (wrote < 0 && errno != EINTR)
			return -errno;
		text += wrote > 0 ? wrote : 0;
		size -= wrote > 0 ? (size_t)wrote : 0;
	}
	return 0;
}

/* Only root may give a file away: where it cannot be, it is one's own from now on. */
static int dress(const struct profile_file *file, int fd)
{
	if (file->there && fchown(fd, file->uid, file->gid) < 0 && errno != EPERM)
		return -errno;
	return fchmod(fd, file->there ? file->mode : 0644) < 0 ? -errno : 0;
}

static int replace(const struct profile_file *file, const char *text, size_t size, struct error *error)
{
	char temporary[PATH_MAX + 8];
	snprintf(temporary, sizeof(temporary), "%s.XXXXXX", file->path);
	const int fd = mkostemp(temporary, O_CLOEXEC);
	if (fd < 0)
		return error_set(error, -errno, "%s: %s", temporary, strerror(errno));
	int result = write_all(fd, text, size);
	if (result == 0)
		result = dress(file, fd);
	if (result == 0 && fsync(fd) < 0)
		result = -errno;
	if (close(fd) < 0 && result == 0)
		result = -errno;
	if (result == 0 && rename(temporary, file->path) < 0)
		result = -errno;
	if (result < 0) {
		unlink(temporary);
		return error_set(error, result, "%s: %s", file->path, strerror(-result));
	}
	fsync(file->folder_fd);
	return 0;
}

int profile_file_save(struct profile_file *file, struct error *error)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		return error_set(error, -ENOMEM, "out of memory");
	for (size_t i = 0; i < file->count; i++)
		fprintf(out, "%s\n", file->lines[i]);
	int result = fclose(out) == 0 ? check_text(file, text, size, error) : error_set(error, -ENOMEM, "out of memory");
	if (result == 0)
		result = replace(file, text, size, error);
	free(text);
	return result;
}
