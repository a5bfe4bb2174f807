/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A renderer that works in plain memory: a pattern that moves to the right,
 * with depth and motion, 40 frames a second, and what the daemon says of it.
 *
 * usage: example-memory [--seconds S]
 */

#include <math.h>
#include <pursuit.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define WIDTH 640
#define HEIGHT 360
#define FRAME_NS UINT64_C(25000000)
#define PIXELS_A_FRAME 4

static uint64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static void sleep_until(uint64_t ns)
{
	struct timespec until = {.tv_sec = (time_t)(ns / 1000000000u), .tv_nsec = (long)(ns % 1000000000u)};
	clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
}

/* Rows are `stride` bytes apart, the top one first. */
static void draw(const struct pursuit_frame *frame, uint32_t number)
{
	for (uint32_t y = 0; y < HEIGHT; y++) {
		uint8_t *color = frame->color.data + y * frame->color.stride;
		float *depth = (float *)(void *)(frame->depth.data + y * frame->depth.stride);
		float *motion = (float *)(void *)(frame->motion.data + y * frame->motion.stride);
		for (uint32_t x = 0; x < WIDTH; x++) {
			double along = (double)x - (double)number * PIXELS_A_FRAME;
			double wave = sin(along * 0.1) * sin((double)y * 0.1);
			color[4 * x + 0] = (uint8_t)(128 + 120 * wave); /* blue, green, red, alpha */
			color[4 * x + 1] = (uint8_t)(128 - 120 * wave);
			color[4 * x + 2] = (uint8_t)(255 * y / HEIGHT);
			color[4 * x + 3] = 255;
			depth[x] = 0.5f;
			motion[2 * x + 0] = PIXELS_A_FRAME; /* since the frame before: to the right */
			motion[2 * x + 1] = 0.0f;
		}
	}
}

static void print_feedback(struct pursuit_stream *stream)
{
	struct pursuit_feedback_report report;

	while (pursuit_poll_feedback(stream, &report)) {
		if (report.shown == PURSUIT_SHOWN) {
			printf("frame %llu: shown %.1f ms after its submit, %u vblanks, %u in-betweens, %u late\n",
				   (unsigned long long)report.frame_id, (double)(report.flip_ns - report.submit_ns) * 1e-6,
				   report.vblanks, report.in_betweens, report.late_in_betweens);
		} else {
			printf("frame %llu: %s\n", (unsigned long long)report.frame_id,
				   report.shown == PURSUIT_REPLACED ? "replaced by a newer one" : "refused");
		}
	}
}

int main(int count, char **arguments)
{
	double seconds = count == 3 && strcmp(arguments[1], "--seconds") == 0 ? atof(arguments[2]) : 5.0;
	struct pursuit_stream_params params = {
		.width = WIDTH,
		.height = HEIGHT,
		.color_format = PURSUIT_COLOR_BGRA8,
		.depth_format = PURSUIT_DEPTH_FLOAT32,
		.motion_format = PURSUIT_MOTION_FLOAT32,
		.motion_kind = PURSUIT_MOTION_IS_BACKWARD,
		.name = "example-memory",
	};
	struct pursuit_stream *stream = pursuit_open(&params);

	if (!stream) {
		perror("pursuit_open");
		return 1;
	}
	uint64_t begin = now_ns();
	for (uint32_t number = 0; (double)number * (double)FRAME_NS < seconds * 1e9; number++) {
		struct pursuit_frame *frame = pursuit_acquire(stream);
		if (frame) {
			draw(frame, number);
			frame->time_ns = begin + number * FRAME_NS;
			pursuit_submit(stream, frame);
		}
		print_feedback(stream);
		sleep_until(begin + (number + 1) * FRAME_NS);
	}
	print_feedback(stream);

	struct pursuit_status status;
	pursuit_get_status(stream, &status);
	printf("%llu frames submitted, %llu published; %s\n", (unsigned long long)status.submitted,
		   (unsigned long long)status.published, status.message);
	pursuit_close(&stream);
	return 0;
}
