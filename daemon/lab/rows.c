/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/rows.h"

#include <string.h>

struct row *rows_add(struct rows *rows)
{
	struct row *row = &rows->rows[rows->end++ % ROWS];
	memset(row, 0, sizeof(*row));
	row->points.time[POINT_SUBMIT] = row->points.time[POINT_INTAKE] = POINT_NOT_YET;
	row->points.time[POINT_READY] = POINT_NOT_YET;
	return row;
}

bool rows_full(const struct rows *rows)
{
	return rows->end - rows->first == ROWS;
}

struct row *rows_find(struct rows *rows, uint64_t vblank)
{
	for (uint64_t i = rows->end; i-- > rows->first;)
		if (rows->rows[i % ROWS].points.vblank == vblank)
			return &rows->rows[i % ROWS];
	return NULL;
}

void rows_tell(struct rows *rows, const struct points *points)
{
	static const enum point told[] = {POINT_SUBMIT, POINT_INTAKE, POINT_READY};
	struct row *row = rows_find(rows, points->vblank);
	if (!row)
		return;
	row->told = true;
	row->points.frame_id = points->frame_id;
	row->points.phase = points->phase;
	row->points.show = points->show;
	memcpy(row->points.method, points->method, sizeof(row->points.method));
	for (uint32_t i = 0; i < sizeof(told) / sizeof(told[0]); i++)
		row->points.time[told[i]] = points->time[told[i]];
}

bool rows_trigger(struct rows *rows, uint64_t time_ns)
{
	uint64_t at = rows->end;
	if (time_ns <= rows->taken_flip_ns)
		return true;
	while (at > rows->first && rows->rows[(at - 1) % ROWS].points.time[POINT_FLIP] >= time_ns)
		at--;
	if (at == rows->end)
		return false;
	rows->rows[at % ROWS].points.time[POINT_TRIGGER] = time_ns;
	return true;
}

static bool is_complete(const struct row *row)
{
	return row->told && !row->edge_open && !row->photon_open;
}

uint64_t rows_next(const struct rows *rows)
{
	const struct row *row = &rows->rows[rows->first % ROWS];
	if (rows->first == rows->end)
		return UINT64_MAX;
	return row->points.time[POINT_EVENT] + (is_complete(row) ? rows->hold_ns : ROWS_WAIT_NS);
}

bool rows_take(struct rows *rows, uint64_t now_ns, bool force, struct points *points)
{
	const struct row *row = &rows->rows[rows->first % ROWS];
	if (rows->first == rows->end)
		return false;
	const bool at_once = is_complete(row) && rows->hold_ns == 0;
	if (!force && !at_once && now_ns < rows_next(rows))
		return false;
	*points = row->points;
	rows->taken_flip_ns = row->points.time[POINT_FLIP];
	points->edge_lost |= row->edge_open;
	points->photon_lost |= row->photon_open;
	for (uint32_t i = 0; i < POINT_COUNT; i++)
		if (points->time[i] == POINT_NOT_YET)
			points->time[i] = POINT_UNKNOWN;
	rows->first++;
	return true;
}
