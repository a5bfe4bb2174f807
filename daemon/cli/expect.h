/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Comparing displayed frames with those of an earlier run: by hash, which
 * promises equality on one machine type, Mesa version and renderer, or with
 * images, within a tolerance.
 *
 * The file of hashes: `# key value` lines that name what made it, then one
 * `number hash` line a displayed frame, XXH3 64 bit in hex.
 */
#ifndef PURSUIT_CLI_EXPECT_H
#define PURSUIT_CLI_EXPECT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "daemon/engine/engine.h"
#include "daemon/error.h"
#include "daemon/measure/measure.h"

/* ---- writing ---- */

struct expect_writer {
	FILE *file;
	const char *path;
	const struct engine_info *info;
	const char *method;
	bool started;
};

int expect_writer_open(struct expect_writer *writer, const char *path, const struct engine_info *info,
					   const char *method, struct error *error);
int expect_writer_add(struct expect_writer *writer, uint64_t number, const struct picture *picture, uint64_t hash,
					  struct error *error);
/* 0 or a negative errno with a sentence: a full disk may be told only here. NULL file accepted. */
int expect_writer_close(struct expect_writer *writer, struct error *error);

/* ---- comparing ---- */

enum expect_tolerance {
	EXPECT_IDENTICAL = 0,
	EXPECT_PSNR,  /* at least so many dB */
	EXPECT_CODES, /* at most so many code values off, in any channel of any pixel */
};

struct expect {
	char pattern[1024]; /* of images; "": hashes */
	enum expect_tolerance tolerance;
	double limit;
	uint64_t *numbers, *hashes; /* rising numbers; of images no hashes */
	bool *seen;
	uint32_t count;
	char made_by[512]; /* renderer and version of the file of hashes */
	uint32_t compared, different, unexpected;
};

/* "40dB" or "2" (code values); false if it is neither. */
bool expect_read_tolerance(const char *text, struct expect *expect);

/*
 * A file of hashes, a pattern of images, or a folder of numbered PNG files, all of which are expected then (with a
 * pattern of numbered folders nobody knows which there are). 0 or a negative errno with a sentence.
 */
int expect_load(struct expect *expect, const char *path, struct error *error);
void expect_finish(struct expect *expect);

/* Compares one displayed frame; what differs is named on stderr. */
void expect_compare(struct expect *expect, uint64_t number, const struct picture *picture, uint64_t hash);

/* After the last frame: says what was expected and never displayed, and what is likely to blame. True: all well. */
bool expect_conclude(struct expect *expect, const struct engine_info *info);

#endif
