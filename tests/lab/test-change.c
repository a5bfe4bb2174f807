/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A lab's settings change while flips come, with chips that are the test's: what stays is not touched, what is new
 * comes first, what cannot be had leaves all as it was, and each flip has its row.
 */
#include <errno.h>
#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>
#include <unistd.h>

#include "daemon/lab/chip.h"
#include "daemon/lab/lab.h"
#include "daemon/lab/latency_log.h"
#include "daemon/options.h"
#include "tests/test.h"

#define LINES 8u
#define QUICK 100

/* ---- chips: one, with lines 0 to 7, each of which one chip at a time may have ---- */

struct chip {
	uint32_t lines[CHIP_LINES], count;
	int pipe[2];
};

static struct {
	pthread_mutex_t lock;
	bool taken[LINES], level[LINES];
	unsigned opened, closed, edges;
} board = {.lock = PTHREAD_MUTEX_INITIALIZER};

const char *chip_library(void)
{
	return "the test's";
}

static int take(struct chip *chip, const struct chip_params *params, struct error *error)
{
	const char *list = params->lines;
	char name[CHIP_NAME_BYTES];
	while (chip_next_line(&list, name) == 1) {
		const unsigned long line = strtoul(name, NULL, 10);
		if (strcmp(params->chip, "board") != 0 || line >= LINES)
			return error_set(error, -ENOENT, "%s: there is no %s %s", params->option, params->chip, name);
		if (board.taken[line])
			return error_set(error, -EBUSY, "%s: %s is busy", params->option, name);
		chip->lines[chip->count++] = (uint32_t)line;
	}
	for (uint32_t i = 0; i < chip->count; i++) {
		board.taken[chip->lines[i]] = true;
		if (!params->input)
			board.level[chip->lines[i]] = params->levels >> i & 1;
	}
	return 0;
}

struct chip *chip_open(const struct chip_params *params, struct error *error)
{
	struct chip *chip = calloc(1, sizeof(*chip));
	pthread_mutex_lock(&board.lock);
	const int result = take(chip, params, error);
	board.opened += result == 0;
	pthread_mutex_unlock(&board.lock);
	if (result == 0 && pipe(chip->pipe) == 0)
		return chip;
	free(chip);
	return NULL;
}

void chip_close(struct chip **chip)
{
	if (!*chip)
		return;
	pthread_mutex_lock(&board.lock);
	for (uint32_t i = 0; i < (*chip)->count; i++)
		board.taken[(*chip)->lines[i]] = false;
	board.closed++;
	pthread_mutex_unlock(&board.lock);
	close((*chip)->pipe[0]);
	close((*chip)->pipe[1]);
	free(*chip);
	*chip = NULL;
}

uint32_t chip_line_count(const struct chip *chip)
{
	return chip->count;
}

const char *chip_text(const struct chip *chip)
{
	(void)chip;
	return "board";
}

int chip_set(struct chip *chip, uint32_t levels)
{
	pthread_mutex_lock(&board.lock);
	for (uint32_t i = 0; i < chip->count; i++) {
		board.edges += board.level[chip->lines[i]] != (levels >> i & 1);
		board.level[chip->lines[i]] = levels >> i & 1;
	}
	pthread_mutex_unlock(&board.lock);
	return 0;
}

int chip_get(struct chip *chip, uint32_t *levels)
{
	(void)chip;
	*levels = 0;
	return 0;
}

int chip_fd(const struct chip *chip)
{
	return chip->pipe[0];
}

int chip_read(struct chip *chip, struct chip_edge *edges, uint32_t most)
{
	(void)chip;
	(void)edges;
	(void)most;
	return 0;
}

static bool is_taken(unsigned line)
{
	pthread_mutex_lock(&board.lock);
	const bool taken = board.taken[line];
	pthread_mutex_unlock(&board.lock);
	return taken;
}

static bool is_high(unsigned line)
{
	pthread_mutex_lock(&board.lock);
	const bool level = board.level[line];
	pthread_mutex_unlock(&board.lock);
	return level;
}

/* ---- the lab ---- */

