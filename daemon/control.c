/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/control.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "daemon/client.h"
#include "daemon/keys.h"
#include "daemon/printable.h"
#include "daemon/version.h"

#define TIMELINE_ROWS 400u
#define LATENCY_ROWS 200u /* that fit a packet */

struct control {
	struct control_params params;
	struct server *server;
	uint64_t start_ns;
	struct capture *capture;
};

/* ---- life ---- */

struct control *control_create(const struct control_params *params, struct error *error)
{
	struct control *control = calloc(1, sizeof(*control));
	if (!control) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	control->params = *params;
	control->start_ns = clock_now(params->clock);
	const struct capture_params capture = {params->loop,     params->log,    params->clock,
										   params->settings, params->output, params->closer};
	control->capture = capture_create(&capture, error);
	if (!control->capture)
		control_destroy(&control);
	return control;
}

void control_destroy(struct control **control)
{
	struct control *self = *control;
	*control = NULL;
	if (!self)
		return;
	self->server = NULL;
	capture_destroy(&self->capture);
	free(self);
}

struct capture *control_get_capture(struct control *control)
{
	return control->capture;
}

void control_set_server(struct control *control, struct server *server)
{
	control->server = server;
}

/* ---- requests ---- */

struct request {
	uint64_t client_id;
	uint32_t serial;
	const char *arguments; /* what follows the name */
	int fd;                /* the handler's, -1 none */
};

static void reply(struct control *control, const struct request *request, int status, const char *text)
{
	server_reply(control->server, request->client_id, request->serial, status, text);
}

/* Settings of the picture that can change, as they are now. */
static json_t *changeable_json(const struct settings *settings)
{
	json_t *object = json_object();
	for (const struct option_row *row = option_table(); row->name; row++) {
		char value[OPTION_VALUE_BYTES];
		if (live_effect_of(row) != LIVE_NEXT_FRAME)
			continue;
		settings_get(settings, row->name, value, sizeof(value));
		json_object_set_new(object, row->name, json_string(value));
	}
	return object;
}

/* Text from files and kernel, as JSON wants it. */
static json_t *clean_string(const char *text)
{
	char clean[PATH_MAX];
	snprintf(clean, sizeof(clean), "%s", text);
	printable_clean(clean);
	return json_string(clean);
}

/* What the settings come from, beside command line and defaults. */
static void add_configuration(const struct control *control, json_t *object)
{
	const struct reload *reload = control->params.reload;
	const struct live *live = control->params.live;
	const struct profile *profile = live_profile(live);
	json_t *files = json_array(), *asked = json_array();
	for (unsigned i = 0; i < reload->file_count; i++) {
		char *path = realpath(reload->files[i], NULL);
		json_array_append_new(files, clean_string(path ? path : reload->files[i]));
		free(path);
	}
	for (const struct option_row *row = option_table(); row->name; row++)
		if (live->is_asked[row - option_table()])
			json_array_append_new(asked, json_string(row->name));
	json_object_set_new(object, "profile", clean_string(profile ? profile->application : ""));
	json_object_set_new(
		object, "configuration",
		json_pack("{s:o, s:o, s:o}", "files", files, "mistake", clean_string(reload->mistake.text), "asked", asked));
}

