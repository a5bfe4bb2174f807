/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "task.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum task_event_kind { TASK_HIT, TASK_MISS, TASK_FALSE };
static const char *const kind_names[] = {"hit", "miss", "false"};

struct task_event {
	double time;
	uint32_t ring, key;
	enum task_event_kind kind;
	char method[32];
};

struct task {
	struct task_score score; /* as told last */
	struct task_event *events;
	size_t count, capacity;
};

struct task *task_create(void)
{
	return calloc(1, sizeof(struct task));
}

void task_destroy(struct task **task)
{
	if (*task)
		free((*task)->events);
	free(*task);
	*task = NULL;
}

static void add(struct task *task, const struct task_event *event)
{
	if (task->count == task->capacity) {
		const size_t wanted = task->capacity ? task->capacity * 2 : 256;
		struct task_event *bigger = realloc(task->events, wanted * sizeof(*bigger));
		if (!bigger)
			return;
		task->events = bigger;
		task->capacity = wanted;
	}
	task->events[task->count++] = *event;
}

bool task_changed(const struct task *task, const struct task_score *score)
{
	return memcmp(&task->score, score, sizeof(*score)) != 0;
}

void task_note(struct task *task, double time, const struct task_score *score, uint32_t key, const char *method)
{
	const struct task_score before = task->score;
	struct task_event event = {.time = time, .ring = score->shown, .key = key};
	snprintf(event.method, sizeof(event.method), "%s", method);
	task->score = *score;
	event.kind = TASK_HIT;
	for (uint32_t i = before.hits; i < score->hits; i++)
		add(task, &event);
	event.kind = TASK_FALSE;
	for (uint32_t i = before.false_answers; i < score->false_answers; i++)
		add(task, &event);
	/* The rings that have just left, without an answer. */
	event.kind = TASK_MISS;
	event.key = 0;
	for (uint32_t i = before.misses; i < score->misses; i++) {
		event.ring = score->shown - (score->misses - i);
		add(task, &event);
	}
}

int task_write_csv(const struct task *task, const char *path, struct error *error)
{
	FILE *file = fopen(path, "we");
	if (!file)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	fprintf(file, "time_s,ring,event,key,method\n");
	for (size_t i = 0; i < task->count; i++) {
		const struct task_event *event = &task->events[i];
		const char key[2] = {event->key > ' ' && event->key < 127 && event->key != ',' ? (char)event->key : '\0'};
		fprintf(file, "%.4f,%u,%s,%s,%s\n", event->time, event->ring, kind_names[event->kind], key, event->method);
	}
	const bool wrong = ferror(file) != 0;
	return fclose(file) != 0 || wrong ? error_set(error, -EIO, "%s: not written whole", path) : 0;
}

static void count(json_t *methods, const struct task_event *event)
{
	static const char *const names[] = {"hits", "misses", "false_answers"};
	json_t *method = json_object_get(methods, event->method);
	if (!method) {
		method = json_pack("{s:i, s:i, s:i, s:i}", "shown", 0, "hits", 0, "misses", 0, "false_answers", 0);
		json_object_set_new(methods, event->method, method);
	}
	json_t *number = json_object_get(method, names[event->kind]), *shown = json_object_get(method, "shown");
	json_integer_set(number, json_integer_value(number) + 1);
	json_integer_set(shown, json_integer_value(shown) + 1);
}

json_t *task_json(const struct task *task)
{
	json_t *methods = json_object(), *events = json_array();
	for (size_t i = 0; i < task->count; i++) {
		const struct task_event *event = &task->events[i];
		count(methods, event);
		json_array_append_new(events, json_pack("{s:f, s:i, s:s, s:s}", "time", event->time, "ring", (int)event->ring,
												"event", kind_names[event->kind], "method", event->method));
	}
	return json_pack("{s:o, s:o}", "methods", methods, "events", events);
}

void task_describe(const struct task *task, char *text, size_t size)
{
	snprintf(text, size, "%u rings, %u hits, %u misses, %u false", task->score.shown, task->score.hits,
			 task->score.misses, task->score.false_answers);
}
