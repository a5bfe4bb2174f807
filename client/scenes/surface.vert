/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * All solid things. The clip position at this moment and at the other one both
 * go down interpolated, and the fragment divides (Didyk et al. 2010, Section 6,
 * "Motion Flow"); equal moments take the same arithmetic, so their difference
 * is exactly zero.
 */
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec2 a_uv;
layout(location = 3) in vec4 a_tint;   /* rgb, and how much of the sky is seen */
layout(location = 4) in uvec4 a_extra; /* texture layer, sway weight, sway phase, own light */
layout(location = 5) in uint a_id;

uniform mat4 u_now;
uniform mat4 u_other;
uniform mat4 u_model;
uniform vec4 u_sway; /* phases: two now, two at the other moment */
uniform vec4 u_sway_size;
uniform vec3 u_sun_direction;
uniform vec3 u_sun_color;
uniform vec3 u_sky_color;
uniform vec3 u_bounce_color;
uniform vec4 u_draw_tint; /* rgb, own light */
uniform uint u_id_base;

out vec3 v_now;
out vec3 v_other;
out vec3 v_surface;
out vec3 v_light;
#ifdef SHADOWED
out vec3 v_sun;
out vec3 v_world;
#endif
flat out uint v_id;

vec3 swayed(vec2 phase)
{
	float weight = float(a_extra.y) / 255.0;
	float own = float(a_extra.z) * (6.2831853 / 256.0);
	vec2 wave = sin(phase + vec2(own, own * 3.0));
	return a_position + u_sway_size.xyz * (weight * vec3(wave.x, wave.y, wave.y));
}

void main()
{
	vec4 now = u_now * vec4(swayed(u_sway.xy), 1.0);
	vec4 other = u_other * vec4(swayed(u_sway.zw), 1.0);
	vec3 normal = normalize(mat3(u_model) * a_normal);
	vec3 tint = a_tint.rgb * u_draw_tint.rgb;
	tint *= tint;
	vec3 ambient = mix(u_bounce_color, u_sky_color, normal.y * 0.5 + 0.5) * a_tint.a;
	ambient += float(a_extra.w) / 64.0 + u_draw_tint.a;
	vec3 sun = u_sun_color * max(dot(normal, u_sun_direction), 0.0);
#ifdef SHADOWED
	v_light = tint * ambient;
	v_sun = tint * sun;
	v_world = (u_model * vec4(a_position, 1.0)).xyz;
#else
	v_light = tint * (ambient + sun * (0.25 + 0.75 * a_tint.a));
#endif
	v_now = now.xyw;
	v_other = other.xyw;
	v_surface = vec3(a_uv, float(a_extra.x));
	v_id = a_id + u_id_base;
	gl_Position = now;
}
