/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Switching between clients: at a vblank, each displayed picture one client's and whole, in-betweens included; and a
 * client that has stopped shows the last frame that it submitted. Judged by the pictures that --tee recorded.
 */

#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"

#define WIDTH 64u
#define HEIGHT 48u
#define PATIENCE 2400 /* turns of 25 ms */
#define STEP 10
#define LEVELS 20u
#define SPACING 3 /* so that they can be told apart after rounding */
/* Pixels a frame; with three the eye would lose it on a display of 64 pixels, and no in-betweens be made of it. */
#define MOTION 1.0f
#define RUNS_MOST 64u

/* Stripes along the motion look the same wherever they have moved to. */
struct player {
	struct pursuit_stream *stream;
	const char *name;
	int darkest;
	uint32_t stripe; /* rows */
	uint32_t frames;
	int level; /* of its last frame */
};

/* Pictures of one client one after another. */
struct run {
	int player, first_level, last_level;
	uint64_t pictures, in_betweens;
};

static struct fixture fixture;
static struct player players[2] = {{.name = "game a", .darkest = 30, .stripe = 8},
								   {.name = "game b", .darkest = 150, .stripe = 4}};

/* ---- clients ---- */

static void open_player(struct player *player)
{
	const struct pursuit_stream_params params = {.width = WIDTH,
												 .height = HEIGHT,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT32,
												 .socket_path = fixture.socket,
												 .name = player->name};
	player->stream = pursuit_open(&params);
}

static int level_of_row(const struct player *player, int level, uint32_t y)
{
	return level + (y / player->stripe % 2 ? STEP : 0);
}

static void submit(struct player *player)
{
	struct pursuit_frame *frame = pursuit_acquire(player->stream);
	if (!frame)
		return;
	const int level = player->darkest + SPACING * (int)(player->frames % LEVELS);
	for (uint32_t y = 0; y < HEIGHT; y++) {
		memset(frame->color.data + y * frame->color.stride, level_of_row(player, level, y), (size_t)WIDTH * 4);
		float *depth = (float *)(void *)(frame->depth.data + y * frame->depth.stride);
		float *motion = (float *)(void *)(frame->motion.data + y * frame->motion.stride);
		for (uint32_t x = 0; x < WIDTH; x++) {
			depth[x] = 0.5f;
			motion[2 * x] = MOTION;
			motion[2 * x + 1] = 0.0f;
		}
	}
	player->frames++;
	player->level = level;
	pursuit_submit(player->stream, frame);
}

static uint64_t count_shown(struct pursuit_stream *stream, uint64_t *in_betweens)
{
	struct pursuit_feedback_report report;
	uint64_t shown = 0;
	while (pursuit_poll_feedback(stream, &report)) {
		shown += report.shown == PURSUIT_SHOWN;
		*in_betweens += report.in_betweens;
	}
	return shown;
}

/* All that are open play until this one was shown so often, with in-betweens. */
static bool play_until_shown(struct player *player, uint64_t frames)
{
	uint64_t shown = 0, in_betweens = 0;
	count_shown(player->stream, &in_betweens);
	in_betweens = 0;
	for (int i = 0; i < PATIENCE && (shown < frames || in_betweens < frames / 2); i++) {
		for (int p = 0; p < 2; p++)
			submit(&players[p]);
		sleep_ms(25);
		shown += count_shown(player->stream, &in_betweens);
	}
	return shown >= frames && in_betweens >= frames / 2;
}

/* ---- the daemon ---- */

static int ask(const char *request, struct raw_reply *reply)
{
	const int fd = raw_greet(fixture.socket), status = raw_control(fd, request, -1, reply);
	close(fd);
	return status;
}

/* Vblanks that were reported so far. */
static uint64_t count_vblanks(void)
{
	static struct raw_reply reply;
	static uint64_t seen;
	char request[64];
	uint64_t rows;
	do {
		snprintf(request, sizeof(request), "timeline %" PRIu64 " 16", seen);
		CHECK_INT(ask(request, &reply), 0);
		const char *text = strstr((const char *)reply.raw + sizeof(reply.control), "\"rows\"");
		text = text ? strchr(text, '[') : NULL;
		for (rows = 0; text && (text = strchr(text + 1, '[')) != NULL;)
			rows++;
		seen += rows;
	} while (rows > 0);
	return seen;
}

/* Nothing is shown any more: all pause. */
static void wait_until_still(void)
{
	const int fd = raw_greet(fixture.socket);
	question_wait_for_rest(fd);
	close(fd);
}

