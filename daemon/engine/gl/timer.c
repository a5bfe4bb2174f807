/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/timer.h"

#include "daemon/engine/now.h"

/* EXT_disjoint_timer_query, which the headers of core GL lack. */
#define GL_GPU_DISJOINT_EXT 0x8FBB

void timer_init(struct timer *timer, const struct gl *gl, bool queries, bool finish)
{
	*timer = (struct timer){.finish = finish, .queries = gl->timer_queries && queries && !finish};
	if (timer->queries)
		gl->GenQueries(TIMER_QUERIES, timer->ids);
}

void timer_finish(struct timer *timer, const struct gl *gl)
{
	if (timer->queries)
		gl->DeleteQueries(TIMER_QUERIES, timer->ids);
	*timer = (struct timer){0};
}

const char *timer_source(const struct timer *timer)
{
	return timer->queries ? "timer-query" : timer->finish ? "finish" : "cpu";
}

void timer_begin(struct timer *timer, const struct gl *gl, struct engine_pass_report *pass, bool on_cpu)
{
	timer->open = pass;
	timer->open_query = timer->queries && !on_cpu && timer->pending < TIMER_QUERIES;
	if (timer->open_query)
		gl->BeginQuery(GL_TIME_ELAPSED, timer->ids[timer->pending]);
	else if (!timer->queries || on_cpu)
		timer->began_ns = now_ns();
	else
		timer->began_ns = 0;
}

void timer_end(struct timer *timer, const struct gl *gl)
{
	timer->open->runs++;
	if (timer->open_query) {
		gl->EndQuery(GL_TIME_ELAPSED);
		timer->owners[timer->pending++] = timer->open;
		return;
	}
	if (!timer->began_ns)
		return;
	if (timer->finish)
		gl->Finish();
	timer->open->ms += (double)(now_ns() - timer->began_ns) * 1e-6;
}

/* GLES only: since the last question the GPU's clock changed its pace or stood still. Core GL does not tell. */
static bool lost_count(const struct gl *gl)
{
	GLint disjoint = 0;
	if (gl->gles)
		gl->GetIntegerv(GL_GPU_DISJOINT_EXT, &disjoint);
	return disjoint != 0;
}

void timer_collect(struct timer *timer, const struct gl *gl)
{
	GLuint64 ns[TIMER_QUERIES] = {0};
	for (uint32_t i = 0; i < timer->pending; i++)
		gl->GetQueryObjectui64v(timer->ids[i], GL_QUERY_RESULT, &ns[i]);
	const bool lost = timer->pending && lost_count(gl);
	for (uint32_t i = 0; i < timer->pending && !lost; i++)
		timer->owners[i]->ms += (double)ns[i] * 1e-6;
	timer->pending = 0;
}

void timer_drop(struct timer *timer)
{
	timer->pending = 0;
}
