/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The spans between time points that latency statistics are made of: one table
 * for the daemon, the log reader and the plots. Pure; one thread.
 */
#ifndef PURSUIT_LAB_SPANS_H
#define PURSUIT_LAB_SPANS_H

#include "daemon/lab/histogram.h"
#include "daemon/lab/points.h"

enum span_kind {
	SPAN_SUBMIT_TO_INTAKE = 0,
	SPAN_INTAKE_TO_READY,
	SPAN_SUBMIT_TO_FLIP,
	SPAN_READY_TO_FLIP,
	SPAN_TARGET_TO_FLIP,
	SPAN_FLIP_TO_EVENT,
	SPAN_FLIP_TO_EDGE,
	SPAN_EVENT_TO_EDGE,
	SPAN_GPIO_SET,
	SPAN_FLIP_TO_PHOTON,
	SPAN_SUBMIT_TO_PHOTON,
	SPAN_EDGE_TO_PHOTON,
	SPAN_TRIGGER_TO_PHOTON,
	SPAN_REFRESH,
	SPANS,
};

struct span_info {
	const char *name; /* "flip_to_edge" */
	enum point from, to;
	bool real_only; /* only first showings of real frames */
	bool new_only;  /* only vblanks that show a new picture */
	const char *help;
};

const struct span_info *span_info(enum span_kind kind);

struct spans {
	struct histogram histograms[SPANS];
	uint64_t rows, lost_edges, lost_photons; /* not set though wanted; not seen though expected */
	uint64_t last_vblank, last_flip_ns;
};

/* The span of one frame; false if one of its points is not known. */
bool span_of(const struct points *points, enum span_kind kind, int64_t *span_ns);
/* Counts a frame; frames come in the order of vblanks. */
void spans_add(struct spans *spans, const struct points *points);

#endif
