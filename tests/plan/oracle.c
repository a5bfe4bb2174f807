/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* docs/method.md, 1, 2 and 3 (stretch), pixel by pixel, with nothing shared with the analysis. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fixture.h"

struct field {
	uint32_t w, h;
	double *ux, *uy, *z;
};

static double half_value(uint16_t bits)
{
	int exponent = bits >> 10 & 31, mantissa = bits & 1023;
	double magnitude = exponent == 0    ? ldexp(mantissa, -24)
					   : exponent == 31 ? (double)(mantissa ? NAN : INFINITY)
										: ldexp(1024 + mantissa, exponent - 25);
	return bits & 0x8000 ? -magnitude : magnitude;
}

static void motion_at(const struct fixture *fixture, uint32_t x, uint32_t y, double *mx, double *my)
{
	const struct pursuit_plane *plane = fixture->motion_plane;
	const uint8_t *row = fixture->motion + y * plane->stride;
	if (plane->format == PURSUIT_FORMAT_RG16F) {
		uint16_t halves[2];
		memcpy(halves, row + 4 * (size_t)x, 4);
		*mx = half_value(halves[0]);
		*my = half_value(halves[1]);
	} else {
		float singles[2];
		memcpy(singles, row + 8 * (size_t)x, 8);
		*mx = (double)singles[0];
		*my = (double)singles[1];
	}
}

