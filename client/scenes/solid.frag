/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Textured, lit at the vertices, with haze. CUTOUT discards what the texture's alpha leaves out. */
#include "surface.glsl"

in vec3 v_surface;
in vec3 v_light;

uniform sampler2DArray u_material;
uniform vec4 u_haze; /* colour, density squared */

void main()
{
	vec4 texel = texture(u_material, v_surface);
#ifdef CUTOUT
	if (texel.a < 0.5)
		discard;
#endif
	vec3 light = texel.rgb * texel.rgb * v_light;
	float distance2 = v_now.z * v_now.z * u_haze.w;
	write_surface(mix(light, u_haze.rgb, distance2 / (1.0 + distance2)));
}
