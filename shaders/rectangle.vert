/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The whole target as two triangles, without vertices in memory. */
out vec2 v_source; /* 0 to 1, row 0 is the top of the picture */

void main()
{
	vec2 corner = vec2(float((0x32 >> gl_VertexID) & 1), float((0x2c >> gl_VertexID) & 1));
	v_source = corner;
	gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
