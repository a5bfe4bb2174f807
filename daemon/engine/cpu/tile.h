/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * One tile of the displaced picture (docs/method.md, 3): first each triangle
 * writes where its pixels come from, then all pixels are sampled. Compiled once
 * per level by the level_*.c that include it; each defines, above this include,
 *
 *   put_span(x, y, span)                 coordinates of a span of pixels
 *   sample_row(canvas, x, y, count, out) bilinear samples
 *   shift_row(upper, lower, fx, fy, count, out)  the same where all move alike
 *   mix_row(out, low, tear, count)       fades to L
 *
 * No cracks: where an edge crosses a row is computed once per edge and row from
 * its upper end, by both triangles alike, and each triangle of the row covers
 * from where one of its edges crosses to where another does, whichever side
 * they are on. So along a row the signed coverage of all triangles is that of
 * the fixed border, one, whatever is rounded; those that turn over cover less
 * than nothing and are not drawn, so that others cover more than once.
 */

#include <math.h>
#include <string.h>

#define FRACTION 4294967296.0 /* fixed point: 32 bits after the point */
#define LARGEST_SLOPE 1048576.0
#define LARGEST_BASE 268435456.0

/* A corner: displaced place within the tile, source place in the picture. */
struct corner {
	double x, y, sx, sy;
};

/* A linear function of the place within the tile, fixed point. */
struct ramp {
	int64_t base, dx, dy; /* base: at the centre of the tile's first pixel */
};

/* Where an edge crosses the centres of rows: the first pixel whose centre is not left of it. */
struct crossing {
	int64_t at, step;
};

/* A triangle within a tile. */
struct shape {
	struct corner corners[3];
	struct ramp x, y;
	double z, zx, zy; /* depth at the tile's origin, and how it changes */
	float z_least, z_most;
	bool deep; /* settled by depth */
	int16_t tear;
};

/* A run of pixels of one row. */
struct span {
	uint32_t count;
	int32_t x, y, dx, dy;
};

static inline int64_t fixed(double value, double limit)
{
	value = value < limit ? value : limit;
	value = value > -limit ? value : -limit;
	return (int64_t)(value * FRACTION);
}

/* The first row whose centre is not above y; within 0 to TILE_HEIGHT. */
static inline int32_t first_row(double y)
{
	y = y > 0.0 ? y : 0.0;
	y = y < (double)TILE_HEIGHT ? y : (double)TILE_HEIGHT;
	/* Upwards: y - 0.5 is at least -0.5. */
	int32_t row = (int32_t)(y + 0.5);
	return (double)row + 0.5 < y ? row + 1 : (double)row - 0.5 >= y ? row - 1 : row;
}

/* `a` above `b`; the crossing of the row `row`, which is between them. */
static inline struct crossing cross(const struct corner *a, const struct corner *b, int32_t first, int32_t row)
{
	double slope = (b->x - a->x) / (b->y - a->y);
	double at = a->x + ((double)first + 0.5 - a->y) * slope;
	/* Rounded up from half a pixel before. */
	const int64_t half_up = (INT64_C(1) << 31) - 1;
	struct crossing crossing = {fixed(at, LARGEST_BASE) + half_up, fixed(slope, LARGEST_SLOPE)};
	crossing.at += (row - first) * crossing.step;
	return crossing;
}

static inline int32_t column_of(int64_t at)
{
	int64_t column = at >> 32;
	return column < 0 ? 0 : column > (int64_t)TILE_WIDTH ? (int32_t)TILE_WIDTH : (int32_t)column;
}

/* Writes a span where it is nearer than what is there. */
static inline void put_deep(struct scene_scratch *scratch, const struct shape *shape, uint32_t row, uint32_t column,
							const struct span *span)
{
	uint32_t at = row * TILE_WIDTH + column;
	float start = (float)(shape->z + shape->zx * ((double)column + 0.5) + shape->zy * ((double)row + 0.5));
	const float step = (float)shape->zx, least = shape->z_least, most = shape->z_most;
	for (uint32_t i = 0; i < span->count; i++) {
		float z = start + step * (float)i;
		z = z > least ? z : least;
		z = z < most ? z : most;
		if (!(z < scratch->depth[at + i]))
			continue;
		scratch->depth[at + i] = z;
		scratch->x[at + i] = (int32_t)((uint32_t)span->x + i * (uint32_t)span->dx);
		scratch->y[at + i] = (int32_t)((uint32_t)span->y + i * (uint32_t)span->dy);
		scratch->tear[at + i] = shape->tear;
	}
}

