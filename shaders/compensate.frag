/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Real frame (with REAL) or in-between with equal light over N vblanks (Didyk et al. 2010, 5.1 "Gamma Correction",
 * "Selective Blur"; docs/method.md, 5 and 6). Drawn over the undisplaced triangles, or with WEIGHT_ONE over everything.
 */
#include "transfer.glsl"
#include "stretch.glsl"
#include "low.glsl"

uniform sampler2D u_picture;
uniform float u_count; /* N */
uniform float u_boost; /* k, 0 to 1 */

#ifndef WEIGHT_ONE
in vec2 v_displaced;
#endif

out vec4 o_color;

float blur_weight()
{
#ifdef WEIGHT_ONE
	return 1.0;
#else
	float stretch = larger_singular_value(dFdx(v_displaced), dFdy(v_displaced));
	return smoothstep(BLUR_FROM, BLUR_FULL, stretch - 1.0);
#endif
}

void main()
{
	vec3 code = texelFetch(u_picture, ivec2(gl_FragCoord.xy), 0).rgb;
	vec3 mixed = mix(code, low_at(ivec2(gl_FragCoord.xy)), blur_weight());
#ifdef NO_COMPENSATION
	o_color = vec4(mixed, 1.0);
#else
	vec3 original = to_light(code);
	vec3 between = min(original, max(to_light(mixed), (u_count * original - 1.0) / (u_count - 1.0)));
	vec3 gain = original - between;
#ifdef REAL
	vec3 light = original + u_boost * (u_count - 1.0) * gain;
#else
	vec3 light = original - u_boost * gain;
#endif
	o_color = vec4(from_light(clamp(light, 0.0, 1.0)), 1.0);
#endif
}
