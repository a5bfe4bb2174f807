/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Motion and depth to the vertices of the grid (docs/method.md, 1 and 2; Didyk et al. 2010, 5.1 "Morphing", Section 6
 * "Motion Flow"): one group of invocations a vertex, that is a cell with a border of nothing around all cells. The
 * same operations in the same order as on the CPU (daemon/engine/analysis/). Needs no more than OpenGL ES 3.1 promises.
 */
layout(local_size_x = ANALYSE_GROUP) in;

layout(binding = UNIT_MOTION) uniform usampler2D u_motion; /* bits: two floats, or both halves in one word */
layout(binding = UNIT_DEPTH) uniform usampler2D u_depth;   /* bits */

layout(std140, binding = 0) uniform job
{
	ivec4 u_picture; /* size of colour in pixels, of a cell; columns of tiles */
	ivec4 u_planes;  /* sizes of motion and depth */
	ivec4 u_kinds;   /* DEPTH_BITS_*, DEPTH_MAP_*, 1 if motion is halves, place of the first vertex in b_words */
	vec4 u_scale;    /* T / S; degrees per second of a pixel per S; g squared from which on a cell snaps */
	vec4 u_range;    /* near, far - near */
	ivec4 u_band;    /* first row of vertices now, rows in all; first rows of motion and of depth in the textures */
};

layout(std430, binding = 0) buffer found
{
	uint b_words[]; /* moves, invalid pixels, 0, 0; by tile: invalid; by vertex: x y ux uy z snapped */
};

/* No fused multiply and add where that can be said, so that ties are settled as on the CPU. */
#ifdef GL_ES
#define EXACT
#else
#define EXACT precise
#endif

shared uint s_peak, s_key, s_moves, s_invalid;

const uint MAGNITUDE = 0x7fffffffu, INFINITE = 0x7f800000u, KEY_NONE = 0x7fffffffu;

/* Exact, without denormals, which a GPU may take for 0. */
float half_value(uint bits)
{
	uint exponent = bits & 0x7c00u, shifted = (bits & 0x7fffu) << 13;
	uint normal = shifted + (112u << 23) + (exponent == 0x7c00u ? 112u << 23 : 0u);
	float tiny = uintBitsToFloat(shifted + (113u << 23)) - uintBitsToFloat(113u << 23);
	uint value = exponent == 0u ? floatBitsToUint(tiny) : normal;
	return uintBitsToFloat(value | (bits & 0x8000u) << 16);
}

/* The pixel of a plane that a pixel of the picture shows. */
ivec2 plane_pixel(ivec2 pixel, ivec2 plane)
{
	if (plane == u_picture.xy)
		return pixel;
	return ivec2((2u * uvec2(pixel) + 1u) * uvec2(plane) / (2u * uvec2(u_picture.xy)));
}

uvec2 motion_bits(ivec2 pixel)
{
	uvec2 bits = texelFetch(u_motion, plane_pixel(pixel, u_planes.xy) - ivec2(0, u_band.z), 0).xy;
	if (u_kinds.z == 0)
		return bits;
	return uvec2(floatBitsToUint(half_value(bits.x & 0xffffu)), floatBitsToUint(half_value(bits.x >> 16)));
}

bool is_number(uvec2 bits)
{
	return (bits.x & INFINITE) != INFINITE && (bits.y & INFINITE) != INFINITE;
}

float square(vec2 v)
{
	EXACT float sum = v.x * v.x + v.y * v.y;
	return sum;
}

/* u of a motion vector that is a number. */
vec2 displacement_of(uvec2 bits)
{
	vec2 m = clamp(uintBitsToFloat(bits), -65504.0, 65504.0);
	EXACT float speed = sqrt(square(m)) * u_scale.y;
	float t = clamp((speed - 70.0) / 20.0, 0.0, 1.0);
	EXACT float tracking = 1.0 - t * t * (3.0 - 2.0 * t);
	return clamp(tracking * (u_scale.x * m), -16384.0, 16384.0);
}

vec2 displacement(ivec2 pixel)
{
	uvec2 bits = motion_bits(min(pixel, u_picture.xy - 1));
	return is_number(bits) ? displacement_of(bits) : vec2(0.0);
}

float clamped_depth(float z)
{
	return z > 0.0 ? (z < 1.0 ? z : 1.0) : 0.0;
}

