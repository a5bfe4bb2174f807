/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What presenting costs, headless at 120 Hz, method pursuit, as lines of `name value unit`:
 *   cpu       CPU time of the daemon, all its threads, as a share of a core: with nothing to do, with a client that has
 *             stopped, and with a still picture sent 60 times a second, declared and found by looking
 *   wake      from a vblank's time to the presenting thread's flip, in a still picture, by --spin-us; and what its
 * thread needs for that of a core overhead  from a frame's submission to its picture, less the time that the engine
 * worked meanwhile
 *
 *   bench-presenting PURSUITD [SECONDS]
 */
#include <dirent.h>
#include <inttypes.h>
#include <jansson.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"

enum content { STOPPED, DECLARED, LOOKED, MOVING };
static const char *const content_names[] = {"stopped", "still_declared", "still_looked", "moving"};

static const struct size {
	uint32_t width, height;
} sizes[] = {{640, 360}, {1280, 720}, {1920, 1080}};

static struct fixture fixture;
static unsigned seconds = 5;

/* ---- the daemon ---- */

static bool is_thread(const char *task, const char *name)
{
	char path[400], text[32] = "";
	snprintf(path, sizeof(path), "/proc/%d/task/%s/comm", (int)fixture.pid, task);
	FILE *file = fopen(path, "r");
	const bool read = file && fgets(text, sizeof(text), file);
	if (file)
		fclose(file);
	return read && strncmp(text, name, strlen(name)) == 0;
}

/* ns that threads of this name have run; NULL: all. */
static uint64_t thread_ran_ns(const char *name)
{
	char path[64], file_name[400];
	uint64_t sum = 0;
	snprintf(path, sizeof(path), "/proc/%d/task", (int)fixture.pid);
	DIR *folder = opendir(path);
	for (const struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
		uint64_t ran = 0;
		if (name && !is_thread(entry->d_name, name))
			continue;
		snprintf(file_name, sizeof(file_name), "%s/%s/schedstat", path, entry->d_name);
		FILE *file = fopen(file_name, "r");
		if (file && fscanf(file, "%" SCNu64, &ran) == 1)
			sum += ran;
		if (file)
			fclose(file);
	}
	if (folder)
		closedir(folder);
	return sum;
}

static double status_figure(const char *object, const char *name)
{
	static struct raw_reply reply;
	const int fd = raw_greet(fixture.socket);
	double value = -1.0;
	if (raw_control(fd, "status", -1, &reply) == 0) {
		json_t *json = json_loads((const char *)reply.raw + sizeof(reply.control), 0, NULL);
		const json_t *at = *object ? json_object_get(json, object) : json;
		value = json_number_value(json_object_get(at, name));
		json_decref(json);
	}
	close(fd);
	return value;
}

/* ---- the client ---- */

static struct pursuit_stream *open_stream(const struct size *size)
{
	const struct pursuit_stream_params params = {.width = size->width,
												 .height = size->height,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT16,
												 .socket_path = fixture.socket};
	return pursuit_open(&params);
}

/* Noise; the middle third moves by 4 pixels to the left (as a half: 0xc400) from each slot to the next. */
static void draw(struct pursuit_frame *frame, bool moves, uint32_t slot)
{
	const uint32_t width = frame->color.width, height = frame->color.height;
	for (uint32_t y = 0; y < height; y++) {
		uint32_t *color = (uint32_t *)(void *)(frame->color.data + y * frame->color.stride);
		float *depth = (float *)(void *)(frame->depth.data + y * frame->depth.stride);
		uint16_t *motion = (uint16_t *)(void *)(frame->motion.data + y * frame->motion.stride);
		for (uint32_t x = 0; x < width; x++) {
			const bool inside = x > width / 3 && x < width * 2 / 3 && y > height / 3 && y < height * 2 / 3;
			const uint32_t place = x + (inside && moves ? 4 * slot : 0);
			color[x] = 0xff000000u | (place * 2654435761u ^ y * 40503u) >> 8;
			depth[x] = inside ? 0.3f : 0.6f;
			motion[2 * x] = moves && inside ? 0xc400 : 0;
			motion[2 * x + 1] = 0;
		}
	}
}

/* Each slot is drawn once: a client that writes would only disturb. */
static void play(struct pursuit_stream *stream, enum content content, double play_seconds)
{
	const uint8_t *drawn[8] = {NULL};
	uint64_t next_ns = now_ns();
	const uint64_t end_ns = next_ns + (uint64_t)(play_seconds * 1e9);
	for (; next_ns < end_ns; next_ns += 1000000000u / 60) {
		const struct timespec then = {(time_t)(next_ns / 1000000000u), (long)(next_ns % 1000000000u)};
		clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &then, NULL);
		struct pursuit_frame *frame = pursuit_acquire(stream);
		if (!frame)
			continue;
		unsigned slot = 0;
		while (slot < 7 && drawn[slot] && drawn[slot] != frame->color.data)
			slot++;
		if (drawn[slot] != frame->color.data)
			draw(frame, content == MOVING, slot);
		drawn[slot] = frame->color.data;
		frame->time_ns = next_ns;
		frame->flags |= content == DECLARED ? PURSUIT_FLAG_DAMAGE : 0u;
		pursuit_submit(stream, frame);
	}
}

