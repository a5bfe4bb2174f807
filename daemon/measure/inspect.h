/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Looks for the mistakes that streams are made with: motion of the wrong sign,
 * unit, scale or kind, depth the wrong way round, jitter that was not taken
 * out, planes that stand still, intervals that are not those of the times.
 *
 * Photometric: whatever motion says, the picture must agree. For a pair of
 * neighbouring frames, A (whose pixels have the motion) and B, the brightness
 * of A at x is that of B at x + s m(x); s is -1 for backward motion (A is the
 * newer frame), +1 for forward motion (A is the older). Each hypothesis about a
 * mistake is a matrix applied to m first; the right one explains best. What
 * remains is solved for one common shift (Lucas, Kanade 1981), which is jitter
 * if it changes its sign. Where two pixels of A come from one of B, that with
 * the colour of B was the nearer.
 *
 * Knows no file, no socket and no clock. One thread.
 */
#ifndef PURSUIT_INSPECT_H
#define PURSUIT_INSPECT_H

#include <stdbool.h>
#include <stdint.h>

#define INSPECT_PAIRS 256u
#define INSPECT_FINDINGS 16u

/* One frame, borrowed. */
struct inspect_view {
	uint32_t width, height;
	const float *luma;     /* width x height, code values, 0 to 1; smoothed, since edges without antialiasing mislead */
	const float *motion;   /* two a pixel, pixels, +y down, as stored; NULL: none */
	const float *nearness; /* rises towards the viewer; not finite where unknown; NULL: no depth */
	bool forward;
	bool usable_motion; /* neither a cut nor flagged invalid */
	bool has_jitter;
	float jitter[2];   /* pixels */
	uint64_t frame_id; /* counts the client's frames, those that never arrived included */
	uint64_t time_ns;
	uint64_t real_interval_ns, motion_interval_ns; /* as declared, 0 unknown */
	uint64_t invalid_motion;                       /* pixels whose motion is NaN or infinite */
	uint64_t outside_depth;                        /* pixels of device depth outside [0, 1], or that are not numbers */
	uint64_t color_hash, depth_hash, motion_hash;
};

enum inspect_hypothesis {
	INSPECT_RIGHT = 0,
	INSPECT_ZERO,
	INSPECT_SIGN,
	INSPECT_X_SIGN,
	INSPECT_Y_SIGN,
	INSPECT_SWAPPED,
	INSPECT_THIRD,
	INSPECT_HALF,
	INSPECT_DOUBLE,
	INSPECT_TRIPLE,
	INSPECT_NDC,
	INSPECT_NDC_DOWN,
	INSPECT_NDC_SIGN,
	INSPECT_NDC_DOWN_SIGN,
	INSPECT_UV,
	INSPECT_UV_UP,
	INSPECT_UV_SIGN,
	INSPECT_SHIFTED,    /* right, and the common shift that is left over */
	INSPECT_OTHER_KIND, /* forward motion declared as backward, or the other way round */
	INSPECT_HYPOTHESES,
};

/* One pair's common shift that motion leaves over, and what may explain it. Pixels. */
struct inspect_residual {
	float shift[2];
	float motion[2]; /* median of the motion */
	float jitter[2]; /* difference of the declared jitter, signed as the shift */
	bool has_jitter;
};

/* Zeroed: nothing seen. */
struct inspect {
	uint32_t frames, pairs;
	uint64_t samples;
	double cost[INSPECT_HYPOTHESES];   /* sum over the samples */
	uint32_t wins[INSPECT_HYPOTHESES]; /* pairs that it explains better than what was declared */
	uint64_t other_samples;            /* of INSPECT_OTHER_KIND, and those of INSPECT_RIGHT in the same pairs */
	uint64_t other_right_samples;
	double other_right_cost;
	double speed_sum; /* of |m|, over the samples */
	uint64_t nearer_wins, farther_wins;
	struct inspect_residual residuals[INSPECT_PAIRS];
	uint32_t residual_count;
	uint32_t no_motion, no_depth, sizes_changed;
	uint64_t invalid_motion, outside_depth, pixels;
	uint32_t changing_pairs; /* the picture changes */
	uint32_t frozen_color, frozen_depth, frozen_motion, constant_depth;
	uint32_t times_backwards, intervals_wrong, intervals_known;
	double interval_ratio_sum;
};

/* Adds a frame alone, then it with its predecessor. Both frames have their own memory. */
void inspect_add_frame(struct inspect *inspect, const struct inspect_view *view);
void inspect_add_pair(struct inspect *inspect, const struct inspect_view *previous, const struct inspect_view *current);

enum inspect_level {
	INSPECT_NOTE = 0, /* could not be told, or a hint */
	INSPECT_WARNING,  /* works, but not as well as it could */
	INSPECT_MISTAKE,
};

struct inspect_finding {
	enum inspect_level level;
	const char *code;   /* "motion-sign"; static */
	char text[200];     /* what was seen */
	const char *advice; /* what mends it; static */
};

/* The most serious first. Gives their number back, at most INSPECT_FINDINGS. */
uint32_t inspect_findings(const struct inspect *inspect, struct inspect_finding findings[INSPECT_FINDINGS]);

/* Mean error of a hypothesis over all samples, in code values; NaN without samples. */
double inspect_cost(const struct inspect *inspect, enum inspect_hypothesis hypothesis);
const char *inspect_level_name(enum inspect_level level);

#endif