/* z of what is no finite number: decided here, since a GPU need not know NaN. */
float odd_depth(uint bits)
{
	if ((bits & MAGNITUDE) != INFINITE || u_kinds.y == DEPTH_MAP_OPEN)
		return 1.0;
	bool far = (bits == INFINITE) != (u_kinds.y == DEPTH_MAP_REVERSED);
	return far ? 1.0 : 0.0;
}

float depth(ivec2 pixel)
{
	if (u_kinds.x == DEPTH_BITS_NONE)
		return 0.5;
	uint bits = texelFetch(u_depth, plane_pixel(pixel, u_planes.zw) - ivec2(0, u_band.w), 0).x;
	float d = uintBitsToFloat(bits);
	if (u_kinds.x == DEPTH_BITS_16)
		d = float(int(bits & 0xffffu)) / 65535.0;
	else if (u_kinds.x == DEPTH_BITS_24)
		d = float(int(bits & 0xffffffu)) / 16777215.0;
	else if ((bits & INFINITE) == INFINITE)
		return odd_depth(bits);
	if (u_kinds.y == DEPTH_MAP_REVERSED)
		return clamped_depth(1.0 - d);
	if (u_kinds.y == DEPTH_MAP_RANGE)
		return clamped_depth((d - u_range.x) / u_range.y);
	if (u_kinds.y == DEPTH_MAP_INFINITE)
		return d <= u_range.x ? 0.0 : clamped_depth(1.0 - u_range.x / d);
	if (u_kinds.y == DEPTH_MAP_OPEN)
		return d == -1.0 ? 0.0 : clamped_depth(d / (1.0 + d));
	return clamped_depth(d);
}

/* gx and gy, squared. */
vec2 gradient(ivec2 pixel, vec2 u)
{
	return vec2(square(displacement(pixel + ivec2(1, 0)) - u), square(displacement(pixel + ivec2(0, 1)) - u));
}

struct cell {
	ivec2 start, size;
};

/* Looks at all pixels of the cell: the largest g squared into s_peak, what moves, what is no number. */
void find_peak(cell at)
{
	float peak = 0.0;
	uint moves = 0u, invalid = 0u;
	for (int i = int(gl_LocalInvocationIndex); i < at.size.x * at.size.y; i += ANALYSE_GROUP) {
		ivec2 pixel = at.start + ivec2(i % at.size.x, i / at.size.x);
		uvec2 bits = motion_bits(pixel);
		bool number = is_number(bits);
		vec2 u = number ? displacement_of(bits) : vec2(0.0);
		vec2 g = gradient(pixel, u);
		peak = max(peak, max(g.x, g.y));
		moves |= u != vec2(0.0) ? 1u : 0u;
		if (!number) {
			invalid++;
			ivec2 tile = pixel / PLAN_TILE_SIDE;
			b_words[FOUND_HEAD + tile.y * u_picture.w + tile.x] = 1u;
		}
	}
	/* Floats that are not negative sort as their bits do. */
	if (peak > 0.0)
		atomicMax(s_peak, floatBitsToUint(peak));
	if (moves != 0u)
		atomicOr(s_moves, moves);
	if (invalid != 0u)
		atomicAdd(s_invalid, invalid);
}

/* Largest k with k / 4 <= g, at most 63: exact, since the squares are. */
uint quantised(float square)
{
	if (16.0 * square >= 63.0 * 63.0)
		return 63u;
	uint k = uint(4.0 * sqrt(square));
	while (k > 0u && float(k * k) > 16.0 * square)
		k--;
	while (float((k + 1u) * (k + 1u)) <= 16.0 * square)
		k++;
	return k;
}

/* Of the pixels that are as strong as the strongest: the one nearest to the centre, then the first. Into s_key. */
void find_place(cell at, float least)
{
	uint best = KEY_NONE;
	for (int i = int(gl_LocalInvocationIndex); i < at.size.x * at.size.y; i += ANALYSE_GROUP) {
		ivec2 place = ivec2(i % at.size.x, i / at.size.x);
		vec2 g = gradient(at.start + place, displacement(at.start + place));
		ivec2 d = 2 * place + 1 - at.size;
		uint key = uint(d.x * d.x + d.y * d.y) << 12 | uint(place.y << 6 | place.x);
		if (max(g.x, g.y) >= least)
			best = min(best, key);
	}
	if (best != KEY_NONE)
		atomicMin(s_key, best);
}

