/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The order of the motion models (docs/method.md, 10) on exact paths: errors of
 * displacement against what Newton's formula says, digit by digit, and how
 * they fall with the interval. Prints the table; --json FILE writes it.
 */
#include "table.h"

#include "daemon/engine/motion_order.h"
#include "tests/test.h"

static const double steps[] = {1.0 / 4, 1.0 / 3, 1.0 / 2, 1.0, 2.0};
static const double intervals[] = {1.0 / 15, 1.0 / 30, 1.0 / 60, 1.0 / 120};
static const char *const models[] = {"linear", "quadratic"};

static struct table table;

static double error_after(enum motion_path path, enum engine_motion_model model, double interval, uint32_t gap,
						  double phase)
{
	struct error error = {""};
	const double worst = motion_order_error(path, model, interval, gap, phase, &error);
	CHECK_STRING(error.text, "");
	return worst;
}

static double error_of(enum motion_path path, enum engine_motion_model model, double interval, double phase)
{
	return error_after(path, model, interval, 1, phase);
}

/* What is left where the model is exact: floats of some pixels. */
#define FLOAT_NOISE 2e-5

static void test_parabola(void)
{
	for (size_t t = 0; t < 4; t++)
		for (size_t s = 0; s < 5; s++) {
			const double p = steps[s], square = intervals[t] * intervals[t];
			const double linear = p * (p + 1.0) / 2.0 * square * hypot(300.0, 900.0);
			CHECK_NEAR(error_of(MOTION_PATH_PARABOLA, ENGINE_MOTION_LINEAR, intervals[t], p), linear, FLOAT_NOISE);
			/* At the longest interval the change is more than half of the motion: not believed, linear. */
			if (t > 0)
				CHECK_NEAR(error_of(MOTION_PATH_PARABOLA, ENGINE_MOTION_QUADRATIC, intervals[t], p), 0.0, FLOAT_NOISE);
		}
}

static void test_cubic(void)
{
	for (size_t t = 1; t < 4; t++)
		for (size_t s = 0; s < 5; s++) {
			const double p = steps[s], cube = intervals[t] * intervals[t] * intervals[t];
			const double quadratic = p * (p + 1.0) * (p + 2.0) / 6.0 * cube * hypot(4000.0, 2000.0);
			CHECK_NEAR(error_of(MOTION_PATH_CUBIC, ENGINE_MOTION_QUADRATIC, intervals[t], p), quadratic, FLOAT_NOISE);
		}
}

/* Frames between the two were lost: exact where it was, and the formula's error where it was not. */
static void test_lost_frames(void)
{
	for (uint32_t gap = 2; gap <= 6; gap++)
		for (size_t s = 0; s < 5; s++) {
			const double p = steps[s], t = 1.0 / 240, cube = t * t * t;
			const double cubic = p * (p + 1.0) * (2.0 * p + 3.0 * gap + 1.0) / 12.0 * cube * hypot(4000.0, 2000.0);
			CHECK_NEAR(error_after(MOTION_PATH_PARABOLA, ENGINE_MOTION_QUADRATIC, t, gap, p), 0.0, FLOAT_NOISE);
			CHECK_NEAR(error_after(MOTION_PATH_CUBIC, ENGINE_MOTION_QUADRATIC, t, gap, p), cubic, FLOAT_NOISE);
		}
}

/* Halving the interval divides by 4 and by 8; the fan has terms of higher order, which vanish with the interval. */
static void test_order_of_convergence(void)
{
	for (size_t s = 0; s < 5; s++)
		for (int model = 0; model < 2; model++)
			for (size_t t = 1; t < 4; t++) {
				const double coarse =
					error_of(MOTION_PATH_FAN, (enum engine_motion_model)model, intervals[t - 1], steps[s]);
				const double fine = error_of(MOTION_PATH_FAN, (enum engine_motion_model)model, intervals[t], steps[s]);
				const double order = log2(coarse / fine), want = model ? 3.0 : 2.0;
				char what[96];
				snprintf(what, sizeof(what), "fan %s, step %.3g, interval 1/%.0f to 1/%.0f: order", models[model],
						 steps[s], 1.0 / intervals[t - 1], 1.0 / intervals[t]);
				table_add(&table, what, fabs(order - want), "order", 0.01);
			}
}

