/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "materials.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "maths.h"

struct texel {
	float r, g, b, a;
};

static float clamp01(float x)
{
	return x < 0.0f ? 0.0f : x > 1.0f ? 1.0f : x;
}

static float smooth(float low, float high, float x)
{
	float t = clamp01((x - low) / (high - low));
	return t * t * (3.0f - 2.0f * t);
}

static float mixf(float a, float b, float t)
{
	return a + (b - a) * t;
}

static int wrap(int x, int period)
{
	while (x >= period)
		x -= period;
	while (x < 0)
		x += period;
	return x;
}

static float lattice(int x, int y, uint32_t seed)
{
	uint32_t h = (uint32_t)x * 0x9e3779b1u ^ (uint32_t)y * 0x85ebca77u ^ seed * 0xc2b2ae3du;
	h = (h ^ (h >> 15)) * 0x2c1b3c6du;
	h = (h ^ (h >> 12)) * 0x297a2d39u;
	return (float)(h >> 8) * (1.0f / 16777216.0f);
}

/* Value noise that repeats after u = 1 and v = 1, with period_x by period_y lattice points. */
static float noise(float u, float v, int period_x, int period_y, uint32_t seed)
{
	float x = u * (float)period_x, y = v * (float)period_y;
	float fx = floorf(x), fy = floorf(y);
	int x0 = wrap((int)fx, period_x), y0 = wrap((int)fy, period_y);
	int x1 = x0 + 1 == period_x ? 0 : x0 + 1, y1 = y0 + 1 == period_y ? 0 : y0 + 1;
	float tx = x - fx, ty = y - fy;
	tx = tx * tx * (3.0f - 2.0f * tx);
	ty = ty * ty * (3.0f - 2.0f * ty);
	float low = mixf(lattice(x0, y0, seed), lattice(x1, y0, seed), tx);
	float high = mixf(lattice(x0, y1, seed), lattice(x1, y1, seed), tx);
	return mixf(low, high, ty);
}

static float fbm(float u, float v, int period_x, int period_y, int octaves, uint32_t seed)
{
	float sum = 0.0f, weight = 0.5f, total = 0.0f;
	for (int i = 0; i < octaves; i++) {
		sum += weight * noise(u, v, period_x << i, period_y << i, seed + (uint32_t)i * 101u);
		total += weight;
		weight *= 0.55f;
	}
	return sum / total;
}

static struct texel shade(float r, float g, float b, float s)
{
	return (struct texel){r * s, g * s, b * s, 1.0f};
}

/* A masonry pattern: which block, and the distance to its joint in the unit of v. */
struct block {
	uint32_t id;
	float edge;
	float x, y;
};

static struct block masonry(float u, float v, int columns, int rows, float offset)
{
	float y = v * (float)rows;
	int row = (int)floorf(y);
	float x = u * (float)columns + ((row & 1) ? offset : 0.0f);
	int column = (int)floorf(x);
	struct block block;
	block.x = x - floorf(x);
	block.y = y - floorf(y);
	float dx = fminf(block.x, 1.0f - block.x) * (float)rows / (float)columns;
	float dy = fminf(block.y, 1.0f - block.y);
	block.edge = fminf(dx, dy);
	block.id = scene_hash2((uint32_t)((column + columns) % columns), (uint32_t)row + 77u);
	return block;
}

static float block_random(struct block block, uint32_t seed)
{
	return (float)scene_random(block.id, seed);
}

static struct texel plain(float u, float v)
{
	float n = fbm(u, v, 16, 16, 5, 1);
	return shade(0.94f, 0.94f, 0.94f, 0.86f + 0.2f * n);
}

static struct texel ashlar(float u, float v)
{
	float wobble = (fbm(u, v, 32, 32, 3, 5) - 0.5f) * 0.008f;
	struct block block = masonry(u + wobble, v + wobble, 2, 4, 0.5f);
	float grain = fbm(u, v, 24, 24, 5, 2), stain = fbm(u, v, 3, 3, 4, 3);
	float pit = smooth(0.66f, 0.8f, noise(u, v, 90, 90, 4));
	float joint = smooth(0.012f, 0.045f, block.edge);
	float bevel = smooth(0.03f, 0.12f, block.y) * 0.1f - smooth(0.88f, 0.97f, block.y) * -0.08f;
	float s = (0.74f + 0.26f * grain + bevel) * (0.86f + 0.2f * block_random(block, 1)) * (0.84f + 0.3f * stain);
	s *= (0.5f + 0.5f * joint) * (1.0f - 0.22f * pit);
	float warm = block_random(block, 2) * 0.05f;
	return shade(0.97f + warm, 0.90f, 0.78f - warm, s);
}

