/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Lines of a GPIO chip, requested together: outputs that are set at once, or
 * one input whose edges the kernel stamps. Behind it lies libgpiod 1
 * (gpio_v1.c), libgpiod 2 (gpio_v2.c) or nothing (gpio_stub.c), as meson found.
 *
 * Levels are logical: with active_low a high level is a low voltage. Bit i is
 * line i of the list. One thread at a time.
 */
#ifndef PURSUIT_LAB_CHIP_H
#define PURSUIT_LAB_CHIP_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/error.h"

#define CHIP_LINES 16u
#define CHIP_NAME_BYTES 32u

struct chip_params {
	const char *chip;   /* path, name ("gpiochip0") or label; "": the first that has all lines, which must be names */
	const char *lines;  /* offsets or names, separated by commas */
	const char *option; /* what the lines' list is called in messages: "gpio-line" */
	bool input;         /* one line, both edges */
	bool active_low;
	uint32_t levels; /* of outputs, from the moment they are requested */
};

struct chip_edge {
	uint64_t time_ns; /* CLOCK_MONOTONIC, by the kernel */
	bool rising;
};

struct chip;

/* "libgpiod 1.6.3", or "none". Static. */
const char *chip_library(void);

/*
 * Requests the lines. NULL with a sentence that says what there is instead of
 * what was asked for, who holds a busy line, or what permission is missing.
 */
struct chip *chip_open(const struct chip_params *params, struct error *error);
/* Lines are released; most drivers then keep the last level. NULL accepted. */
void chip_close(struct chip **chip);

uint32_t chip_line_count(const struct chip *chip);
/* "gpiochip0 (gpio-sim.0)" */
const char *chip_text(const struct chip *chip);

/* All outputs at once. 0 or -errno; -ENODEV: the chip is gone. */
int chip_set(struct chip *chip, uint32_t levels);
/* All lines as they are. 0 or -errno. */
int chip_get(struct chip *chip, uint32_t *levels);

/* Of an input: readable when there are edges. */
int chip_fd(const struct chip *chip);
/* Never waits. How many, 0 none, or -errno. */
int chip_read(struct chip *chip, struct chip_edge *edges, uint32_t most);

/* ---- for those behind it ---- */

/*
 * Takes the next name off a list of lines. 1, 0 at its end, -EINVAL with a
 * sentence. An empty list and an empty name are errors.
 */
int chip_next_line(const char **list, char name[CHIP_NAME_BYTES]);
/* A name that is a number is an offset. */
bool chip_is_offset(const char *name, uint32_t *offset);
/*
 * How many lines a list names, or -EINVAL with a sentence. Offsets without a chip are refused: line 17 of some chip
 * or other may be the power supply.
 */
int chip_count_lines(const char *chip, const char *list, const char *option, struct error *error);
/* The chips that there are, for a sentence: "gpiochip0 (lab-chip, 28 lines), ...". Zeroed: none. */
struct chip_list {
	char text[256];
	uint32_t count;
};
void chip_list_add(struct chip_list *list, const char *name, const char *label, uint32_t lines);

/* The sentence for an errno of open(2) on a chip; a name without a slash is one under /dev. */
int chip_explain_open(const char *chip, int code, struct error *error);
/* There is no such chip; or, if it is "", none that has all the lines that are named. */
int chip_explain_missing(const char *chip, const struct chip_list *list, struct error *error);
/* The chip (its text) has `count` lines, and this is none of them. */
int chip_explain_line(const struct chip_params *params, const char *text, const char *line, uint32_t count,
					  struct error *error);
/* Somebody holds a line; user: who, NULL unknown. */
int chip_explain_busy(const struct chip_params *params, const char *text, uint32_t offset, const char *user,
					  struct error *error);

#endif
