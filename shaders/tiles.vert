/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Parts of the picture as rectangles, corners in pixels of the picture whatever the size of the target. */
in vec2 a_position;

uniform vec2 u_size; /* of the target, in pixels of the picture */

void main()
{
	gl_Position = vec4(2.0 * a_position / u_size - 1.0, 0.0, 1.0);
}
