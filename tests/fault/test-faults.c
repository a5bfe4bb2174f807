/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Each call that can fail, failed in turn (faults.h), in recordings, images,
 * the shim and the server. Always: no crash, no leak, no descriptor left open,
 * what was said to be done is done. Interrupted and short calls change nothing.
 * docs/faults.md is the table.
 */

#include <errno.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "daemon/control.h"
#include "daemon/lab/latency_log.h"
#include "daemon/lab/latency_read.h"
#include "daemon/record/image.h"
#include "daemon/record/recorder.h"
#include "daemon/server.h"
#include "tests/client/fake_daemon.h"
#include "tests/fault/faults.h"
#include "tests/fuzz/fake-output.h"
#include "tests/fuzz/talker.h"
#include "tests/record/sample.h"
#include "tests/record/sample_exr.h"
#include "tests/test.h"

#define FRAMES 3u
#define MOST_CALLS 2000u

static struct sample samples[FRAMES];

/* ---- recordings ---- */

/* Frames that were said to be written. */
static uint64_t write_frames(const char *path, bool *complete)
{
	const struct recording_writer_params params = {.path = path, .info = "program=test\n"};
	struct error error;
	uint64_t written = 0;
	struct recording_writer *writer = recording_writer_create(&params, &error);
	*complete = false;
	if (!writer)
		return 0;
	*complete = true;
	for (uint32_t i = 0; i < FRAMES; i++) {
		const bool fine = recording_writer_frame(writer, &samples[i].frame, i, &error) == 0;
		written += fine;
		*complete &= fine;
	}
	*complete &= recording_writer_close(&writer, &error) == 0;
	return written;
}

/* Frames that are read back and equal. */
static uint64_t read_frames(const char *path)
{
	const struct recording_reader_params params = {.path = path};
	struct error error;
	uint64_t same = 0;
	struct recording_reader *reader = recording_reader_create(&params, &error);
	for (uint32_t i = 0; reader && i < recording_reader_frame_count(reader); i++) {
		struct frame frame;
		if (recording_reader_frame(reader, i, 0, &frame, NULL, &error) == 0)
			for (uint32_t k = 0; k < FRAMES; k++)
				same += sample_equal(&frame, &samples[k].frame);
	}
	recording_reader_destroy(&reader);
	return same;
}

/* What was written before the disk was full is there. */
static bool run_writer(void)
{
	bool complete;
	const char *path = sample_path("written.pursuit");
	const uint64_t written = write_frames(path, &complete);
	fault_pause(true);
	if (written > 0)
		CHECK(read_frames(path) >= written);
	return complete;
}

static bool run_reader(void)
{
	return read_frames(sample_path("good.pursuit")) == FRAMES;
}

static bool run_recorder(void)
{
	const char *path = sample_path("recorded.pursuit");
	const struct recorder_params params = {.writer = {.path = path}};
	struct recorder_stats stats = {0};
	struct error error;
	struct recorder *recorder = recorder_create(&params, &error);
	if (!recorder)
		return false;
	for (uint32_t i = 0; i < FRAMES; i++)
		recorder_push(recorder, &samples[i].frame, i);
	const bool fine = recorder_destroy(&recorder, &stats, &error) == 0;
	fault_pause(true);
	CHECK_INT(stats.frames_written + stats.frames_dropped, FRAMES);
	if (stats.frames_written > 0)
		CHECK(read_frames(path) >= stats.frames_written);
	return fine && stats.frames_written == FRAMES;
}

/* ---- the latency log ---- */

#define LOG_ROWS 600u

static void write_latency(const char *path)
{
	static const struct log quiet = {.fd = 2, .level = LOG_LEVEL_ERROR};
	struct error error;
	struct latency_log *log = latency_log_create(path, "setting refresh = 120\n", &quiet, &error);
	for (uint64_t i = 1; i <= LOG_ROWS; i++) {
		const struct points points = {.vblank = i, .frame_id = i, .method = "hold"};
		latency_log_push(log, &points);
	}
	latency_log_destroy(&log);
}

static bool read_latency(const char *name)
{
	struct latency_table table;
	struct error error;
	if (latency_read(sample_path(name), &table, &error) < 0)
		return false;
	CHECK(table.count > 0 && table.count <= LOG_ROWS);
	latency_table_finish(&table);
	return true;
}

static bool run_latency(void)
{
	const bool text = read_latency("latency.csv");
	return read_latency("latency.bin") && text;
}

/* ---- images ---- */

