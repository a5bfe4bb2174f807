/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * test_examples PROGRAM: runs an example against a daemon of ours and follows
 * its motion: what was at (position - motion) in the frame before must be here.
 */

#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/client/harness.h"
#include "tests/test.h"

#define PIXELS (640 * 360)

struct picture {
	uint64_t id;
	uint8_t color[PIXELS * 4];
	float motion[PIXELS * 2];
	float depth[PIXELS];
};

static struct picture pictures[2];

static float half_value(uint16_t half)
{
	int exponent = half >> 10 & 31;
	float value =
		exponent ? ldexpf(1024.0f + (float)(half & 0x3ff), exponent - 25) : ldexpf((float)(half & 0x3ff), -24);
	return half & 0x8000 ? -value : value;
}

static void take_picture(struct picture *picture, const struct pursuit_frame_header *header, const uint8_t *planes)
{
	picture->id = header->frame_id;
	memcpy(picture->color, planes + header->planes[0].offset, sizeof(picture->color));
	memcpy(picture->depth, planes + header->planes[1].offset, sizeof(picture->depth));
	const uint8_t *motion = planes + header->planes[2].offset;
	for (int i = 0; i < PIXELS * 2; i++) {
		picture->motion[i] = header->planes[2].format == PURSUIT_FORMAT_RG16F
								 ? half_value(((const uint16_t *)motion)[i])
								 : ((const float *)motion)[i];
	}
}

/* How well pictures agree along the motion, worst of all pairs. */
struct agreement {
	int pairs;
	double error;  /* mean difference of colour */
	double turned; /* the same with the motion's y turned, where y moves enough to tell */
};

/* Mean difference of colour along the motion, where there is any; `turn` turns the motion's y. */
static double follow(const struct picture *newer, const struct picture *before, float turn, int *moving)
{
	double sum = 0;

	*moving = 0;
	for (int i = 0; i < PIXELS; i++) {
		float x = newer->motion[2 * i], y = newer->motion[2 * i + 1] * turn;
		int from_x = i % 640 - (int)lrintf(x), from_y = i / 640 - (int)lrintf(y);
		if ((x == 0.0f && y == 0.0f) || from_x < 0 || from_x >= 640 || from_y < 0 || from_y >= 360) {
			continue;
		}
		for (int c = 0; c < 3; c++) {
			sum += abs(newer->color[4 * i + c] - before->color[4 * (from_y * 640 + from_x) + c]) / 3.0;
		}
		(*moving)++;
	}
	return *moving ? sum / *moving : 1000.0;
}

static float tallest_motion(const struct picture *picture)
{
	float tallest = 0;
	for (int i = 0; i < PIXELS; i++) {
		tallest = fmaxf(tallest, fabsf(picture->motion[2 * i + 1]));
	}
	return tallest;
}

static void compare_pictures(const struct picture *newer, const struct picture *older, struct agreement *agreement)
{
	int moving;
	double error = follow(newer, older, 1.0f, &moving);

	CHECK(moving > 10000);
	agreement->pairs++;
	agreement->error = fmax(agreement->error, error);
	if (tallest_motion(newer) > 2.0f) {
		agreement->turned = fmax(agreement->turned, follow(newer, older, -1.0f, &moving));
	}
}

static pid_t run_example(const char *program, int seconds)
{
	char text[16];
	snprintf(text, sizeof(text), "%d", seconds);
	pid_t child = fork();
	if (child == 0) {
		setenv("PURSUIT_SOCKET", harness.path, 1);
		execl(program, program, "--seconds", text, (char *)NULL);
		_exit(127);
	}
	return child;
}

/* Plays it for so long: pairs of frames that follow each other are compared. Its exit status, -1 if it has none. */
static int play_example(const char *program, int seconds, struct agreement *agreement)
{
	struct fake_daemon daemon;
	const uint8_t *planes;
	int taken = 0, status = 0;
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	pid_t child = run_example(program, seconds);

	while (waitpid(child, &status, WNOHANG) == 0) {
		fake_step(&daemon);
		const struct pursuit_frame_header *header = fake_take(&daemon, &planes);
		if (header && header->plane_count == 3 && header->planes[0].stride == 640 * 4) {
			struct picture *picture = &pictures[taken++ % 2], *before = &pictures[taken % 2];
			take_picture(picture, header, planes);
			fake_report(&daemon, header->frame_id, PURSUIT_FEEDBACK_SHOWN);
			if (taken > 1 && before->id + 1 == picture->id && (taken % 5 == 0 || agreement->pairs == 0)) {
				compare_pictures(picture, before, agreement);
			}
		}
		sleep_ms(1);
	}
	fake_stop(&daemon, true);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* On a busy machine hardly a frame comes in a second. */
static int follow_example(const char *program)
{
	struct agreement agreement = {0};
	int status = 0;
	for (int seconds = 1; seconds <= 64 && agreement.pairs == 0 && status == 0; seconds *= 4) {
		status = play_example(program, seconds, &agreement);
	}
	if (status == 77) {
		return 77;
	}
	printf("%d pairs, error along the motion %.2f, with y turned %.2f\n", agreement.pairs, agreement.error,
		   agreement.turned);
	CHECK_INT(status, 0);
	CHECK(agreement.pairs >= 1);
	CHECK(agreement.error < 8.0);
	CHECK(agreement.turned == 0.0 || agreement.turned > 12.0);
	return 0;
}

int main(int count, char **arguments)
{
	if (count != 2 || !harness_start()) {
		return 2;
	}
	int result = follow_example(arguments[1]);
	harness_finish();
	if (result == 77) {
		SKIP("the example has nothing to render with on this machine");
	}
	return test_result();
}
