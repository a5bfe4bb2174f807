/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* `pursuit latency --loopback OUT:IN`: a line's own set-to-edge time, through a wire from an output to an input. */
#ifndef PURSUIT_CLI_LOOPBACK_H
#define PURSUIT_CLI_LOOPBACK_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/error.h"
#include "daemon/lab/histogram.h"

struct loopback_params {
	const char *chip;  /* "": the first that fits */
	const char *lines; /* OUT:IN */
	uint32_t count;    /* edges of each direction */
	uint32_t interval_us;
};

struct loopback_result {
	struct histogram rising, falling; /* start of the call that sets the line, to the kernel's stamp of the input */
	struct histogram set;             /* the call itself */
	uint32_t lost;                    /* no edge within 100 ms */
	char text[160];                   /* the chip */
};

/* Is it OUT:IN, one line each? */
bool loopback_are_lines(const char *lines);

/* Takes count x 2 x interval. 0 or a negative errno with a sentence. */
int loopback_measure(const struct loopback_params *params, struct loopback_result *result, struct error *error);

#endif
