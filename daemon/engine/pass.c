/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pass.h"

#include <string.h>

static const struct pass *const passes[PASS_COUNT] = {
	[PASS_ANALYSE] = &pass_analyse, [PASS_UPLOAD] = &pass_upload,
	[PASS_PYRAMID] = &pass_pyramid, [PASS_COMPENSATE] = &pass_compensate,
	[PASS_WARP] = &pass_warp,       [PASS_UI] = &pass_ui,
	[PASS_READ] = &pass_read,
};

int pass_run(struct engine *engine, enum pass_id id, struct error *error)
{
	const struct pass *pass = passes[id];
	const char *reason = pass->prepare(engine);
	if (reason) {
		report_leave_out(&engine->report, pass->name, reason);
		return 0;
	}
	timer_begin(&engine->timer, engine_gl(engine), &engine->report.passes[id], pass->on_cpu);
	int result = pass->run(engine, error);
	timer_end(&engine->timer, engine_gl(engine));
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
		report->passes[i].name = passes[i]->name;
}
