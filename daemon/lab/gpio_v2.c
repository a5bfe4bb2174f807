/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Lines through libgpiod 2 (Debian 13, Ubuntu 24.10 and newer). */

#include "daemon/lab/chip.h"

#include <dirent.h>
#include <errno.h>
#include <gpiod.h>
#include <stdlib.h>
#include <string.h>

#define CONSUMER "pursuit"
#define READ_MOST 16

struct chip {
	struct gpiod_line_request *request;
	struct gpiod_edge_event_buffer *events;
	unsigned offsets[CHIP_LINES];
	uint32_t count;
	bool input;
	char text[96];
};

const char *chip_library(void)
{
	return "libgpiod 2";
}

/* ---- finding ---- */

/* What is known of a chip; false if it went away meanwhile. */
static bool describe(struct gpiod_chip *device, char name[CHIP_NAME_BYTES], char label[CHIP_NAME_BYTES],
					 uint32_t *lines)
{
	struct gpiod_chip_info *info = gpiod_chip_get_info(device);
	if (!info)
		return false;
	snprintf(name, CHIP_NAME_BYTES, "%s", gpiod_chip_info_get_name(info));
	snprintf(label, CHIP_NAME_BYTES, "%s", gpiod_chip_info_get_label(info));
	*lines = (uint32_t)gpiod_chip_info_get_num_lines(info);
	gpiod_chip_info_free(info);
	return true;
}

/* -1: it has no such line. */
static int find_offset(struct gpiod_chip *device, const char *line)
{
	char name[CHIP_NAME_BYTES], label[CHIP_NAME_BYTES];
	uint32_t offset, lines;
	if (!chip_is_offset(line, &offset))
		return gpiod_chip_get_line_offset_from_name(device, line);
	return describe(device, name, label, &lines) && offset < lines ? (int)offset : -1;
}

static bool has_lines(struct gpiod_chip *chip, const char *list)
{
	char name[CHIP_NAME_BYTES];
	uint32_t offset;
	while (chip_next_line(&list, name) == 1)
		if (!chip_is_offset(name, &offset) && find_offset(chip, name) < 0)
			return false;
	return true;
}

static int is_chip(const struct dirent *entry)
{
	return strncmp(entry->d_name, "gpiochip", 8) == 0;
}

/* Is it the one that is asked for? It goes on the list. */
static bool fits(struct gpiod_chip *device, const struct chip_params *params, struct chip_list *list)
{
	char name[CHIP_NAME_BYTES], label[CHIP_NAME_BYTES];
	uint32_t lines;
	if (!describe(device, name, label, &lines))
		return false;
	chip_list_add(list, name, label, lines);
	if (!*params->chip)
		return has_lines(device, params->lines);
	return strcmp(name, params->chip) == 0 || strcmp(label, params->chip) == 0;
}

/* The first chip under /dev that fits. NULL with a sentence, about permission if that is why. */
static struct gpiod_chip *search(const struct chip_params *params, struct error *error)
{
	struct dirent **entries = NULL;
	struct gpiod_chip *found = NULL;
	struct chip_list list = {.count = 0};
	char path[300], closed[300] = "";
	const int count = scandir("/dev", &entries, is_chip, versionsort);
	for (int i = 0; i < count; i++) {
		snprintf(path, sizeof(path), "/dev/%s", entries[i]->d_name);
		struct gpiod_chip *device = found ? NULL : gpiod_chip_open(path);
		if (!device && !found && (errno == EACCES || errno == EPERM))
			snprintf(closed, sizeof(closed), "%s", path);
		if (device && fits(device, params, &list))
			found = device;
		else if (device)
			gpiod_chip_close(device);
		free(entries[i]);
	}
	free(entries);
	if (!found && *closed)
		chip_explain_open(closed, EACCES, error);
	else if (!found)
		chip_explain_missing(params->chip, &list, error);
	return found;
}

static struct gpiod_chip *open_device(const struct chip_params *params, struct error *error)
{
	if (!strchr(params->chip, '/'))
		return search(params, error);
	struct gpiod_chip *device = gpiod_chip_open(params->chip);
	if (!device)
		chip_explain_open(params->chip, errno, error);
	return device;
}

static int find_lines(struct chip *chip, struct gpiod_chip *device, const struct chip_params *params,
					  struct error *error)
{
	char line[CHIP_NAME_BYTES], name[CHIP_NAME_BYTES], label[CHIP_NAME_BYTES];
	const char *list = params->lines;
	uint32_t lines;
	if (!describe(device, name, label, &lines))
		return chip_explain_open(params->chip, errno, error);
	snprintf(chip->text, sizeof(chip->text), "%s (%s)", name, label);
	while (chip_next_line(&list, line) == 1) {
		const int offset = find_offset(device, line);
		if (offset < 0)
			return chip_explain_line(params, chip->text, line, lines, error);
		chip->offsets[chip->count++] = (unsigned)offset;
	}
	return 0;
}

/* ---- requesting ---- */

