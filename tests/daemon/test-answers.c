/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What a client is answered about frames whose flips are late, or that come while there is no presenter. */

#include "tests/daemon/render-world.h"

/* ---- what a client hears of its last frame before a pause ---- */

static struct stream client = {.number = 1};
static struct pursuit_shm_control client_control;

/* Its real frame was given to the presenter, for a vblank soon; the flip is not told. */
static void show_real_frame_of_client(void)
{
	struct presenter_image image;
	memset(&client_control, 0, sizeof(client_control));
	client.control = &client_control;
	client.feedback_count = 0;
	atomic_init(&client.references, 1);
	atomic_init(&client.ended, false);
	show_boosted();
	world.silent = true;
	world.render.stream_number = client.number;
	showing_add_frame(&world.render.showing, 1, &client, &world.picture.frame);
	const uint64_t vblank = render_first_vblank(&world.render) + 1;
	CHECK_INT(pictures_acquire(&world.pictures.presenter, 64, 64, &image), 0);
	CHECK_INT(draw_queue(&world.render, &image, vblank, STATS_REAL, 0.0), 0);
	CHECK_INT(atomic_load(&client.references), 2);
	world.render.next_vblank = vblank + 1;
}

/* However long a flip takes to be told, its frame was shown then; of one that never ends there is a report, too. */
static void test_a_flip_that_ends_late(void)
{
	const struct pursuit_feedback *report = &client_control.feedback[0];
	for (uint32_t vblanks = 10; vblanks <= 450; vblanks += 40) {
		world_init();
		show_real_frame_of_client();
		run(vblanks);
		const bool given_up = vblanks > 30 + 256; /* SLEEP_ANYWAY after the pause has begun */
		CHECK_INT(client_control.feedback_count, given_up ? 1 : 0);
		const uint64_t flip_ns = world.untold[0].flip_ns;
		tell_untold();
		run(100);
		CHECK(world.render.paused);
		CHECK_INT(client_control.feedback_count, 1);
		CHECK_INT(report->state, given_up ? PURSUIT_FEEDBACK_REPLACED : PURSUIT_FEEDBACK_SHOWN);
		CHECK_INT(report->flip_ns, given_up ? 0 : flip_ns);
		CHECK_INT(world.stats.lost_real_frames, given_up ? 1 : 0);
		CHECK_INT(world.stats.real_frames, given_up ? 0 : 1);
		CHECK_INT(atomic_load(&client.references), 1);
		world_finish();
	}
}

/* The presenter itself was held up, and has skipped the vblank: it shows the frame when it goes on. */
static void test_a_frame_whose_vblank_is_skipped(void)
{
	for (uint32_t vblanks = 1; vblanks <= 200; vblanks += 14) {
		world_init();
		show_real_frame_of_client();
		world.silent = false;
		world.held_up = true;
		run(vblanks);
		CHECK_INT(client_control.feedback_count, 0);
		world.held_up = false;
		run(200);
		CHECK(world.render.paused);
		CHECK_INT(client_control.feedback_count, 1);
		CHECK_INT(client_control.feedback[0].state, PURSUIT_FEEDBACK_SHOWN);
		CHECK_INT(world.stats.lost_real_frames, 0);
		CHECK_INT(world.stats.real_frames, 1);
		CHECK(world.pictures.flips.front.serial == world.render.serial && world.render.front_plain);
		world_finish();
	}
}

/* Nothing is kept of one that is gone. */
static void test_a_client_that_is_gone_before_its_flip(void)
{
	world_init();
	show_real_frame_of_client();
	run(100);
	CHECK_INT(atomic_load(&client.references), 2);
	atomic_store(&client.ended, true);
	render_set_streams(&world.render, NULL, 0);
	CHECK_INT(atomic_load(&client.references), 1);
	tell_untold();
	run(100);
	CHECK(world.render.paused);
	CHECK_INT(client_control.feedback_count, 0);
	CHECK_INT(world.stats.real_frames, 1);
	world_finish();
}

/* The display took the plain picture of the pause before it came to the real frame's own: that is the frame, too. */
static void test_a_frame_shown_as_its_plain_picture(void)
{
	struct presenter_flip flip = {.vblank = 7, .flip_ns = 5 * MS, .group = 1, .shown = PRESENTER_PICTURE};
	world_init();
	show_real_frame_of_client();
	world.render.group++;
	showing_add_frame(&world.render.showing, 2, &client, &world.picture.frame);
	showing_settle_frames(&world.render.showing, 3);
	CHECK_INT(client_control.feedback_count, 0);
	flip.serial = 100;
	showing_add_picture(&world.render.showing,
						&(struct showing_picture){.serial = 100, .group = 1, .show = STATS_REPEAT, .ready_ns = MS});
	render_flip(&world.render, &flip);
	/* And the one after it, which was given no picture, is told of after it. */
	CHECK_INT(client_control.feedback_count, 2);
	CHECK_INT(client_control.feedback[0].state, PURSUIT_FEEDBACK_SHOWN);
	CHECK_INT(client_control.feedback[0].flip_ns, 5 * MS);
	CHECK_INT(client_control.feedback[1].state, PURSUIT_FEEDBACK_REPLACED);
	world_finish();
}

