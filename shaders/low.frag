/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The low-frequency layer L at the size of the picture: uniform cubic B-spline over one pyramid level
 * (Didyk et al. 2010, Section 6, "Blur").
 */
uniform sampler2D u_picture; /* the level */
uniform float u_level_scale; /* 1 / 2^level */

out vec4 o_color;

vec4 spline_weights(float f)
{
	float g = 1.0 - f;
	vec4 w;
	w.x = g * g * g;
	w.y = 4.0 + f * f * (3.0 * f - 6.0);
	w.z = 4.0 + g * g * (3.0 * g - 6.0);
	w.w = f * f * f;
	return w / 6.0;
}

vec3 fetch(int x, int y)
{
	return texelFetch(u_picture, ivec2(x, y), 0).rgb;
}

vec3 row(ivec4 xs, vec4 w, int y)
{
	return w.x * fetch(xs.x, y) + w.y * fetch(xs.y, y) + w.z * fetch(xs.z, y) + w.w * fetch(xs.w, y);
}

void main()
{
	vec2 texel = floor(gl_FragCoord.xy) * u_level_scale;
	vec2 base = floor(texel);
	ivec2 last = textureSize(u_picture, 0) - 1;
	vec4 wx = spline_weights(texel.x - base.x);
	vec4 wy = spline_weights(texel.y - base.y);
	ivec4 xs = clamp(ivec4(-1, 0, 1, 2) + int(base.x), 0, last.x);
	ivec4 ys = clamp(ivec4(-1, 0, 1, 2) + int(base.y), 0, last.y);
	vec3 sum = wy.x * row(xs, wx, ys.x) + wy.y * row(xs, wx, ys.y);
	sum += wy.z * row(xs, wx, ys.z) + wy.w * row(xs, wx, ys.w);
	o_color = vec4(floor(sum * 255.0 + 0.5) / 255.0, 1.0);
}
