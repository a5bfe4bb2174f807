/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Lines through libgpiod 1 (Debian 12: 1.6), whose edges bear CLOCK_MONOTONIC stamps since Linux 5.7. */

#include "daemon/lab/chip.h"

#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CONSUMER "pursuit"
#define READ_MOST 16

struct chip {
	struct gpiod_chip *chip;
	struct gpiod_line_bulk lines;
	bool requested;
	int fd; /* of an input; libgpiod's */
	char text[96];
};

const char *chip_library(void)
{
	return "libgpiod 1";
}

/* ---- finding ---- */

static void list_chips(struct chip_list *list)
{
	struct gpiod_chip_iter *iterator = gpiod_chip_iter_new();
	struct gpiod_chip *chip;
	if (!iterator)
		return;
	while ((chip = gpiod_chip_iter_next(iterator)))
		chip_list_add(list, gpiod_chip_name(chip), gpiod_chip_label(chip), gpiod_chip_num_lines(chip));
	gpiod_chip_iter_free(iterator);
}

/* Does it have all lines of the list that are given by name? */
static bool has_lines(struct gpiod_chip *chip, const char *list)
{
	char name[CHIP_NAME_BYTES];
	uint32_t offset;
	while (chip_next_line(&list, name) == 1)
		if (!chip_is_offset(name, &offset) && !gpiod_chip_find_line(chip, name))
			return false;
	return true;
}

static struct gpiod_chip *open_any(const char *lines)
{
	struct gpiod_chip_iter *iterator = gpiod_chip_iter_new();
	struct gpiod_chip *chip = NULL;
	if (!iterator)
		return NULL;
	while ((chip = gpiod_chip_iter_next(iterator)))
		if (has_lines(chip, lines))
			break;
	if (chip)
		gpiod_chip_iter_free_noclose(iterator);
	else
		gpiod_chip_iter_free(iterator);
	return chip;
}

/* libgpiod's lookup hides a missing permission behind "no such device"; the path tells. */
static int explain_chip(const char *name, int code, struct error *error)
{
	const char *one = *name ? name : "gpiochip0";
	struct chip_list list = {.count = 0};
	char path[64];
	snprintf(path, sizeof(path), "%s%.40s", strchr(one, '/') ? "" : "/dev/", one);
	if (access(path, F_OK) == 0 && access(path, R_OK | W_OK) < 0 && errno == EACCES)
		return chip_explain_open(path, EACCES, error);
	if (code != 0 && code != ENOENT && code != ENODEV && code != ENOTTY && code != EINVAL)
		return chip_explain_open(one, code, error);
	list_chips(&list);
	return chip_explain_missing(name, &list, error);
}

static struct gpiod_line *find_line(struct gpiod_chip *chip, const char *name)
{
	uint32_t offset;
	if (!chip_is_offset(name, &offset))
		return gpiod_chip_find_line(chip, name);
	return offset < gpiod_chip_num_lines(chip) ? gpiod_chip_get_line(chip, offset) : NULL;
}

static int find_lines(struct chip *chip, const struct chip_params *params, struct error *error)
{
	char name[CHIP_NAME_BYTES];
	const char *list = params->lines;
	gpiod_line_bulk_init(&chip->lines);
	while (chip_next_line(&list, name) == 1) {
		struct gpiod_line *line = find_line(chip->chip, name);
		if (!line)
			return chip_explain_line(params, chip->text, name, gpiod_chip_num_lines(chip->chip), error);
		gpiod_line_bulk_add(&chip->lines, line);
	}
	return 0;
}

/* ---- requesting ---- */

static int explain_request(struct chip *chip, const struct chip_params *params, int code, struct error *error)
{
	struct gpiod_line *line, **each;
	gpiod_line_bulk_foreach_line(&chip->lines, line, each)
	{
		const char *user = gpiod_line_update(line) == 0 ? gpiod_line_consumer(line) : NULL;
		if (code == EBUSY && gpiod_line_is_used(line))
			return chip_explain_busy(params, chip->text, gpiod_line_offset(line), user, error);
	}
	return error_set(error, -code, "%s: %s of %s: %s", params->option, params->lines, chip->text, strerror(code));
}

