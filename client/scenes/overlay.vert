/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The UI layer: rectangles in pixels, y down, glyphs from a texture. */
layout(location = 0) in vec2 a_position;
layout(location = 1) in vec2 a_uv;
layout(location = 2) in vec4 a_color; /* premultiplied */

uniform vec2 u_size;

out vec2 v_uv;
out vec4 v_color;

void main()
{
	v_uv = a_uv;
	v_color = a_color;
	gl_Position = vec4(a_position.x / u_size.x * 2.0 - 1.0, 1.0 - a_position.y / u_size.y * 2.0, 0.0, 1.0);
}
