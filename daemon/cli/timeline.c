/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "timeline.h"

#include <errno.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char *const show_names[TIMELINE_SHOWS] = {"real", "in-between", "repeat", "standby", "kept"};

static bool read_row(const json_t *json, struct timeline_row *row)
{
	uint64_t *const numbers[] = {&row->vblank, &row->target_ns, &row->ready_ns, &row->flip_ns, &row->frame_id};
	if (json_array_size(json) != 7)
		return false;
	for (size_t i = 0; i < 5; i++)
		*numbers[i] = (uint64_t)json_integer_value(json_array_get(json, i));
	const char *show = json_string_value(json_array_get(json, 5));
	row->phase = json_number_value(json_array_get(json, 6));
	for (unsigned i = 0; show && i < TIMELINE_SHOWS; i++) {
		if (strcmp(show, show_names[i]) == 0) {
			row->show = (enum timeline_show)i;
			return true;
		}
	}
	return false;
}

static int add_rows(struct timeline *timeline, const json_t *rows, struct error *error)
{
	size_t count = json_array_size(rows);
	if (timeline->count + count > timeline->capacity) {
		uint32_t capacity = 2 * timeline->capacity + (uint32_t)count;
		struct timeline_row *grown = realloc(timeline->rows, capacity * sizeof(*grown));
		if (!grown)
			return error_set(error, -ENOMEM, "out of memory");
		timeline->rows = grown;
		timeline->capacity = capacity;
	}
	for (size_t i = 0; i < count; i++) {
		if (!read_row(json_array_get(rows, i), &timeline->rows[timeline->count]))
			return error_set(error, -EPROTO, "the daemon's timeline has a row that is none");
		timeline->count++;
	}
	return 0;
}

int timeline_fetch(struct timeline *timeline, struct control *control, struct error *error)
{
	*timeline = (struct timeline){0};
	uint64_t total = 1;
	int result = 0;
	for (uint64_t from = 0; from < total && result == 0;) {
		char request[64];
		json_t *reply = NULL;
		snprintf(request, sizeof(request), "timeline %" PRIu64 " 400", from);
		result = control_ask(control, request, -1, &reply, error);
		if (result < 0)
			return result;
		uint64_t first = (uint64_t)json_integer_value(json_object_get(reply, "first"));
		const json_t *rows = json_object_get(reply, "rows");
		if (from == 0) {
			timeline->first = first;
			total = (uint64_t)json_integer_value(json_object_get(reply, "total"));
		}
		result = add_rows(timeline, rows, error);
		from = json_array_size(rows) ? first + json_array_size(rows) : total;
		json_decref(reply);
	}
	return result;
}

void timeline_finish(struct timeline *timeline)
{
	free(timeline->rows);
	*timeline = (struct timeline){0};
}
