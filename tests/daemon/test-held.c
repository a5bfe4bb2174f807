/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Pictures that lie in the presenter's memory already are not drawn again, and none is stale: whatever happens between
 * two pictures, each is compared with one that is drawn into fresh memory.
 *
 *   test-held CONTEXT    cpu or egl
 */
#include <stdlib.h>
#include <string.h>

#include "daemon/lab/patch.h"
#include "daemon/present/pictures.h"
#include "daemon/render.h"
#include "tests/engine/picture.h"
#include "tests/test.h"

#define STREAMS 3u
#define MS UINT64_C(1000000)

static const char *context;

struct source {
	struct picture picture;
	uint64_t frame_id;
};

static struct world {
	struct clock_virtual clock;
	struct clock real_clock;
	struct log log;
	struct settings settings;
	struct stats stats;
	struct presenter_impl impl;
	struct pictures pictures;
	struct lab *lab;
	struct render render;
	struct source sources[STREAMS];
	struct engine_request request; /* of the picture that is drawn next */
	bool trusting;                 /* pictures are not compared */
	uint64_t vblank;
	uint32_t compared, wrong, kept; /* kept: not drawn, since it was there */
	uint32_t random;
} world;

/* ---- the presenter: the headless one's memory and queue; each picture is looked at as it comes ---- */

static void compare(const struct presenter_image *image, uint64_t vblank)
{
	const size_t size = image->stride * image->height;
	if (world.trusting)
		return;
	uint8_t *fresh = aligned_alloc(64, size);
	struct engine_image target = {.data = fresh, .stride = image->stride};
	struct presenter_image copy = *image;
	struct error error = {""};
	copy.data = fresh;
	CHECK_INT(engine_render(world.render.engine, &world.request, &target, &error), 0);
	view_draw(&world.render, &copy);
	if (world.render.lab)
		patch_draw(&copy, world.settings.lab.patch_corner, world.settings.lab.patch_size, vblank & 1);
	bool same = true;
	for (uint32_t y = 0; y < image->height && same; y++)
		same = memcmp(image->data + y * image->stride, fresh + y * image->stride, 4 * (size_t)image->width) == 0;
	world.compared++;
	world.wrong += !same;
	free(fresh);
}

static int present(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank, uint64_t group,
				   uint64_t serial)
{
	compare(image, vblank);
	return pictures_present(presenter, image, vblank, group, serial);
}

static void set_standby(struct presenter *presenter, const struct presenter_image *image, uint64_t group,
						uint64_t serial)
{
	compare(image, world.render.real_vblank);
	pictures_set_standby(presenter, image, group, serial);
}

/* ---- the world ---- */

static void on_engine(void *data, const struct engine_info *info)
{
	(void)data;
	(void)info;
}

static void remake_engine(void)
{
	struct error error = {""};
	engine_destroy(&world.render.engine);
	world.render.begun = false;
	if (draw_make_engine(&world.render, &error) < 0) {
		printf("%s\n", error.text);
		SKIP("there is no such engine");
	}
}

static void make_lab(void)
{
	struct error error = {""};
	CHECK_INT(settings_set(&world.settings, "patch", "alternate", &error), 0);
	CHECK_INT(settings_set(&world.settings, "patch-size", "4", &error), 0);
	const struct lab_params params = {
		.settings = &world.settings.lab, .clock = &world.real_clock, .log = &world.log, .period_ns = 8e6, .header = ""};
	world.lab = lab_create(&params, &error);
	CHECK(world.lab);
}

static void world_init(void)
{
	const struct presenter_params params = {
		.clock = &world.clock.clock, .log = &world.log, .refresh_numerator = 120, .refresh_denominator = 1};
	struct error error = {""};
	memset(&world, 0, sizeof(world));
	world.random = 1;
	log_init(&world.log, LOG_LEVEL_ERROR);
	clock_init_real(&world.real_clock);
	clock_init_virtual(&world.clock, 1000 * MS);
	settings_defaults(&world.settings);
	CHECK_INT(settings_set(&world.settings, "context", context, &error), 0);
	make_lab();
	world.impl = presenter_headless;
	world.impl.present = present;
	world.impl.set_standby = set_standby;
	pictures_init(&world.pictures, &world.impl, &params);
	struct render *render = &world.render;
	render->settings = &world.settings;
	render->clock = &world.clock.clock;
	render->log = &world.log;
	render->owner.engine_made = on_engine;
	render->presenter = &world.pictures.presenter;
	render->grid = world.pictures.grid;
	render->stats = &world.stats;
	showing_init(&render->showing, &world.stats);
	remake_engine();
}

