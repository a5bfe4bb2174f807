/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Procedural materials: square pictures that tile, made on the CPU with their
 * mipmaps, so that every renderer samples the same bits and fine detail fades
 * with distance and does not shimmer. Albedo is stored as its square root.
 */
#ifndef PURSUIT_SCENES_MATERIALS_H
#define PURSUIT_SCENES_MATERIALS_H

#include <stdbool.h>
#include <stdint.h>

enum material {
	MATERIAL_PLAIN,  /* almost white, a little grain */
	MATERIAL_ASHLAR, /* 2 m: dressed sandstone blocks */
	MATERIAL_BRICK,  /* 2 m */
	MATERIAL_PAVING, /* 2 m: flagstones */
	MATERIAL_MARBLE,
	MATERIAL_PLASTER,
	MATERIAL_WOOD,   /* 1 m: planks along v */
	MATERIAL_BARK,   /* birch, v up the trunk */
	MATERIAL_LEAVES, /* cutout, a spray of leaves */
	MATERIAL_GRASS,  /* ground */
	MATERIAL_TUFT,   /* cutout, blades from v = 0 up to v = 1 */
	MATERIAL_FABRIC,
	MATERIAL_PAINT, /* painted steel with rivets along both edges in u */
	MATERIAL_SAND,
	MATERIAL_FUR,
	MATERIAL_CLOUDS, /* red: cover */
	MATERIAL_FACADE, /* 4 x 4 windows, alpha unused */
	MATERIAL_ASPHALT,
	MATERIAL_GRID, /* dark panels with bright lines */
	MATERIAL_COUNT
};

#define MATERIAL_SIZE 512
#define MATERIAL_LEVELS 10

/* RGBA8, MATERIAL_SIZE squared, row v = 0 first. */
void material_fill(enum material material, uint8_t *pixels);
/* The next mipmap level of a picture of `size` (from 2 up), in place of `pixels`; cutouts keep their coverage. */
void material_halve(uint8_t *pixels, uint32_t size, double coverage);
/* The part of the picture that a cutout keeps; 1 for the others. */
double material_coverage(const uint8_t *pixels, uint32_t size);

#endif
