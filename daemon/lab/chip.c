/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/chip.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int chip_next_line(const char **list, char name[CHIP_NAME_BYTES])
{
	if (!**list)
		return 0;
	const size_t length = strcspn(*list, ",");
	if (length == 0 || length >= CHIP_NAME_BYTES)
		return -EINVAL;
	snprintf(name, CHIP_NAME_BYTES, "%.*s", (int)length, *list);
	*list += length;
	if (**list == ',' && *++*list == '\0')
		return -EINVAL;
	return 1;
}

bool chip_is_offset(const char *name, uint32_t *offset)
{
	char *end;
	if (!isdigit((unsigned char)*name))
		return false;
	errno = 0;
	const unsigned long number = strtoul(name, &end, 10);
	*offset = (uint32_t)number;
	return *end == '\0' && errno == 0 && number <= 65535;
}

int chip_count_lines(const char *chip, const char *list, const char *option, struct error *error)
{
	char names[CHIP_LINES][CHIP_NAME_BYTES];
	const char *rest = list;
	uint32_t offset;
	int count = 0, taken = 0;
	while (count < (int)CHIP_LINES && (taken = chip_next_line(&rest, names[count])) == 1) {
		for (int i = 0; i < count; i++)
			if (strcmp(names[i], names[count]) == 0)
				return error_set(error, -EINVAL, "%s: %s is listed twice", option, names[i]);
		if (!*chip && chip_is_offset(names[count], &offset))
			return error_set(error, -EINVAL, "%s: %s is an offset: say of which chip with --gpio-chip", option,
							 names[count]);
		count++;
	}
	if (count == (int)CHIP_LINES && *rest)
		return error_set(error, -EINVAL, "%s: \"%.64s\" has more than %u lines", option, list, CHIP_LINES);
	if (count == 0 || taken < 0)
		return error_set(error, -EINVAL, "%s: \"%.64s\" is no list of lines like 17 or GPIO17,GPIO27", option, list);
	return count;
}

void chip_list_add(struct chip_list *list, const char *name, const char *label, uint32_t lines)
{
	const size_t used = strlen(list->text);
	snprintf(list->text + used, sizeof(list->text) - used, "%s%s (%s, %u lines)", list->count++ ? ", " : "", name,
			 label, lines);
}

/* ---- sentences ---- */

int chip_explain_open(const char *chip, int code, struct error *error)
{
	const char *folder = strchr(chip, '/') ? "" : "/dev/";
	if (code == EACCES || code == EPERM)
		return error_set(
			error, -code,
			"gpio-chip: no permission to open %s%.64s; join the group that owns it (ls -l /dev/gpiochip*) or "
			"install the udev rule of docs/lab.md",
			folder, chip);
	return error_set(error, -code, "gpio-chip: %s%.64s: %s", folder, chip, strerror(code));
}

int chip_explain_missing(const char *chip, const struct chip_list *list, struct error *error)
{
	const char *there = list->count ? "there are " : "this machine has none";
	if (!*chip)
		return error_set(error, -ENOENT, "gpio-chip: no chip has all lines that are named; %s%s", there, list->text);
	return error_set(error, -ENOENT, "gpio-chip: there is no chip \"%.64s\"; %s%s", chip, there, list->text);
}

int chip_explain_line(const struct chip_params *params, const char *text, const char *line, uint32_t count,
					  struct error *error)
{
	return error_set(error, -ENOENT, "%s: %s has no line %s; it has 0 to %u (gpioinfo shows their names)",
					 params->option, text, line, count - 1);
}

int chip_explain_busy(const struct chip_params *params, const char *text, uint32_t offset, const char *user,
					  struct error *error)
{
	return error_set(error, -EBUSY, "%s: line %u of %s is in use by %s", params->option, offset, text,
					 user ? user : "the kernel");
}