static struct texel brick(float u, float v)
{
	float wobble = (fbm(u, v, 48, 48, 2, 15) - 0.5f) * 0.004f;
	struct block block = masonry(u + wobble, v + wobble, 8, 24, 0.5f);
	float grain = fbm(u, v, 64, 64, 3, 12), stain = fbm(u, v, 4, 4, 4, 13);
	float joint = smooth(0.06f, 0.16f, block.edge);
	float tone = block_random(block, 1);
	float s =
		(0.7f + 0.4f * grain) * (0.75f + 0.35f * tone) * (0.8f + 0.3f * stain) + 0.12f * smooth(0.6f, 0.9f, block.y);
	struct texel clay = shade(0.80f, 0.47f + 0.1f * block_random(block, 2), 0.38f, s);
	struct texel mortar = shade(0.76f, 0.73f, 0.67f, 0.7f + 0.3f * grain);
	return (struct texel){mixf(mortar.r, clay.r, joint), mixf(mortar.g, clay.g, joint), mixf(mortar.b, clay.b, joint),
						  1};
}

static struct texel paving(float u, float v)
{
	float wobble = (fbm(u, v, 24, 24, 3, 25) - 0.5f) * 0.012f;
	struct block block = masonry(u + wobble, v - wobble, 3, 4, 0.5f);
	float grain = fbm(u, v, 40, 40, 4, 22), stain = fbm(u, v, 4, 4, 4, 23);
	float joint = smooth(0.015f, 0.05f, block.edge);
	float crack = smooth(0.012f, 0.0f, fabsf(fbm(u, v, 5, 5, 4, 27) - 0.5f));
	float s = (0.68f + 0.36f * grain) * (0.78f + 0.34f * block_random(block, 1)) * (0.8f + 0.35f * stain);
	s *= (0.45f + 0.55f * joint) * (1.0f - 0.25f * crack);
	float warm = block_random(block, 3) * 0.1f;
	return shade(0.86f + warm, 0.82f, 0.78f - warm, s);
}

static struct texel marble(float u, float v)
{
	float warp = fbm(u, v, 4, 4, 5, 31);
	float vein = 1.0f - smooth(0.0f, 0.06f, fabsf(fbm(u + warp * 0.3f, v + warp * 0.3f, 4, 4, 4, 32) - 0.5f));
	float grain = fbm(u, v, 64, 64, 3, 33);
	float s = 0.86f + 0.12f * warp - 0.22f * vein + 0.1f * (grain - 0.5f);
	return shade(0.98f, 0.95f, 0.90f, s);
}

static struct texel plaster(float u, float v)
{
	float grain = fbm(u, v, 48, 48, 4, 41), stain = fbm(u, v, 3, 3, 5, 42);
	float trowel = fbm(u, v, 6, 20, 3, 43);
	return shade(0.96f, 0.93f, 0.87f, 0.70f + 0.16f * grain + 0.14f * stain + 0.08f * trowel);
}

static struct texel wood(float u, float v)
{
	int plank = (int)floorf(u * 4.0f);
	float x = u * 4.0f - (float)plank, edge = fminf(x, 1.0f - x);
	float shift = (float)scene_random((uint32_t)plank, 51u);
	float bend = fbm(u, v, 8, 3, 3, 52u) * 1.2f;
	float ring = noise(u + bend * 0.03f, v + shift, 128, 6, 53u);
	float grain = noise(u, v + shift, 256, 24, 54u);
	float knot = noise(u, v, 8, 5, 55u);
	float s = (0.62f + 0.26f * ring + 0.16f * grain) * (0.8f + 0.3f * (float)scene_random((uint32_t)plank, 56u));
	s *= (0.45f + 0.55f * smooth(0.01f, 0.035f, edge)) * (1.0f - 0.3f * smooth(0.86f, 0.96f, knot));
	return shade(0.90f, 0.68f, 0.47f, s);
}

static struct texel bark(float u, float v)
{
	float mark = noise(u, v, 10, 70, 61u) * 0.6f + noise(u, v, 28, 60, 62u) * 0.4f;
	float big = smooth(0.64f, 0.72f, fbm(u, v, 5, 9, 3, 63u));
	float dark = fmaxf(smooth(0.66f, 0.76f, mark), big);
	float grain = fbm(u, v, 24, 48, 4, 64u);
	float s = mixf(0.84f + 0.2f * (grain - 0.3f), 0.30f + 0.2f * grain, dark);
	return shade(0.96f, 0.93f, 0.86f, s);
}