static int explain_request(const struct chip *chip, struct gpiod_chip *device, const struct chip_params *params,
						   int code, struct error *error)
{
	for (uint32_t i = 0; i < chip->count && code == EBUSY; i++) {
		struct gpiod_line_info *info = gpiod_chip_get_line_info(device, chip->offsets[i]);
		const bool used = info && gpiod_line_info_is_used(info);
		if (used)
			chip_explain_busy(params, chip->text, chip->offsets[i], gpiod_line_info_get_consumer(info), error);
		gpiod_line_info_free(info);
		if (used)
			return -EBUSY;
	}
	return error_set(error, -code, "%s: %s of %s: %s", params->option, params->lines, chip->text, strerror(code));
}

/* The settings of each line; outputs start with their own level. */
static bool configure(const struct chip *chip, struct gpiod_line_config *config, struct gpiod_line_settings *settings,
					  const struct chip_params *params)
{
	gpiod_line_settings_set_active_low(settings, params->active_low);
	gpiod_line_settings_set_direction(settings,
									  params->input ? GPIOD_LINE_DIRECTION_INPUT : GPIOD_LINE_DIRECTION_OUTPUT);
	if (params->input) {
		gpiod_line_settings_set_edge_detection(settings, GPIOD_LINE_EDGE_BOTH);
		gpiod_line_settings_set_event_clock(settings, GPIOD_LINE_CLOCK_MONOTONIC);
	}
	for (uint32_t i = 0; i < chip->count; i++) {
		if (!params->input)
			gpiod_line_settings_set_output_value(settings, params->levels >> i & 1 ? GPIOD_LINE_VALUE_ACTIVE
																				   : GPIOD_LINE_VALUE_INACTIVE);
		if (gpiod_line_config_add_line_settings(config, &chip->offsets[i], 1, settings) < 0)
			return false;
	}
	return true;
}

static int request(struct chip *chip, struct gpiod_chip *device, const struct chip_params *params, struct error *error)
{
	struct gpiod_line_settings *settings = gpiod_line_settings_new();
	struct gpiod_line_config *config = gpiod_line_config_new();
	struct gpiod_request_config *consumer = gpiod_request_config_new();
	int result = 0;
	if (settings && config && consumer && configure(chip, config, settings, params)) {
		gpiod_request_config_set_consumer(consumer, CONSUMER);
		chip->request = gpiod_chip_request_lines(device, consumer, config);
	}
	if (!chip->request)
		result = explain_request(chip, device, params, errno ? errno : ENOMEM, error);
	gpiod_request_config_free(consumer);
	gpiod_line_config_free(config);
	gpiod_line_settings_free(settings);
	return result;
}

struct chip *chip_open(const struct chip_params *params, struct error *error)
{
	if (chip_count_lines(params->chip, params->lines, params->option, error) < 0)
		return NULL;
	struct chip *chip = calloc(1, sizeof(*chip));
	if (chip && params->input)
		chip->events = gpiod_edge_event_buffer_new(READ_MOST);
	if (!chip || (params->input && !chip->events)) {
		error_set(error, -ENOMEM, "%s: out of memory", params->option);
		chip_close(&chip);
		return NULL;
	}
	chip->input = params->input;
	struct gpiod_chip *device = open_device(params, error);
	if (!device || find_lines(chip, device, params, error) < 0 || request(chip, device, params, error) < 0)
		chip_close(&chip);
	if (device)
		gpiod_chip_close(device);
	return chip;
}

void chip_close(struct chip **chip)
{
	struct chip *self = *chip;
	*chip = NULL;
	if (!self)
		return;
	if (self->request)
		gpiod_line_request_release(self->request);
	gpiod_edge_event_buffer_free(self->events);
	free(self);
}

/* ---- using ---- */

uint32_t chip_line_count(const struct chip *chip)
{
	return chip->count;
}

const char *chip_text(const struct chip *chip)
{
	return chip->text;
}

int chip_set(struct chip *chip, uint32_t levels)
{
	enum gpiod_line_value values[CHIP_LINES];
	for (uint32_t i = 0; i < chip->count; i++)
		values[i] = levels >> i & 1 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
	return gpiod_line_request_set_values(chip->request, values) < 0 ? -errno : 0;
}

int chip_get(struct chip *chip, uint32_t *levels)
{
	enum gpiod_line_value values[CHIP_LINES];
	*levels = 0;
	if (gpiod_line_request_get_values(chip->request, values) < 0)
		return -errno;
	for (uint32_t i = 0; i < chip->count; i++)
		*levels |= (uint32_t)(values[i] == GPIOD_LINE_VALUE_ACTIVE) << i;
	return 0;
}

int chip_fd(const struct chip *chip)
{
	return chip->input ? gpiod_line_request_get_fd(chip->request) : -1;
}

int chip_read(struct chip *chip, struct chip_edge *edges, uint32_t most)
{
	const int ready = gpiod_line_request_wait_edge_events(chip->request, 0);
	if (ready <= 0)
		return ready < 0 ? -errno : 0;
	const int count =
		gpiod_line_request_read_edge_events(chip->request, chip->events, most < READ_MOST ? most : READ_MOST);
	if (count < 0)
		return -errno;
	for (int i = 0; i < count; i++) {
		struct gpiod_edge_event *event = gpiod_edge_event_buffer_get_event(chip->events, (unsigned long)i);
		edges[i].time_ns = gpiod_edge_event_get_timestamp_ns(event);
		edges[i].rising = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
	}
	return count;
}
