/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The pixel kernels, once per instruction set. All levels give equal bits:
 * integers, or floats without contraction and reassociation. tile.h and
 * kernels.h hold the code of all of them.
 */
#ifndef PURSUIT_ENGINE_CPU_LEVELS_H
#define PURSUIT_ENGINE_CPU_LEVELS_H

#include <stdint.h>

#include "daemon/engine/cpu/light.h"
#include "daemon/engine/cpu/scene.h"

enum cpu_level {
	CPU_LEVEL_PLAIN = 0, /* what the compiler makes of plain C for the base machine */
	CPU_LEVEL_AVX2,
	CPU_LEVEL_AVX512, /* foundation, byte and word, vector length */
	CPU_LEVEL_NEON,   /* 64-bit ARM */
	CPU_LEVEL_COUNT,
};

struct cpu_kernels {
	const char *name;
	/* Draws one tile of the displaced picture; counts pixels that no triangle covers, of which there are none. */
	void (*draw_tile)(const struct scene *scene, uint32_t tile, struct scene_scratch *scratch);
	/* `ui` (premultiplied) over opaque pixels, in place. */
	void (*blend_row)(uint8_t *pixels, const uint8_t *ui, uint32_t count);
	/*
	 * Texels first to first + count - 1 of a row of the next pyramid level, from three rows of the level below (pixel 0
	 * of each; what lies beside must be readable). docs/method.md, 4.
	 */
	void (*halve_row)(const uint8_t *const rows[3], uint32_t first, uint32_t count, uint8_t *out);
	/*
	 * Pixels first to first + count - 1 of a row of L, from four rows of a pyramid level with 2^shift pixels a texel.
	 * `wy`: their weights; `wx`: four weights for each of the 2^shift places in a texel. shift: 1 to 6.
	 */
	void (*spline_row)(const uint8_t *const rows[4], const float wy[4], const float (*wx)[4], uint32_t shift,
					   uint32_t first, uint32_t count, uint8_t *out);
	/* B and E of `count` pixels with their blur weights (docs/method.md, 6). */
	void (*compensate)(const struct light *light, const uint8_t *color, const uint8_t *low, const float *weights,
					   uint32_t count, uint8_t *between, uint8_t *real);
};

/* Kernels of a level; NULL if this build or this machine lacks it. */
const struct cpu_kernels *cpu_level_kernels(enum cpu_level level);

/* The fastest level that this machine has. */
const struct cpu_kernels *cpu_level_best(void);

#endif
