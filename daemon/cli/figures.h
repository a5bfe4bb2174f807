/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The figures of a run, by the names that scripts know (docs/pursuit(1)):
 * gathered while a schedule is played, written as JSON and as a small table.
 */
#ifndef PURSUIT_CLI_FIGURES_H
#define PURSUIT_CLI_FIGURES_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "daemon/options.h"
#include "player.h"

struct figures {
	uint32_t real_frames;
	uint32_t in_between_frames;
	uint32_t displayed_frames;
	uint32_t repeated_frames;
	uint32_t late_in_betweens;
	uint32_t lost_real_frames;
	uint64_t duration_ns;
	struct quality quality;
	double *engine_ms; /* one a real frame */
	uint32_t engine_ms_capacity;
	json_t *passes, *left_out; /* name: count */
	json_t *frames;            /* a row for each real frame */
	json_t *displayed;         /* of the row that is being made */
	struct picture size;       /* of the picture shown last; data NULL */
};

int figures_init(struct figures *figures, struct error *error);
void figures_finish(struct figures *figures);

/* For an observer of player.h. *hash: XXH3 of the picture, its rows packed. */
int figures_add_picture(struct figures *figures, const struct player_picture *picture, uint64_t hash,
						struct error *error);
int figures_add_frame(struct figures *figures, const struct player_frame *frame, const struct recorded_frames *frames,
					  struct error *error);

/* XXH3 64 bit of the pixels, rows packed; alpha is 255 everywhere. */
uint64_t figures_hash(const struct picture *picture);

/* The p-th percentile of some values (0 to 100), linear between ranks; 0 without values. Sorts them. */
double figures_percentile(double *values, uint32_t count, double p);

/* A new object with all figures but `frames`. NULL: out of memory. */
json_t *figures_json(struct figures *figures);

/* {"psnr", "ssim", "psnr_min", "frames"}; null values where nothing was scored. */
json_t *figures_quality_json(const struct quality *quality);

/* A number, or null where it is not finite. */
json_t *figures_number(double value);

/* The settings of the engine that make a run repeatable, by the names of the options. */
json_t *figures_settings_json(const struct settings *settings);

/* The table for a person. */
void figures_print(struct figures *figures, FILE *out);

#endif
