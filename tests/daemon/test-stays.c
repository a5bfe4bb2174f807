/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The picture that stays while nothing moves: one that missed its vblank is drawn again, and then all sleeps. The
 * presenter is the headless one's memory and queue, on a virtual clock, and refuses what it is told to.
 */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "daemon/present/pictures.h"
#include "daemon/render.h"
#include "tests/engine/picture.h"
#include "tests/test.h"

#define MS UINT64_C(1000000)

static struct {
	struct clock_virtual clock;
	struct log log;
	struct settings settings;
	struct stats stats;
	struct presenter_impl impl;
	struct pictures pictures;
	struct render render;
	struct picture picture;
	unsigned refusals, refused, taken;
	unsigned full, lacks; /* so often there is no picture to draw into; there was none */
	uint64_t drawing_ns;  /* that a picture takes */
	bool silent;          /* flips are told later */
	bool held_up;         /* the presenter shows nothing for the moment */
	struct presenter_flip untold[512];
	uint32_t untold_count;
	unsigned closed; /* tees */
} world;

static int acquire(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image)
{
	clock_wait_until(&world.clock.clock, clock_now(&world.clock.clock) + world.drawing_ns);
	if (world.full > 0) {
		world.full--;
		world.lacks++;
		return -EBUSY;
	}
	return pictures_acquire(presenter, width, height, image);
}

static int present(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank, uint64_t group,
				   uint64_t serial)
{
	if (world.refusals > 0) {
		world.refusals--;
		world.refused++;
		return -ETIME;
	}
	world.taken++;
	return pictures_present(presenter, image, vblank, group, serial);
}

static void on_engine(void *data, const struct engine_info *info)
{
	(void)data;
	(void)info;
}

static void on_close(void *data, struct tee *tee)
{
	(void)data;
	tee_destroy(&tee);
	world.closed++;
}

static void world_init(void)
{
	const struct presenter_params params = {
		.clock = &world.clock.clock, .log = &world.log, .refresh_numerator = 120, .refresh_denominator = 1};
	struct error error = {""};
	memset(&world, 0, sizeof(world));
	log_init(&world.log, LOG_LEVEL_ERROR);
	clock_init_virtual(&world.clock, 1000 * MS);
	settings_defaults(&world.settings);
	CHECK_INT(settings_set(&world.settings, "context", "cpu", &error), 0);
	world.impl = presenter_headless;
	world.impl.present = present;
	world.impl.acquire = acquire;
	pictures_init(&world.pictures, &world.impl, &params);
	struct render *render = &world.render;
	*render = (struct render){.settings = &world.settings,
							  .clock = &world.clock.clock,
							  .log = &world.log,
							  .stats = &world.stats,
							  .owner = {.engine_made = on_engine, .close_tee = on_close}};
	CHECK_INT(render_start(render, &error), 0);
	render_set_presenter(render, &world.pictures.presenter);
}

static void world_finish(void)
{
	render_finish(&world.render);
	pictures_finish(&world.pictures);
	if (world.picture.memory)
		picture_finish(&world.picture);
}

static void tell(const struct presenter_flip *flip)
{
	if (!world.silent)
		render_flip(&world.render, flip);
	else if (world.untold_count < sizeof(world.untold) / sizeof(world.untold[0]))
		world.untold[world.untold_count++] = *flip;
}

static void tell_untold(void)
{
	world.silent = false;
	for (uint32_t i = 0; i < world.untold_count; i++)
		tell(&world.untold[i]);
	world.untold_count = 0;
}

/* What is due within some vblanks is done, and each of them shown. */
static void run(uint32_t vblanks)
{
	const struct grid *grid = &world.pictures.grid;
	const uint64_t first = grid_at_or_after(grid, clock_now(&world.clock.clock)) + 1;
	for (uint64_t vblank = first; vblank < first + vblanks; vblank++) {
		const uint64_t vblank_ns = grid_time(grid, vblank);
		for (uint32_t step = 0; step < 1000 && clock_now(&world.clock.clock) < vblank_ns; step++) {
			const uint64_t next_ns = render_step(&world.render);
			clock_wait_until(&world.clock.clock, next_ns < vblank_ns ? next_ns : vblank_ns);
		}
		if (world.pictures.running && world.pictures.next_vblank <= vblank && !world.held_up) {
			const struct presenter_flip flip = pictures_show_next(&world.pictures, vblank_ns);
			tell(&flip);
		}
	}
}

