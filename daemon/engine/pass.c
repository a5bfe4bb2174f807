/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pass.h"

#include <errno.h>
#include <string.h>

static const char *const names[PASS_COUNT] = {
	[PASS_ANALYSE] = "analyse",
	[PASS_FIELD] = "field",
	[PASS_PAINT] = "paint",
	[PASS_PUT] = "put",
	[PASS_UPLOAD] = "upload",
	[PASS_PYRAMID] = "pyramid",
	[PASS_COMPENSATE] = "compensate",
	[PASS_WARP] = "warp",
	[PASS_UI] = "ui",
	[PASS_READ] = "read",
	[PASS_COPY] = "copy",
};

int pass_run(struct engine *engine, enum pass_id id, struct error *error)
{
	struct executor *executor = engine->executor;
	const struct pass *pass = executor->ops->passes[id];
	if (!pass)
		return error_set(error, -ENOTSUP, "method %s needs \"%s\", which context %s does not have",
						 engine->params.method, names[id], executor->info.context);
	const char *reason = pass->prepare ? pass->prepare(engine) : NULL;
	if (reason) {
		report_leave_out(&engine->report, names[id], reason);
		return 0;
	}
	executor->ops->time_begin(executor, &engine->report.passes[id], pass->on_cpu);
	int result = pass->run(engine, error);
	executor->ops->time_end(executor);
	return result;
}

void report_leave_out(struct engine_report *report, const char *name, const char *reason)
{
	for (uint32_t i = 0; i < report->left_out_count; i++)
		if (strcmp(report->left_out[i].name, name) == 0)
			return;
	if (report->left_out_count < ENGINE_MAX_LEFT_OUT)
		report->left_out[report->left_out_count++] = (struct engine_left_out){name, reason};
}

void report_begin(struct engine_report *report, uint64_t frame_id, const char *time_source)
{
	*report = (struct engine_report){.frame_id = frame_id, .time_source = time_source, .pass_count = PASS_COUNT};
	for (int i = 0; i < PASS_COUNT; i++)
		report->passes[i].name = names[i];
}