void put(vec2 position, vec2 u, float z, float snapped)
{
	int row = u_band.x + int(gl_WorkGroupID.y);
	int at = u_kinds.w + 6 * (row * int(gl_NumWorkGroups.x) + int(gl_WorkGroupID.x));
	b_words[at] = floatBitsToUint(position.x);
	b_words[at + 1] = floatBitsToUint(position.y);
	b_words[at + 2] = floatBitsToUint(u.x);
	b_words[at + 3] = floatBitsToUint(u.y);
	b_words[at + 4] = floatBitsToUint(z);
	b_words[at + 5] = floatBitsToUint(snapped);
}

/* The nearer side of the discontinuity at a pixel. */
void put_snapped(ivec2 pixel)
{
	vec2 u = displacement(pixel), g = gradient(pixel, u);
	ivec2 step = g.x >= g.y ? ivec2(1, 0) : ivec2(0, 1);
	vec2 other_u = displacement(pixel + step);
	float z = depth(pixel), other_z = depth(min(pixel + step, u_picture.xy - 1));
	bool other = other_z != z ? other_z < z : square(other_u) > square(u);
	put(vec2(pixel) + 0.5 + 0.5 * vec2(step), other ? other_u : u, other ? other_z : z, 1.0);
}

void put_mean(cell at)
{
	ivec2 second = at.start + at.size / 2, first = second - 1 + (at.size & 1);
	ivec2 right = ivec2(second.x, first.y), below = ivec2(first.x, second.y);
	vec2 left_u = displacement(first) + displacement(below), right_u = displacement(right) + displacement(second);
	float z = min(min(depth(first), depth(right)), min(depth(below), depth(second)));
	put(vec2(at.start) + 0.5 * vec2(at.size), (left_u + right_u) * 0.25, z, 0.0);
}

/* A vertex on the border: in line with the centres of the cells, never displaced. */
void put_border(ivec2 id, ivec2 last)
{
	ivec2 pixel;
	vec2 position;
	for (int axis = 0; axis < 2; axis++) {
		int start = (id[axis] - 1) * u_picture.z, size = min(u_picture.z, u_picture[axis] - start);
		bool first = id[axis] == 0, end = id[axis] == last[axis];
		pixel[axis] = first ? 0 : end ? u_picture[axis] - 1 : start + size / 2;
		position[axis] = first ? 0.0 : end ? float(u_picture[axis]) : float(start) + 0.5 * float(size);
	}
	put(position, vec2(0.0), depth(pixel), 0.0);
}

void start_group()
{
	if (gl_LocalInvocationIndex == 0u) {
		s_peak = 0u;
		s_key = KEY_NONE;
		s_moves = 0u;
		s_invalid = 0u;
	}
	memoryBarrierShared();
	barrier();
}

void finish_group()
{
	memoryBarrierShared();
	barrier();
}

void put_cell(cell at, bool snaps)
{
	if (s_moves != 0u)
		b_words[0] = 1u;
	if (s_invalid != 0u)
		atomicAdd(b_words[1], s_invalid);
	if (snaps)
		put_snapped(at.start + ivec2(s_key & 63u, s_key >> 6 & 63u));
	else
		put_mean(at);
}

void main()
{
	ivec2 id = ivec2(gl_WorkGroupID.xy) + ivec2(0, u_band.x), last = ivec2(int(gl_NumWorkGroups.x), u_band.y) - 1;
	bool border = id.x == 0 || id.y == 0 || id.x == last.x || id.y == last.y;
	cell at;
	at.start = max((id - 1) * u_picture.z, ivec2(0));
	at.size = border ? ivec2(0) : min(ivec2(u_picture.z), u_picture.xy - at.start);
	start_group();
	find_peak(at);
	finish_group();
	float peak = uintBitsToFloat(s_peak);
	bool snaps = !border && peak >= u_scale.z;
	if (snaps) {
		uint k = quantised(peak);
		find_place(at, float(k * k) / 16.0);
	}
	finish_group();
	if (gl_LocalInvocationIndex != 0u)
		return;
	if (border)
		put_border(id, last);
	else
		put_cell(at, snaps);
}
