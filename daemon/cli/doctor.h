/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What `pursuit doctor` found out: one finding a thing, in plain words, with the command that mends it. */
#ifndef PURSUIT_CLI_DOCTOR_H
#define PURSUIT_CLI_DOCTOR_H

#include <stdbool.h>
#include <stdint.h>

#define DOCTOR_FINDINGS 64u

enum doctor_state {
	DOCTOR_WORKS = 0,
	DOCTOR_NOTE,  /* nothing is wrong, but something is not there */
	DOCTOR_LIMIT, /* works, but not as well as it could */
	DOCTOR_FAILS,
};

struct doctor_finding {
	enum doctor_state state;
	const char *area; /* static: "renderer", "display", "gpio", "scheduling", "service", "socket", "daemon" */
	char text[240];
	char mend[200]; /* what to do, a command where there is one; "" nothing */
};

struct doctor {
	struct doctor_finding findings[DOCTOR_FINDINGS];
	uint32_t count;
	const char *system; /* folder in front of /sys and /dev, "" for the real ones; for tests */
};

/* mend: a command; NULL only for what works, or is none of its business. More findings than fit are dropped. */
__attribute__((format(printf, 5, 6))) void doctor_add(struct doctor *doctor, enum doctor_state state, const char *area,
													  const char *mend, const char *format, ...);

void doctor_look_at_renderers(struct doctor *doctor);
void doctor_look_at_displays(struct doctor *doctor);
void doctor_look_at_gpio(struct doctor *doctor);
void doctor_look_at_scheduling(struct doctor *doctor);
void doctor_look_at_service(struct doctor *doctor);
/* socket NULL: the usual one. */
void doctor_look_at_daemon(struct doctor *doctor, const char *socket);

/* The fastest refresh rate of the detailed timings of an EDID, Hz, with its size; 0 if it has none that is whole. */
double doctor_read_edid(const uint8_t *edid, uint32_t bytes, uint32_t *width, uint32_t *height);

#endif
