/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/glx_sync.h"

#include <string.h>

/* A clock that is further from ours is another one. */
#define SAME_CLOCK_NS UINT64_C(5000000000)

static bool find(const char *name, void *function, size_t size)
{
	const window_function found = window_find_function(name);
	if (found)
		memcpy(function, &found, size);
	return found != NULL;
}

bool glx_sync_init(struct glx_sync *sync, struct window *window, uint64_t now_ns)
{
	int64_t ust = 0, msc = 0, sbc = 0;
	memset(sync, 0, sizeof(*sync));
	if (!window_get_glx(window, &sync->display, &sync->drawable) || !window_has_extension("GLX_OML_sync_control") ||
		!find("glXGetSyncValuesOML", &sync->get_values, sizeof(sync->get_values)) ||
		!find("glXWaitForSbcOML", &sync->wait_for_sbc, sizeof(sync->wait_for_sbc)) ||
		!sync->get_values(sync->display, sync->drawable, &ust, &msc, &sbc) || ust <= 0) {
		sync->display = NULL;
		return false;
	}
	const uint64_t time_ns = (uint64_t)ust * 1000;
	const uint64_t distance_ns = time_ns > now_ns ? time_ns - now_ns : now_ns - time_ns;
	if (distance_ns > SAME_CLOCK_NS)
		sync->display = NULL;
	return sync->display != NULL;
}

bool glx_sync_wait(struct glx_sync *sync, uint64_t *time_ns, uint64_t *sequence)
{
	int64_t ust = 0, msc = 0, sbc = 0;
	if (!sync->display || !sync->wait_for_sbc(sync->display, sync->drawable, 0, &ust, &msc, &sbc) || ust <= 0)
		return false;
	*time_ns = (uint64_t)ust * 1000;
	*sequence = msc > 0 ? (uint64_t)msc : 0;
	return true;
}
