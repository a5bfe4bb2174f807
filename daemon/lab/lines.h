/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Lines that may not be there: a chip that is not plugged in yet, a line that
 * somebody else holds, a chip that vanishes while it is used. Each is said
 * once, tried again with a growing delay (0.1 to 5 s), and said again when it
 * works. Belongs to the lab's thread; `text` is copied by whoever publishes it.
 */
#ifndef PURSUIT_LAB_LINES_H
#define PURSUIT_LAB_LINES_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/lab/chip.h"
#include "daemon/log.h"

struct lines {
	struct chip_params params; /* levels: what outputs are requested with */
	const struct log *log;
	bool wanted;
	struct chip *chip; /* NULL: not there now */
	bool readable;     /* of an input: its descriptor has something */
	uint64_t retry_ns, delay_ns;
	uint64_t check_ns; /* when a quiet input is looked after next */
	uint64_t failures; /* times that they were lost or could not be had */
	char text[256];    /* "gpiochip0 (gpio-sim.0) 17", or what is wrong */
};

/* Tries to open them if they are wanted, missing and due. True: they are newly there. */
bool lines_revive(struct lines *lines, uint64_t now_ns);
/* This chip, just opened with the params, is theirs from now on (NULL: to be tried). */
void lines_adopt(struct lines *lines, struct chip *chip, uint64_t now_ns);
/* They failed with this errno: closed, to be tried again. */
void lines_lose(struct lines *lines, int code, uint64_t now_ns);
/* When lines_revive() or lines_check() has something to do; UINT64_MAX never. */
uint64_t lines_next(const struct lines *lines);
/* Once a second: is the chip of an input still there? An unplugged one sends no edge that would tell. */
void lines_check(struct lines *lines, uint64_t now_ns);
void lines_finish(struct lines *lines);

#endif
