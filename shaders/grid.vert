/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The grid, displaced by u_shift real intervals (Didyk et al. 2010, Section 6, "Morphing").
 * Rows run downwards everywhere: row 0 of a texture is the top of the picture.
 */
in vec2 a_position;
in vec2 a_displacement;
in float a_depth;

uniform vec2 u_size;
uniform float u_shift;      /* phase at which it is drawn */
uniform float u_last_phase; /* phase whose distortion drives the blur weight */

out vec2 v_source;    /* 0 to 1 */
out vec2 v_displaced; /* pixels, at u_last_phase */

void main()
{
	vec2 position = a_position + u_shift * a_displacement;
	v_source = a_position / u_size;
	v_displaced = a_position + u_last_phase * a_displacement;
	gl_Position = vec4(2.0 * position / u_size - 1.0, 2.0 * DEPTH_SCALE * a_depth - 1.0, 1.0);
}
