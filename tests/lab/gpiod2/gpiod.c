/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/lab/gpiod2/gpiod.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/gpio.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

struct gpiod_chip {
	int fd;
};

struct gpiod_chip_info {
	struct gpiochip_info info;
};

struct gpiod_line_info {
	struct gpio_v2_line_info info;
};

struct gpiod_line_settings {
	enum gpiod_line_direction direction;
	enum gpiod_line_edge edge;
	enum gpiod_line_clock clock;
	bool active_low, value;
};

struct gpiod_line_config {
	uint32_t count, offsets[GPIO_V2_LINES_MAX];
	struct gpiod_line_settings settings[GPIO_V2_LINES_MAX];
};

struct gpiod_request_config {
	char consumer[GPIO_MAX_NAME_SIZE];
};

struct gpiod_line_request {
	int fd;
	uint32_t count;
};

struct gpiod_edge_event {
	struct gpio_v2_line_event event;
};

struct gpiod_edge_event_buffer {
	size_t capacity;
	struct gpiod_edge_event events[];
};

/* ---- chips ---- */

struct gpiod_chip *gpiod_chip_open(const char *path)
{
	struct gpiochip_info info;
	const int fd = open(path, O_RDWR | O_CLOEXEC);
	struct gpiod_chip *chip = fd >= 0 && ioctl(fd, GPIO_GET_CHIPINFO_IOCTL, &info) == 0 ? malloc(sizeof(*chip)) : NULL;
	if (chip)
		chip->fd = fd;
	else if (fd >= 0)
		close(fd);
	return chip;
}

void gpiod_chip_close(struct gpiod_chip *chip)
{
	if (!chip)
		return;
	close(chip->fd);
	free(chip);
}

struct gpiod_chip_info *gpiod_chip_get_info(struct gpiod_chip *chip)
{
	struct gpiod_chip_info *info = calloc(1, sizeof(*info));
	if (info && ioctl(chip->fd, GPIO_GET_CHIPINFO_IOCTL, &info->info) == 0)
		return info;
	free(info);
	return NULL;
}

struct gpiod_line_info *gpiod_chip_get_line_info(struct gpiod_chip *chip, unsigned int offset)
{
	struct gpiod_line_info *info = calloc(1, sizeof(*info));
	if (!info)
		return NULL;
	info->info.offset = offset;
	if (ioctl(chip->fd, GPIO_V2_GET_LINEINFO_IOCTL, &info->info) == 0)
		return info;
	free(info);
	return NULL;
}

int gpiod_chip_get_line_offset_from_name(struct gpiod_chip *chip, const char *name)
{
	struct gpiochip_info info = {.lines = 0};
	if (ioctl(chip->fd, GPIO_GET_CHIPINFO_IOCTL, &info) < 0)
		return -1;
	for (uint32_t i = 0; i < info.lines; i++) {
		struct gpio_v2_line_info line = {.offset = i};
		if (ioctl(chip->fd, GPIO_V2_GET_LINEINFO_IOCTL, &line) < 0)
			return -1;
		if (strcmp(line.name, name) == 0)
			return (int)i;
	}
	errno = ENOENT;
	return -1;
}

void gpiod_chip_info_free(struct gpiod_chip_info *info)
{
	free(info);
}

const char *gpiod_chip_info_get_name(struct gpiod_chip_info *info)
{
	return info->info.name;
}

const char *gpiod_chip_info_get_label(struct gpiod_chip_info *info)
{
	return info->info.label;
}

size_t gpiod_chip_info_get_num_lines(struct gpiod_chip_info *info)
{
	return info->info.lines;
}

void gpiod_line_info_free(struct gpiod_line_info *info)
{
	free(info);
}

bool gpiod_line_info_is_used(struct gpiod_line_info *info)
{
	return info->info.flags & GPIO_V2_LINE_FLAG_USED;
}

const char *gpiod_line_info_get_consumer(struct gpiod_line_info *info)
{
	return *info->info.consumer ? info->info.consumer : NULL;
}

/* ---- what is asked for ---- */

