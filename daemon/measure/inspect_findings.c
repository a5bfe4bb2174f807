/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/inspect.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A hypothesis must explain this much better than what was declared. */
#define CLEARLY_BETTER 0.75
/* It may explain only a little better where it does so in nearly every pair: scenes hide much of what moves. */
#define BETTER_EVERYWHERE 0.93
#define BETTER_EVERYWHERE_SAME_LENGTH 0.95
#define NEARLY_ALL 0.9
#define ENOUGH_PAIRS 5u
/* Motion that leaves more than this of the change explains nothing. */
#define UNEXPLAINED 0.92
/* What is left is the border's and noise: motion that explains so much is right. */
#define EXPLAINED 0.02
/* Code values: below it too little changes to tell anything. */
#define ENOUGH_CHANGE 0.003
#define ENOUGH_SAMPLES 500u
#define ENOUGH_CLAIMS 60u
#define ENOUGH_RESIDUALS 5u
#define JITTER 0.15 /* rms; that of a pixel is 0.6, and coarse pictures of fine things shake by 0.1 themselves */
#define MANY 0.5

struct list {
	struct inspect_finding *findings;
	uint32_t count;
};

__attribute__((format(printf, 5, 6))) static void add(struct list *list, enum inspect_level level, const char *code,
													  const char *advice, const char *format, ...)
{
	va_list arguments;
	if (list->count == INSPECT_FINDINGS)
		return;
	struct inspect_finding *finding = &list->findings[list->count++];
	*finding = (struct inspect_finding){.level = level, .code = code, .advice = advice};
	va_start(arguments, format);
	vsnprintf(finding->text, sizeof(finding->text), format, arguments);
	va_end(arguments);
}

struct hypothesis {
	const char *code, *text, *advice;
};

static const char ndc_advice[] =
	"motion is in pixels: multiply x by width / 2 and y by height / 2, and turn y so that + is down";
static const char uv_advice[] = "motion is in pixels: multiply x by the width and y by the height, + is right and down";
static const char scale_advice[] =
	"multiply the motion, or set motion_interval_ns to the time that it spans (0: from the frame before)";

static const struct hypothesis hypotheses[INSPECT_HYPOTHESES] = {
	[INSPECT_SIGN] = {"motion-sign", "motion points the wrong way",
					  "backward motion is position now minus position before: turn the sign of both components"},
	[INSPECT_X_SIGN] = {"motion-x-sign", "the x of motion has the wrong sign",
						"+x is to the right: turn the sign of x"},
	[INSPECT_Y_SIGN] = {"motion-y-sign", "the y of motion has the wrong sign",
						"+y is down, in GL's clip space it is up: turn the sign of y"},
	[INSPECT_SWAPPED] = {"motion-swapped", "x and y of motion are exchanged", "the first component is x, the second y"},
	[INSPECT_THIRD] = {"motion-scale", "motion is three times too long", scale_advice},
	[INSPECT_HALF] = {"motion-scale", "motion is twice too long", scale_advice},
	[INSPECT_DOUBLE] = {"motion-scale", "motion is half of what it should be", scale_advice},
	[INSPECT_TRIPLE] = {"motion-scale", "motion is a third of what it should be", scale_advice},
	[INSPECT_NDC] = {"motion-unit", "motion is in normalised device coordinates, y up", ndc_advice},
	[INSPECT_NDC_DOWN] = {"motion-unit", "motion is in normalised device coordinates, y down", ndc_advice},
	[INSPECT_NDC_SIGN] = {"motion-unit", "motion is in normalised device coordinates and points the wrong way",
						  ndc_advice},
	[INSPECT_NDC_DOWN_SIGN] = {"motion-unit",
							   "motion is in normalised device coordinates, y down, and points the wrong way",
							   ndc_advice},
	[INSPECT_UV] = {"motion-unit", "motion is in texture coordinates (0 to 1)", uv_advice},
	[INSPECT_UV_UP] = {"motion-unit", "motion is in texture coordinates, y up", uv_advice},
	[INSPECT_UV_SIGN] = {"motion-unit", "motion is in texture coordinates and points the wrong way", uv_advice},
};