char *control_status_text(struct control *control)
{
	struct stats *stats = malloc(sizeof(*stats)); /* a quarter of a megabyte */
	struct output_info info;
	char refresh[64];
	if (!stats)
		return NULL;
	output_get_stats(control->params.output, stats);
	output_get_info(control->params.output, &info);
	json_t *object = stats_json(stats);
	free(stats);
	settings_get(control->params.settings, "refresh", refresh, sizeof(refresh));
	json_object_set_new(object, "version", json_string(PURSUITD_VERSION));
	json_object_set_new(object, "pid", json_integer(getpid()));
	json_object_set_new(object, "uptime",
						json_real((double)((clock_now(control->params.clock) - control->start_ns) / 1000000) / 1e3));
	json_object_set_new(object, "method", json_string(info.method));
	json_object_set_new(object, "refresh", json_real((double)info.grid.numerator / (double)info.grid.denominator));
	json_object_set_new(object, "refresh_text", json_string(refresh));
	json_object_set_new(object, "presenter", json_string(info.presenter));
	json_object_set_new(object, "display", json_string(info.display));
	json_object_set_new(object, "display_trouble", json_string(info.trouble));
	json_object_set_new(object, "flip_time_source", json_string(presenter_time_source_name(info.time_source)));
	json_object_set_new(object, "renderer", json_string(info.renderer));
	json_object_set_new(object, "context", json_string(info.context));
	json_object_set_new(object, "software", json_boolean(info.software));
	if (control->server) {
		json_object_set_new(object, "clients", json_integer(server_client_count(control->server)));
		json_object_set_new(object, "streams", server_streams_json(control->server));
	}
	if (lab_is_active(control->params.lab))
		json_object_set_new(object, "lab", lab_status_json(control->params.lab));
	json_object_set_new(object, "settings", changeable_json(control->params.settings));
	add_configuration(control, object);
	json_t *recording = capture_json(control->capture);
	if (recording)
		json_object_set_new(object, "recording", recording);
	char *text = json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(12));
	json_decref(object);
	return text;
}

static void on_status(struct control *control, const struct request *request)
{
	char *text = control_status_text(control);
	reply(control, request, text ? 0 : ENOMEM, text ? text : "out of memory");
	free(text);
}

static void on_settings(struct control *control, const struct request *request)
{
	char *text = capture_settings_text(control->params.settings, " = ");
	reply(control, request, text ? 0 : ENOMEM, text ? text : "out of memory");
	free(text);
}

/* What a person wants to know of each setting beside its value. */
static void on_origins(struct control *control, const struct request *request)
{
	const struct live *live = control->params.live;
	json_t *object = json_object();
	for (const struct option_row *row = option_table(); row->name; row++) {
		json_t *origin = live_origin_json(live, row);
		json_object_set_new(origin, "live", json_string(live_effect_name(live_effect_of(row))));
		json_object_set_new(object, row->name, origin);
	}
	char *text = json_dumps(object, JSON_COMPACT);
	reply(control, request, text ? 0 : ENOMEM, text ? text : "out of memory");
	free(text);
	json_decref(object);
}

static void on_timeline(struct control *control, const struct request *request)
{
	unsigned long long from = 0, count = TIMELINE_ROWS;
	struct stats *stats = malloc(sizeof(*stats));
	if (sscanf(request->arguments, "%llu %llu", &from, &count) < 0 && *request->arguments)
		from = 0;
	if (count > TIMELINE_ROWS)
		count = TIMELINE_ROWS;
	if (!stats) {
		reply(control, request, ENOMEM, "out of memory");
		return;
	}
	output_get_stats(control->params.output, stats);
	json_t *object = stats_timeline_json(stats, from, count);
	char *text = json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(6));
	reply(control, request, text ? 0 : ENOMEM, text ? text : "out of memory");
	free(text);
	json_decref(object);
	free(stats);
}

static void on_latency(struct control *control, const struct request *request)
{
	unsigned long long from = 0, count = LATENCY_ROWS;
	if (!lab_is_active(control->params.lab)) {
		reply(control, request, EINVAL,
			  "latency: this daemon keeps no time points; start pursuitd with --latency, or: pursuit set latency=yes");
		return;
	}
	if (sscanf(request->arguments, "%llu %llu", &from, &count) < 0 && *request->arguments)
		from = 0;
	json_t *object = lab_rows_json(control->params.lab, from, count < LATENCY_ROWS ? count : LATENCY_ROWS);
	char *text = object ? json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(6)) : NULL;
	reply(control, request, text ? 0 : ENOMEM, text ? text : "out of memory");
	free(text);
	json_decref(object);
}

static void on_record(struct control *control, const struct request *request)
{
	struct error error = {""};
	if (!server_is_owner(control->server, request->client_id)) {
		if (request->fd >= 0)
			close(request->fd);
		reply(control, request, EPERM, "record: the daemon's own user or root only may record what others show");
		return;
	}
	const int result = capture_begin(control->capture, request->fd, &error);
	reply(control, request, result, result < 0 ? error.text : "recording");
}