/* A boosted real frame is on display, and nothing comes after it. */
static void show_boosted(void)
{
	const struct engine_begin_params params = {.n = 2, .last_phase = 0.5, .real_interval_ns = 16 * MS};
	struct error error = {""};
	picture_init(&world.picture, 64, 64, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
	picture_draw_layers(&world.picture, 1.0);
	struct frame frame = world.picture.frame;
	frame.stream = frame.header.frame_id = 1;
	CHECK_INT(engine_begin(world.render.engine, &frame, &params, &error), 0);
	world.render.begun = true;
	world.render.group = 1;
	world.render.paused = false;
}

static void test_the_view_changes_while_nothing_moves(void)
{
	world_init();
	run(10);
	CHECK_INT(world.taken, 0);
	const uint32_t views[] = {VIEW_HELP, 0};
	for (unsigned i = 0; i < 2; i++) {
		world.refusals = 3;
		render_set_view(&world.render, views[i]);
		run(60);
		CHECK_INT(world.refusals, 0);
		CHECK_INT(world.taken, i + 1);
		CHECK(world.pictures.flips.has_front && world.pictures.flips.front.serial == world.render.serial);
		CHECK(world.render.paused && !world.pictures.running);
	}
	world_finish();
}

/* However long it takes to draw: what was learned at the first attempt counts at the next. */
static void test_a_slow_picture(void)
{
	for (uint64_t drawing_ns = 1 * MS; drawing_ns < 400 * MS; drawing_ns = drawing_ns * 5 / 2) {
		world_init();
		run(10);
		world.drawing_ns = drawing_ns;
		render_set_view(&world.render, VIEW_HELP);
		run(200);
		CHECK(world.taken <= 3);
		CHECK(world.pictures.flips.has_front && world.pictures.flips.front.serial == world.render.serial);
		CHECK(world.render.paused && !world.pictures.running);
		world_finish();

		world_init();
		world.drawing_ns = drawing_ns;
		show_boosted();
		run(200);
		CHECK(world.taken <= 3);
		CHECK(world.render.front_plain && world.pictures.flips.front.serial == world.render.serial);
		CHECK(world.render.paused && !world.pictures.running);
		world_finish();
	}
}

/* Real frames that take many vblanks have all planned far ahead: it sleeps when the picture is there, not before. */
static void test_slow_real_frames(void)
{
	for (uint64_t cost_ns = 10 * MS; cost_ns < 400 * MS; cost_ns *= 2) {
		world_init();
		cost_add(&world.render.real_cost, cost_ns);
		show_boosted();
		run(200);
		CHECK_INT(world.taken, 1);
		CHECK(world.pictures.flips.has_front && world.pictures.flips.front.serial == world.render.serial);
		CHECK(world.render.paused && !world.pictures.running);
		world_finish();
	}
}

static void test_a_boosted_picture_does_not_stay(void)
{
	world_init();
	show_boosted();
	world.refusals = 3;
	run(100);
	CHECK_INT(world.refused, 3);
	CHECK_INT(world.taken, 1);
	CHECK(world.render.front_plain && world.pictures.flips.front.serial == world.render.serial);
	CHECK(world.render.paused && !world.pictures.running);
	world_finish();
}

static void test_a_presenter_that_takes_nothing(void)
{
	world_init();
	show_boosted();
	world.refusals = 100000;
	run(400);
	CHECK(world.refused > 10 && world.refused < 200);
	CHECK(world.render.paused);
	const unsigned refused = world.refused;
	run(400);
	CHECK_INT(world.refused, refused);
	world_finish();
}

static struct tee *make_tee(const char *folder, const char *name, char path[64])
{
	struct error error = {""};
	snprintf(path, 64, "%s/%s.y4m", folder, name);
	struct tee *tee = tee_create(&(struct tee_params){.path = path, .log = &world.log}, &error);
	CHECK(tee != NULL);
	return tee;
}

/* The serials of the pictures in the file, "1 2 "; takes the file away. */
static const char *pictures_in(const char *path)
{
	static char list[256];
	char times[80], line[256];
	uint64_t serial, last = 0;
	list[0] = 0;
	snprintf(times, sizeof(times), "%s.csv", path);
	FILE *file = fopen(times, "re");
	CHECK(file != NULL);
	while (file && fgets(line, sizeof(line), file)) {
		if (sscanf(line, "%*u,%*u,%*u,%*u,%*[^,],%" SCNu64, &serial) != 1 || serial == last)
			continue;
		last = serial;
		snprintf(list + strlen(list), sizeof(list) - strlen(list), "%" PRIu64 " ", serial);
	}
	if (file)
		fclose(file);
	unlink(times);
	unlink(path);
	return list;
}

/*
 * A recording that another follows just before the pause, while the display takes its time: both have their pictures,
 * however long it takes to hear of them.
 */
static void test_a_recording_before_a_pause(void)
{
	for (uint32_t vblanks = 20; vblanks <= 400; vblanks += 95) {
		char folder[] = "/tmp/pursuit-stays-XXXXXX", one[64], other[64];
		CHECK(mkdtemp(folder) != NULL);
		world_init();
		render_set_tee(&world.render, make_tee(folder, "one", one));
		show_boosted();
		run(35);
		CHECK_INT(world.render.serial, 2);
		world.silent = true;
		render_set_view(&world.render, VIEW_HELP);
		run(3);
		CHECK_INT(world.render.serial, 3);
		render_set_tee(&world.render, make_tee(folder, "other", other));
		run(vblanks);
		CHECK_INT(world.render.serial, 4);
		CHECK_INT(world.closed, 0);
		tell_untold();
		run(20);
		CHECK(world.render.paused);
		CHECK_INT(world.closed, 1);
		world_finish();
		CHECK_STRING(pictures_in(one), "1 2 3 ");
		CHECK_STRING(pictures_in(other), "4 ");
		CHECK_INT(rmdir(folder), 0);
	}
}

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

/* However long a flip takes to be told, its frame was shown then; of one that never ends a report comes all the same.
 */
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

/* What is to stay was queued for a vblank that was skipped: it is there in the end. */
static void test_a_picture_whose_vblank_is_skipped(void)
{
	for (uint32_t vblanks = 1; vblanks < 80; vblanks += 3) {
		world_init();
		render_set_view(&world.render, VIEW_HELP);
		run(60);
		CHECK(world.render.paused);
		world.held_up = true;
		render_set_view(&world.render, 0);
		run(vblanks);
		world.held_up = false;
		run(100);
		CHECK(world.pictures.flips.front.serial == world.render.serial && world.taken >= 2);
		CHECK(world.render.paused && !world.pictures.running);
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

/* ---- what drawing costs ---- */

/* With another setting, has it been forgotten by the next frame? */
static bool forgets(const char *name, const char *value)
{
	struct settings settings = world.settings;
	struct error error = {""};
	cost_add(&world.render.between_cost, 7 * MS);
	cost_add(&world.render.plain_cost, 7 * MS);
	CHECK_INT(settings_set(&settings, name, value, &error), 0);
	render_set_settings(&world.render, &settings);
	world.render.frame = world.picture.frame;
	world.render.frame.stream = 1;
	world.drawing_ns = 0;
	draw_held(&world.render, render_first_vblank(&world.render) + 1);
	CHECK(!world.render.settings_changed);
	return world.render.between_cost.count == 0;
}

/* Only where the work is another one; a file, a limit or a socket that changes leaves it known. */
static void test_costs_are_kept(void)
{
	static const char *const same[][2] = {{"record", "/tmp/r"},           {"max-clients", "3"},
										  {"strobe-line", "0"},           {"display-width-mm", "1000"},
										  {"viewing-distance-mm", "400"}, {"gamma", "2.4"}};
	static const char *const other[][2] = {{"method", "scatter"}, {"blur", "off"},     {"compensation", "no"},
										   {"cell", "16"},        {"analysis", "gpu"}, {"level", "1"},
										   {"patch", "alternate"}};
	world_init();
	show_boosted();
	for (size_t i = 0; i < sizeof(same) / sizeof(same[0]); i++) {
		CHECK(!forgets(same[i][0], same[i][1]));
		CHECK_INT(world.render.between_cost.count, i + 1);
	}
	for (size_t i = 0; i < sizeof(other) / sizeof(other[0]); i++)
		CHECK(forgets(other[i][0], other[i][1]));
	CHECK(!forgets("patch", "alternate"));
	world_finish();
}

static unsigned count_logged(const char *text)
{
	static char content[4096];
	unsigned count = 0;
	const ssize_t got = pread(world.log.fd, content, sizeof(content) - 1, 0);
	content[got > 0 ? got : 0] = 0;
	for (const char *at = content; (at = strstr(at, text)) != NULL; at++)
		count++;
	return count;
}

/* Tried at each vblank, and said when it begins and when it ends. */
static void test_no_picture_to_draw_into(void)
{
	world_init();
	world.log = (struct log){.fd = memfd_create("log", MFD_CLOEXEC), .level = LOG_LEVEL_INFO};
	show_boosted();
	world.full = 20;
	run(200);
	CHECK_INT(world.lacks, 20);
	CHECK_INT(world.taken, 1);
	CHECK(world.render.paused && world.render.front_plain);
	CHECK_INT(count_logged("no memory for a picture of 64x64"), 1);
	CHECK_INT(count_logged("there is memory for pictures again"), 1);
	/* Where it begins and ends all the time it is not said each time. */
	for (unsigned i = 0; i < 40; i++) {
		world.full = 1;
		render_set_view(&world.render, i % 2 ? 0 : VIEW_HELP);
		run(6);
	}
	CHECK_INT(world.lacks, 60);
	CHECK(count_logged("no memory for a picture") <= 4 * LOG_LIMIT_PER_SECOND);
	CHECK_INT(count_logged("there is memory for pictures again"), count_logged("no memory for a picture"));
	close(world.log.fd);
	world_finish();
}

int main(void)
{
	RUN(test_the_view_changes_while_nothing_moves);
	RUN(test_a_slow_picture);
	RUN(test_slow_real_frames);
	RUN(test_a_boosted_picture_does_not_stay);
	RUN(test_a_presenter_that_takes_nothing);
	RUN(test_a_recording_before_a_pause);
	RUN(test_a_flip_that_ends_late);
	RUN(test_a_frame_whose_vblank_is_skipped);
	RUN(test_a_picture_whose_vblank_is_skipped);
	RUN(test_a_client_that_is_gone_before_its_flip);
	RUN(test_a_frame_shown_as_its_plain_picture);
	RUN(test_costs_are_kept);
	RUN(test_no_picture_to_draw_into);
	return test_result();
}