/* The rows from `row` to `end` between two edges. */
static inline void put_rows(struct scene_scratch *scratch, const struct shape *shape, int32_t row, int32_t end,
							struct crossing left, struct crossing right)
{
	struct span span = {.dx = (int32_t)(shape->x.dx >> 16), .dy = (int32_t)(shape->y.dx >> 16)};
	int64_t x = shape->x.base + row * shape->x.dy, y = shape->y.base + row * shape->y.dy;
	for (; row < end; row++) {
		int32_t first = column_of(left.at), last = column_of(right.at);
		if (first < last) {
			uint32_t at = (uint32_t)row * TILE_WIDTH + (uint32_t)first;
			span.count = (uint32_t)(last - first);
			span.x = (int32_t)((x + first * shape->x.dx) >> 16);
			span.y = (int32_t)((y + first * shape->y.dx) >> 16);
			if (shape->deep) {
				put_deep(scratch, shape, (uint32_t)row, (uint32_t)first, &span);
			} else {
				put_span(scratch->x + at, scratch->y + at, &span);
				if (shape->tear)
					for (uint32_t i = 0; i < span.count; i++)
						scratch->tear[at + i] = shape->tear;
			}
		}
		left.at += left.step;
		right.at += right.step;
		x += shape->x.dy;
		y += shape->y.dy;
	}
}

/* Corners from the top; false if that was an odd permutation. */
static inline bool sort_corners(const struct corner **a, const struct corner **b, const struct corner **c)
{
	const struct corner *swap;
	bool even = true;
#define SORT(p, q)           \
	if ((*q)->y < (*p)->y) { \
		swap = *p;           \
		*p = *q;             \
		*q = swap;           \
		even = !even;        \
	}
	SORT(a, b)
	SORT(b, c)
	SORT(a, b)
#undef SORT
	return even;
}

static inline void put_shape(struct scene_scratch *scratch, const struct shape *shape)
{
	const struct corner *top = &shape->corners[0], *middle = &shape->corners[1], *bottom = &shape->corners[2];
	bool even = sort_corners(&top, &middle, &bottom);
	int32_t begin = first_row(top->y), turn = first_row(middle->y), end = first_row(bottom->y);
	if (begin < turn) {
		struct crossing whole = cross(top, bottom, begin, begin), part = cross(top, middle, begin, begin);
		put_rows(scratch, shape, begin, turn, even ? whole : part, even ? part : whole);
	}
	if (turn < end) {
		struct crossing whole = cross(top, bottom, begin, turn), part = cross(middle, bottom, turn, turn);
		put_rows(scratch, shape, turn, end, even ? whole : part, even ? part : whole);
	}
}

struct place {
	double left, top; /* of the tile */
};

static inline struct corner corner_of(const struct scene *scene, uint32_t index, const struct place *place)
{
	const struct plan_vertex *vertex = &scene->mesh->plan->vertices[index];
	return (struct corner){(double)scene->x[index] - place->left, (double)scene->y[index] - place->top,
						   (double)vertex->x, (double)vertex->y};
}

/* A value at each corner as a function of the place. */
struct slope {
	double x, y;
};

static inline struct slope slope_of(const struct shape *shape, double inverse, double along1, double along2)
{
	const struct corner *c = shape->corners;
	double x1 = c[1].x - c[0].x, y1 = c[1].y - c[0].y, x2 = c[2].x - c[0].x, y2 = c[2].y - c[0].y;
	return (struct slope){(along1 * y2 - along2 * y1) * inverse, (along2 * x1 - along1 * x2) * inverse};
}

static inline struct ramp ramp_of(const struct shape *shape, double inverse, double s0, double s1, double s2)
{
	const struct corner *origin = &shape->corners[0];
	struct slope slope = slope_of(shape, inverse, s1 - s0, s2 - s0);
	/* Texel centres lie at halves. */
	double base = s0 - 0.5 + slope.x * (0.5 - origin->x) + slope.y * (0.5 - origin->y);
	return (struct ramp){fixed(base, LARGEST_BASE), fixed(slope.x, LARGEST_SLOPE), fixed(slope.y, LARGEST_SLOPE)};
}

static inline void find_depth(const struct scene *scene, const uint32_t *index, double inverse, struct shape *shape)
{
	const struct plan_vertex *vertices = scene->mesh->plan->vertices;
	float a = vertices[index[0]].z, b = vertices[index[1]].z, c = vertices[index[2]].z;
	struct slope slope = slope_of(shape, inverse, (double)b - (double)a, (double)c - (double)a);
	shape->zx = slope.x;
	shape->zy = slope.y;
	shape->z = (double)a - slope.x * shape->corners[0].x - slope.y * shape->corners[0].y;
	shape->z_least = a < b ? a < c ? a : c : b < c ? b : c;
	shape->z_most = a > b ? a > c ? a : c : b > c ? b : c;
}

