/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A frame of any format as plain numbers, for daemon/measure/inspect.h. */
#ifndef PURSUIT_CLI_STREAM_VIEW_H
#define PURSUIT_CLI_STREAM_VIEW_H

#include "daemon/frame.h"
#include "daemon/measure/inspect.h"

struct stream_view {
	struct inspect_view view; /* points into what follows */
	float *luma, *motion, *nearness;
	size_t capacity; /* pixels */
};

/* Zeroed before the first call; all planes at the size of colour (nearest pixel). 0 or -ENOMEM. */
int stream_view_read(struct stream_view *view, const struct frame *frame);
void stream_view_finish(struct stream_view *view);

#endif
