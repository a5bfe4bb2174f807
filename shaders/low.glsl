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

/* At pixel `pixel` of the picture; `scale` = 1 / 2^level. */
vec3 low_frequency(sampler2D level, vec2 pixel, float scale)
{
	vec2 texel = pixel * scale;
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

/*
 * Weights of five texels in a row for the layer between two pixels, the way bilinear sampling mixes their values.
 * Neighbouring pixels are at most half a texel apart, so that their splines share four texels or five.
 */
float[5] between_weights(float position, float scale, float last_pixel, out int first)
{
	float left = clamp(floor(position), 0.0, last_pixel);
	float right = clamp(floor(position) + 1.0, 0.0, last_pixel);
	float f = position - floor(position);
	float base = floor(left * scale);
	vec4 a = (1.0 - f) * spline_weights(left * scale - base);
	vec4 b = f * spline_weights(fract(right * scale));
	bool shifted = floor(right * scale) > base;
	first = int(base) - 1;
	if (shifted)
		return float[5](a.x, a.y + b.x, a.z + b.y, a.w + b.z, b.w);
	return float[5](a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w, 0.0);
}

/* Anywhere, `position` in pixel indices; `size` of the picture in pixels. */
vec3 low_frequency_between(sampler2D level, vec2 position, float scale, vec2 size)
{
	int first_x;
	int first_y;
	float wx[5] = between_weights(position.x, scale, size.x - 1.0, first_x);
	float wy[5] = between_weights(position.y, scale, size.y - 1.0, first_y);
	ivec2 last = textureSize(level, 0) - 1;
	vec3 sum = vec3(0.0);
	for (int j = 0; j < 5; j++)
		for (int i = 0; i < 5; i++) {
			ivec2 texel = clamp(ivec2(first_x + i, first_y + j), ivec2(0), last);
			sum += wx[i] * wy[j] * texelFetch(level, texel, 0).rgb;
		}
	return sum;
}