static bool focus_shows_something(const char *request)
{
	static struct raw_reply reply;
	const uint64_t before = count_vblanks();
	CHECK_INT(ask(request, &reply), 0);
	for (int i = 0; i < PATIENCE && count_vblanks() == before; i++)
		sleep_ms(25);
	wait_until_still();
	return count_vblanks() > before;
}

/* ---- the video ---- */

static int luma_of(int grey)
{
	return 16 + (219 * grey + 127) / 255;
}

/* Whose picture this is, whole; -1: nobody's. */
static int owner_of(const uint8_t *luma, int *level)
{
	for (int p = 0; p < 2; p++) {
		for (uint32_t i = 0; i < LEVELS; i++) {
			const int candidate = players[p].darkest + SPACING * (int)i;
			bool same = true;
			for (uint32_t j = 0; j < WIDTH * HEIGHT && same; j++)
				same = abs(luma[j] - luma_of(level_of_row(&players[p], candidate, j / WIDTH))) <= 1;
			if (same) {
				*level = candidate;
				return p;
			}
		}
	}
	return -1;
}

static uint32_t read_runs(const char *path, struct run runs[RUNS_MOST])
{
	static uint8_t planes[WIDTH * HEIGHT * 3];
	char line[256];
	uint32_t count = 0;
	int before = -1, level = 0;
	uint64_t pictures = 0;
	FILE *file = fopen(path, "r");
	CHECK(file && fgets(line, sizeof(line), file));
	while (file && fgets(line, sizeof(line), file) && strncmp(line, "FRAME", 5) == 0 &&
		   fread(planes, 1, sizeof(planes), file) == sizeof(planes)) {
		const int owner = owner_of(planes, &level);
		CHECK(owner >= 0);
		if (owner < 0)
			printf("       ... picture %" PRIu64 " is mixed\n", pictures);
		if (owner != before && count < RUNS_MOST)
			runs[count++] = (struct run){.player = owner, .first_level = level};
		struct run *run = &runs[count - 1];
		run->in_betweens += run->pictures > 0 && level == run->last_level;
		run->last_level = level;
		run->pictures++;
		before = owner;
		pictures++;
	}
	if (file)
		fclose(file);
	return count;
}

/* ---- tests ---- */

/* Six runs: a, b, a, b while both play, in the midst of in-betweens; then a and b, both stopped. */
static void test_switches(void)
{
	char path[128], option[160];
	static struct raw_reply reply;
	static struct run runs[RUNS_MOST];
	snprintf(path, sizeof(path), "%s/shown.y4m", fixture.folder);
	snprintf(option, sizeof(option), "--tee=%s", path);
	/* Blur would come to the border, where the motion ends. */
	const char *const arguments[] = {option, "--method=pursuit", "--blur=off", NULL};
	fixture_start(&fixture, arguments);
	open_player(&players[0]);
	CHECK(play_until_shown(&players[0], 12));
	open_player(&players[1]);
	CHECK(play_until_shown(&players[1], 12));
	CHECK_INT(ask("set focus=game a", &reply), 0);
	CHECK(play_until_shown(&players[0], 12));
	CHECK_INT(ask("set focus=game b", &reply), 0);
	CHECK(play_until_shown(&players[1], 12));
	wait_until_still();
	CHECK(focus_shows_something("set focus=game a"));
	CHECK(focus_shows_something("set focus=game b"));
	const int last_a = players[0].level, last_b = players[1].level;
	pursuit_close(&players[1].stream); /* what is left is shown */
	wait_until_still();
	pursuit_close(&players[0].stream);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);

	const uint32_t count = read_runs(path, runs);
	uint64_t in_betweens = 0;
	CHECK_INT(count, 7);
	for (uint32_t i = 0; i < count; i++) {
		CHECK_INT(runs[i].player, i % 2);
		in_betweens += i < 4 ? runs[i].in_betweens : 0;
	}
	CHECK(in_betweens > 12);
	for (uint32_t i = 4; i < 7 && i < count; i++) {
		CHECK_INT(runs[i].first_level, i == 5 ? last_b : last_a);
		CHECK_INT(runs[i].last_level, i == 5 ? last_b : last_a);
	}
}

int main(int argc, char **argv)
{
	(void)argc;
	fixture_init(&fixture, argv[1]);
	RUN(test_switches);
	fixture_finish(&fixture);
	return test_result();
}