static enum inspect_hypothesis best_hypothesis(const struct inspect *inspect)
{
	enum inspect_hypothesis best = INSPECT_SIGN;
	for (enum inspect_hypothesis h = INSPECT_SIGN; h < INSPECT_SHIFTED; h++)
		if (inspect->cost[h] < inspect->cost[best])
			best = h;
	return best;
}

static bool other_kind_is_better(const struct inspect *inspect)
{
	if (inspect->other_samples < ENOUGH_SAMPLES || !inspect->other_right_samples)
		return false;
	double right = inspect->other_right_cost / (double)inspect->other_right_samples;
	return inspect_cost(inspect, INSPECT_OTHER_KIND) < CLEARLY_BETTER * right;
}

static void find_unrelated(const struct inspect *inspect, struct list *list)
{
	const double right = inspect->cost[INSPECT_RIGHT], zero = inspect->cost[INSPECT_ZERO];
	if (right < UNEXPLAINED * zero || right < UNEXPLAINED * inspect->cost[INSPECT_SIGN])
		return;
	add(list, INSPECT_WARNING, "motion-unrelated",
		"is it this frame's motion, of the same camera, with the same jitter and size? Moving textures, particles and "
		"light have none",
		"motion explains only %.0f %% of the change of the picture", fmax(0.0, 100.0 - 100.0 * right / zero));
}

struct shake {
	double rms, mean; /* of the shifts */
	double jitter;    /* regression of the shifts on the declared jitter */
	bool jitter_known;
	bool in_motion; /* motion shakes as the shifts do */
};

static struct shake measure_shake(const struct inspect *inspect)
{
	const uint32_t count = inspect->residual_count;
	double sum[2] = {0.0, 0.0}, square = 0.0, cross = 0.0, own = 0.0;
	double changes[2] = {0.0, 0.0};
	for (uint32_t i = 0; i < count; i++) {
		const struct inspect_residual *r = &inspect->residuals[i], *before = i ? r - 1 : r;
		for (int axis = 0; axis < 2; axis++) {
			const double shift = (double)r->shift[axis], jitter = r->has_jitter ? (double)r->jitter[axis] : 0.0;
			const double turn = (double)(r->motion[axis] - before->motion[axis]);
			const double shift_turn = (double)(r->shift[axis] - before->shift[axis]);
			sum[axis] += shift;
			square += shift * shift;
			cross += shift * jitter;
			own += jitter * jitter;
			changes[0] += turn * shift_turn;
			changes[1] += shift_turn * shift_turn;
		}
	}
	const double n = count ? count : 1;
	return (struct shake){
		.rms = sqrt(square / n),
		.mean = hypot(sum[0], sum[1]) / n,
		.jitter = own > 0.0 ? cross / own : 0.0,
		.jitter_known = own > 0.01 * n,
		.in_motion = changes[0] < -0.5 * changes[1],
	};
}

static bool find_jitter(const struct inspect *inspect, struct list *list)
{
	static const char in_motion[] =
		"leave the jitter out of both matrices that motion comes from, or subtract its difference from the motion";
	static const char in_picture[] =
		"hand in the picture after the temporal filter that the jitter is for, or render without jitter";
	const struct shake shake = measure_shake(inspect);
	if (inspect->residual_count < ENOUGH_RESIDUALS || shake.rms < JITTER || shake.mean > 0.6 * shake.rms)
		return false;
	const bool motion = shake.jitter_known ? shake.jitter < 0.0 : shake.in_motion;
	if (motion)
		add(list, INSPECT_MISTAKE, "jitter-in-motion", in_motion,
			"motion and picture disagree by a shift that changes from frame to frame, %.2f pixels (rms): motion holds "
			"the "
			"jitter",
			shake.rms);
	else
		add(list, INSPECT_MISTAKE, "jitter-in-picture", in_picture,
			"motion and picture disagree by a shift that changes from frame to frame, %.2f pixels (rms): the picture "
			"shakes by the jitter",
			shake.rms);
	return true;
}