static struct texel grass(float u, float v)
{
	float blades = noise(u, v, 170, 60, 71u) * 0.5f + noise(u, v, 60, 170, 72u) * 0.5f;
	float patch = fbm(u, v, 4, 4, 5, 73u), dry = smooth(0.45f, 0.75f, fbm(u, v, 6, 6, 4, 74u));
	float leaf = smooth(0.78f, 0.86f, noise(u, v, 70, 70, 75u));
	float s = 0.42f + 0.5f * blades * (0.6f + 0.6f * patch);
	struct texel t = shade(mixf(0.62f, 0.86f, dry), mixf(0.80f, 0.78f, dry), mixf(0.34f, 0.44f, dry), s);
	t.r = mixf(t.r, 0.72f, leaf * 0.6f);
	t.g = mixf(t.g, 0.56f, leaf * 0.6f);
	t.b = mixf(t.b, 0.28f, leaf * 0.6f);
	return t;
}

static struct texel fabric(float u, float v)
{
	float weave = 0.5f + 0.25f * sinf(u * 628.3185f) + 0.25f * sinf(v * 628.3185f);
	float fold = fbm(u, v, 6, 2, 3, 81u), thread = noise(u, v, 180, 12, 82u);
	float band = smooth(0.47f, 0.49f, fabsf(v - 0.5f)) + smooth(0.012f, 0.006f, fabsf(fabsf(v - 0.5f) - 0.42f));
	float diamond = fabsf(fmodf(u * 8.0f, 1.0f) - 0.5f) + fabsf(fmodf(v * 8.0f, 1.0f) - 0.5f);
	float pattern = smooth(0.30f, 0.34f, diamond) - smooth(0.40f, 0.44f, diamond);
	float s = (0.70f + 0.14f * weave + 0.1f * thread + 0.16f * (fold - 0.5f)) *
			  (1.0f + 0.4f * clamp01(band + pattern * 0.7f));
	return shade(0.86f, 0.86f, 0.86f, s);
}

static struct texel paint(float u, float v)
{
	float grain = fbm(u, v, 24, 24, 4, 91u), streak = fbm(u, v, 24, 2, 4, 92u);
	float x = fminf(fabsf(u - 0.12f), fabsf(u - 0.88f)), y = fabsf(fmodf(v * 8.0f, 1.0f) - 0.5f) / 8.0f;
	float d = sqrtf(x * x + y * y);
	float rivet = smooth(0.034f, 0.028f, d), ring = smooth(0.05f, 0.035f, d) - rivet;
	float s = 0.72f + 0.2f * grain + 0.16f * (streak - 0.5f) + 0.2f * rivet - 0.3f * ring;
	float rust = smooth(0.6f, 0.75f, fbm(u, v, 8, 5, 5, 93u));
	return (struct texel){mixf(s, 0.62f, rust * 0.5f), mixf(s, 0.42f, rust * 0.5f), mixf(s, 0.30f, rust * 0.5f), 1.0f};
}

static struct texel sand(float u, float v)
{
	float bend = fbm(u, v, 4, 4, 4, 101u);
	float ripple = 0.5f + 0.5f * sinf((v * 14.0f + bend * 2.2f) * 6.2831853f);
	float grain = fbm(u, v, 96, 96, 2, 102u), patch = fbm(u, v, 3, 3, 5, 103u);
	float stone = smooth(0.86f, 0.9f, noise(u, v, 80, 80, 104u));
	float s = 0.70f + 0.08f * ripple + 0.2f * (grain - 0.5f) + 0.24f * patch - 0.3f * stone;
	return shade(0.97f, 0.84f, 0.64f, s);
}

static struct texel fur(float u, float v)
{
	float strand = noise(u, v, 150, 26, 111u) * 0.6f + noise(u, v, 250, 40, 112u) * 0.4f;
	float patch = fbm(u, v, 5, 5, 4, 113u);
	float s = 0.5f + 0.42f * strand + 0.24f * (patch - 0.4f);
	return shade(0.98f, 0.92f, 0.82f, s);
}

static struct texel clouds(float u, float v)
{
	float cover = fbm(u, v, 4, 4, 7, 121u);
	cover = smooth(0.46f, 0.72f, cover) * 0.9f;
	return (struct texel){cover, cover, cover, 1.0f};
}