/* By its list; with the order kept, torn ones are among the folded. */
static inline bool may_tear(const struct warp_mesh *mesh, uint32_t triangle)
{
	return triangle >= mesh->torn.first &&
		   (triangle < mesh->folded.first || triangle >= mesh->folded_torn.first || mesh->keep_order);
}

static inline void put_triangle(const struct scene *scene, struct scene_scratch *scratch, uint32_t triangle,
								const struct place *place)
{
	const struct warp_mesh *mesh = scene->mesh;
	const uint32_t *index = mesh->lists + triangle;
	struct shape shape;
	for (int i = 0; i < 3; i++)
		shape.corners[i] = corner_of(scene, index[i], place);
	const struct corner *c = shape.corners;
	double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[1].y - c[0].y) * (c[2].x - c[0].x);
	/* What turns over covers nothing; what is nearly flat is left to the crossings. */
	if (area < -1e-3)
		return;
	double inverse = area > 1e-12 ? 1.0 / area : 0.0;
	shape.x = ramp_of(&shape, inverse, c[0].sx, c[1].sx, c[2].sx);
	shape.y = ramp_of(&shape, inverse, c[0].sy, c[1].sy, c[2].sy);
	shape.deep = triangle >= mesh->folded.first;
	shape.tear = 0;
	if (shape.deep)
		find_depth(scene, index, inverse, &shape);
	if (scene->tears && may_tear(mesh, triangle))
		shape.tear = (int16_t)(warp_mesh_tear(mesh, index, scene->phase) * (1 << TEAR_BITS) + 0.5);
	put_shape(scratch, &shape);
}

/* The triangles of a tile. */
struct bin {
	const uint32_t *triangles;
	uint32_t count;
};

/* Whether all that the tile may show moves alike, and how. */
static inline bool is_uniform(const struct scene *scene, const struct bin *bin, float *ux, float *uy)
{
	const struct plan_vertex *vertices = scene->mesh->plan->vertices;
	const uint32_t *lists = scene->mesh->lists;
	const float tolerance = scene->tolerance;
	*ux = vertices[lists[bin->triangles[0]]].ux;
	*uy = vertices[lists[bin->triangles[0]]].uy;
	for (uint32_t i = 0; i < bin->count; i++)
		for (uint32_t k = 0; k < 3; k++) {
			const struct plan_vertex *vertex = &vertices[lists[bin->triangles[i] + k]];
			if (!(fabsf(vertex->ux - *ux) <= tolerance) || !(fabsf(vertex->uy - *uy) <= tolerance))
				return false;
		}
	return true;
}

/* The tile's pixels in the displayed picture. */
struct area {
	uint32_t tile, left, top, width, height;
};

static inline struct area area_of(const struct scene *scene, uint32_t tile)
{
	uint32_t left = tile % scene->bins.columns * TILE_WIDTH, top = tile / scene->bins.columns * TILE_HEIGHT;
	uint32_t width = scene->width - left, height = scene->height - top;
	return (struct area){tile, left, top, width < TILE_WIDTH ? width : TILE_WIDTH,
						 height < TILE_HEIGHT ? height : TILE_HEIGHT};
}

static inline uint8_t *out_row(const struct scene *scene, const struct area *area, uint32_t row)
{
	return scene->sheet->data + (area->top + row) * scene->sheet->stride + 4 * (size_t)area->left;
}

/* A copy from one place of the picture, unless it is there; false if that is not all within it and its border. */
static bool shift_tile(const struct scene *scene, const struct area *area, float ux, float uy)
{
	const struct canvas *picture = scene->picture;
	const float limit = 16384.0f;
	float by_x = -scene->phase * ux, by_y = -scene->phase * uy;
	if (!(fabsf(by_x) < limit) || !(fabsf(by_y) < limit))
		return false;
	int32_t dx = (int32_t)floorf(by_x * 65536.0f + 0.5f), dy = (int32_t)floorf(by_y * 65536.0f + 0.5f);
	int32_t x = (int32_t)area->left + (dx >> 16), y = (int32_t)area->top + (dy >> 16);
	const int32_t border = CANVAS_BORDER, width = (int32_t)picture->width, height = (int32_t)picture->height;
	if (x < -border || y < -border || x + (int32_t)area->width + 1 > width + border ||
		y + (int32_t)area->height + 1 > height + border)
		return false;
	uint32_t fx = pixel_weight(dx), fy = pixel_weight(dy);
	const bool stays = x == (int32_t)area->left && y == (int32_t)area->top && fx == 0 && fy == 0;
	if (stays && sheet_has(scene->sheet, area->tile, contents_of(scene->contents, scene->id, area->tile)))
		return true;
	for (uint32_t row = 0; row < area->height; row++) {
		const uint8_t *upper = canvas_row(picture, y + (int32_t)row) + 4 * (ptrdiff_t)x;
		const uint8_t *lower = upper + picture->stride;
		uint8_t *out = out_row(scene, area, row);
		/* Of a length that compilers know this is four stores, of another a string instruction that is slow to begin.
		 */
		if (fx == 0 && fy == 0 && area->width == TILE_WIDTH)
			memcpy(out, upper, 4 * TILE_WIDTH);
		else if (fx == 0 && fy == 0)
			memcpy(out, upper, 4 * (size_t)area->width);
		else
			shift_row(upper, lower, fx, fy, area->width, out);
	}
	return true;
}