static bool run_images(void)
{
	static const char *const names[] = {"a.png", "a.pfm", "a.exr"};
	uint8_t picture[4 * 4 * 4] = {0};
	struct image image;
	struct error error;
	bool fine = image_write_png(sample_path("b.png"), picture, 16, 4, 4, false, &error) == 0;
	for (size_t i = 0; i < 6; i++) {
		const bool read =
			image_read(sample_path(names[i / 2]), i % 2 ? IMAGE_VALUES : IMAGE_BGRA, 0, &image, &error) == 0;
		if (read)
			image_finish(&image);
		fine &= read;
	}
	return fine;
}

static void prepare_files(void)
{
	static const float values[4 * 4] = {0.5f};
	static const struct sample_exr_channel channel = {"Z", 2, values};
	const struct sample_exr exr = {.width = 4, .height = 4, .compression = 3, .channels = &channel, .channel_count = 1};
	const uint8_t picture[4 * 4 * 4] = {0};
	struct error error;
	bool complete;
	for (uint32_t i = 0; i < FRAMES; i++)
		sample_init(&samples[i], i + 1, 16, 9);
	CHECK_INT(write_frames(sample_path("good.pursuit"), &complete), FRAMES);
	CHECK_INT(image_write_png(sample_path("a.png"), picture, 16, 4, 4, true, &error), 0);
	CHECK_INT(image_write_pfm(sample_path("a.pfm"), values, 4, 4, 1, &error), 0);
	CHECK(sample_exr_write(sample_path("a.exr"), &exr));
	write_latency(sample_path("latency.csv"));
	write_latency(sample_path("latency.bin"));
}

/* ---- the shim ---- */

/* One turn of a game, and of the daemon, which is the test's own. */
static bool turn(struct pursuit_stream *stream, struct fake_daemon *daemon)
{
	const uint8_t *planes;
	struct pursuit_frame *frame = pursuit_acquire(stream);
	if (frame)
		pursuit_submit(stream, frame);
	fault_pause(true);
	fake_step(daemon);
	const bool arrived = fake_take(daemon, &planes) != NULL;
	usleep(2000);
	fault_pause(false);
	return arrived;
}

/* Whatever failed, the game goes on, and its frames arrive in the end. */
static bool run_shim(void)
{
	struct fake_daemon daemon;
	struct pursuit_stream_params params = {.width = 16, .height = 8};
	fault_pause(true);
	params.socket_path = sample_path("socket");
	CHECK(fake_start(&daemon, params.socket_path, FAKE_GOOD));
	fault_pause(false);
	struct pursuit_stream *stream = pursuit_open(&params);
	int arrived = 0;
	for (int i = 0; stream && i < 4000 && arrived < 2; i++)
		arrived += turn(stream, &daemon);
	if (stream)
		CHECK_INT(arrived, 2);
	pursuit_close(&stream);
	fault_pause(true);
	fake_stop(&daemon, true);
	return arrived == 2;
}

/* ---- the server ---- */

struct world {
	struct settings settings;
	struct clock clock;
	struct loop *loop;
	struct output *output;
	struct live live;
	struct reload reload;
	struct control *control;
	struct server *server;
};

static bool create(struct world *world)
{
	struct error error;
	world->loop = loop_create(&error);
	if (!world->loop)
		return false;
	struct arguments arguments;
	char *argv[] = {NULL};
	if (arguments_read(&arguments, 0, argv, &error) < 0)
		return false;
	live_init(&world->live, &world->settings, &arguments.profiles, NULL);
	reload_init(&world->reload, &world->live, NULL, &arguments, 0, argv);
	const struct control_params control_params = {.loop = world->loop,
												  .clock = &world->clock,
												  .settings = &world->settings,
												  .output = world->output,
												  .live = &world->live,
												  .reload = &world->reload};
	world->control = control_create(&control_params, &error);
	if (!world->control)
		return false;
	const struct server_params server_params = {.loop = world->loop,
												.clock = &world->clock,
												.settings = &world->settings,
												.output = world->output,
												.control = control_handle,
												.data = world->control};
	world->server = server_create(&server_params, &error);
	if (world->server)
		control_set_server(world->control, world->server);
	return world->server != NULL;
}

static void step(struct world *world)
{
	struct error error;
	fault_pause(false);
	for (int i = 0; i < 3; i++)
		CHECK_INT(loop_step(world->loop, 0, &error), 0);
	fault_pause(true);
}

