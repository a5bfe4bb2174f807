/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The motion of every scene is exact: the previous picture, looked up by
 * backward motion, is this one; the previous frame's forward motion is this
 * frame's backward motion; and where the world stands still, motion is what
 * depth and the two camera matrices say.
 */
#include "client/scenes/scene.h"
#include "context.h"
#include "picture.h"
#include "tests/test.h"

enum { WIDTH = 480, HEIGHT = 270 };

static const double step = 1.0 / 60.0;

/* Distance along the view axis, from device depth. */
static double distance(const struct scene_camera *camera, double depth)
{
	double n = (double)camera->near_distance, f = (double)camera->far_distance;
	return n * f / (f - depth * (f - n));
}

/* The four pixels around a position, if all are inside, of the same object and at about the same distance. */
struct lookup {
	size_t index[4];
	double weight[4];
};

static bool look_up(const struct picture *now, size_t i, const struct picture *then, double x, double y,
					struct lookup *lookup)
{
	double fx = floor(x - 0.5), fy = floor(y - 0.5), tx = x - 0.5 - fx, ty = y - 0.5 - fy;
	if (!(fx >= 0.0 && fy >= 0.0 && fx + 1.0 < WIDTH && fy + 1.0 < HEIGHT))
		return false;
	double here = distance(&now->camera, (double)now->pixels.depth[i]);
	for (size_t k = 0; k < 4; k++) {
		size_t at = ((size_t)fy + k / 2) * WIDTH + (size_t)fx + k % 2;
		lookup->index[k] = at;
		lookup->weight[k] = (k % 2 ? tx : 1.0 - tx) * (k / 2 ? ty : 1.0 - ty);
		double there = distance(&then->camera, (double)then->pixels.depth[at]);
		if (then->pixels.object_id[at] != now->pixels.object_id[i] || fabs(there - here) > 0.06 * here)
			return false;
	}
	return true;
}

struct agreement {
	size_t pixels;
	double color_error, unmoved_error; /* sums of squares, warped and not */
	double motion_error;               /* sum, pixels */
	size_t far_off;                    /* motion off by more than a tenth of a pixel */
};

static void compare(const struct picture *then, const struct picture *now, struct agreement *sum)
{
	for (size_t i = 0; i < now->count; i++) {
		double mx = (double)now->pixels.backward[2 * i], my = (double)now->pixels.backward[2 * i + 1];
		double x = (double)(i % WIDTH) + 0.5 - mx, y = (double)(i / WIDTH) + 0.5 - my, fx = 0.0, fy = 0.0;
		struct lookup lookup;
		if (!look_up(now, i, then, x, y, &lookup))
			continue;
		double color[3] = {0.0, 0.0, 0.0};
		for (size_t k = 0; k < 4; k++) {
			fx += lookup.weight[k] * (double)then->pixels.forward[2 * lookup.index[k]];
			fy += lookup.weight[k] * (double)then->pixels.forward[2 * lookup.index[k] + 1];
			for (size_t c = 0; c < 3; c++)
				color[c] += lookup.weight[k] * then->pixels.color[4 * lookup.index[k] + c];
		}
		for (size_t c = 0; c < 3; c++) {
			double warped = now->pixels.color[4 * i + c] - color[c];
			double unmoved = now->pixels.color[4 * i + c] - then->pixels.color[4 * i + c];
			sum->color_error += warped * warped;
			sum->unmoved_error += unmoved * unmoved;
		}
		double off = hypot(fx - mx, fy - my);
		sum->motion_error += off;
		sum->far_off += off > 0.1;
		sum->pixels++;
	}
}

static double psnr(double squares, size_t pixels)
{
	return squares > 0.0 ? 10.0 * log10(255.0 * 255.0 * 3.0 * (double)pixels / squares) : 100.0;
}

static struct scene *create(const char *name)
{
	char error[256] = "";
	struct scene *scene = scene_create(name, WIDTH, HEIGHT, test_context_lookup, error, sizeof(error));
	if (!scene)
		fprintf(stderr, "%s: %s\n", name, error);
	CHECK(scene != NULL);
	return scene;
}

static void check_scene(const char *name, double least_psnr, double least_part, double least_gain)
{
	static const double times[] = {0.9, 4.4, 37.0, 118.7};
	struct scene *scene = create(name);
	struct picture then, now;
	struct agreement sum = {0};
	picture_init(&then, WIDTH, HEIGHT);
	picture_init(&now, WIDTH, HEIGHT);
	for (size_t t = 0; t < 4; t++) {
		CHECK(picture_take(&then, scene, times[t] - 2.0 * step, times[t] - step, times[t]));
		CHECK(picture_take(&now, scene, times[t] - step, times[t], times[t] + step));
		compare(&then, &now, &sum);
	}
	double part = (double)sum.pixels / (4.0 * WIDTH * HEIGHT), warped = psnr(sum.color_error, sum.pixels);
	double unmoved = psnr(sum.unmoved_error, sum.pixels), off = sum.motion_error / (double)sum.pixels;
	double far_off = (double)sum.far_off / (double)sum.pixels;
	printf("%-10s warped %.1f dB, unmoved %.1f dB, on %.0f%%; forward and backward differ by %.4f px, %.3f%% by over "
		   "0.1\n",
		   name, warped, unmoved, 100.0 * part, off, 100.0 * far_off);
	CHECK(warped >= least_psnr);
	CHECK(warped >= unmoved + least_gain);
	CHECK(part >= least_part);
	CHECK(off <= 0.01);
	CHECK(far_off <= 0.005);
	picture_finish(&then);
	picture_finish(&now);
	scene_destroy(&scene);
}

