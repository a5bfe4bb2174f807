/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The UI layer, premultiplied, in code values; blending does the rest. */
uniform sampler2D u_picture;

in vec2 v_source;

out vec4 o_color;

void main()
{
	o_color = texture(u_picture, v_source);
}
