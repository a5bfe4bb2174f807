/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

layout(location = 0) out vec4 o_color;

in vec2 v_uv;
in vec4 v_color;

uniform sampler2D u_glyphs;

void main()
{
	o_color = v_color * texture(u_glyphs, v_uv).r;
}
