/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The picture that stays while nothing moves: one that missed its vblank is drawn again, and then all sleeps, once it
 * is shown, and recorded.
 */
#include <inttypes.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/daemon/render-world.h"

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

/* What is to stay was queued for a vblank that was skipped: it is there in the end. */
static void test_a_picture_whose_vblank_is_skipped(void)
{
	for (uint32_t vblanks = 1; vblanks < 80; vblanks += 3) {
		world_init();
		world.skips_none = vblanks % 2 == 0;
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
	RUN(test_a_picture_whose_vblank_is_skipped);
	RUN(test_costs_are_kept);
	RUN(test_no_picture_to_draw_into);
	return test_result();
}