/* ---- what waits where there is no presenter ---- */

static uint8_t client_planes[3][1 << 18];

/* The client publishes its next frame, over one that was not taken. */
static void publish(uint64_t frame_id)
{
	const uint32_t slot = 1 + (frame_id & 1);
	client_control.headers[slot] = world.picture.frame.header;
	client_control.headers[slot].frame_id = frame_id;
	memcpy(client_planes[slot], world.picture.memory, (size_t)frame_layout(&client_control.headers[slot]));
	client_control.latest = slot | PURSUIT_SLOT_FRESH;
}

static void on_record(void *data, const struct frame *frame)
{
	(void)data;
	(void)frame;
}

static void show_nothing_of_client(void)
{
	struct stream *const streams[] = {&client};
	show_real_frame_of_client();
	world.render.owner.record = on_record;
	client.planes = client_planes[0];
	client.slot_bytes = sizeof(client_planes[0]);
	client.slot_count = sizeof(client_planes) / sizeof(client_planes[0]);
	client.held_slot = 0;
	client.last_id = 0;
	render_set_streams(&world.render, streams, 1);
}

/* Of the frames from 2 to the last each, in their order, and only one of them as shown (0: none). */
static void check_answers(uint64_t last, uint64_t shown)
{
	CHECK_INT(client_control.feedback_count, last);
	for (uint64_t frame_id = 2; frame_id <= last; frame_id++) {
		const struct pursuit_feedback *report = &client_control.feedback[frame_id - 1];
		CHECK_INT(report->frame_id, frame_id);
		CHECK_INT(report->state, frame_id == shown ? PURSUIT_FEEDBACK_SHOWN : PURSUIT_FEEDBACK_REPLACED);
		CHECK_INT(report->flip_ns != 0, frame_id == shown);
	}
}

static void go_over_to(struct presenter *presenter, bool at_once)
{
	render_wish_presenter(&world.render, presenter, at_once);
	CHECK(render_go_over(&world.render));
}

/*
 * Where a window goes before another is made for it, the newest frame waits and is shown there; where the window is
 * lost it is answered as the others are, since nobody knows for how long.
 */
static void test_frames_between_presenters(void)
{
	for (unsigned lost = 0; lost < 2; lost++) {
		world_init();
		show_nothing_of_client();
		run(2);
		tell_untold();
		render_wish_presenter(&world.render, NULL, lost);
		run(60);
		CHECK(render_go_over(&world.render));
		CHECK_INT(client_control.feedback_count, 1);
		CHECK_INT(client_control.feedback[0].state, PURSUIT_FEEDBACK_SHOWN);
		for (uint64_t frame_id = 2; frame_id < 6; frame_id++) {
			publish(frame_id);
			render_step(&world.render);
		}
		CHECK_INT(client_control.feedback_count, lost ? 5 : 4);
		render_wish_presenter(&world.render, &world.pictures.presenter, false);
		CHECK(render_go_over(&world.render));
		run(100);
		CHECK(world.render.paused);
		check_answers(5, lost ? 0 : 5);
		CHECK_INT(atomic_load(&client.references), 1);
		render_set_streams(&world.render, NULL, 0);
		world_finish();
	}
}

/* The one that waits is answered, whatever comes instead: a newer one, no presenter, the end of the stream. */
static void test_frame_that_waited_for_nothing(void)
{
	for (unsigned what = 0; what < 3; what++) {
		world_init();
		show_nothing_of_client();
		run(2);
		tell_untold();
		world.render.paused = true;
		publish(2);
		go_over_to(NULL, false);
		render_step(&world.render);
		CHECK_INT(client_control.feedback_count, 1);
		CHECK_INT(atomic_load(&client.references), 2);
		if (what == 0) {
			publish(3);
			go_over_to(&world.pictures.presenter, false);
			run(100);
			check_answers(3, 3);
		} else if (what == 1) {
			go_over_to(NULL, true);
			check_answers(2, 0);
		} else {
			atomic_store(&client.ended, true);
			render_set_streams(&world.render, NULL, 0);
			CHECK_INT(client_control.feedback_count, 1);
		}
		CHECK_INT(atomic_load(&client.references), 1);
		render_set_streams(&world.render, NULL, 0);
		world_finish();
	}
}

int main(void)
{
	RUN(test_a_flip_that_ends_late);
	RUN(test_a_frame_whose_vblank_is_skipped);
	RUN(test_a_client_that_is_gone_before_its_flip);
	RUN(test_a_frame_shown_as_its_plain_picture);
	RUN(test_frames_between_presenters);
	RUN(test_frame_that_waited_for_nothing);
	return test_result();
}