static struct texel facade(float u, float v)
{
	struct block block = masonry(u, v, 4, 4, 0.0f);
	float x = fabsf(block.x - 0.5f), y = fabsf(block.y - 0.52f);
	float window = smooth(0.31f, 0.295f, x) * smooth(0.34f, 0.325f, y);
	float bar = smooth(0.012f, 0.02f, fabsf(block.x - 0.5f)) * smooth(0.012f, 0.02f, fabsf(block.y - 0.6f));
	float grain = fbm(u, v, 48, 48, 3, 131u), lit = block_random(block, 3);
	float wall = (0.66f + 0.2f * grain) * (1.0f - 0.25f * smooth(0.9f, 0.97f, block.y));
	float glass = (0.22f + 0.24f * block.y + 0.2f * block_random(block, 4)) * (0.45f + 0.55f * bar);
	struct texel pane = lit > 0.62f ? shade(1.0f, 0.86f, 0.55f, 0.6f + 0.4f * bar) : shade(0.72f, 0.86f, 1.0f, glass);
	return (struct texel){mixf(wall, pane.r, window), mixf(wall * 0.96f, pane.g, window),
						  mixf(wall * 0.9f, pane.b, window), 1.0f};
}

static struct texel asphalt(float u, float v)
{
	float grain = noise(u, v, 200, 200, 141u), patch = fbm(u, v, 5, 5, 5, 142u);
	float stone = smooth(0.8f, 0.9f, noise(u, v, 120, 120, 143u));
	return shade(0.62f, 0.63f, 0.66f, 0.55f + 0.25f * grain + 0.3f * (patch - 0.4f) + 0.25f * stone);
}

static struct texel grid(float u, float v)
{
	struct block block = masonry(u, v, 4, 4, 0.0f);
	float grain = fbm(u, v, 32, 32, 4, 151u), line = smooth(0.035f, 0.02f, block.edge);
	float s = (0.5f + 0.3f * grain) * (0.75f + 0.4f * block_random(block, 1));
	float hatch = smooth(0.38f, 0.42f, fabsf(fmodf((block.x + block.y) * 5.0f, 1.0f) - 0.5f));
	if (block_random(block, 2) > 0.7f)
		s *= 0.8f + 0.35f * hatch;
	return (struct texel){mixf(s, 0.9f, line), mixf(s, 0.97f, line), mixf(s * 1.1f, 1.0f, line), 1.0f};
}

typedef struct texel (*painter)(float u, float v);

static const painter painters[MATERIAL_COUNT] = {
	[MATERIAL_PLAIN] = plain,   [MATERIAL_ASHLAR] = ashlar,   [MATERIAL_BRICK] = brick,   [MATERIAL_PAVING] = paving,
	[MATERIAL_MARBLE] = marble, [MATERIAL_PLASTER] = plaster, [MATERIAL_WOOD] = wood,     [MATERIAL_BARK] = bark,
	[MATERIAL_GRASS] = grass,   [MATERIAL_FABRIC] = fabric,   [MATERIAL_PAINT] = paint,   [MATERIAL_SAND] = sand,
	[MATERIAL_FUR] = fur,       [MATERIAL_CLOUDS] = clouds,   [MATERIAL_FACADE] = facade, [MATERIAL_ASPHALT] = asphalt,
	[MATERIAL_GRID] = grid,
};

static void put(uint8_t *pixel, struct texel t)
{
	pixel[0] = (uint8_t)(clamp01(t.r) * 255.0f + 0.5f);
	pixel[1] = (uint8_t)(clamp01(t.g) * 255.0f + 0.5f);
	pixel[2] = (uint8_t)(clamp01(t.b) * 255.0f + 0.5f);
	pixel[3] = (uint8_t)(clamp01(t.a) * 255.0f + 0.5f);
}

/* One leaf: a pointed ellipse with a midrib, wrapped around the borders. */
static void paint_leaf(uint8_t *pixels, float cx, float cy, float length, float angle, float tone)
{
	float c = cosf(angle), s = sinf(angle);
	int reach = (int)length + 1;
	for (int y = -reach; y <= reach; y++) {
		for (int x = -reach; x <= reach; x++) {
			float along = ((float)x * c + (float)y * s) / length, across = ((float)y * c - (float)x * s) / length;
			float width = 0.42f * (1.0f - along * along) * (1.0f - 0.25f * along);
			if (fabsf(along) >= 1.0f || fabsf(across) >= width)
				continue;
			uint32_t px = (uint32_t)((int)cx + x) & (MATERIAL_SIZE - 1),
					 py = (uint32_t)((int)cy + y) & (MATERIAL_SIZE - 1);
			float rib = smooth(0.05f, 0.02f, fabsf(across));
			float vein = 0.06f * sinf((along * 9.0f - fabsf(across) * 9.0f) * 3.0f);
			float light = tone * (0.86f + 0.3f * across / width * 0.5f + vein) + 0.12f * rib;
			put(pixels + (py * MATERIAL_SIZE + px) * 4, shade(0.86f, 0.92f, 0.50f, light));
		}
	}
}