static void colonnade_warps_exactly(void)
{
	check_scene("colonnade", 30.0, 0.7, 4.0);
}

static void tower_warps_exactly(void)
{
	check_scene("tower", 30.0, 0.6, 4.0);
}

static void fan_warps_exactly(void)
{
	check_scene("fan", 30.0, 0.7, 4.0);
}

static void trees_warps_exactly(void)
{
	check_scene("trees", 28.0, 0.5, 3.0);
}

static void creature_warps_exactly(void)
{
	check_scene("creature", 30.0, 0.6, 3.0);
}

static void rings_warps_exactly(void)
{
	check_scene("rings", 30.0, 0.6, 3.0);
}

static void hud_warps_exactly(void)
{
	check_scene("hud", 28.0, 0.6, 4.0);
}

static void still_warps_exactly(void)
{
	check_scene("still", 100.0, 0.7, 0.0);
}

/* Gauss-Jordan with pivots; column-major. */
static bool invert(const float *in, double *out)
{
	double a[4][8];
	for (int r = 0; r < 4; r++) {
		for (int c = 0; c < 4; c++) {
			a[r][c] = (double)in[c * 4 + r];
			a[r][4 + c] = r == c;
		}
	}
	for (int p = 0; p < 4; p++) {
		int best = p;
		for (int r = p; r < 4; r++)
			best = fabs(a[r][p]) > fabs(a[best][p]) ? r : best;
		for (int c = 0; c < 8; c++) {
			double swap = a[p][c];
			a[p][c] = a[best][c];
			a[best][c] = swap;
		}
		if (a[p][p] == 0.0)
			return false;
		for (int r = 0; r < 4; r++) {
			double factor = a[r][p] / a[p][p];
			for (int c = 0; c < 8 && r != p; c++)
				a[r][c] -= factor * a[p][c];
		}
		double pivot = a[p][p];
		for (int c = 0; c < 8; c++)
			a[p][c] /= pivot;
	}
	for (int r = 0; r < 4; r++)
		for (int c = 0; c < 4; c++)
			out[c * 4 + r] = a[r][4 + c];
	return true;
}

/* Where depth and the cameras say that the pixel's point was. */
static void reproject(const struct scene_camera *camera, const double *inverse, double x, double y, double depth,
					  double *out)
{
	double clip[4] = {x / WIDTH * 2.0 - 1.0, 1.0 - y / HEIGHT * 2.0, depth * 2.0 - 1.0, 1.0}, world[4], then[4];
	for (int r = 0; r < 4; r++) {
		world[r] = 0.0;
		for (int c = 0; c < 4; c++)
			world[r] += inverse[c * 4 + r] * clip[c];
	}
	for (int r = 0; r < 4; r++) {
		then[r] = 0.0;
		for (int c = 0; c < 4; c++)
			then[r] += (double)camera->previous_view_projection[c * 4 + r] * world[c];
	}
	out[0] = (then[0] / then[3] * 0.5 + 0.5) * WIDTH;
	out[1] = (0.5 - then[1] / then[3] * 0.5) * HEIGHT;
}

static bool is_world(const char *name, uint32_t id)
{
	if (strcmp(name, "colonnade") == 0)
		return id != 0 && (id % 64) < 32;
	return id != 0;
}

static void cameras_depth_and_motion_agree(void)
{
	static const char *const names[] = {"colonnade", "tower", "still"};
	for (size_t n = 0; n < 3; n++) {
		struct scene *scene = create(names[n]);
		struct picture now;
		double inverse[16], worst = 0.0;
		size_t pixels = 0;
		picture_init(&now, WIDTH, HEIGHT);
		CHECK(picture_take(&now, scene, 5.0 - step, 5.0, 5.0 + step));
		CHECK(invert(now.camera.view_projection, inverse));
		for (size_t i = 0; i < now.count; i++) {
			double x = (double)(i % WIDTH) + 0.5, y = (double)(i / WIDTH) + 0.5, then[2];
			if (!is_world(names[n], now.pixels.object_id[i]))
				continue;
			reproject(&now.camera, inverse, x, y, (double)now.pixels.depth[i], then);
			worst = fmax(worst, hypot(x - then[0] - (double)now.pixels.backward[2 * i],
									  y - then[1] - (double)now.pixels.backward[2 * i + 1]));
			pixels++;
		}
		printf("%-10s depth and cameras against motion: worst %.4f px of %zu\n", names[n], worst, pixels);
		CHECK(pixels > now.count / 4);
		CHECK(worst < 0.02);
		picture_finish(&now);
		scene_destroy(&scene);
	}
}

int main(int argc, char **argv)
{
	struct test_context context;
	if (!test_context_init(&context, argc > 1 && strcmp(argv[1], "es") == 0))
		SKIP("no surfaceless EGL context");
	RUN(colonnade_warps_exactly);
	RUN(tower_warps_exactly);
	RUN(fan_warps_exactly);
	RUN(trees_warps_exactly);
	RUN(creature_warps_exactly);
	RUN(rings_warps_exactly);
	RUN(hud_warps_exactly);
	RUN(still_warps_exactly);
	RUN(cameras_depth_and_motion_agree);
	test_context_finish(&context);
	return test_result();
}
