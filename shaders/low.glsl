/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The low-frequency layer: uniform cubic B-spline over one pyramid level (Didyk et al. 2010, Section 6, "Blur"). */

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

/* `position` in pixel indices of the picture, `scale` = 1 / 2^level. */
vec3 low_frequency(sampler2D level, vec2 position, float scale)
{
	vec2 texel = position * scale;
	ivec2 first = ivec2(floor(texel)) - 1;
	vec2 fraction = texel - floor(texel);
	ivec2 last = textureSize(level, 0) - 1;
	vec4 wx = spline_weights(fraction.x);
	vec4 wy = spline_weights(fraction.y);
	ivec4 xs = clamp(ivec4(0, 1, 2, 3) + first.x, 0, last.x);
	ivec4 ys = clamp(ivec4(0, 1, 2, 3) + first.y, 0, last.y);
	vec3 sum = vec3(0.0);
	for (int j = 0; j < 4; j++) {
		vec3 row = wx.x * texelFetch(level, ivec2(xs.x, ys[j]), 0).rgb;
		row += wx.y * texelFetch(level, ivec2(xs.y, ys[j]), 0).rgb;
		row += wx.z * texelFetch(level, ivec2(xs.z, ys[j]), 0).rgb;
		row += wx.w * texelFetch(level, ivec2(xs.w, ys[j]), 0).rgb;
		sum += wy[j] * row;
	}
	return floor(sum * 255.0 + 0.5) / 255.0;
}