static int request(struct chip *chip, const struct chip_params *params, struct error *error)
{
	const struct gpiod_line_request_config config = {
		.consumer = CONSUMER,
		.request_type = params->input ? GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES : GPIOD_LINE_REQUEST_DIRECTION_OUTPUT,
		.flags = params->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0,
	};
	int values[CHIP_LINES];
	for (uint32_t i = 0; i < CHIP_LINES; i++)
		values[i] = params->levels >> i & 1;
	if (gpiod_line_request_bulk(&chip->lines, &config, values) < 0)
		return explain_request(chip, params, errno, error);
	chip->requested = true;
	if (!params->input)
		return 0;
	chip->fd = gpiod_line_event_get_fd(gpiod_line_bulk_get_line(&chip->lines, 0));
	return 0;
}

struct chip *chip_open(const struct chip_params *params, struct error *error)
{
	if (chip_count_lines(params->chip, params->lines, params->option, error) < 0)
		return NULL;
	struct chip *chip = calloc(1, sizeof(*chip));
	if (!chip) {
		error_set(error, -ENOMEM, "%s: out of memory", params->option);
		return NULL;
	}
	chip->fd = -1;
	chip->chip = *params->chip ? gpiod_chip_open_lookup(params->chip) : open_any(params->lines);
	if (!chip->chip) {
		explain_chip(params->chip, errno, error);
		chip_close(&chip);
		return NULL;
	}
	snprintf(chip->text, sizeof(chip->text), "%s (%s)", gpiod_chip_name(chip->chip), gpiod_chip_label(chip->chip));
	if (find_lines(chip, params, error) < 0 || request(chip, params, error) < 0)
		chip_close(&chip);
	return chip;
}

void chip_close(struct chip **chip)
{
	struct chip *self = *chip;
	*chip = NULL;
	if (!self)
		return;
	if (self->requested)
		gpiod_line_release_bulk(&self->lines);
	if (self->chip)
		gpiod_chip_close(self->chip);
	free(self);
}

/* ---- using ---- */

uint32_t chip_line_count(const struct chip *chip)
{
	return chip->lines.num_lines;
}

const char *chip_text(const struct chip *chip)
{
	return chip->text;
}

int chip_set(struct chip *chip, uint32_t levels)
{
	int values[CHIP_LINES];
	for (uint32_t i = 0; i < chip->lines.num_lines; i++)
		values[i] = levels >> i & 1;
	return gpiod_line_set_value_bulk(&chip->lines, values) < 0 ? -errno : 0;
}

int chip_get(struct chip *chip, uint32_t *levels)
{
	int values[CHIP_LINES] = {0};
	*levels = 0;
	if (gpiod_line_get_value_bulk(&chip->lines, values) < 0)
		return -errno;
	for (uint32_t i = 0; i < chip->lines.num_lines; i++)
		*levels |= (uint32_t)(values[i] != 0) << i;
	return 0;
}

int chip_fd(const struct chip *chip)
{
	return chip->fd;
}

int chip_read(struct chip *chip, struct chip_edge *edges, uint32_t most)
{
	struct gpiod_line_event events[READ_MOST];
	struct pollfd poll_fd = {.fd = chip->fd, .events = POLLIN};
	const int ready = poll(&poll_fd, 1, 0);
	if (ready <= 0)
		return ready < 0 ? -errno : 0;
	if (!(poll_fd.revents & POLLIN))
		return -ENODEV;
	const int count = gpiod_line_event_read_fd_multiple(chip->fd, events, most < READ_MOST ? most : READ_MOST);
	if (count < 0)
		return -errno;
	for (int i = 0; i < count; i++) {
		edges[i].time_ns = (uint64_t)events[i].ts.tv_sec * UINT64_C(1000000000) + (uint64_t)events[i].ts.tv_nsec;
		edges[i].rising = events[i].event_type == GPIOD_LINE_EVENT_RISING_EDGE;
	}
	return count;
}
