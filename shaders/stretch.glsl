/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The larger singular value of the 2x2 matrix with columns a and b. */
float larger_singular_value(vec2 a, vec2 b)
{
	float aa = dot(a, a);
	float bb = dot(b, b);
	float ab = dot(a, b);
	float spread = sqrt((aa - bb) * (aa - bb) + 4.0 * ab * ab);
	return sqrt(0.5 * (aa + bb + spread));
}
