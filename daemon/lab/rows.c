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

uint64_t rows_next(const struct rows *rows)
{
	return rows->first == rows->end ? UINT64_MAX
									: rows->rows[rows->first % ROWS].points.time[POINT_EVENT] + ROWS_WAIT_NS;
}

bool rows_take(struct rows *rows, uint64_t now_ns, bool force, struct points *points)
{
	const struct row *row = &rows->rows[rows->first % ROWS];
	if (rows->first == rows->end)
		return false;
	const bool complete = row->told && !row->edge_open && !row->photon_open;
	if (!complete && !force && now_ns < rows_next(rows))
		return false;
	*points = row->points;
	points->edge_lost |= row->edge_open;
	points->photon_lost |= row->photon_open;
	for (uint32_t i = 0; i < POINT_COUNT; i++)
		if (points->time[i] == POINT_NOT_YET)
			points->time[i] = POINT_UNKNOWN;
	rows->first++;
	return true;
}