/* ---- measurements ---- */

static void print_cpu(const char *name, const struct size *size, double share)
{
	char dimensions[32] = "";
	if (size)
		snprintf(dimensions, sizeof(dimensions), ".%ux%u", size->width, size->height);
	printf("presenting.cpu.%s%s %.2f %% of a core\n", name, dimensions, 100.0 * share);
	fflush(stdout);
}

static double measure_waiting(void)
{
	const uint64_t before = thread_ran_ns(NULL);
	sleep_ms(seconds * 1000);
	return (double)(thread_ran_ns(NULL) - before) / (seconds * 1e9);
}

static void measure_cpu(const struct size *size, enum content content)
{
	struct pursuit_stream *stream = open_stream(size);
	play(stream, content, 1.5);
	if (content == STOPPED) {
		sleep_ms(1000);
		print_cpu(content_names[content], size, measure_waiting());
	} else {
		const uint64_t before = thread_ran_ns(NULL);
		play(stream, content, seconds);
		print_cpu(content_names[content], size, (double)(thread_ran_ns(NULL) - before) / (seconds * 1e9));
	}
	pursuit_close(&stream);
	sleep_ms(200);
}

/* A daemon of its own, since percentiles are those of its whole run. */
static void measure_overhead(const struct size *size)
{
	const char *const arguments[] = {"--method=pursuit", NULL};
	fixture_start(&fixture, arguments);
	struct pursuit_stream *stream = open_stream(size);
	play(stream, MOVING, 2.0 * seconds);
	printf("presenting.overhead.%ux%u.median %.3f ms\n", size->width, size->height,
		   status_figure("overhead_ms", "p50"));
	printf("presenting.overhead.%ux%u.p99 %.3f ms\n", size->width, size->height, status_figure("overhead_ms", "p99"));
	fflush(stdout);
	pursuit_close(&stream);
	fixture_stop(&fixture, SIGTERM);
}

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* From vblank to flip, in us: columns of the latency log by their names. */
static size_t read_wakes(const char *path, double *wakes, size_t most)
{
	char line[2048];
	size_t count = 0;
	int target = -1, flip = -1;
	FILE *file = fopen(path, "r");
	while (file && fgets(line, sizeof(line), file) && count < most) {
		uint64_t target_ns = 0, flip_ns = 0;
		const bool names = strstr(line, "target_ns") && strstr(line, "flip_ns");
		int column = 0;
		char *rest = line;
		for (const char *word; (word = strsep(&rest, ",\n")) != NULL; column++) {
			if (names && strcmp(word, "target_ns") == 0)
				target = column;
			if (names && strcmp(word, "flip_ns") == 0)
				flip = column;
			if (!names && column == target)
				target_ns = strtoull(word, NULL, 10);
			if (!names && column == flip)
				flip_ns = strtoull(word, NULL, 10);
		}
		if (target_ns && flip_ns)
			wakes[count++] = ((double)flip_ns - (double)target_ns) / 1e3;
	}
	if (file)
		fclose(file);
	return count;
}

static void measure_wakes(const char *spin_us)
{
	static double wakes[100000];
	const struct size size = {640, 360};
	char path[128];
	snprintf(path, sizeof(path), "%s/wakes.csv", fixture.folder);
	const char *const arguments[] = {"--spin-us", spin_us, "--latency-log", path, NULL};
	unlink(path);
	fixture_start(&fixture, arguments);
	struct pursuit_stream *stream = open_stream(&size);
	play(stream, DECLARED, 1.0);
	const uint64_t before = thread_ran_ns("pursuit-flip");
	play(stream, DECLARED, 2.0 * seconds);
	const double share = (double)(thread_ran_ns("pursuit-flip") - before) / (2e9 * seconds);
	pursuit_close(&stream);
	fixture_stop(&fixture, SIGTERM);
	const size_t count = read_wakes(path, wakes, sizeof(wakes) / sizeof(wakes[0]));
	qsort(wakes, count, sizeof(wakes[0]), compare);
	if (count > 0)
		printf("presenting.wake.spin_%s.median %.1f us\npresenting.wake.spin_%s.p99 %.1f us\n", spin_us,
			   wakes[count / 2], spin_us, wakes[count - 1 - count / 100]);
	printf("presenting.wake.spin_%s.cpu %.2f %% of a core\n", spin_us, 100.0 * share);
	fflush(stdout);
}

int main(int argc, char **argv)
{
	static const char *const spins[] = {"0", "50", "100", "200", "400"};
	const char *const arguments[] = {"--method=pursuit", NULL};
	if (argc > 2)
		seconds = (unsigned)atoi(argv[2]);
	fixture_init(&fixture, argv[1]);
	for (size_t i = 0; i < sizeof(spins) / sizeof(spins[0]); i++)
		measure_wakes(spins[i]);
	fixture_start(&fixture, arguments);
	sleep_ms(1000);
	print_cpu("waiting", NULL, measure_waiting());
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
		for (enum content content = STOPPED; content <= MOVING; content++)
			measure_cpu(&sizes[i], content);
	fixture_stop(&fixture, SIGTERM);
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
		measure_overhead(&sizes[i]);
	fixture_finish(&fixture);
	return 0;
}