struct gpiod_line_settings *gpiod_line_settings_new(void)
{
	struct gpiod_line_settings *settings = calloc(1, sizeof(*settings));
	if (settings)
		*settings = (struct gpiod_line_settings){GPIOD_LINE_DIRECTION_AS_IS, GPIOD_LINE_EDGE_NONE,
												 GPIOD_LINE_CLOCK_MONOTONIC, false, false};
	return settings;
}

void gpiod_line_settings_free(struct gpiod_line_settings *settings)
{
	free(settings);
}

int gpiod_line_settings_set_direction(struct gpiod_line_settings *settings, enum gpiod_line_direction direction)
{
	settings->direction = direction;
	return 0;
}

int gpiod_line_settings_set_edge_detection(struct gpiod_line_settings *settings, enum gpiod_line_edge edge)
{
	settings->edge = edge;
	return 0;
}

void gpiod_line_settings_set_active_low(struct gpiod_line_settings *settings, bool active_low)
{
	settings->active_low = active_low;
}

int gpiod_line_settings_set_event_clock(struct gpiod_line_settings *settings, enum gpiod_line_clock clock)
{
	settings->clock = clock;
	return 0;
}

int gpiod_line_settings_set_output_value(struct gpiod_line_settings *settings, enum gpiod_line_value value)
{
	settings->value = value == GPIOD_LINE_VALUE_ACTIVE;
	return 0;
}

struct gpiod_line_config *gpiod_line_config_new(void)
{
	return calloc(1, sizeof(struct gpiod_line_config));
}

void gpiod_line_config_free(struct gpiod_line_config *config)
{
	free(config);
}

int gpiod_line_config_add_line_settings(struct gpiod_line_config *config, const unsigned int *offsets, size_t count,
										struct gpiod_line_settings *settings)
{
	for (size_t i = 0; i < count; i++) {
		if (config->count == GPIO_V2_LINES_MAX) {
			errno = E2BIG;
			return -1;
		}
		config->offsets[config->count] = offsets[i];
		config->settings[config->count++] = *settings;
	}
	return 0;
}

struct gpiod_request_config *gpiod_request_config_new(void)
{
	return calloc(1, sizeof(struct gpiod_request_config));
}

void gpiod_request_config_free(struct gpiod_request_config *config)
{
	free(config);
}

void gpiod_request_config_set_consumer(struct gpiod_request_config *config, const char *consumer)
{
	snprintf(config->consumer, sizeof(config->consumer), "%s", consumer);
}

/* ---- requests ---- */

static uint64_t flags_of(const struct gpiod_line_settings *settings)
{
	uint64_t flags = settings->active_low ? GPIO_V2_LINE_FLAG_ACTIVE_LOW : 0;
	flags |= settings->direction == GPIOD_LINE_DIRECTION_INPUT ? GPIO_V2_LINE_FLAG_INPUT : 0;
	flags |= settings->direction == GPIOD_LINE_DIRECTION_OUTPUT ? GPIO_V2_LINE_FLAG_OUTPUT : 0;
	if (settings->edge == GPIOD_LINE_EDGE_RISING || settings->edge == GPIOD_LINE_EDGE_BOTH)
		flags |= GPIO_V2_LINE_FLAG_EDGE_RISING;
	if (settings->edge == GPIOD_LINE_EDGE_FALLING || settings->edge == GPIOD_LINE_EDGE_BOTH)
		flags |= GPIO_V2_LINE_FLAG_EDGE_FALLING;
	return flags | (settings->clock == GPIOD_LINE_CLOCK_REALTIME ? GPIO_V2_LINE_FLAG_EVENT_CLOCK_REALTIME : 0);
}

static void add_levels(struct gpio_v2_line_config *config, const struct gpiod_line_config *lines)
{
	struct gpio_v2_line_config_attribute *levels = &config->attrs[config->num_attrs++];
	levels->attr.id = GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES;
	for (uint32_t i = 0; i < lines->count; i++) {
		levels->mask |= UINT64_C(1) << i;
		levels->attr.values |= (uint64_t)lines->settings[i].value << i;
	}
}

