/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The displaced grid shows the undisplaced picture (Didyk et al. 2010, Section 6, "Morphing"); with TEAR, triangles
 * that are stretched too far fade to the low-frequency layer (5.1 "Selective Blur").
 */
#ifdef TEAR
#include "stretch.glsl"
#define LOW_BETWEEN
#include "low.glsl"

uniform vec2 u_size;
#endif

uniform sampler2D u_picture;

in vec2 v_source;

out vec4 o_color;

void main()
{
	vec3 color = texture(u_picture, v_source).rgb;
#ifdef TEAR
	/* These are the columns of the inverse map; its larger singular value over its determinant is the stretch. */
	vec2 dx = dFdx(v_source) * u_size;
	vec2 dy = dFdy(v_source) * u_size;
	float area = max(abs(dx.x * dy.y - dx.y * dy.x), 1e-12);
	float tear = smoothstep(TEAR_FROM, TEAR_FULL, larger_singular_value(dx, dy) / area - 1.0);
	color = mix(color, low_between(v_source * u_size, u_size), tear);
#endif
	o_color = vec4(color, 1.0);
}