static void on_recorded(void *data, uint64_t client_id, uint32_t serial, int result, const char *text)
{
	struct control *control = data;
	if (control->server)
		server_reply(control->server, client_id, serial, result, text);
}

/* A recording that was ended by hand is not asked for any more: the same file may be named once more. */
static void empty_setting(struct control *control)
{
	struct error error = {""};
	if (*control->params.settings->record && live_set(control->params.live, "record=", true, &error) < 0)
		log_warning(control->params.log, "record-stop: the setting record stays as it is: %s", error.text);
}

static void on_record_stop(struct control *control, const struct request *request)
{
	struct error error = {""};
	if (!server_is_owner(control->server, request->client_id)) {
		reply(control, request, EPERM, "record-stop: the daemon's own user or root only may end a recording");
		return;
	}
	const int result = capture_end(control->capture, on_recorded, control, request->client_id, request->serial, &error);
	if (result < 0)
		reply(control, request, result, error.text);
	if (result != -EINVAL)
		empty_setting(control);
}

/* "key q", "key escape": as if it had been pressed in the window. */
static void on_key(struct control *control, const struct request *request)
{
	const struct presenter_key key = {keys_parse(request->arguments), clock_now(control->params.clock)};
	if (key.code == 0) {
		reply(control, request, EINVAL, "key: must be one character, or escape, f1 or close");
		return;
	}
	if (keys_find(key.code) == KEY_QUIT && !server_is_owner(control->server, request->client_id)) {
		reply(control, request, EPERM, "key: the daemon's own user or root only may end it");
		return;
	}
	output_press_key(control->params.output, &key);
	reply(control, request, 0, "pressed");
}

static void on_set(struct control *control, const struct request *request)
{
	static const char focus[] = "focus=";
	const bool owner = server_is_owner(control->server, request->client_id);
	struct error error = {""};
	int result;
	if (strncmp(request->arguments, focus, strlen(focus)) == 0)
		result = server_focus(control->server, request->arguments + strlen(focus), &error);
	else
		result = live_set(control->params.live, request->arguments, owner, &error);
	reply(control, request, result, result < 0 ? error.text : "set");
}

static void on_unset(struct control *control, const struct request *request)
{
	struct error error = {""};
	const bool owner = server_is_owner(control->server, request->client_id);
	const int result = live_unset(control->params.live, request->arguments, owner, &error);
	reply(control, request, result, result < 0 ? error.text : "unset");
}

static void on_reload(struct control *control, const struct request *request)
{
	struct error error = {""};
	if (!server_is_owner(control->server, request->client_id)) {
		reply(control, request, EPERM, "reload: for the daemon's own user or root only");
		return;
	}
	const int result = reload_now(control->params.reload, "on request", &error);
	reply(control, request, result < 0 ? result : 0, result < 0 ? error.text : "reloaded");
}

static void on_ping(struct control *control, const struct request *request)
{
	reply(control, request, 0, "pong");
}

void control_handle(void *data, uint64_t client_id, uint32_t serial, const char *text, int fd)
{
	static const struct {
		const char *name;
		void (*handle)(struct control *control, const struct request *request);
	} requests[] = {
		{"origins", on_origins},
		{"status", on_status},
		{"settings", on_settings},
		{"timeline", on_timeline},
		{"latency", on_latency},
		{"record", on_record},
		{"record-stop", on_record_stop},
		{"ping", on_ping},
		{"key", on_key},
		{"set", on_set},
		{"unset", on_unset},
		{"reload", on_reload},
	};
	struct control *control = data;
	const size_t length = strcspn(text, " ");
	const struct request request = {client_id, serial, text + length + strspn(text + length, " "), fd};
	for (size_t i = 0; i < sizeof(requests) / sizeof(requests[0]); i++) {
		if (strlen(requests[i].name) == length && strncmp(requests[i].name, text, length) == 0) {
			requests[i].handle(control, &request);
			return;
		}
	}
	char answer[256];
	snprintf(
		answer, sizeof(answer),
		"\"%.64s\" is no request; there are status, settings, origins, timeline, latency, record, record-stop, set, "
		"unset, reload, key and ping",
		text);
	reply(control, &request, EINVAL, answer);
	if (fd >= 0)
		close(fd);
}
