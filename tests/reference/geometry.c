/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Timing, effective displacement and normalised depth (docs/method.md, 1; Didyk et al. 2010, Section 6). */
#include "reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double seconds(uint64_t ns)
{
	return (double)ns * 1e-9;
}

void reference_timing(struct reference_timing *timing, const struct pursuit_frame_header *header,
					  const struct engine_begin_params *begin)
{
	/* proto/frame.h: a motion interval of 0 is the frame's real interval. */
	const uint64_t motion_ns = header->motion_interval_ns ? header->motion_interval_ns : header->real_interval_ns;
	const uint64_t real_ns = begin->real_interval_ns ? begin->real_interval_ns : header->real_interval_ns;

	timing->real_s = seconds(real_ns ? real_ns : motion_ns);
	timing->motion_s = seconds(motion_ns ? motion_ns : real_ns);
	timing->n = begin->n < 1 ? 1 : begin->n > 8 ? 8 : begin->n;
	timing->last_phase = begin->last_phase < 0.0 ? (timing->n - 1.0) / timing->n : begin->last_phase;
}

double reference_speed(double pixels, double time, double width, double display_width_mm, double distance_mm)
{
	const double degrees_per_pixel = atan(display_width_mm / width / distance_mm) * 180.0 / acos(-1.0);
	return pixels / time * degrees_per_pixel;
}

double reference_tracking(double degrees_per_second)
{
	return 1.0 - reference_smoothstep(70.0, 90.0, degrees_per_second);
}

static double clamp(double low, double high, double x)
{
	return x < low ? low : x > high ? high : x;
}

double reference_depth(uint32_t kind, double near_distance, double far_distance, double value)
{
	double z = 0.5;
	switch (kind) {
	case PURSUIT_DEPTH_DEVICE:
		z = value;
		break;
	case PURSUIT_DEPTH_DEVICE_REVERSED:
		z = 1.0 - value;
		break;
	case PURSUIT_DEPTH_LINEAR:
		if (near_distance > 0.0 && isinf(far_distance))
			z = value <= near_distance ? 0.0 : 1.0 - near_distance / value;
		else if (near_distance > 0.0 && far_distance > near_distance)
			z = (value - near_distance) / (far_distance - near_distance);
		else
			z = value / (1.0 + value);
		break;
	default:
		return z;
	}
	return isnan(z) ? 1.0 : clamp(0.0, 1.0, z);
}

/* Geometry pixel of a colour pixel. */
static const uint8_t *pixel_at(const struct pursuit_plane *plane, const uint8_t *data, uint32_t i, uint32_t j,
							   uint32_t width, uint32_t height)
{
	const uint64_t gi = (2 * (uint64_t)i + 1) * plane->width / (2 * (uint64_t)width);
	const uint64_t gj = (2 * (uint64_t)j + 1) * plane->height / (2 * (uint64_t)height);
	return data + gj * plane->stride + gi * pursuit_format_bytes(plane->format);
}

static double decode_depth(uint32_t format, const uint8_t *pixel)
{
	uint16_t short_value;
	uint32_t word;
	float single;
	switch (format) {
	case PURSUIT_FORMAT_DEPTH16:
		memcpy(&short_value, pixel, sizeof(short_value));
		return short_value / 65535.0;
	case PURSUIT_FORMAT_DEPTH24:
		memcpy(&word, pixel, sizeof(word));
		return (word & 0xffffffu) / 16777215.0;
	case PURSUIT_FORMAT_DEPTH32F:
		memcpy(&single, pixel, sizeof(single));
		return (double)single;
	default:
		abort();
	}
}

static void decode_motion(uint32_t format, const uint8_t *pixel, double m[2])
{
	uint16_t halves[2];
	float singles[2];
	for (int c = 0; c < 2; c++) {
		if (format == PURSUIT_FORMAT_RG16F) {
			memcpy(halves, pixel, sizeof(halves));
			m[c] = reference_half(halves[c]);
		} else {
			memcpy(singles, pixel, sizeof(singles));
			m[c] = (double)singles[c];
		}
	}
}