static struct clock real_clock;
static struct log quiet;
static struct settings settings;
static struct lab *lab;
static uint64_t vblank;
static char folder[] = "/tmp/pursuit-lab-XXXXXX";

static void flip(unsigned count)
{
	for (unsigned i = 0; i < count; i++) {
		const uint64_t now_ns = clock_now(&real_clock);
		const struct presenter_flip event = {
			.vblank = ++vblank, .target_ns = now_ns, .flip_ns = now_ns, .serial = vblank, .shown = PRESENTER_PICTURE};
		const struct points points = {.vblank = vblank, .frame_id = vblank};
		struct presenter_image image = {.data = NULL};
		lab_mark_picture(lab, &image, vblank, vblank, POINTS_REAL);
		lab_flip(lab, &event);
		lab_tell(lab, &points);
		nanosleep(&(struct timespec){0, 1000000}, NULL);
	}
}

/* "name=value name=value" */
static struct settings changed(const char *changes)
{
	struct settings fresh = settings;
	char words[256], *rest = words;
	struct error error = {""};
	snprintf(words, sizeof(words), "%s", changes);
	for (char *word; (word = strtok_r(rest, " ", &rest)) != NULL;) {
		char *equals = strchr(word, '=');
		*equals = 0;
		CHECK_INT(settings_set(&fresh, word, equals + 1, &error), 0);
	}
	return fresh;
}

static void change(const char *changes)
{
	const struct settings fresh = changed(changes);
	struct error error = {""};
	const int result = lab_prepare(lab, &fresh.lab, 0.0, "", &error);
	if (result < 0)
		fprintf(stderr, "%s: %s\n", changes, error.text);
	CHECK_INT(result, 0);
	if (result < 0)
		return;
	struct latency_log *log = lab_commit(lab);
	latency_log_destroy(&log);
	settings = fresh;
}

static void refuse(const char *changes, const char *sentence)
{
	const struct settings fresh = changed(changes);
	struct error error = {""};
	CHECK(lab_prepare(lab, &fresh.lab, 0.0, "", &error) < 0);
	if (!strstr(error.text, sentence))
		CHECK_STRING(error.text, sentence);
}

static json_int_t count(const char *name)
{
	json_t *status = lab_status_json(lab);
	const json_int_t value = json_integer_value(json_object_get(status, name));
	json_decref(status);
	return value;
}

static void wait_for(const char *name, json_int_t wanted)
{
	for (int i = 0; i < 6000 && count(name) < wanted; i++)
		nanosleep(&(struct timespec){0, 10000000}, NULL);
	CHECK_INT(count(name), wanted);
}

/* ---- tests ---- */

static void test_off_and_on(void)
{
	CHECK(!lab_is_active(lab));
	flip(3);
	CHECK(!lab_status_json(lab));
	for (int i = 0; i < 10; i++) {
		change("latency=yes");
		CHECK(lab_is_active(lab));
		flip(3);
		change("latency=no");
		CHECK(!lab_is_active(lab));
		flip(1);
	}
	change("latency=yes");
	wait_for("rows", 30);
}

/* The line stays as it is while other things change: not opened anew, an edge a flip. */
static void test_line_that_stays(void)
{
	change("gpio-chip=board gpio-line=1");
	const unsigned opened = board.opened;
	const json_int_t rows = count("rows"), edges = count("edges");
	for (int i = 0; i < QUICK; i++) {
		char changes[128];
		snprintf(changes, sizeof(changes), "gpio-pulse-us=%d debounce-us=%d patch=%s strobe-phase=0.%d", 100 + i, i,
				 i % 2 ? "off" : "sequence", i % 10);
		flip(1);
		change(changes);
	}
	CHECK_INT(board.opened, opened);
	wait_for("rows", rows + QUICK);
	wait_for("edges", edges + QUICK);
	CHECK_INT(count("lost_edges"), 0);
}

