/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/spans.h"

static const struct span_info infos[SPANS] = {
	[SPAN_SUBMIT_TO_INTAKE] = {"submit_to_intake", POINT_SUBMIT, POINT_INTAKE, true, false,
							   "the client published a frame, the daemon took it"},
	[SPAN_INTAKE_TO_READY] = {"intake_to_ready", POINT_INTAKE, POINT_READY, true, false,
							  "the daemon took a frame, its picture was done"},
	[SPAN_SUBMIT_TO_FLIP] = {"submit_to_flip", POINT_SUBMIT, POINT_FLIP, true, false,
							 "the client published a frame, it was first shown"},
	[SPAN_READY_TO_FLIP] = {"ready_to_flip", POINT_READY, POINT_FLIP, false, true, "a picture was done, it was shown"},
	[SPAN_TARGET_TO_FLIP] = {"target_to_flip", POINT_TARGET, POINT_FLIP, false, false,
							 "how far from the vblank aimed at the flip was"},
	[SPAN_FLIP_TO_EVENT] = {"flip_to_event", POINT_FLIP, POINT_EVENT, false, false,
							"how late the event that tells of a flip is: its spread is the event jitter"},
	[SPAN_FLIP_TO_EDGE] = {"flip_to_edge", POINT_FLIP, POINT_EDGE, false, false,
						   "flip, the line has changed (the offset asked for is in it)"},
	[SPAN_EVENT_TO_EDGE] =
		{"event_to_edge", POINT_EVENT, POINT_EDGE, false, false,
		 "the lab was told of a flip, the line has changed: what the lab itself takes, and the offset"},
	[SPAN_GPIO_SET] = {"gpio_set", POINT_EDGE, POINT_EDGE, false, false,
					   "the call that sets the line: the edge is somewhere in it"},
	[SPAN_FLIP_TO_PHOTON] = {"flip_to_photon", POINT_FLIP, POINT_PHOTON, false, false, "flip, light"},
	[SPAN_SUBMIT_TO_PHOTON] = {"submit_to_photon", POINT_SUBMIT, POINT_PHOTON, true, false,
							   "the client published a frame, its light came"},
	[SPAN_EDGE_TO_PHOTON] = {"edge_to_photon", POINT_EDGE, POINT_PHOTON, false, false, "marker edge, light"},
	[SPAN_TRIGGER_TO_PHOTON] = {"trigger_to_photon", POINT_TRIGGER, POINT_PHOTON, false, false,
								"edge of the trigger input, light of the next flip"},
	[SPAN_REFRESH] = {"refresh", POINT_FLIP, POINT_FLIP, false, false, "from one flip to the flip of the next vblank"},
};

const struct span_info *span_info(enum span_kind kind)
{
	return &infos[kind];
}

bool span_of(const struct points *points, enum span_kind kind, int64_t *span_ns)
{
	const struct span_info *info = &infos[kind];
	const uint64_t from = points->time[info->from], to = points->time[info->to];
	if (!point_known(from) || !point_known(to) || kind == SPAN_REFRESH)
		return false;
	if (info->real_only && points->show != POINTS_REAL)
		return false;
	if (info->new_only && points->show != POINTS_REAL && points->show != POINTS_IN_BETWEEN)
		return false;
	*span_ns = kind == SPAN_GPIO_SET ? (int64_t)points->set_ns : (int64_t)(to - from);
	return true;
}

void spans_add(struct spans *spans, const struct points *points)
{
	const uint64_t flip_ns = points->time[POINT_FLIP];
	int64_t span_ns;
	spans->rows++;
	for (uint32_t kind = 0; kind < SPANS; kind++)
		if (span_of(points, (enum span_kind)kind, &span_ns))
			histogram_add(&spans->histograms[kind], span_ns);
	if (points->vblank == spans->last_vblank + 1 && point_known(flip_ns) && point_known(spans->last_flip_ns))
		histogram_add(&spans->histograms[SPAN_REFRESH], (int64_t)(flip_ns - spans->last_flip_ns));
	spans->last_vblank = points->vblank;
	spans->last_flip_ns = flip_ns;
	spans->lost_edges += points->edge_lost;
	spans->lost_photons += points->photon_lost;
}
