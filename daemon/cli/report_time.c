/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Engine times: one frame at a time, the variants taking turns so that noise hits all alike. */

#include <errno.h>
#include <stdlib.h>

#include "daemon/clock.h"
#include "interrupt.h"
#include "report.h"

static double now_ms(void)
{
	return (double)clock_monotonic_ns() / 1e6;
}

int report_add_time(struct report_row *row, double ms, struct error *error)
{
	if (row->engine_ms_count == row->engine_ms_capacity) {
		const uint32_t capacity = row->engine_ms_capacity ? 2 * row->engine_ms_capacity : 64;
		double *grown = realloc(row->engine_ms, capacity * sizeof(*grown));
		if (!grown)
			return error_set(error, -ENOMEM, "out of memory");
		row->engine_ms = grown;
		row->engine_ms_capacity = capacity;
	}
	row->engine_ms[row->engine_ms_count++] = ms;
	return 0;
}

static int time_frame(struct report_row *row, const struct clip *clip, const struct clip_real *real, uint8_t *picture,
					  bool counted, struct error *error)
{
	struct engine *engine = row->variant->engine;
	const double start = now_ms();
	int result = engine_begin(engine, &real->frame, &real->begin, error);
	for (uint32_t k = 0; k < real->shown_count && result == 0; k++) {
		struct engine_image image = {picture, 4 * (size_t)clip->width};
		result = engine_render(engine, &clip->shown[real->first_shown + k].request, &image, error);
	}
	const double spent = now_ms() - start;
	if (result < 0 || !counted)
		return result;
	const struct engine_report *report = engine_get_report(engine);
	row->bytes_up += report->bytes_up;
	row->bytes_down += report->bytes_down;
	row->displayed += real->shown_count;
	return report_add_time(row, spent / real->shown_count, error);
}

static int take_turn(struct report_row *row, const struct clip *clip, uint8_t *picture, struct error *error)
{
	int result = 0;
	for (uint32_t i = 0; i < clip->real_count && result == 0; i++)
		result = time_frame(row, clip, &clip->reals[i], picture, i > 0 || clip->real_count == 1, error);
	return result;
}

int report_time(struct report_row *const *rows, uint32_t count, const struct clip *clip, uint32_t samples,
				struct error *error)
{
	uint8_t *picture = clip_plane(clip, 4, error);
	const uint32_t each = clip->real_count > 1 ? clip->real_count - 1 : 1, turns = (samples + each - 1) / each;
	int result = picture ? 0 : -ENOMEM;
	for (uint32_t turn = 0; turn < turns && result == 0 && !interrupt_seen(); turn++) {
		for (uint32_t i = 0; i < count && result == 0; i++)
			result = take_turn(rows[(i + turn) % count], clip, picture, error);
	}
	free(picture);
	return result;
}
