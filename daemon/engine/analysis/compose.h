/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Motion over several recorded frames from the motion of each: what replay
 * needs when it feeds only every K-th frame as a real one. Each step is looked
 * up where the one before it leads:
 *
 *   backward  M(x) = m0(x) + m1(x - m0(x)) + ...   frames: the real one, the one before it, ...
 *   forward   M(x) = m0(x) + m1(x + m0(x)) + ...   frames: the real one, the one after it, ...
 *
 * Looked up bilinearly, but as the nearest pixel where the four differ by more
 * than a pixel of motion, so that silhouettes do not mix; outside, the edge.
 */
#ifndef PURSUIT_ANALYSIS_COMPOSE_H
#define PURSUIT_ANALYSIS_COMPOSE_H

#include "daemon/frame.h"

/*
 * Composes the motion of `count` frames, all of one kind and one colour size,
 * into `out`: x and y for each pixel of the motion plane of frames[0], packed
 * (width x height x 2 floats, caller's). Pixels without a number in frames[0]
 * become NaN; where a later frame has none, or is flagged cut or motion
 * invalid, the step before it is repeated. The intervals that the composed
 * motion spans, and a cut among the frames, are the caller's to carry over.
 *
 * 0, or -EINVAL with a sentence. Any thread; planes must not change meanwhile.
 */
int motion_compose(const struct frame *const *frames, uint32_t count, float *out, struct error *error);

#endif
