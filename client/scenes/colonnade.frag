/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Stone in the sun: the roof line and the arches cast soft shadows that are computed, not stored. */
#include "surface.glsl"

in vec3 v_surface;
in vec3 v_light;
in vec3 v_sun;
in vec3 v_world;

uniform sampler2DArray u_material;
uniform vec4 u_haze;
uniform vec3 u_sun_direction;

/* How much sun comes over the right wall and, behind the left facade, through its arches. */
float sun_seen(vec3 p)
{
	vec2 slope = u_sun_direction.yz / u_sun_direction.x;
	float over_roof = p.y + (4.0 - p.x) * slope.x - 9.6;
	float seen = clamp(over_roof * 6.0 + 0.5, 0.0, 1.0);
	vec2 facade = p.yz + (-4.4 - p.x) * slope;
	facade.y = abs(fract(facade.y * 0.25) - 0.5) * 4.0;
	facade.x = max(facade.x - 2.6, 0.0);
	float arch = clamp((1.55 - length(facade)) * 8.0 + 0.5, 0.0, 1.0);
	return p.x < -4.45 ? seen * arch : seen;
}

void main()
{
	vec3 texel = texture(u_material, v_surface).rgb;
	vec3 light = texel * texel * (v_light + v_sun * sun_seen(v_world));
	float distance2 = v_now.z * v_now.z * u_haze.w;
	write_surface(mix(light, u_haze.rgb, distance2 / (1.0 + distance2)));
}