/* The same with a frame lost between the two: what is where at the older one's moment is found well enough. */
static void test_order_after_a_loss(void)
{
	for (size_t s = 0; s < 5; s++)
		for (size_t t = 2; t < 4; t++) {
			const double coarse = error_after(MOTION_PATH_FAN, ENGINE_MOTION_QUADRATIC, intervals[t - 1], 2, steps[s]);
			const double fine = error_after(MOTION_PATH_FAN, ENGINE_MOTION_QUADRATIC, intervals[t], 2, steps[s]);
			char what[96];
			snprintf(what, sizeof(what), "fan quadratic, a frame lost, step %.3g, interval 1/%.0f to 1/%.0f: order",
					 steps[s], 1.0 / intervals[t - 1], 1.0 / intervals[t]);
			table_add(&table, what, fabs(log2(coarse / fine) - 3.0), "order", 0.01);
		}
}

/* And the error is as much larger than without one as the formula says. */
static void test_size_after_a_loss(void)
{
	for (uint32_t gap = 2; gap <= 6; gap++)
		for (size_t s = 0; s < 5; s++) {
			const double p = steps[s], t = 1.0 / 60, want = (2.0 * p + 3.0 * gap + 1.0) / (2.0 * p + 4.0);
			const double lost = error_after(MOTION_PATH_FAN, ENGINE_MOTION_QUADRATIC, t, gap, p);
			CHECK_NEAR(lost / error_of(MOTION_PATH_FAN, ENGINE_MOTION_QUADRATIC, t, p), want, 0.02 * want);
		}
}

/* At a fixed interval the error follows p (p + 1) and p (p + 1)(p + 2), not p and p^2: backward motion is a secant. */
static void test_step(void)
{
	for (int model = 0; model < 2; model++) {
		double first = 0.0;
		for (size_t s = 0; s < 5; s++) {
			const double p = steps[s], shape = p * (p + 1.0) * (model ? p + 2.0 : 1.0);
			const double scaled = error_of(MOTION_PATH_FAN, (enum engine_motion_model)model, 1.0 / 60, p) / shape;
			char what[64];
			first = s ? first : scaled;
			snprintf(what, sizeof(what), "fan %s, step %.3g: share off the polynomial", models[model], p);
			table_add(&table, what, fabs(scaled / first - 1.0), "share", 0.002);
		}
	}
}

static void print_table(void)
{
	for (int path = 0; path < MOTION_PATH_COUNT; path++)
		for (int model = 0; model < 2; model++) {
			printf("%s, %s: error in pixels\n  interval", motion_path_name((enum motion_path)path), models[model]);
			for (size_t s = 0; s < 5; s++)
				printf("   step %-5.3g", steps[s]);
			for (size_t t = 0; t < 4; t++) {
				printf("\n  1/%-6.0f", 1.0 / intervals[t]);
				for (size_t s = 0; s < 5; s++)
					printf(" %11.6f",
						   error_of((enum motion_path)path, (enum engine_motion_model)model, intervals[t], steps[s]));
			}
			printf("\n");
		}
}

int main(int argc, char **argv)
{
	table_init(&table, "order", "plan");
	RUN(test_parabola);
	RUN(test_cubic);
	RUN(test_lost_frames);
	RUN(test_order_of_convergence);
	RUN(test_order_after_a_loss);
	RUN(test_size_after_a_loss);
	RUN(test_step);
	print_table();
	CHECK(table_finish(&table, argc, argv));
	return test_result();
}
