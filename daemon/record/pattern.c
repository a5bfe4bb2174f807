/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/record/pattern.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* The conversion at `at` (which points behind the %): its length without the %, 0 if it is none that we take. */
static size_t conversion(const char *at, int *width)
{
	*width = 0;
	if (at[0] == 'd')
		return 1;
	if (at[0] != '0' || at[1] < '1' || at[1] > '9' || at[2] != 'd')
		return 0;
	*width = at[1] - '0';
	return 3;
}

/* Where the one conversion is: NULL if there is none or more than one, or one that we do not take. */
static const char *find_conversion(const char *pattern, size_t *length, int *width)
{
	const char *found = NULL;
	for (const char *at = strchr(pattern, '%'); at; at = strchr(at, '%')) {
		if (at[1] == '%') {
			at += 2;
			continue;
		}
		int digits;
		const size_t bytes = conversion(at + 1, &digits);
		if (!bytes || found)
			return NULL;
		found = at;
		*length = bytes + 1;
		*width = digits;
		at += bytes + 1;
	}
	return found;
}

int pattern_check(const char *option, const char *pattern, struct error *error)
{
	size_t length;
	int width;
	if (!find_conversion(pattern, &length, &width))
		return error_set(error, -EINVAL, "%s: pattern '%s': must have exactly one %%d or %%04d, where the number goes",
						 option, pattern);
	if (strlen(pattern) > PATTERN_MAX_PATH - 16)
		return error_set(error, -EINVAL, "%s: pattern is %zu bytes, must be at most %d", option, strlen(pattern),
						 PATTERN_MAX_PATH - 16);
	return 0;
}

int pattern_check_written(const char *option, const char *pattern, const char *ending, struct error *error)
{
	const int result = pattern_check(option, pattern, error);
	const size_t length = strlen(pattern), least = strlen(ending);
	if (result == 0 && (length < least || strcasecmp(pattern + length - least, ending) != 0))
		return error_set(error, -EINVAL, "%s: pattern '%s': must end in %s, the format that is written", option,
						 pattern, ending);
	return result;
}

/* Copies up to `end` with %% made one %. */
static char *append(char *to, const char *from, const char *end)
{
	while (from < end) {
		if (*from == '%')
			from++;
		*to++ = *from++;
	}
	return to;
}

bool pattern_name(const char *pattern, uint64_t number, char name[PATTERN_MAX_PATH])
{
	size_t length;
	int width;
	const char *at = find_conversion(pattern, &length, &width);
	if (!at || strlen(pattern) > PATTERN_MAX_PATH - 16 || number > PATTERN_MAX_NUMBER)
		return false;
	char *to = append(name, pattern, at);
	to += snprintf(to, 16, "%0*" PRIu64, width, number);
	to = append(to, at + length, at + strlen(at));
	*to = '\0';
	return true;
}

bool pattern_exists(const char *pattern, uint64_t number)
{
	char name[PATTERN_MAX_PATH];
	return pattern_name(pattern, number, name) && access(name, F_OK) == 0;
}

/* The number in a file name, if the pattern yields exactly that name for it. */
static bool match(const char *pattern, const char *folder, size_t prefix, const char *entry, uint64_t *number)
{
	char path[PATTERN_MAX_PATH + 256], name[PATTERN_MAX_PATH];
	const int length = snprintf(path, sizeof(path), "%s%s", folder, entry);
	if (length < 0 || (size_t)length <= prefix || path[prefix] < '0' || path[prefix] > '9')
		return false;
	errno = 0;
	*number = strtoull(path + prefix, NULL, 10);
	return errno == 0 && pattern_name(pattern, *number, name) && strcmp(name, path) == 0;
}

struct list {
	uint64_t *numbers;
	size_t count, room;
};

static bool add(struct list *list, uint64_t number)
{
	if (list->count == list->room) {
		const size_t room = list->room ? 2 * list->room : 256;
		uint64_t *numbers = realloc(list->numbers, room * sizeof(*numbers));
		if (!numbers)
			return false;
		list->numbers = numbers;
		list->room = room;
	}
	list->numbers[list->count++] = number;
	return true;
}

static int compare(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

int pattern_list(const char *pattern, uint64_t **numbers, size_t *count, struct error *error)
{
	size_t length;
	int width;
	char folder[PATTERN_MAX_PATH], start[PATTERN_MAX_PATH];
	const char *at = find_conversion(pattern, &length, &width);
	const char *slash = strrchr(pattern, '/');
	struct list list = {NULL, 0, 0};
	bool whole = true;

	*numbers = NULL;
	*count = 0;
	if (!at || strlen(pattern) > PATTERN_MAX_PATH - 16 || (slash && slash > at))
		return error_set(error, -EINVAL, "%s: numbered folders cannot be searched: give --first and --last", pattern);
	*append(folder, pattern, slash ? slash + 1 : pattern) = '\0';
	const size_t prefix = (size_t)(append(start, pattern, at) - start);
	DIR *dir = opendir(folder[0] ? folder : ".");
	if (!dir)
		return error_set(error, -errno, "%s: folder cannot be read: %s", folder[0] ? folder : ".", strerror(errno));
	for (struct dirent *entry; whole && (entry = readdir(dir));) {
		uint64_t number;
		if (match(pattern, folder, prefix, entry->d_name, &number))
			whole = add(&list, number);
	}
	closedir(dir);
	if (!whole) {
		free(list.numbers);
		return error_set(error, -ENOMEM, "%s: out of memory", pattern);
	}
	if (list.count > 0)
		qsort(list.numbers, list.count, sizeof(*list.numbers), compare);
	*numbers = list.numbers;
	*count = list.count;
	return 0;
}

int pattern_range(const char *pattern, uint64_t *first, uint64_t *last, struct error *error)
{
	uint64_t *numbers;
	size_t count;
	const int result = pattern_list(pattern, &numbers, &count, error);
	if (result < 0)
		return result;
	if (count == 0)
		return error_set(error, -ENOENT, "%s: no such file with any number: check the pattern", pattern);
	*first = numbers[0];
	*last = numbers[count - 1];
	free(numbers);
	return 0;
}
