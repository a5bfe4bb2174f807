/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* One level of the binomial pyramid from the level below (Didyk et al. 2010, Section 6, "Blur"). */
uniform sampler2D u_picture;

out vec4 o_color;

vec3 row(ivec3 x, int y)
{
	vec3 outer = texelFetch(u_picture, ivec2(x.x, y), 0).rgb + texelFetch(u_picture, ivec2(x.z, y), 0).rgb;
	return outer + 2.0 * texelFetch(u_picture, ivec2(x.y, y), 0).rgb;
}

void main()
{
	ivec2 last = textureSize(u_picture, 0) - 1;
	ivec2 centre = 2 * ivec2(gl_FragCoord.xy);
	ivec3 x = clamp(ivec3(-1, 0, 1) + centre.x, 0, last.x);
	ivec3 y = clamp(ivec3(-1, 0, 1) + centre.y, 0, last.y);
	vec3 sum = row(x, y.x) + 2.0 * row(x, y.y) + row(x, y.z);
	/* One sum in sixteen lies halfway between two code values: rounded here, upwards, whatever the renderer would do. */
	vec3 whole = floor(sum * 255.0 + 0.5);
	o_color = vec4(floor(whole / 16.0 + 0.5) / 255.0, 1.0);
}
