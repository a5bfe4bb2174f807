/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What every surface writes: depth, motion, id, and colour in code values. */
layout(location = 0) out vec4 o_color;
layout(location = 1) out float o_depth;
layout(location = 2) out vec2 o_motion;
layout(location = 3) out uint o_id;

in vec3 v_now;
in vec3 v_other;
flat in uint v_id;

uniform vec2 u_motion_scale; /* half the size in pixels, y down; negated for forward motion */

/* Behind the camera at the other moment: far away, but finite. */
vec2 motion()
{
	vec2 other = v_other.xy / max(v_other.z, 0.001);
	return clamp((v_now.xy / v_now.z - other) * u_motion_scale, -32768.0, 32768.0);
}

void write_surface(vec3 light)
{
	o_color = vec4(sqrt(clamp(light, 0.0, 1.0)), 1.0);
	o_depth = gl_FragCoord.z;
	o_motion = motion();
	o_id = v_id;
}
