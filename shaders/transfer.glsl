/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Code values to light and back, for the display (Didyk et al. 2010, 5.1 "Gamma Correction"). Arguments in [0, 1]. */

#ifdef CURVE_GAMMA

uniform float u_gamma;

vec3 to_light(vec3 code)
{
	return pow(code, vec3(u_gamma));
}

vec3 from_light(vec3 light)
{
	return pow(light, vec3(1.0 / u_gamma));
}

#else

vec3 to_light(vec3 code)
{
	vec3 linear = code / 12.92;
	vec3 curved = pow((code + 0.055) / 1.055, vec3(2.4));
	return mix(curved, linear, lessThanEqual(code, vec3(0.04045)));
}

vec3 from_light(vec3 light)
{
	vec3 linear = 12.92 * light;
	vec3 curved = 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055;
	return mix(curved, linear, lessThanEqual(light, vec3(0.0031308)));
}

#endif
