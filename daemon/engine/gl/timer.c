/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/timer.h"

#include "daemon/engine/now.h"

void timer_init(struct timer *timer, const struct gl *gl, bool software, bool finish)
{
	*timer = (struct timer){.finish = finish, .queries = gl->timer_queries && !software && !finish};
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

void timer_collect(struct timer *timer, const struct gl *gl)
{
	for (uint32_t i = 0; i < timer->pending; i++) {
		GLuint64 ns = 0;
		gl->GetQueryObjectui64v(timer->ids[i], GL_QUERY_RESULT, &ns);
		timer->owners[i]->ms += (double)ns * 1e-6;
	}
	timer->pending = 0;
}

void timer_drop(struct timer *timer)
{
	timer->pending = 0;
}
