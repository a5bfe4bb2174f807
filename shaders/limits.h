/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Constants that C and GLSL share (docs/method.md has them in words). GLSL gets
 * this text before every shader: preprocessor lines and comments only.
 */
#ifndef PURSUIT_SHADERS_LIMITS_H
#define PURSUIT_SHADERS_LIMITS_H

/* Stretch above 1 where the blur weight w begins and is full (Didyk et al. 2010, 5.1 "Selective Blur"). */
#define BLUR_FROM 0.25
#define BLUR_FULL 1.0

/* Stretch above 1 where a tear begins and is complete: nothing but L is shown. */
#define TEAR_FROM 1.0
#define TEAR_FULL 2.0

/* Interval between real frames, in seconds, where the boost begins to fade and is gone (Section 2, Bloch's law). */
#define BLOCH_FROM 0.030
#define BLOCH_GONE 0.050

/* Depth 1 lies this much in front of the cleared depth buffer, so that the far plane passes LESS. */
#define DEPTH_SCALE 0.9999

/* Vertex attributes. */
#define ATTRIBUTE_POSITION 0
#define ATTRIBUTE_DISPLACEMENT 1
#define ATTRIBUTE_DEPTH 2

/* Texture units. */
#define UNIT_PICTURE 0
#define UNIT_LOW 1
#define UNIT_MOTION 2
#define UNIT_DEPTH 3

/* Invocations of a group of the analysis; OpenGL ES 3.1 promises 128. */
#define ANALYSE_GROUP 64
/* Words before the tiles in what it finds; pixels a side of the plan's tiles. */
#define FOUND_HEAD 4
#define PLAN_TILE_SIDE 64
/* How it gets depth, and how that becomes z (docs/method.md, 1). */
#define DEPTH_BITS_NONE 0
#define DEPTH_BITS_16 1
#define DEPTH_BITS_24 2
#define DEPTH_BITS_32F 3
#define DEPTH_MAP_AS_IS 0
#define DEPTH_MAP_REVERSED 1
#define DEPTH_MAP_RANGE 2
#define DEPTH_MAP_INFINITE 3
#define DEPTH_MAP_OPEN 4

#endif
