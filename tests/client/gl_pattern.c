/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/client/gl_pattern.h"

#include <math.h>
#include <string.h>

#define MAX_PIXELS (WIDTH * HEIGHT)

/* Each pixel says where it is. */

static uint8_t color_at(uint32_t x, uint32_t y, uint32_t channel)
{
	const uint32_t values[4] = {x * 5 + 3, y * 9 + 1, x * y + 17, 255 - x};
	return (uint8_t)values[channel];
}

static float depth_at(uint32_t x, uint32_t y)
{
	return (float)(x + y * GEOMETRY_WIDTH) / (float)(GEOMETRY_WIDTH * GEOMETRY_HEIGHT - 1);
}

/* Exact as halves. */
static float motion_at(uint32_t x, uint32_t y, uint32_t channel)
{
	return channel ? (float)y * 0.5f - 2.25f : (float)x * -0.25f + 1.0f;
}

static uint32_t id_at(uint32_t x, uint32_t y)
{
	return (x * 7 + y * 3) % 251;
}

static GLuint make_texture(GLenum internal, GLsizei width, GLsizei height, GLenum format, GLenum type,
						   const void *pixels)
{
	GLuint texture = 0;

	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)internal, width, height, 0, format, type, pixels);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glBindTexture(GL_TEXTURE_2D, 0);
	return texture;
}

GLuint color_texture(GLenum internal)
{
	static uint8_t bytes[MAX_PIXELS * 4];
	static float floats[MAX_PIXELS * 4];
	static uint32_t tens[MAX_PIXELS];

	for (uint32_t i = 0; i < MAX_PIXELS; i++) {
		tens[i] = 0;
		for (uint32_t c = 0; c < 4; c++) {
			uint8_t value = color_at(i % WIDTH, i / WIDTH, c);
			bytes[i * 4 + c] = value;
			floats[i * 4 + c] = (float)value * 0.25f; /* exact as halves, beyond 1 */
			tens[i] |= (c < 3 ? (uint32_t)value * 4 + 1 : value & 3u) << (c * 10);
		}
	}
	switch (internal) {
	case GL_RGBA16F:
		return make_texture(internal, WIDTH, HEIGHT, GL_RGBA, GL_FLOAT, floats);
	case GL_RGB10_A2:
		return make_texture(internal, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV, tens);
	default:
		return make_texture(internal, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, bytes);
	}
}

GLuint depth_texture(GLenum internal)
{
	static float floats[MAX_PIXELS];
	bool red = internal == GL_R32F;

	for (uint32_t i = 0; i < GEOMETRY_WIDTH * GEOMETRY_HEIGHT; i++) {
		floats[i] = depth_at(i % GEOMETRY_WIDTH, i / GEOMETRY_WIDTH);
	}
	return make_texture(internal, GEOMETRY_WIDTH, GEOMETRY_HEIGHT, red ? GL_RED : GL_DEPTH_COMPONENT, GL_FLOAT, floats);
}

GLuint motion_texture(GLenum internal)
{
	static float floats[MAX_PIXELS * 2];

	for (uint32_t i = 0; i < GEOMETRY_WIDTH * GEOMETRY_HEIGHT * 2; i++) {
		floats[i] = motion_at(i / 2 % GEOMETRY_WIDTH, i / 2 / GEOMETRY_WIDTH, i % 2);
	}
	return make_texture(internal, GEOMETRY_WIDTH, GEOMETRY_HEIGHT, GL_RG, GL_FLOAT, floats);
}

GLuint id_texture(GLenum internal)
{
	static uint32_t words[MAX_PIXELS];
	static uint16_t shorts[MAX_PIXELS];
	static uint8_t bytes[MAX_PIXELS];
	GLenum type = internal == GL_R8UI ? GL_UNSIGNED_BYTE : internal == GL_R16UI ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
	const void *pixels = internal == GL_R8UI ? (void *)bytes : internal == GL_R16UI ? (void *)shorts : (void *)words;

	for (uint32_t i = 0; i < GEOMETRY_WIDTH * GEOMETRY_HEIGHT; i++) {
		words[i] = id_at(i % GEOMETRY_WIDTH, i / GEOMETRY_WIDTH);
		shorts[i] = (uint16_t)words[i];
		bytes[i] = (uint8_t)words[i];
	}
	return make_texture(internal, GEOMETRY_WIDTH, GEOMETRY_HEIGHT, GL_RED_INTEGER, type, pixels);
}