static void leaves(uint8_t *pixels)
{
	for (uint32_t i = 0; i < MATERIAL_SIZE * MATERIAL_SIZE; i++)
		memcpy(pixels + i * 4, (const uint8_t[4]){118, 130, 62, 0}, 4);
	for (uint32_t i = 0; i < 54; i++) {
		double x = scene_random(i, 161u), y = scene_random(i, 162u);
		if (hypot(x - 0.5, y - 0.5) > 0.47)
			continue;
		paint_leaf(pixels, (float)(48.0 + x * 416.0), (float)(48.0 + y * 416.0),
				   (float)(30.0 + 16.0 * scene_random(i, 163u)), (float)(scene_random(i, 164u) * 6.28318),
				   (float)(0.62 + 0.38 * (double)i / 54.0));
	}
}

static void tuft(uint8_t *pixels)
{
	for (uint32_t i = 0; i < MATERIAL_SIZE * MATERIAL_SIZE; i++)
		memcpy(pixels + i * 4, (const uint8_t[4]){120, 140, 66, 0}, 4);
	for (uint32_t i = 0; i < 46; i++) {
		float root = (float)(90.0 + 330.0 * scene_random(i, 171u)),
			  lean = (float)((scene_random(i, 172u) - 0.5) * 260.0);
		float height = (float)(220.0 + 270.0 * scene_random(i, 173u)),
			  tone = (float)(0.55 + 0.45 * scene_random(i, 174u));
		for (int y = 0; y < (int)height; y++) {
			float t = (float)y / height, width = 13.0f * (1.0f - t * t) + 1.0f, x = root + lean * t * t;
			for (int k = (int)-width; k <= (int)width; k++) {
				int px = (int)x + k;
				if (px < 0 || px >= MATERIAL_SIZE)
					continue;
				float light = tone * (0.5f + 0.5f * t) * (1.0f - 0.3f * fabsf((float)k) / width);
				put(pixels + (y * MATERIAL_SIZE + px) * 4, shade(0.80f, 0.96f, 0.46f, light));
			}
		}
	}
}

void material_fill(enum material material, uint8_t *pixels)
{
	if (material == MATERIAL_LEAVES) {
		leaves(pixels);
		return;
	}
	if (material == MATERIAL_TUFT) {
		tuft(pixels);
		return;
	}
	for (uint32_t y = 0; y < MATERIAL_SIZE; y++) {
		for (uint32_t x = 0; x < MATERIAL_SIZE; x++) {
			float u = ((float)x + 0.5f) / MATERIAL_SIZE, v = ((float)y + 0.5f) / MATERIAL_SIZE;
			put(pixels + (y * MATERIAL_SIZE + x) * 4, painters[material](u, v));
		}
	}
}

double material_coverage(const uint8_t *pixels, uint32_t size)
{
	uint32_t kept = 0, count = size * size;
	for (uint32_t i = 0; i < count; i++)
		kept += pixels[i * 4 + 3] >= 128;
	return (double)kept / (double)count;
}

static double scaled_coverage(const uint8_t *pixels, uint32_t count, double scale)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < count; i++)
		kept += (double)pixels[i * 4 + 3] * scale >= 127.5;
	return (double)kept / (double)count;
}

static void keep_coverage(uint8_t *pixels, uint32_t count, double coverage)
{
	double low = 0.0, high = 8.0;
	for (int i = 0; i < 12; i++) {
		double middle = 0.5 * (low + high);
		if (scaled_coverage(pixels, count, middle) < coverage)
			low = middle;
		else
			high = middle;
	}
	for (uint32_t i = 0; i < count; i++)
		pixels[i * 4 + 3] = (uint8_t)fmin(255.0, (double)pixels[i * 4 + 3] * high);
}

void material_halve(uint8_t *pixels, uint32_t size, double coverage)
{
	uint32_t half = size / 2;
	for (uint32_t y = 0; y < half; y++) {
		for (uint32_t x = 0; x < half; x++) {
			const uint8_t *a = pixels + (2 * y * size + 2 * x) * 4, *b = a + size * 4;
			uint8_t sum[4];
			for (int c = 0; c < 4; c++)
				sum[c] = (uint8_t)((a[c] + a[4 + c] + b[c] + b[4 + c] + 2) / 4);
			memcpy(pixels + (y * half + x) * 4, sum, 4);
		}
	}
	if (coverage < 1.0)
		keep_coverage(pixels, half * half, coverage);
}
