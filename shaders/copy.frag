/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pixels of a picture to the same places of another one. */
uniform sampler2D u_picture;

out vec4 o_color;

void main()
{
	o_color = texelFetch(u_picture, ivec2(gl_FragCoord.xy), 0);
}