/* Of the same length as what was declared, so that it cannot win by merely moving less. */
static bool same_length(enum inspect_hypothesis hypothesis)
{
	return hypothesis >= INSPECT_SIGN && hypothesis <= INSPECT_SWAPPED;
}

/* A scale can look like jitter and jitter like a scale: what explains more is meant. */
static bool shift_is_best(const struct inspect *inspect)
{
	const double shifted = inspect->cost[INSPECT_SHIFTED];
	return shifted < CLEARLY_BETTER * inspect->cost[INSPECT_RIGHT] && shifted < inspect->cost[best_hypothesis(inspect)];
}

static bool is_better(const struct inspect *inspect, enum inspect_hypothesis hypothesis)
{
	const double share = inspect->cost[hypothesis] / inspect->cost[INSPECT_RIGHT];
	if (share < CLEARLY_BETTER)
		return true;
	return inspect->pairs >= ENOUGH_PAIRS && inspect->wins[hypothesis] >= NEARLY_ALL * inspect->pairs &&
		   share < (same_length(hypothesis) ? BETTER_EVERYWHERE_SAME_LENGTH : BETTER_EVERYWHERE);
}

static bool find_hypothesis(const struct inspect *inspect, struct list *list)
{
	const double right = inspect->cost[INSPECT_RIGHT], zero = inspect->cost[INSPECT_ZERO];
	const enum inspect_hypothesis best = best_hypothesis(inspect);
	if (right < EXPLAINED * zero)
		return false;
	if (is_better(inspect, best) && (same_length(best) || inspect->cost[best] < UNEXPLAINED * zero)) {
		add(list, INSPECT_MISTAKE, hypotheses[best].code, hypotheses[best].advice,
			"%s: read that way it leaves %.0f %% of the picture's change unexplained, as declared %.0f %%",
			hypotheses[best].text, 100.0 * inspect->cost[best] / zero, 100.0 * right / zero);
		return true;
	}
	if (!other_kind_is_better(inspect))
		return false;
	add(list, INSPECT_MISTAKE, "motion-kind",
		"declare the kind that it is: backward is now minus before, forward is next minus now",
		"motion fits the neighbour on the other side: it is of the other kind than declared");
	return true;
}

static void find_motion(const struct inspect *inspect, struct list *list)
{
	if (inspect->samples < ENOUGH_SAMPLES || inspect_cost(inspect, INSPECT_ZERO) < ENOUGH_CHANGE) {
		if (inspect->pairs)
			add(list, INSPECT_NOTE, "still", "check a stream in which the camera and something in the picture move",
				"too little moves in %u pairs of frames to judge the motion", inspect->pairs);
		return;
	}
	const double speed = inspect->speed_sum / (double)inspect->samples;
	if (inspect->frozen_motion > MANY * inspect->changing_pairs && inspect->frozen_motion > 1)
		add(list, INSPECT_MISTAKE, "motion-frozen",
			"render motion anew for each frame, into the buffer that is submitted",
			"the motion plane stays the same in %u of %u pairs whose picture changes", inspect->frozen_motion,
			inspect->changing_pairs);
	else if (shift_is_best(inspect) && find_jitter(inspect, list))
		return;
	else if (find_hypothesis(inspect, list))
		return;
	else if (speed < 0.01)
		add(list, INSPECT_MISTAKE, "motion-zero",
			"are the previous frame's matrices kept, and is the motion target bound and written?",
			"the picture changes, but motion is %.4f pixels on average", speed);
	else if (!find_jitter(inspect, list))
		find_unrelated(inspect, list);
}

static bool has_mistake(const struct list *list)
{
	for (uint32_t i = 0; i < list->count; i++)
		if (list->findings[i].level >= INSPECT_WARNING)
			return true;
	return false;
}

