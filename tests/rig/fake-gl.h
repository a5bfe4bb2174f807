/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The GL of the machine, with a say of the test's, whose functions stand before EGL's. Fences are the kernel's own, of
 * its timeline for tests (sw_sync), and signal when the test says so. As a library that is loaded before a program
 * (LD_PRELOAD) it only gives fences, which signal FAKE_FENCES_MS milliseconds later.
 */
#ifndef PURSUIT_FAKE_GL_H
#define PURSUIT_FAKE_GL_H

#include <stdbool.h>
#include <stdint.h>

struct fake_gl {
	int textures;    /* that are there */
	bool refuses;    /* nothing can be drawn into */
	bool has_fences; /* asked when a context is made */
	bool breaks;     /* fences cannot be had after all */
	uint32_t fences; /* so many were given */
	uint32_t waits;  /* so often all was waited for */
};

extern struct fake_gl fake_gl;

/* False: this kernel has no fences for tests. */
bool fake_gl_open_fences(void);
/* All fences that were given until now signal. */
void fake_gl_signal(void);

#endif