static void test_other_lines(void)
{
	change("gpio-line=2");
	CHECK(!is_taken(1) && is_taken(2));
	change("gpio-line=2,3 gpio-pattern=counter"); /* one that is held */
	CHECK(is_taken(2) && is_taken(3));
	change("gpio-active-low=yes");
	flip(2);
	change("photodiode-line=4 trigger-line=5 vsync-line=6");
	CHECK(is_taken(4) && is_taken(5) && is_taken(6));
	change("photodiode-line=5 trigger-line=4"); /* each other's */
	CHECK(is_taken(4) && is_taken(5));
	change("photodiode-line= trigger-line= vsync-line=");
	CHECK(!is_taken(4) && !is_taken(5) && !is_taken(6));
	change("gpio-line=1 gpio-pattern=toggle gpio-active-low=no");
	CHECK(is_taken(1) && !is_taken(2));
}

/* A line that is left has its final level, whether or not others had to be let go for the change; the others wait. */
static void test_levels_that_are_left(void)
{
	change("gpio-line=1,2,3 gpio-pattern=counter gpio-final=high");
	CHECK(!is_high(1) && !is_high(2) && !is_high(3));
	change("gpio-line=3,4,5");
	CHECK(is_high(1) && is_high(2) && !is_high(3) && !is_high(4));
	refuse("gpio-line=3,9,4", "there is no board 9");
	CHECK(!is_high(3) && !is_high(5));
	change("gpio-final=keep");
	change("gpio-line=4,6,7");
	CHECK(!is_high(3) && !is_high(5));
	change("gpio-line=1 gpio-pattern=toggle gpio-final=low");
	change("gpio-line=2");
	CHECK(!is_high(1));
	change("gpio-line=1");
}

static void test_refusals(void)
{
	const json_int_t rows = count("rows"), edges = count("edges");
	for (int i = 0; i < 10; i++) {
		refuse("gpio-line=9", "there is no board 9");
		refuse("gpio-chip=other", "there is no other");
		refuse("gpio-line=1,2", "the pattern wants 1");
		refuse("trigger-line=4 photodiode-line=9", "there is no board 9");
		refuse("latency-log=/no-such-folder/log.csv", "/no-such-folder/log.csv");
		flip(1);
		for (int j = 0; j < 60000 && !is_taken(1); j++)
			nanosleep(&(struct timespec){0, 1000000}, NULL);
		CHECK(is_taken(1));
		CHECK(!is_taken(4));
	}
	wait_for("rows", rows + 10);
	wait_for("edges", edges + 10);
}

static void test_logs(void)
{
	char changes[128];
	for (int i = 0; i < 3; i++) {
		snprintf(changes, sizeof(changes), "latency-log=%s/%d.csv", folder, i);
		change(changes);
		flip(2);
	}
	change("latency-log=");
	for (int i = 0; i < 3; i++) {
		snprintf(changes, sizeof(changes), "%s/%d.csv", folder, i);
		CHECK(access(changes, F_OK) == 0);
		unlink(changes);
	}
}

static void test_strobe(void)
{
	change("strobe-line=7");
	CHECK(is_taken(7));
	flip(2);
	change("strobe-duty=0.2 strobe-phase=0.1");
	change("strobe-line=6");
	CHECK(is_taken(6) && !is_taken(7));
	change("strobe-line=");
	CHECK(!is_taken(6));
}

int main(void)
{
	struct error error = {""};
	clock_init_real(&real_clock);
	log_init(&quiet, LOG_LEVEL_ERROR);
	settings_defaults(&settings);
	CHECK(mkdtemp(folder) != NULL);
	CHECK_INT(settings_set(&settings, "lab-priority", "0", &error), 0);
	const struct lab_params params = {.settings = &settings.lab, .clock = &real_clock, .log = &quiet, .period_ns = 8e6};
	lab = lab_create(&params, &error);
	CHECK(lab != NULL);
	RUN(test_off_and_on);
	RUN(test_line_that_stays);
	RUN(test_other_lines);
	RUN(test_levels_that_are_left);
	RUN(test_refusals);
	RUN(test_logs);
	RUN(test_strobe);
	lab_destroy(&lab);
	for (unsigned i = 0; i < LINES; i++)
		CHECK(!is_taken(i));
	CHECK_INT(board.opened, board.closed);
	rmdir(folder);
	return test_result();
}
