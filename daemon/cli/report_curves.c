/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_curves.h"

#include <math.h>

#include "report_html.h"

#define WIDTH 900.0
#define HEIGHT 380.0
#define LEFT 80.0
#define RIGHT 230.0 /* for the names */
#define TOP 16.0
#define BOTTOM 54.0
#define TICKS_MOST 8.0

/* Told apart by people with any colour vision (Okabe and Ito 2008). */
static const char *const colors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};
#define COLORS (sizeof(colors) / sizeof(colors[0]))

struct frame_of {
	double least[2], most[2];
};

static bool point_of(const json_t *point, double value[2])
{
	const json_t *x = json_array_get(point, 0), *y = json_array_get(point, 1);
	value[0] = json_number_value(x);
	value[1] = json_number_value(y);
	return json_is_number(x) && json_is_number(y);
}

static void widen(struct frame_of *frame, const double value[2])
{
	for (int axis = 0; axis < 2; axis++) {
		frame->least[axis] = fmin(frame->least[axis], value[axis]);
		frame->most[axis] = fmax(frame->most[axis], value[axis]);
	}
}

/* False: there is nothing to draw. */
static bool find_frame(const json_t *curves, struct frame_of *frame)
{
	const json_t *curve, *point;
	double value[2];
	size_t c, i;
	*frame = (struct frame_of){{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
	json_array_foreach(curves, c, curve)
	{
		json_array_foreach(json_object_get(curve, "points"), i, point)
		{
			if (point_of(point, value))
				widen(frame, value);
		}
	}
	for (int axis = 0; axis < 2; axis++) {
		if (!(frame->least[axis] <= frame->most[axis]))
			return false;
		if (frame->least[axis] == frame->most[axis])
			frame->most[axis] = frame->least[axis] + 1.0;
	}
	return true;
}

static double place(const struct frame_of *frame, int axis, double value)
{
	const double share = (value - frame->least[axis]) / (frame->most[axis] - frame->least[axis]);
	return axis == 0 ? LEFT + share * (WIDTH - LEFT - RIGHT) : HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM);
}

/* 1, 2 or 5 times a power of ten, so that there are not too many. */
static double tick_step(double span)
{
	double step = pow(10.0, floor(log10(span / TICKS_MOST)));
	static const double times[] = {1.0, 2.0, 5.0, 10.0};
	for (unsigned i = 0; i < 4; i++)
		if (span / (step * times[i]) <= TICKS_MOST)
			return step * times[i];
	return step * 10.0;
}

static void write_axes(const struct frame_of *frame, const json_t *plot, FILE *out)
{
	for (int axis = 0; axis < 2; axis++) {
		const double step = tick_step(frame->most[axis] - frame->least[axis]);
		for (double at = ceil(frame->least[axis] / step) * step; at <= frame->most[axis] + step / 1e6; at += step) {
			const double p = place(frame, axis, at), label = fabs(at) < step / 1e6 ? 0.0 : at;
			if (axis == 0)
				fprintf(out,
						"<path d=\"M%.1f %.1fV%.1f\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"%.1f\" "
						"text-anchor=\"middle\">%g</text>\n",
						p, TOP, HEIGHT - BOTTOM, p, HEIGHT - BOTTOM + 18, label);
			else
				fprintf(out,
						"<path d=\"M%.1f %.1fH%.1f\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"%.1f\" "
						"text-anchor=\"end\">%g</text>\n",
						LEFT, p, WIDTH - RIGHT, LEFT - 6, p + 4, label);
		}
	}
	const char *x = json_string_value(json_object_get(plot, "x")), *y = json_string_value(json_object_get(plot, "y"));
	fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">", (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 12);
	html_text(out, x ? x : "");
	fprintf(out, "</text>\n<text transform=\"translate(18 %.1f) rotate(-90)\" text-anchor=\"middle\">",
			(TOP + HEIGHT - BOTTOM) / 2);
	html_text(out, y ? y : "");
	fputs("</text>\n", out);
}

static void write_curve(const struct frame_of *frame, const json_t *curve, size_t index, bool steps, FILE *out)
{
	const char *name = json_string_value(json_object_get(curve, "name")), *color = colors[index % COLORS];
	const json_t *point;
	double value[2];
	size_t i;
	fputs("<path d=\"", out);
	json_array_foreach(json_object_get(curve, "points"), i, point)
	{
		if (!point_of(point, value))
			continue;
		if (steps && i > 0)
			fprintf(out, "H%.1f", place(frame, 0, value[0]));
		fprintf(out, "%c%.1f %.1f", i == 0 ? 'M' : 'L', place(frame, 0, value[0]), place(frame, 1, value[1]));
	}
	const double y = TOP + 12.0 + 22.0 * (double)index;
	fprintf(out, "\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\"/>\n", color);
	fprintf(out, "<path d=\"M%.1f %.1fh22\" stroke=\"%s\" stroke-width=\"3\"/><text x=\"%.1f\" y=\"%.1f\">",
			WIDTH - RIGHT + 12, y, color, WIDTH - RIGHT + 40, y + 4);
	html_text(out, name ? name : "");
	fputs("</text>\n", out);
}

void curves_write(const json_t *plot, const char *title, FILE *out)
{
	const json_t *curves = json_object_get(plot, "curves"), *curve;
	struct frame_of frame;
	size_t i;
	if (!find_frame(curves, &frame))
		return;
	fprintf(out,
			"<svg viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" style=\"max-width:100%%;background:#fff\" role=\"img\" "
			"font-family=\"Helvetica,Arial,sans-serif\" font-size=\"13\" aria-label=\"",
			WIDTH, HEIGHT, WIDTH);
	html_text(out, title);
	fputs("\">\n", out);
	write_axes(&frame, plot, out);
	json_array_foreach(curves, i, curve)
		write_curve(&frame, curve, i, json_is_true(json_object_get(plot, "steps")), out);
	fputs("</svg>\n", out);
}