/* A stream with a frame, requests and a recording: bytes as of a fuzzer (tests/fuzz/talker.c). */
static void talk(struct world *world)
{
	static const uint8_t acts[][4] = {{2, 0, 1, 0}, {5, 2, 0, 0}, {9, 0, 0, 0}, {9, 1, 0, 0}, {9, 4, 13, 0},
									  {5, 0, 0, 0}, {9, 5, 0, 0}, {9, 2, 0, 0}, {8, 0, 0, 0}, {4, 1, 0, 0}};
	struct talker talker;
	talker_init(&talker);
	talker_connect(&talker, world->settings.socket);
	talker_greet(&talker);
	step(world);
	for (size_t i = 0; i < sizeof(acts) / sizeof(acts[0]); i++) {
		struct fuzz_input input = {acts[i], sizeof(acts[i])};
		talker_act(&talker, &input);
		step(world);
		fault_pause(false);
		fake_output_take(world->output);
		fault_pause(true);
		step(world);
	}
	talker_finish(&talker);
	step(world);
}

/* A client that comes afterwards is served. */
static bool serves(struct world *world)
{
	struct pursuit_message_welcome welcome = {.header = {.type = 0}};
	struct talker talker;
	talker_init(&talker);
	talker_connect(&talker, world->settings.socket);
	talker_greet(&talker);
	step(world);
	const ssize_t got = recv(talker.socket, &welcome, sizeof(welcome), MSG_DONTWAIT);
	talker_finish(&talker);
	step(world);
	return got == (ssize_t)sizeof(welcome) && welcome.header.type == PURSUIT_MESSAGE_WELCOME;
}

static bool run_server(void)
{
	struct world world = {.loop = NULL};
	bool served = false;
	fault_pause(true);
	settings_defaults(&world.settings);
	snprintf(world.settings.socket, sizeof(world.settings.socket), "%s", sample_path("server"));
	clock_init_real(&world.clock);
	world.output = fake_output_create(&world.clock);
	fault_pause(false);
	if (create(&world)) {
		fault_pause(true);
		talk(&world);
		/* The planned call may be one that is still to come: the first client may meet it, the second may not. */
		served = serves(&world) || serves(&world);
		CHECK(served);
		CHECK_INT(server_client_count(world.server), 0);
		CHECK_INT(fake_output_stream_count(world.output), 0);
	}
	fault_pause(true);
	if (world.control)
		control_set_server(world.control, NULL);
	server_destroy(&world.server);
	control_destroy(&world.control);
	live_finish(&world.live);
	fake_output_destroy(&world.output);
	loop_destroy(&world.loop);
	return served;
}

/* ---- each call in turn ---- */

static const struct part {
	const char *name;
	bool (*run)(void); /* true: all went well */
} parts[] = {
	{"writer", run_writer}, {"reader", run_reader}, {"recorder", run_recorder}, {"latency", run_latency},
	{"images", run_images}, {"shim", run_shim},     {"server", run_server},
};

static uint64_t fail_in_turn(const struct part *part, enum fault_kind kind)
{
	const bool harmless = kind == FAULT_INTERRUPTED || kind == FAULT_SHORT;
	uint64_t index = 0;
	for (; index < MOST_CALLS; index++) {
		const int open_fds = fuzz_open_fds();
		fault_plan(kind, index);
		const bool fine = part->run();
		const bool came = fault_end();
		CHECK_INT(fuzz_open_fds(), open_fds);
		if (!came || harmless)
			CHECK(fine);
		if (test_failed()) {
			fprintf(stderr, "%s, %s, call %llu\n", part->name, fault_name(kind), (unsigned long long)index);
			break;
		}
		if (!came)
			break;
	}
	CHECK(index < MOST_CALLS);
	return index;
}

static void test_each_call(void)
{
	uint64_t together = 0;
	for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		printf("       %-9s", parts[i].name);
		for (int kind = FAULT_NONE + 1; kind < FAULT_KINDS && !test_failed(); kind++) {
			const uint64_t calls = fail_in_turn(&parts[i], (enum fault_kind)kind);
			together += calls;
			printf(" %s %llu%s", fault_name((enum fault_kind)kind), (unsigned long long)calls,
				   kind + 1 < FAULT_KINDS ? "," : "\n");
		}
	}
	printf("       %llu calls failed in turn\n", (unsigned long long)together);
}

int main(void)
{
	signal(SIGPIPE, SIG_IGN);
	CHECK(sample_folder() != NULL);
	prepare_files();
	RUN(test_each_call);
	for (uint32_t i = 0; i < FRAMES; i++)
		sample_finish(&samples[i]);
	sample_folder_remove();
	return test_result();
}