static void world_finish(void)
{
	lab_destroy(&world.lab);
	view_finish(&world.render.view);
	showing_finish(&world.render.showing);
	engine_destroy(&world.render.engine);
	pictures_finish(&world.pictures);
	for (uint32_t i = 0; i < STREAMS; i++)
		if (world.sources[i].picture.memory)
			picture_finish(&world.sources[i].picture);
}

static uint32_t pick(uint32_t count)
{
	return picture_random(&world.random) % count;
}

/* A new size now and then, one of them with as many bytes as the other; numbers of frames that others have had. */
static void change_picture(struct source *source)
{
	struct picture *picture = &source->picture;
	const bool turned = pick(2);
	if (picture->memory)
		picture_finish(picture);
	picture_init(picture, turned ? 64 : 128, turned ? 128 : 64, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
	picture_draw_layers(picture, pick(1000) / 100.0);
	source->frame_id = pick(3);
}

/* The stream's next frame; `unchanged`: by a client that says so. */
static void begin(uint32_t stream, bool unchanged)
{
	const struct engine_begin_params params = {.n = 2, .last_phase = 0.5, .real_interval_ns = 16 * MS};
	struct source *source = &world.sources[stream];
	struct error error = {""};
	unchanged = unchanged && source->picture.memory;
	if (!unchanged)
		change_picture(source);
	struct frame frame = source->picture.frame;
	frame.stream = stream + 1;
	frame.header.frame_id = ++source->frame_id;
	frame.header.damage_since = source->frame_id - 1;
	frame.header.flags |= unchanged ? PURSUIT_FRAME_DAMAGE : 0;
	CHECK_INT(engine_begin(world.render.engine, &frame, &params, &error), 0);
	world.render.begun = true;
	world.render.group++;
	world.render.real_vblank = world.vblank + 1;
}

static void count_kept(void)
{
	const struct engine_report *report = engine_get_report(world.render.engine);
	for (uint32_t i = 0; i < report->left_out_count; i++)
		world.kept += strcmp(report->left_out[i].name, "read") == 0;
}

/* One picture drawn, queued and shown. */
static void show(enum engine_show what)
{
	const uint64_t vblank = ++world.vblank + 1, vblank_ns = grid_time(&world.pictures.grid, vblank);
	const struct pacer_decision decision = {.show = PACER_IN_BETWEEN, .phase = 0.5};
	clock_wait_until(&world.clock.clock, vblank_ns - MS);
	world.request = (struct engine_request){what, what == ENGINE_SHOW_PLAIN ? 0.0 : decision.phase};
	if (what == ENGINE_SHOW_PLAIN)
		draw_plain(&world.render, vblank);
	else
		draw_in_between(&world.render, &decision, vblank);
	clock_wait_until(&world.clock.clock, vblank_ns + MS);
	pictures_show_next(&world.pictures, clock_now(&world.clock.clock));
}

static void stand_by(void)
{
	world.request = (struct engine_request){ENGINE_SHOW_PLAIN, 0.0};
	draw_plain(&world.render, 0);
}

/* ---- tests ---- */

static void test_still_costs_nothing(void)
{
	world_init();
	world.trusting = true;
	for (uint32_t i = 0; i < 40; i++) {
		begin(0, i > 0);
		show(ENGINE_SHOW_PLAIN);
		show(ENGINE_SHOW_PLAIN);
		const struct engine_report *report = engine_get_report(world.render.engine);
		if (i >= 3) {
			CHECK_INT(report->bytes_up, 0);
			CHECK_INT(report->bytes_down, 0);
		}
	}
	/* Something is drawn over the pictures: once in each of them they are made anew, and then also without it. */
	world.render.view.switches = VIEW_HELP;
	for (uint32_t i = 0; i < 10; i++) {
		begin(0, true);
		show(ENGINE_SHOW_PLAIN);
		if (i >= 3)
			CHECK(engine_get_report(world.render.engine)->bytes_down > 0);
	}
	world.render.view.switches = 0;
	begin(0, true);
	show(ENGINE_SHOW_PLAIN);
	CHECK(engine_get_report(world.render.engine)->bytes_down > 0);
	world_finish();
}

/* A frame of the same picture by a client that does not say so. */
static const struct engine_report *show_same(struct picture *picture)
{
	const struct engine_begin_params params = {.n = 2, .last_phase = 0.5, .real_interval_ns = 16 * MS};
	struct frame frame = picture->frame;
	struct error error = {""};
	frame.stream = 1;
	frame.header.frame_id = ++world.sources[0].frame_id;
	CHECK_INT(engine_begin(world.render.engine, &frame, &params, &error), 0);
	world.render.begun = true;
	world.render.group++;
	world.render.real_vblank = world.vblank + 1;
	show(ENGINE_SHOW_PLAIN);
	return engine_get_report(world.render.engine);
}

/* Does the engine show the picture as it is? */
static bool shows(const struct picture *picture)
{
	const size_t stride = 4 * (size_t)picture->width;
	uint8_t *shown = malloc(stride * picture->height);
	struct engine_image image = {.data = shown, .stride = stride};
	struct error error = {""};
	bool same = engine_render(world.render.engine, &world.request, &image, &error) == 0;
	for (uint32_t y = 0; y < picture->height; y++)
		for (size_t x = 0; x < stride; x++)
			same &= x % 4 == 3 || shown[y * stride + x] == picture_row(picture, PURSUIT_ROLE_COLOR, y)[x];
	free(shown);
	return same;
}

/* The executor without GL finds out by itself that nothing has changed, and sees it when one pixel does. */
static void test_still_is_found(void)
{
	world_init();
	if (strcmp(engine_get_info(world.render.engine)->context, "cpu") != 0) {
		world_finish();
		return;
	}
	world.trusting = true;
	struct picture *picture = &world.sources[0].picture;
	picture_init(picture, 128, 64, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION);
	picture_fill_random(picture, PURSUIT_ROLE_COLOR, 1);
	for (uint32_t round = 0; round < 8; round++) {
		for (uint32_t i = 0; i < 30; i++) {
			const struct engine_report *report = show_same(picture);
			CHECK(i < 22 || report->bytes_up == 0);
			CHECK(i < 26 || report->bytes_down == 0);
		}
		picture_row(picture, PURSUIT_ROLE_COLOR, pick(64))[4 * pick(128) + round % 3] ^= 1;
		CHECK(show_same(picture)->bytes_down > 0);
		CHECK(shows(picture));
	}
	world_finish();
}

static void happen(void)
{
	struct render *render = &world.render;
	switch (pick(16)) {
	case 0:
		render->view.switches ^= VIEW_HELP;
		break;
	case 1:
		render->view.switches ^= VIEW_SPLIT;
		break;
	case 2:
		render->view.switches ^= VIEW_STATISTICS;
		break;
	case 3:
		view_say(&render->view, "something has changed", clock_now(render->clock));
		break;
	case 4:
		render->lab = render->lab ? NULL : world.lab;
		break;
	case 5:
		if (pick(4) == 0)
			remake_engine();
		break;
	case 6:
		render->view.switches = 0;
		render->lab = NULL;
		render->view.message_until_ns = 0;
		break;
	default:
		break;
	}
}

static void test_none_is_stale(void)
{
	uint32_t stream = 0;
	world_init();
	for (uint32_t i = 0; i < 3000; i++) {
		happen();
		if (pick(12) == 0)
			stream = pick(STREAMS);
		if (!world.render.begun || pick(2))
			begin(stream, pick(8) > 0);
		if (pick(10) == 0)
			stand_by();
		show(pick(4) ? ENGINE_SHOW_PLAIN : ENGINE_SHOW_IN_BETWEEN);
		count_kept();
	}
	printf("%u pictures, %u wrong, left as they were in %u frames\n", world.compared, world.wrong, world.kept);
	CHECK_INT(world.wrong, 0);
	CHECK(world.compared >= 3000);
	CHECK(world.kept > 200);
	world_finish();
}

int main(int argc, char **argv)
{
	context = argc > 1 ? argv[1] : "cpu";
	RUN(test_still_costs_nothing);
	RUN(test_none_is_stale);
	RUN(test_still_is_found);
	return test_result();
}
