/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The lab's settings; their rows are in options.c, which says what each means. */
#ifndef PURSUIT_LAB_SETTINGS_H
#define PURSUIT_LAB_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

enum lab_final {
	LAB_FINAL_LOW = 0,
	LAB_FINAL_HIGH,
	LAB_FINAL_KEEP,
};

enum lab_patch {
	LAB_PATCH_OFF = 0,
	LAB_PATCH_ALTERNATE,
	LAB_PATCH_SEQUENCE,
};

struct lab_settings {
	bool latency;
	char latency_log[512]; /* "": none; .csv or .bin */
	uint32_t priority;     /* real-time, 0 none */
	/* outputs */
	char gpio_chip[104]; /* "": the first that fits */
	char gpio_line[256]; /* "": no marker */
	uint32_t pattern;    /* enum pattern_kind */
	uint32_t pulse_us;
	uint32_t offset_us;
	bool active_low;
	uint32_t initial_level; /* 0 low, 1 high */
	uint32_t final_level;   /* enum lab_final */
	char strobe_line[32];   /* "": no strobe */
	double strobe_phase, strobe_duty, strobe_limit;
	bool strobe_active_low;
	/* inputs */
	char photodiode_line[32], trigger_line[32]; /* "": none */
	bool photodiode_active_low, trigger_active_low;
	char vsync_line[32]; /* "": none */
	uint32_t vsync_edge; /* 0 rising, 1 falling */
	double vsync_offset_us;
	uint32_t debounce_us;
	uint32_t photon_least_us, photon_most_us; /* most 0: by the refresh rate */
	/* the patch */
	uint32_t patch;        /* enum lab_patch */
	uint32_t patch_corner; /* 0 top left, 1 top right, 2 bottom left, 3 bottom right */
	uint32_t patch_size;   /* pixels */
};

#endif