static double clamp(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

static double smoothstep(double a, double b, double x)
{
	double t = clamp((x - a) / (b - a), 0, 1);
	return t * t * (3 - 2 * t);
}

static double depth_value(const struct fixture *fixture, uint32_t x, uint32_t y)
{
	const struct pursuit_plane *plane = fixture->depth_plane;
	const uint8_t *row = fixture->depth + y * plane->stride;
	uint32_t word;
	float single;
	if (plane->format == PURSUIT_FORMAT_DEPTH16)
		return (row[2 * (size_t)x] | row[2 * (size_t)x + 1] << 8) / 65535.0;
	memcpy(&word, row + 4 * (size_t)x, 4);
	memcpy(&single, row + 4 * (size_t)x, 4);
	return plane->format == PURSUIT_FORMAT_DEPTH24 ? (word & 0xffffff) / 16777215.0 : (double)single;
}

static double z_of(const struct fixture *fixture, double d)
{
	const struct pursuit_frame_header *header = &fixture->frame.header;
	double n = (double)header->near_distance, f = (double)header->far_distance, z = d;
	if (header->depth_kind == PURSUIT_DEPTH_DEVICE_REVERSED)
		z = 1 - d;
	else if (header->depth_kind == PURSUIT_DEPTH_LINEAR && n > 0 && f > n)
		z = isinf(f) ? (d <= n ? 0 : 1 - n / d) : (d - n) / (f - n);
	else if (header->depth_kind == PURSUIT_DEPTH_LINEAR)
		z = d / (1 + d);
	return isnan(z) ? 1 : clamp(z, 0, 1);
}

static double seconds(uint64_t first, uint64_t second, uint64_t third)
{
	return (double)(first ? first : second ? second : third) * 1e-9;
}

static uint64_t fill_field(struct oracle *oracle, struct field *field, const struct fixture *fixture,
						   const struct plan_params *params)
{
	const struct pursuit_frame_header *header = &fixture->frame.header;
	uint64_t own = header->real_interval_ns, motion = header->motion_interval_ns, pacer = params->real_interval_ns;
	double t = seconds(pacer, own, motion), s = seconds(motion, own, pacer);
	double width_mm = params->display_width_mm > 0 ? (double)params->display_width_mm : 531;
	double distance_mm = params->viewing_distance_mm > 0 ? (double)params->viewing_distance_mm : 600;
	double degrees = atan(width_mm / field->w / distance_mm) * 180 / acos(-1) / s, ratio = clamp(t / s, 0.125, 8);
	uint64_t invalid = 0;
	for (uint32_t j = 0; j < field->h; j++)
		for (uint32_t i = 0; i < field->w; i++) {
			const struct pursuit_plane *plane = fixture->motion_plane;
			double mx, my;
			motion_at(fixture, (2 * i + 1) * plane->width / (2 * field->w),
					  (2 * j + 1) * plane->height / (2 * field->h), &mx, &my);
			if (!isfinite(mx) || !isfinite(my)) {
				invalid++;
				mx = my = 0;
			}
			mx = clamp(mx, -65504, 65504);
			my = clamp(my, -65504, 65504);
			double f = 1 - smoothstep(70, 90, hypot(mx, my) * degrees);
			if (f > 0 && f < 1)
				oracle->slack = fmax(oracle->slack, 1e-6 * ratio * hypot(mx, my));
			size_t at = (size_t)j * field->w + i;
			/* In singles like the engine, since decisions hang on them. */
			field->ux[at] = (double)(float)clamp(f * ratio * mx, -16384, 16384);
			field->uy[at] = (double)(float)clamp(f * ratio * my, -16384, 16384);
			plane = fixture->depth_plane;
			field->z[at] = !plane ? 0.5
								  : z_of(fixture, depth_value(fixture, (2 * i + 1) * plane->width / (2 * field->w),
															  (2 * j + 1) * plane->height / (2 * field->h)));
		}
	return invalid;
}

/* Squared: exact for quarters, so that ties are ties. */
static double step(const struct field *field, uint32_t i, uint32_t j, uint32_t di, uint32_t dj)
{
	if (i + di >= field->w || j + dj >= field->h)
		return 0;
	size_t a = (size_t)j * field->w + i, b = (size_t)(j + dj) * field->w + i + di;
	double dx = field->ux[b] - field->ux[a], dy = field->uy[b] - field->uy[a];
	return dx * dx + dy * dy;
}

/* So alike that singles may see it otherwise, but not equal. */
static int too_close(double a, double b)
{
	return a != b && fabs(a - b) <= 1e-6 * (fabs(a) + fabs(b)) + 1e-37;
}

static int quantised(const struct field *field, uint32_t i, uint32_t j, int *loose)
{
	double quarters = 4 * sqrt(fmax(step(field, i, j, 1, 0), step(field, i, j, 0, 1)));
	*loose |= quarters < 63.5 && too_close(quarters, rint(quarters));
	return (int)fmin(63, floor(quarters));
}

static struct oracle_vertex vertex_at(const struct field *field, double x, double y)
{
	double ux = 0, uy = 0, z = 1;
	int n = 0;
	for (int dj = 0; dj < 2; dj++)
		for (int di = 0; di < 2; di++) {
			/* The pixels that meet at (x, y), or hold it. */
			uint32_t i = (uint32_t)(di ? floor(x) : ceil(x) - 1), j = (uint32_t)(dj ? floor(y) : ceil(y) - 1);
			size_t at = (size_t)j * field->w + i;
			ux += field->ux[at];
			uy += field->uy[at];
			z = fmin(z, field->z[at]);
			n++;
		}
	return (struct oracle_vertex){x, y, ux / n, uy / n, z, 0, 0};
}

static struct oracle_vertex snapped_at(const struct field *field, uint32_t i, uint32_t j)
{
	double gx = step(field, i, j, 1, 0), gy = step(field, i, j, 0, 1);
	int across = gx >= gy, loose = too_close(gx, gy);
	size_t a = (size_t)j * field->w + i, b = across ? a + 1 : a + field->w, side = a;
	if (field->z[b] < field->z[a])
		side = b;
	double square_a = field->ux[a] * field->ux[a] + field->uy[a] * field->uy[a];
	double square_b = field->ux[b] * field->ux[b] + field->uy[b] * field->uy[b];
	if (field->z[b] == field->z[a] && square_b > square_a)
		side = b;
	loose |= too_close(field->z[a], field->z[b]) || (field->z[a] == field->z[b] && too_close(square_a, square_b));
	return (struct oracle_vertex){
		across ? i + 1 : i + 0.5, across ? j + 0.5 : j + 1, field->ux[side], field->uy[side], field->z[side], 1, loose};
}

static struct oracle_vertex cell_vertex(const struct field *field, uint32_t x0, uint32_t y0, uint32_t s, int q_min)
{
	uint32_t x1 = x0 + s < field->w ? x0 + s : field->w, y1 = y0 + s < field->h ? y0 + s : field->h;
	double cx = (x0 + x1) / 2.0, cy = (y0 + y1) / 2.0, nearest = HUGE_VAL;
	int largest = -1, loose = 0;
	uint32_t best_i = 0, best_j = 0;
	for (uint32_t j = y0; j < y1; j++)
		for (uint32_t i = x0; i < x1; i++) {
			int q = quantised(field, i, j, &loose);
			double distance = (i + 0.5 - cx) * (i + 0.5 - cx) + (j + 0.5 - cy) * (j + 0.5 - cy);
			if (q < largest || (q == largest && distance >= nearest))
				continue;
			largest = q;
			nearest = distance;
			best_i = i;
			best_j = j;
		}
	struct oracle_vertex vertex = largest >= q_min ? snapped_at(field, best_i, best_j) : vertex_at(field, cx, cy);
	vertex.loose |= loose;
	return vertex;
}

static double centre(uint32_t c, uint32_t s, uint32_t size)
{
	uint32_t end = (c + 1) * s < size ? (c + 1) * s : size;
	return (c * s + end) / 2.0;
}

static struct oracle_vertex border_at(const struct field *field, double x, double y)
{
	uint32_t i = (uint32_t)fmin(floor(x), field->w - 1), j = (uint32_t)fmin(floor(y), field->h - 1);
	return (struct oracle_vertex){x, y, 0, 0, field->z[(size_t)j * field->w + i], 0, 0};
}

static void fill_vertices(struct oracle *oracle, const struct field *field, uint32_t s, int q_min)
{
	for (uint32_t r = 0; r < oracle->rows; r++)
		for (uint32_t c = 0; c < oracle->columns; c++) {
			double x = c == 0 ? 0 : c == oracle->columns - 1 ? field->w : centre(c - 1, s, field->w);
			double y = r == 0 ? 0 : r == oracle->rows - 1 ? field->h : centre(r - 1, s, field->h);
			int inside = c > 0 && c < oracle->columns - 1 && r > 0 && r < oracle->rows - 1;
			struct oracle_vertex *vertex = &oracle->vertices[r * oracle->columns + c];
			*vertex = inside ? cell_vertex(field, (c - 1) * s, (r - 1) * s, s, q_min) : border_at(field, x, y);
			oracle->snapped += (uint32_t)vertex->snapped;
			oracle->loose += (uint32_t)vertex->loose;
			oracle->max_displacement = fmax(oracle->max_displacement, hypot(vertex->ux, vertex->uy));
		}
}

typedef const struct oracle_vertex *corner;

static double area(corner a, corner b, corner c, double p)
{
	return (b->x + p * b->ux - a->x - p * a->ux) * (c->y + p * c->uy - a->y - p * a->uy) -
		   (b->y + p * b->uy - a->y - p * a->uy) * (c->x + p * c->ux - a->x - p * a->ux);
}

/* The larger singular value, from the entries of the map itself. */
static double stretch(corner a, corner b, corner c, double p)
{
	double d = area(a, b, c, 0), x1 = b->x - a->x, y1 = b->y - a->y, x2 = c->x - a->x, y2 = c->y - a->y;
	double u1 = b->ux - a->ux, v1 = b->uy - a->uy, u2 = c->ux - a->ux, v2 = c->uy - a->uy;
	double a00 = 1 + p * (u1 * y2 - u2 * y1) / d, a01 = p * (u2 * x1 - u1 * x2) / d;
	double a10 = p * (v1 * y2 - v2 * y1) / d, a11 = 1 + p * (v2 * x1 - v1 * x2) / d;
	return 0.5 * (hypot(a00 + a11, a10 - a01) + hypot(a00 - a11, a10 + a01));
}

static void judge(struct oracle *oracle, corner a, corner b, corner c, double p)
{
	double turned = area(a, b, c, p), stretched = stretch(a, b, c, p),
		   slack = 1e-4 * (1 + p * oracle->max_displacement);
	oracle->folded_least += turned <= -slack;
	oracle->folded_most += turned <= slack;
	oracle->doubtful_least += turned > slack && stretched > 1.25 + 1e-5;
	oracle->doubtful_most += turned > -slack && stretched > 1.25 - 1e-5;
}

static double apart(corner a, corner b)
{
	return (a->ux - b->ux) * (a->ux - b->ux) + (a->uy - b->uy) * (a->uy - b->uy);
}

static void fill_triangles(struct oracle *oracle, double p)
{
	for (uint32_t r = 0; r + 1 < oracle->rows; r++)
		for (uint32_t c = 0; c + 1 < oracle->columns; c++) {
			corner v00 = &oracle->vertices[r * oracle->columns + c], v10 = v00 + 1, v01 = v00 + oracle->columns,
				   v11 = v01 + 1;
			int down = area(v00, v10, v11, 0) > 0 && area(v00, v11, v01, 0) > 0;
			int up = area(v00, v10, v01, 0) > 0 && area(v10, v11, v01, 0) > 0;
			uint32_t main = down && (!up || apart(v00, v11) <= apart(v10, v01));
			oracle->diagonals[oracle->quads++] = main;
			if (v00->loose || v10->loose || v01->loose || v11->loose ||
				(down && up && too_close(apart(v00, v11), apart(v10, v01))))
				oracle->diagonals[oracle->quads - 1] = ORACLE_EITHER;
			judge(oracle, v00, v10, main ? v11 : v01, p);
			judge(oracle, main ? v00 : v10, v11, v01, p);
		}
}

static void *make_room(size_t count, size_t size)
{
	void *room = calloc(count, size);
	if (!room)
		abort();
	return room;
}

void oracle_make(struct oracle *oracle, const struct fixture *fixture, const struct plan_params *params)
{
	*oracle = (struct oracle){.still = 1};
	const struct pursuit_plane *colour = &fixture->frame.header.planes[0];
	size_t pixels = (size_t)colour->width * colour->height;
	struct field field = {colour->width, colour->height, make_room(pixels, 8), make_room(pixels, 8),
						  make_room(pixels, 8)};
	uint32_t s = params->cell ? params->cell : 8;
	oracle->invalid = fill_field(oracle, &field, fixture, params);
	oracle->columns = (field.w + s - 1) / s + 2;
	oracle->rows = (field.h + s - 1) / s + 2;
	oracle->vertices = make_room((size_t)oracle->columns * oracle->rows, sizeof(*oracle->vertices));
	oracle->diagonals = make_room((size_t)oracle->columns * oracle->rows, sizeof(*oracle->diagonals));
	for (size_t i = 0; i < pixels; i++)
		oracle->still &= field.ux[i] == 0 && field.uy[i] == 0;
	fill_vertices(oracle, &field, s, params->threshold_quarter ? (int)params->threshold_quarter : 2);
	fill_triangles(oracle, (double)params->last_phase);
	free(field.ux);
	free(field.uy);
	free(field.z);
}

void oracle_finish(struct oracle *oracle)
{
	free(oracle->vertices);
	free(oracle->diagonals);
	*oracle = (struct oracle){0};
}
