/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The low-frequency layer L: uniform cubic B-spline over one pyramid level (Didyk et al. 2010, Section 6, "Blur").
 * Made where it is used, so that it needs no picture of its own.
 */
uniform sampler2D u_low;     /* the level */
uniform float u_level_scale; /* 1 / 2^level */

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

vec3 low_texel(int x, int y)
{
	return texelFetch(u_low, ivec2(x, y), 0).rgb;
}

vec3 low_row(ivec4 xs, vec4 w, int y)
{
	return w.x * low_texel(xs.x, y) + w.y * low_texel(xs.y, y) + w.z * low_texel(xs.z, y) + w.w * low_texel(xs.w, y);
}

/* L at a pixel, rounded to code values. */
vec3 low_at(ivec2 pixel)
{
	vec2 texel = vec2(pixel) * u_level_scale;
	vec2 base = floor(texel);
	ivec2 last = textureSize(u_low, 0) - 1;
	vec4 wx = spline_weights(texel.x - base.x);
	vec4 wy = spline_weights(texel.y - base.y);
	ivec4 xs = clamp(ivec4(-1, 0, 1, 2) + int(base.x), 0, last.x);
	ivec4 ys = clamp(ivec4(-1, 0, 1, 2) + int(base.y), 0, last.y);
	vec3 sum = wy.x * low_row(xs, wx, ys.x) + wy.y * low_row(xs, wx, ys.y);
	sum += wy.z * low_row(xs, wx, ys.z) + wy.w * low_row(xs, wx, ys.w);
	return floor(sum * 255.0 + 0.5) / 255.0;
}

#ifdef LOW_BETWEEN
/* The weights of five texels from `base` on, for L at `texel` between base and base + 2. */
void five_weights(float texel, float base, out float w[5])
{
	float first = floor(texel);
	vec4 four = spline_weights(texel - first);
	bool next = first > base;
	w[0] = next ? 0.0 : four.x;
	w[1] = next ? four.x : four.y;
	w[2] = next ? four.y : four.z;
	w[3] = next ? four.z : four.w;
	w[4] = next ? four.w : 0.0;
}

vec3 rounded(vec3 code)
{
	return floor(code * 255.0 + 0.5) / 255.0;
}

/* L at a position in pixels, sampled bilinearly as the picture is: from four pixels, which share their texels. */
vec3 low_between(vec2 position, vec2 size)
{
	vec2 first = floor(position - 0.5), f = position - 0.5 - first;
	vec2 a = clamp(first, vec2(0.0), size - 1.0) * u_level_scale;
	vec2 b = clamp(first + 1.0, vec2(0.0), size - 1.0) * u_level_scale;
	ivec2 last = textureSize(u_low, 0) - 1, base = ivec2(floor(a));
	float ax[5], ay[5], bx[5], by[5];
	five_weights(a.x, floor(a.x), ax);
	five_weights(b.x, floor(a.x), bx);
	five_weights(a.y, floor(a.y), ay);
	five_weights(b.y, floor(a.y), by);
	vec3 aa = vec3(0.0), ba = vec3(0.0), ab = vec3(0.0), bb = vec3(0.0);
	for (int j = 0; j < 5; j++) {
		vec3 left = vec3(0.0), right = vec3(0.0);
		for (int i = 0; i < 5; i++) {
			ivec2 at = clamp(base + ivec2(i, j) - 1, ivec2(0), last);
			vec3 texel = low_texel(at.x, at.y);
			left += ax[i] * texel;
			right += bx[i] * texel;
		}
		aa += ay[j] * left;
		ba += ay[j] * right;
		ab += by[j] * left;
		bb += by[j] * right;
	}
	return mix(mix(rounded(aa), rounded(ba), f.x), mix(rounded(ab), rounded(bb), f.x), f.y);
}
#endif
