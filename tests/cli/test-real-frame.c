/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Motion of the real frames when only each K-th is real: frame i of the recording moves by i + 1 pixels everywhere. */

#include <unistd.h>

#include "daemon/cli/real_frame.h"
#include "tests/test.h"

#define WIDTH 8u
#define HEIGHT 4u
#define COUNT 12u
#define STEP_NS UINT64_C(10000000)

struct fixture {
	char path[64];
	struct recording_reader *reader;
	struct recorded_frames recorded;
	struct real_frames real;
	struct error error;
};

static void write_frame(struct recording_writer *writer, uint32_t index, uint32_t kind, uint32_t flags)
{
	static uint8_t planes[65536];
	struct error error;
	struct frame frame = {.header = {.frame_id = index + 1,
									 .time_ns = 1000000000 + index * STEP_NS,
									 .real_interval_ns = STEP_NS,
									 .flags = flags,
									 .plane_count = 2,
									 .motion_kind = kind}};
	frame.header.planes[0] = (struct pursuit_plane){.role = PURSUIT_ROLE_COLOR, .format = PURSUIT_FORMAT_BGRA8};
	frame.header.planes[0].transfer.curve = PURSUIT_CURVE_SRGB;
	frame.header.planes[1] = (struct pursuit_plane){.role = PURSUIT_ROLE_MOTION, .format = PURSUIT_FORMAT_RG32F};
	for (uint32_t i = 0; i < 2; i++) {
		frame.header.planes[i].width = WIDTH;
		frame.header.planes[i].height = HEIGHT;
	}
	CHECK(frame_layout(&frame.header) <= sizeof(planes));
	for (uint32_t y = 0; y < HEIGHT; y++) {
		for (uint32_t x = 0; x < WIDTH; x++) {
			const float motion[2] = {(float)(index + 1), -1.0f};
			const struct pursuit_plane *plane = &frame.header.planes[1];
			memcpy(planes + plane->offset + y * plane->stride + x * sizeof(motion), motion, sizeof(motion));
		}
	}
	for (uint32_t i = 0; i < 2; i++)
		frame.planes[i] = planes + frame.header.planes[i].offset;
	CHECK_INT(recording_writer_frame(writer, &frame, frame.header.time_ns, &error), 0);
}

/* `missing`: a frame that is left out; `cut`: one that is flagged as a cut; COUNT: none. */
static void setup(struct fixture *f, uint32_t kind, uint32_t missing, uint32_t cut)
{
	*f = (struct fixture){.path = "/tmp/pursuit-test-XXXXXX"};
	const struct recording_writer_params file = {.path = f->path, .fd = mkstemp(f->path)};
	struct recording_writer *writer = recording_writer_create(&file, &f->error);
	CHECK(writer != NULL);
	for (uint32_t i = 0; i < COUNT; i++) {
		if (i != missing)
			write_frame(writer, i, kind, i == cut ? PURSUIT_FRAME_CUT : 0);
	}
	CHECK_INT(recording_writer_close(&writer, &f->error), 0);
	const struct recording_reader_params params = {.path = f->path};
	f->reader = recording_reader_create(&params, &f->error);
	CHECK(f->reader != NULL);
	CHECK_INT(recorded_frames_read(&f->recorded, f->reader, &f->error), 0);
	f->real = (struct real_frames){.reader = f->reader, .frames = &f->recorded};
}

static void teardown(struct fixture *f)
{
	real_frames_finish(&f->real);
	recorded_frames_finish(&f->recorded);
	recording_reader_destroy(&f->reader);
	unlink(f->path);
}

/* Loads the recorded frame `index` as a real one that spans `span`. */
static void load(struct fixture *f, uint32_t index, uint32_t span, struct frame *frame)
{
	const struct beginning beginning = {
		.frame = index, .span = span, .params = {.n = span, .real_interval_ns = span * STEP_NS}};
	CHECK_INT(real_frames_load(&f->real, &beginning, frame, &f->error), 0);
}

static void check_motion(const struct frame *frame, float x, float y, uint32_t steps)
{
	int index = frame_find_plane(&frame->header, PURSUIT_ROLE_MOTION);
	float motion[2];
	for (uint32_t row = 0; row < HEIGHT; row++) {
		memcpy(motion, frame->planes[index] + row * frame->header.planes[index].stride, sizeof(motion));
		CHECK_NEAR(motion[0], x, 0);
		CHECK_NEAR(motion[1], y, 0);
	}
	CHECK_INT(frame->header.motion_interval_ns, steps * STEP_NS);
}

static void test_backward_looks_back(void)
{
	struct fixture f;
	struct frame frame;
	setup(&f, PURSUIT_MOTION_BACKWARD, COUNT, COUNT);
	load(&f, 6, 3, &frame);
	check_motion(&frame, 7 + 6 + 5, -3, 3);
	CHECK_INT(frame.header.real_interval_ns, 3 * STEP_NS);
	load(&f, 6, 1, &frame);
	CHECK_INT(frame.header.motion_interval_ns, 0);
	teardown(&f);
}

static void test_forward_looks_ahead(void)
{
	struct fixture f;
	struct frame frame;
	setup(&f, PURSUIT_MOTION_FORWARD, COUNT, COUNT);
	load(&f, 6, 3, &frame);
	check_motion(&frame, 7 + 8 + 9, -3, 3);
	teardown(&f);
}

static void test_chains_that_end_early(void)
{
	struct fixture f;
	struct frame frame;
	setup(&f, PURSUIT_MOTION_BACKWARD, COUNT, COUNT);
	load(&f, 0, 3, &frame);
	check_motion(&frame, 1, -1, 1);
	load(&f, 1, 3, &frame);
	check_motion(&frame, 2 + 1, -2, 2);
	teardown(&f);
	setup(&f, PURSUIT_MOTION_BACKWARD, 5, COUNT);
	CHECK_INT(f.recorded.count, COUNT - 1);
	CHECK_INT(f.recorded.frames[5].position, 6);
	load(&f, 5, 3, &frame);
	check_motion(&frame, 7, -1, 1);
	teardown(&f);
}

static void test_cut_on_a_frame_of_truth(void)
{
	struct fixture f;
	struct frame frame;
	setup(&f, PURSUIT_MOTION_BACKWARD, COUNT, 5);
	load(&f, 6, 3, &frame);
	CHECK(frame.header.flags & PURSUIT_FRAME_CUT);
	load(&f, 9, 3, &frame);
	CHECK(!(frame.header.flags & PURSUIT_FRAME_CUT));
	load(&f, 8, 3, &frame);
	CHECK(!(frame.header.flags & PURSUIT_FRAME_CUT));
	load(&f, 7, 3, &frame);
	CHECK(frame.header.flags & PURSUIT_FRAME_CUT);
	teardown(&f);
}

int main(void)
{
	RUN(test_backward_looks_back);
	RUN(test_forward_looks_ahead);
	RUN(test_chains_that_end_early);
	RUN(test_cut_on_a_frame_of_truth);
	return test_result();
}