static void find_depth(const struct inspect *inspect, bool motion_is_right, struct list *list)
{
	const uint64_t claims = inspect->nearer_wins + inspect->farther_wins;
	if (inspect->no_depth == inspect->frames) {
		add(list, INSPECT_WARNING, "no-depth",
			"hand in the depth buffer: without it, what folds may show the wrong side", "no frame has depth");
		return;
	}
	if (inspect->outside_depth > inspect->pixels / 100)
		add(list, INSPECT_MISTAKE, "depth-range", "declare linear depth with near and far, or hand in device depth",
			"%.0f %% of the pixels have device depth outside 0 to 1",
			100.0 * (double)inspect->outside_depth / (double)inspect->pixels);
	if (inspect->constant_depth == inspect->frames - inspect->no_depth)
		add(list, INSPECT_WARNING, "depth-constant",
			"is it the depth buffer of the scene, copied before it is cleared?", "depth is the same at every pixel");
	else if (inspect->frozen_depth > MANY * inspect->changing_pairs && inspect->changing_pairs > 2)
		add(list, INSPECT_WARNING, "depth-frozen", "copy the depth buffer of each frame",
			"the depth plane stays the same in %u of %u pairs whose picture changes", inspect->frozen_depth,
			inspect->changing_pairs);
	else if (motion_is_right && claims >= ENOUGH_CLAIMS && inspect->farther_wins > 2 * inspect->nearer_wins)
		add(list, INSPECT_MISTAKE, "depth-direction",
			"declare the other direction: device depth is 0 at the near plane, device-reversed is 1 there",
			"where surfaces hide each other, the one that is declared farther is in sight at %.0f %% of %llu pixels",
			100.0 * (double)inspect->farther_wins / (double)claims, (unsigned long long)claims);
}

static void find_numbers(const struct inspect *inspect, struct list *list)
{
	if (inspect->no_motion == inspect->frames)
		add(list, INSPECT_WARNING, "no-motion", "hand in motion vectors: without them nothing can be extrapolated",
			"no frame has motion");
	if (inspect->invalid_motion)
		add(list, INSPECT_WARNING, "motion-invalid", "write 0 where nothing is known about the motion",
			"motion is NaN or infinite at %llu pixels (%.2f %%); they count as standing still",
			(unsigned long long)inspect->invalid_motion,
			100.0 * (double)inspect->invalid_motion / (double)inspect->pixels);
	if (inspect->frozen_color > 2)
		add(list, INSPECT_WARNING, "color-frozen", "copy the colour of each frame after it is rendered",
			"colour stays the same in %u pairs of frames though motion says that it moves", inspect->frozen_color);
	if (inspect->sizes_changed > inspect->frames / 2)
		add(list, INSPECT_NOTE, "size-changes", "pairs of frames of different size cannot be compared",
			"the size changes at %u of %u frames", inspect->sizes_changed, inspect->frames);
}

static void find_times(const struct inspect *inspect, struct list *list)
{
	if (inspect->times_backwards)
		add(list, INSPECT_MISTAKE, "time-order",
			"time_ns is the moment that a frame depicts, and rises with every frame",
			"time_ns stands still or runs backwards at %u frames", inspect->times_backwards);
	if (inspect->intervals_known > 2 && inspect->intervals_wrong > MANY * inspect->intervals_known)
		add(list, INSPECT_MISTAKE, "interval",
			"real_interval_ns is time_ns minus that of the frame before; 0 if unknown",
			"real_interval_ns is %.2f times the difference of the times",
			inspect->interval_ratio_sum / inspect->intervals_known);
}

uint32_t inspect_findings(const struct inspect *inspect, struct inspect_finding findings[INSPECT_FINDINGS])
{
	struct inspect_finding unsorted[INSPECT_FINDINGS];
	struct list list = {unsorted, 0};
	uint32_t count = 0;
	if (!inspect->frames)
		return 0;
	find_times(inspect, &list);
	/* What the motion is taken for depends on the interval; what it hides cannot be judged by wrong motion. */
	if (!list.count)
		find_motion(inspect, &list);
	find_depth(inspect, !has_mistake(&list), &list);
	find_numbers(inspect, &list);
	for (int level = INSPECT_MISTAKE; level >= INSPECT_NOTE; level--)
		for (uint32_t i = 0; i < list.count; i++)
			if ((int)unsorted[i].level == level)
				findings[count++] = unsorted[i];
	return count;
}

const char *inspect_level_name(enum inspect_level level)
{
	static const char *const names[] = {"note", "warning", "mistake"};
	return names[level];
}
