/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What a daemon displayed at each vblank: fetched over its socket, drawn as SVG. */
#ifndef PURSUIT_CLI_TIMELINE_H
#define PURSUIT_CLI_TIMELINE_H

#include <stdint.h>

#include "control.h"

enum timeline_show {
	TIMELINE_REAL = 0,
	TIMELINE_IN_BETWEEN,
	TIMELINE_REPEAT,
	TIMELINE_STANDBY, /* the plain picture instead of a late in-between */
	TIMELINE_KEPT,    /* nothing came in time: the picture before stayed */
	TIMELINE_SHOWS,
};

struct timeline_row {
	uint64_t vblank, target_ns, ready_ns, flip_ns, frame_id; /* times 0: unknown */
	enum timeline_show show;
	double phase;
};

struct timeline {
	struct timeline_row *rows;
	uint32_t count, capacity;
	uint64_t first; /* number of rows[0], counted by the daemon */
};

/* All rows that the daemon still has. 0 or a negative errno with a sentence. */
int timeline_fetch(struct timeline *timeline, struct control *control, struct error *error);
void timeline_finish(struct timeline *timeline);

struct timeline_drawing {
	const char *title;
	double refresh_hz;
	uint32_t detail_first, detail_count; /* rows drawn one by one; the others only in the overview */
};

int timeline_write_svg(const struct timeline *timeline, const struct timeline_drawing *drawing, const char *path,
					   struct error *error);

#endif