const void *pixel(const struct pursuit_plane *plane, const uint8_t *planes, uint32_t x, uint32_t y)
{
	return planes + plane->offset + plane->stride * y + (uint64_t)x * pursuit_format_bytes(plane->format);
}

static float half_value(uint16_t half)
{
	int exponent = half >> 10 & 31;
	float mantissa = (float)(half & 0x3ff);
	float value = exponent ? ldexpf(1024.0f + mantissa, exponent - 25) : ldexpf(mantissa, -24);
	return half & 0x8000 ? -value : value;
}

int wrong_colors(const struct pursuit_plane *plane, const uint8_t *planes, bool turned)
{
	static const uint32_t bgra[4] = {2, 1, 0, 3};
	int wrong = 0;

	for (uint32_t i = 0; i < MAX_PIXELS * 4; i++) {
		uint32_t x = i / 4 % WIDTH, y = i / 4 / WIDTH, c = i % 4;
		const void *at = pixel(plane, planes, x, y);
		uint8_t want = color_at(x, turned ? HEIGHT - 1 - y : y, c);
		uint32_t word;
		memcpy(&word, at, 4);
		switch (plane->format) {
		case PURSUIT_FORMAT_RGBA16F:
			wrong += half_value(((const uint16_t *)at)[c]) != (float)want * 0.25f;
			break;
		case PURSUIT_FORMAT_RGB10A2:
			wrong += (word >> (c * 10) & (c < 3 ? 1023u : 3u)) != (c < 3 ? want * 4u + 1u : want & 3u);
			break;
		default:
			wrong += ((const uint8_t *)at)[plane->format == PURSUIT_FORMAT_BGRA8 ? bgra[c] : c] != want;
		}
	}
	return wrong;
}

double worst_depth(const struct pursuit_plane *plane, const uint8_t *planes)
{
	double worst = 0;

	for (uint32_t i = 0; i < GEOMETRY_WIDTH * GEOMETRY_HEIGHT; i++) {
		uint32_t x = i % GEOMETRY_WIDTH, y = i / GEOMETRY_WIDTH, word = 0;
		const void *at = pixel(plane, planes, x, y);
		float single;
		memcpy(&word, at, pursuit_format_bytes(plane->format));
		memcpy(&single, &word, 4);
		double got = plane->format == PURSUIT_FORMAT_DEPTH32F
						 ? (double)single
						 : word / (plane->format == PURSUIT_FORMAT_DEPTH16 ? 65535.0 : 16777215.0);
		worst = fmax(worst, fabs(got - (double)depth_at(x, y)));
	}
	return worst;
}

int wrong_motion(const struct pursuit_plane *plane, const uint8_t *planes, bool turned, float sign)
{
	int wrong = 0;

	for (uint32_t i = 0; i < GEOMETRY_WIDTH * GEOMETRY_HEIGHT * 2; i++) {
		uint32_t x = i / 2 % GEOMETRY_WIDTH, y = i / 2 / GEOMETRY_WIDTH, c = i % 2;
		const void *at = pixel(plane, planes, x, y);
		float want = motion_at(x, turned ? GEOMETRY_HEIGHT - 1 - y : y, c) * (c ? sign : 1.0f);
		float got =
			plane->format == PURSUIT_FORMAT_RG16F ? half_value(((const uint16_t *)at)[c]) : ((const float *)at)[c];
		wrong += got != want;
	}
	return wrong;
}

int wrong_ids(const struct pursuit_plane *plane, const uint8_t *planes)
{
	int wrong = 0;

	for (uint32_t i = 0; i < GEOMETRY_WIDTH * GEOMETRY_HEIGHT; i++) {
		uint32_t x = i % GEOMETRY_WIDTH, y = i / GEOMETRY_WIDTH, got = 0;
		memcpy(&got, pixel(plane, planes, x, y), pursuit_format_bytes(plane->format));
		wrong += got != id_at(x, y);
	}
	return wrong;
}