/* Asks for what the tile will show if it all moves alike, so that it comes while the triangles are worked on. */
static void expect_tile(const struct scene *scene, const struct area *area, float ux, float uy)
{
	const struct canvas *picture = scene->picture;
	const float limit = 16384.0f;
	float by_x = -scene->phase * ux, by_y = -scene->phase * uy;
	if (!(fabsf(by_x) < limit) || !(fabsf(by_y) < limit))
		return;
	int32_t left = (int32_t)area->left + (int32_t)by_x, top = (int32_t)area->top + (int32_t)by_y;
	int32_t right = left + (int32_t)area->width, bottom = top + (int32_t)area->height;
	left = left > 0 ? left : 0;
	right = right < (int32_t)picture->width ? right : (int32_t)picture->width;
	for (int32_t y = top > 0 ? top : 0; y <= bottom && y < (int32_t)picture->height; y++)
		for (int32_t x = left; x < right + 16; x += 16)
			__builtin_prefetch(canvas_row(picture, y) + 4 * (ptrdiff_t)x);
}

/* Fades torn pixels of a row to L. */
static void tear_row(const struct scene *scene, struct scene_scratch *scratch, uint32_t at, uint32_t count,
					 uint8_t *out)
{
	int32_t any = 0;
	for (uint32_t i = 0; i < count; i++)
		any |= scratch->tear[at + i];
	if (!any)
		return;
	sample_row(scene->low, scratch->x + at, scratch->y + at, count, (uint8_t *)scratch->low);
	mix_row(out, (const uint8_t *)scratch->low, scratch->tear + at, count);
}

static void count_uncovered(struct scene_scratch *scratch, const struct area *area)
{
	for (uint32_t row = 0; row < area->height; row++)
		for (uint32_t i = 0; i < area->width; i++)
			scratch->uncovered += scratch->x[row * TILE_WIDTH + i] == INT32_MIN;
}

static void prepare(const struct scene *scene, struct scene_scratch *scratch, const struct bin *bin, bool *torn)
{
	const struct warp_mesh *mesh = scene->mesh;
	bool deep = bin->triangles[bin->count - 1] >= mesh->folded.first;
	for (uint32_t i = 0; i < bin->count && !*torn && scene->tears; i++)
		*torn = may_tear(mesh, bin->triangles[i]);
	if (deep)
		for (uint32_t i = 0; i < TILE_PIXELS; i++)
			scratch->depth[i] = INFINITY;
	if (*torn)
		memset(scratch->tear, 0, sizeof(scratch->tear));
	if (scene->check)
		for (uint32_t i = 0; i < TILE_PIXELS; i++)
			scratch->x[i] = INT32_MIN;
}

static void draw_tile(const struct scene *scene, uint32_t tile, struct scene_scratch *scratch)
{
	const struct area area = area_of(scene, tile);
	const struct bins *bins = &scene->bins;
	const struct bin bin = {bins->triangles + bins->starts[tile], bins->starts[tile + 1] - bins->starts[tile]};
	const struct place place = {(double)area.left, (double)area.top};
	float ux = 0.0f, uy = 0.0f;
	bool torn = false;
	if ((bin.count == 0 || is_uniform(scene, &bin, &ux, &uy)) && shift_tile(scene, &area, ux, uy)) {
		scratch->uncovered += bin.count == 0 ? area.width * area.height : 0;
		return;
	}
	expect_tile(scene, &area, ux, uy);
	prepare(scene, scratch, &bin, &torn);
	for (uint32_t i = 0; i < bin.count; i++)
		put_triangle(scene, scratch, bin.triangles[i], &place);
	if (scene->check)
		count_uncovered(scratch, &area);
	for (uint32_t row = 0; row < area.height; row++) {
		uint32_t at = row * TILE_WIDTH;
		uint8_t *out = out_row(scene, &area, row);
		sample_row(scene->picture, scratch->x + at, scratch->y + at, area.width, out);
		if (torn)
			tear_row(scene, scratch, at, area.width, out);
	}
}