struct gpiod_line_request *gpiod_chip_request_lines(struct gpiod_chip *chip, struct gpiod_request_config *consumer,
													struct gpiod_line_config *lines)
{
	struct gpio_v2_line_request request = {.num_lines = lines->count};
	struct gpiod_line_request *result = calloc(1, sizeof(*result));
	if (!result)
		return NULL;
	snprintf(request.consumer, sizeof(request.consumer), "%s", consumer->consumer);
	memcpy(request.offsets, lines->offsets, sizeof(lines->offsets));
	request.config.flags = flags_of(&lines->settings[0]);
	if (lines->settings[0].direction == GPIOD_LINE_DIRECTION_OUTPUT)
		add_levels(&request.config, lines);
	if (ioctl(chip->fd, GPIO_V2_GET_LINE_IOCTL, &request) < 0) {
		free(result);
		return NULL;
	}
	*result = (struct gpiod_line_request){request.fd, lines->count};
	return result;
}

void gpiod_line_request_release(struct gpiod_line_request *request)
{
	if (!request)
		return;
	close(request->fd);
	free(request);
}

static uint64_t all_lines(const struct gpiod_line_request *request)
{
	return (UINT64_C(1) << request->count) - 1;
}

int gpiod_line_request_set_values(struct gpiod_line_request *request, const enum gpiod_line_value *values)
{
	struct gpio_v2_line_values all = {.mask = all_lines(request)};
	for (uint32_t i = 0; i < request->count; i++)
		all.bits |= (uint64_t)(values[i] == GPIOD_LINE_VALUE_ACTIVE) << i;
	return ioctl(request->fd, GPIO_V2_LINE_SET_VALUES_IOCTL, &all);
}

int gpiod_line_request_get_values(struct gpiod_line_request *request, enum gpiod_line_value *values)
{
	struct gpio_v2_line_values all = {.mask = all_lines(request)};
	if (ioctl(request->fd, GPIO_V2_LINE_GET_VALUES_IOCTL, &all) < 0)
		return -1;
	for (uint32_t i = 0; i < request->count; i++)
		values[i] = all.bits >> i & 1 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
	return 0;
}

int gpiod_line_request_get_fd(struct gpiod_line_request *request)
{
	return request->fd;
}

int gpiod_line_request_wait_edge_events(struct gpiod_line_request *request, int64_t timeout_ns)
{
	struct pollfd poll_fd = {.fd = request->fd, .events = POLLIN | POLLPRI};
	const struct timespec timeout = {(time_t)(timeout_ns / 1000000000), (long)(timeout_ns % 1000000000)};
	const int result = ppoll(&poll_fd, 1, timeout_ns < 0 ? NULL : &timeout, NULL);
	return result > 0 ? 1 : result;
}

int gpiod_line_request_read_edge_events(struct gpiod_line_request *request, struct gpiod_edge_event_buffer *buffer,
										size_t most)
{
	const size_t room = most < buffer->capacity ? most : buffer->capacity;
	const ssize_t got = read(request->fd, buffer->events, room * sizeof(buffer->events[0]));
	return got < 0 ? -1 : (int)((size_t)got / sizeof(buffer->events[0]));
}

/* ---- events ---- */

struct gpiod_edge_event_buffer *gpiod_edge_event_buffer_new(size_t capacity)
{
	struct gpiod_edge_event_buffer *buffer = calloc(1, sizeof(*buffer) + capacity * sizeof(buffer->events[0]));
	if (buffer)
		buffer->capacity = capacity;
	return buffer;
}

void gpiod_edge_event_buffer_free(struct gpiod_edge_event_buffer *buffer)
{
	free(buffer);
}

struct gpiod_edge_event *gpiod_edge_event_buffer_get_event(struct gpiod_edge_event_buffer *buffer, unsigned long index)
{
	return index < buffer->capacity ? &buffer->events[index] : NULL;
}

uint64_t gpiod_edge_event_get_timestamp_ns(struct gpiod_edge_event *event)
{
	return event->event.timestamp_ns;
}

enum gpiod_edge_event_type gpiod_edge_event_get_event_type(struct gpiod_edge_event *event)
{
	return event->event.id == GPIO_V2_LINE_EVENT_RISING_EDGE ? GPIOD_EDGE_EVENT_RISING_EDGE
															 : GPIOD_EDGE_EVENT_FALLING_EDGE;
}
