/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "engine-case.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const show_names[] = {"real", "in-between", "plain"};

static void add(struct bounds_report *sum, const struct bounds_report *one)
{
	sum->pixels += one->pixels;
	sum->same += one->same;
	sum->within_one += one->within_one;
	sum->within_two += one->within_two;
	sum->sharp += one->sharp;
	sum->plain += one->plain;
	sum->plain_within_one += one->plain_within_one;
	sum->other += one->other;
	sum->excused += one->excused;
	sum->outside += one->outside;
	if (one->worst > sum->worst)
		sum->worst = one->worst;
}

static void print_failure(const struct reference *reference, const struct engine_case *what,
						  const struct engine_request *request, const struct bounds_report *report)
{
	fprintf(stderr,
			"%s%s: %s at phase %g: %llu of %llu pixels outside (within 1: %.4f), worst by %.2f steps at (%u, %u): "
			"B G R is %u %u %u, reference %u %u %u\n",
			what->name, reference->geometry.moves ? "" : " (rests)", show_names[request->show], request->phase,
			(unsigned long long)report->outside, (unsigned long long)report->pixels,
			(double)report->within_one / (double)report->pixels, report->worst, report->worst_x, report->worst_y,
			report->worst_got[0], report->worst_got[1], report->worst_got[2], report->worst_want[0],
			report->worst_want[1], report->worst_want[2]);
}

static bool compare_request(struct engine *engine, const struct bounds *bounds, const struct engine_case *what,
							const struct engine_request *request, struct case_totals *totals)
{
	const struct reference *reference = bounds->reference;
	const size_t stride = (size_t)reference->width * 4 + 12; /* rows need not touch */
	struct engine_image image = {.data = reference_alloc(stride, reference->height), .stride = stride};
	struct bounds_report report = {0};
	struct error error = {""};
	bool good = false;
	memset(image.data, 0x5a, stride * reference->height);
	if (engine_render(engine, request, &image, &error) != 0) {
		fprintf(stderr, "%s: engine_render: %s\n", what->name, error.text);
	} else {
		bounds_compare(bounds, request, image.data, stride, &report);
		good = report.outside == 0;
		if (!good)
			print_failure(reference, what, request, &report);
	}
	for (uint32_t j = 0; j + 1 < reference->height; j++)
		if (image.data[j * stride + stride - 1] != 0x5a || image.data[j * stride + stride - 12] != 0x5a)
			good = false;
	add(&totals->reports[request->show], &report);
	free(image.data);
	return good;
}

bool engine_case_run(struct engine *engine, const struct frame *frame, const struct engine_case *what,
					 struct case_totals *totals)
{
	struct reference reference = {0};
	struct bounds bounds;
	struct error error = {""};
	uint32_t width = 0, height = 0;
	bool good = true;
	totals->cases++;
	if (engine_set_params(engine, &what->params, &error) != 0 ||
		engine_begin(engine, frame, &what->begin, &error) != 0) {
		fprintf(stderr, "%s: %s\n", what->name, error.text);
		totals->failed++;
		return false;
	}
	engine_get_size(engine, &width, &height);
	reference_begin(&reference, frame, &what->params, &what->begin);
	good = width == reference.width && height == reference.height;
	bounds_init(&bounds, &reference);
	for (uint32_t i = 0; i < what->request_count && good; i++)
		good = compare_request(engine, &bounds, what, &what->requests[i], totals);
	bounds_finish(&bounds);
	reference_finish(&reference);
	totals->failed += !good;
	return good;
}

void case_totals_print(const struct case_totals *totals)
{
	printf("%u cases, %u failed; shares of pixels:\n", totals->cases, totals->failed);
	for (int show = 0; show < 3; show++) {
		const struct bounds_report *report = &totals->reports[show];
		const double pixels = report->pixels ? (double)report->pixels : 1.0;
		printf(
			"  %-10s %9llu pixels: same %.5f, within 1 %.5f, within 2 %.5f; sharp %.4f; plain %.4f of which within 1 "
			"%.6f; other candidate %.6f; excused %.6f; outside %llu, worst by %.2f steps\n",
			show_names[show], (unsigned long long)report->pixels, (double)report->same / pixels,
			(double)report->within_one / pixels, (double)report->within_two / pixels, (double)report->sharp / pixels,
			(double)report->plain / pixels,
			report->plain ? (double)report->plain_within_one / (double)report->plain : 1.0,
			(double)report->other / pixels, (double)report->excused / pixels, (unsigned long long)report->outside,
			report->worst);
	}
}