/* m to u; false if m is not finite. */
static bool displace(const struct reference_timing *timing, double width, double display_width_mm, double distance_mm,
					 const double m[2], double u[2])
{
	const double ratio = clamp(1.0 / 8.0, 8.0, timing->real_s / timing->motion_s);
	u[0] = u[1] = 0.0;
	if (!isfinite(m[0]) || !isfinite(m[1]))
		return false;
	const double mx = clamp(-65504.0, 65504.0, m[0]), my = clamp(-65504.0, 65504.0, m[1]);
	const double v = reference_speed(sqrt(mx * mx + my * my), timing->motion_s, width, display_width_mm, distance_mm);
	const double f = reference_tracking(v);
	u[0] = clamp(-16384.0, 16384.0, f * ratio * mx);
	u[1] = clamp(-16384.0, 16384.0, f * ratio * my);
	return true;
}

static void fill_depth(struct reference_geometry *geometry, const struct frame *frame)
{
	const struct pursuit_frame_header *header = &frame->header;
	const int index = frame_find_plane(header, PURSUIT_ROLE_DEPTH);
	geometry->has_depth = index >= 0;
	for (uint32_t j = 0; j < geometry->height; j++)
		for (uint32_t i = 0; i < geometry->width; i++) {
			double z = 0.5;
			if (index >= 0) {
				const struct pursuit_plane *plane = &header->planes[index];
				const uint8_t *pixel = pixel_at(plane, frame->planes[index], i, j, geometry->width, geometry->height);
				z = reference_depth(header->depth_kind, (double)header->near_distance, (double)header->far_distance,
									decode_depth(plane->format, pixel));
			}
			geometry->z[(size_t)j * geometry->width + i] = z;
		}
}

void reference_geometry_init(struct reference_geometry *geometry, const struct frame *frame,
							 const struct reference_timing *timing, double display_width_mm, double distance_mm)
{
	const struct pursuit_frame_header *header = &frame->header;
	const struct pursuit_plane *color = &header->planes[frame_find_plane(header, PURSUIT_ROLE_COLOR)];
	const int index = frame_find_plane(header, PURSUIT_ROLE_MOTION);
	const size_t count = (size_t)color->width * color->height;
	const bool rests =
		index < 0 || (header->flags & (PURSUIT_FRAME_CUT | PURSUIT_FRAME_MOTION_INVALID)) || !(timing->real_s > 0.0);

	reference_geometry_finish(geometry);
	geometry->width = color->width;
	geometry->height = color->height;
	geometry->ux = reference_alloc(count, sizeof(double));
	geometry->uy = reference_alloc(count, sizeof(double));
	geometry->z = reference_alloc(count, sizeof(double));
	fill_depth(geometry, frame);
	geometry->known = !rests && header->motion_kind == PURSUIT_MOTION_BACKWARD;
	if (rests)
		return;
	for (uint32_t j = 0; j < color->height; j++)
		for (uint32_t i = 0; i < color->width; i++) {
			const size_t at = (size_t)j * color->width + i;
			const struct pursuit_plane *plane = &header->planes[index];
			double m[2], u[2];
			decode_motion(plane->format, pixel_at(plane, frame->planes[index], i, j, color->width, color->height), m);
			if (!displace(timing, color->width, display_width_mm, distance_mm, m, u))
				geometry->invalid++;
			geometry->ux[at] = u[0];
			geometry->uy[at] = u[1];
			geometry->moves |= u[0] != 0.0 || u[1] != 0.0;
		}
}

void reference_geometry_stop(struct reference_geometry *geometry)
{
	for (size_t i = 0; i < (size_t)geometry->width * geometry->height; i++)
		geometry->ux[i] = geometry->uy[i] = 0.0;
	geometry->moves = false;
}

void reference_geometry_finish(struct reference_geometry *geometry)
{
	free(geometry->ux);
	free(geometry->uy);
	free(geometry->z);
	*geometry = (struct reference_geometry){0};
}
