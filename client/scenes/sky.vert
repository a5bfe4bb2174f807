/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The sky: one triangle over the whole picture, infinitely far, moved by the camera's rotation alone. */
uniform mat3 u_sky_other; /* (x, y, 1) in clip space now -> clip x, y, w at the other moment */
uniform mat3 u_sky_ray;   /* (x, y, 1) in clip space now -> direction in the world */

out vec3 v_now;
out vec3 v_other;
out vec3 v_ray;
flat out uint v_id;

void main()
{
	vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
	v_now = vec3(corner, 1.0);
	v_other = u_sky_other * v_now;
	v_ray = u_sky_ray * v_now;
	v_id = 0u;
	gl_Position = vec4(corner, 1.0, 1.0);
}
