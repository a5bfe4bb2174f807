/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Gradient, sun and clouds, all functions of the direction in the world. */
#include "surface.glsl"

in vec3 v_ray;

uniform sampler2DArray u_material;
uniform vec3 u_horizon;
uniform vec3 u_zenith;
uniform vec3 u_sun_direction;
uniform vec3 u_sun_glow;
uniform vec4 u_clouds; /* colour, texture layer (negative: none) */

void main()
{
	vec3 ray = normalize(v_ray);
	float up = max(ray.y, 0.0);
	float toward = max(dot(ray, u_sun_direction), 0.0);
	float glow = toward * toward;
	glow *= glow;
	float disc = glow * glow;
	disc *= disc;
	disc *= disc;
	disc *= disc;
	vec3 light = mix(u_horizon, u_zenith, sqrt(up)) + u_sun_glow * (glow * 0.25 + disc);
	if (u_clouds.w >= 0.0) {
		float cover = texture(u_material, vec3(ray.xz * (0.35 / (up + 0.18)), u_clouds.w)).r;
		light = mix(light, u_clouds.rgb, cover * min(up * 5.0, 1.0));
	}
	write_surface(light);
}
