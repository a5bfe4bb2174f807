/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The keeper of vblanks of the GLFW presenter, with a window and a drawing thread
 * that are this test's, in virtual time: whatever swaps do, no vblank waits for
 * them for long, and no picture is lost.
 */

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

#include "daemon/present/drawer.h"
#include "daemon/present/presenter.h"
#include "daemon/present/vsync.h"
#include "daemon/present/window.h"
#include "tests/test.h"

#define MS UINT64_C(1000000)
#define NEVER UINT64_MAX
#define DISPLAY 0 /* a swap lasts until the display's next vblank */
#define PERIOD_NS UINT64_C(8333333)
#define VBLANKS 1200u
#define CHANGE_AT 100u /* vblanks that went by */
#define BACK_AT 700u

struct window {
	struct window_params params;
};

struct drawer {
	bool under_way;
	uint64_t ordered_ns, done_ns;
	uint32_t swaps;
};

static struct clock_virtual virtual_clock;
static struct window fake_window;
static struct drawer fake_drawer;
static struct presenter *presenter;
static uint64_t quick_ns, slow_ns; /* what a swap takes, before and between CHANGE_AT and BACK_AT */
static bool hides;
static struct vsync *wire; /* of the display, with an edge at each vblank; NULL: none */
static uint64_t wire_next_ns;
/* On the keeper's thread. */
static uint32_t dated, on_vblank, off_vblank; /* flips by the wire; targets at its vblanks in the end */
static uint32_t flips, drawn, late_between, shown, presented, drawn_at_end, orders_between;
static struct window_state state;
static atomic_bool done;

/* ---- the window and its drawing thread ---- */

struct window *window_create(const struct window_params *params, struct error *error)
{
	(void)error;
	fake_window.params = *params;
	state = (struct window_state){.width = 64, .height = 48, .refresh_hz = 120.0, .changes = 1, .displays = 1};
	params->changed(params->data, &state);
	return &fake_window;
}

void window_destroy(struct window **window)
{
	*window = NULL;
}

void window_mute(struct window *window)
{
	(void)window;
}

void window_leave_at_exit(void)
{
}

uint64_t window_silence_ns(const struct window *window)
{
	(void)window;
	return 0;
}

void window_toggle_fullscreen(struct window *window)
{
	(void)window;
}

void window_fit(struct window *window, uint32_t width, uint32_t height)
{
	(void)window;
	(void)width;
	(void)height;
}

bool window_is_possible(void)
{
	return true;
}

bool window_get_context(struct window *window, struct presenter_context *context)
{
	(void)window;
	(void)context;
	return false;
}

window_function window_find_function(const char *name)
{
	(void)name;
	return NULL;
}

struct drawer *drawer_create(struct window *window, struct error *error)
{
	(void)window;
	(void)error;
	fake_drawer = (struct drawer){.under_way = false};
	return &fake_drawer;
}

int drawer_wait_for_start(struct drawer *drawer, struct error *error)
{
	(void)drawer;
	(void)error;
	return 0;
}

bool drawer_destroy(struct drawer **drawer, void (*gone)(void *data), void *data)
{
	(void)gone;
	(void)data;
	*drawer = NULL;
	return true;
}

static bool is_between(void)
{
	return flips >= CHANGE_AT && flips < BACK_AT;
}

/* With a wire returns of swaps are late by up to 2 ms, or nobody would need it. */
static uint64_t time_of_last_swap(uint64_t now_ns, uint64_t each_ns, uint32_t swaps)
{
	if (each_ns == DISPLAY)
		return (now_ns / PERIOD_NS + swaps) * PERIOD_NS + (wire ? flips * 7919 % 2000 * 1000 : 0);
	return each_ns == NEVER ? NEVER : now_ns + swaps * each_ns;
}

static void play_wire(void)
{
	for (; wire && wire_next_ns <= clock_now(&virtual_clock.clock); wire_next_ns += PERIOD_NS)
		vsync_add_edge(wire, wire_next_ns);
}

void drawer_order(struct drawer *drawer, const struct presenter_image *image, uint32_t width, uint32_t height,
				  uint32_t swaps)
{
	const uint64_t now_ns = clock_now(&virtual_clock.clock), each_ns = is_between() ? slow_ns : quick_ns;
	(void)image;
	(void)width;
	(void)height;
	CHECK(!drawer->under_way);
	*drawer = (struct drawer){true, now_ns, time_of_last_swap(now_ns, each_ns, swaps), swaps};
	orders_between += is_between();
}

bool drawer_wait(struct drawer *drawer, uint64_t until_ns, struct drawer_swap *swap)
{
	/* One that hung is let go when the window is seen again. */
	if (drawer->done_ns == NEVER && !is_between())
		drawer->done_ns = clock_now(&virtual_clock.clock);
	if (drawer->under_way && drawer->done_ns > clock_now(&virtual_clock.clock)) {
		clock_wait_until(&virtual_clock.clock, drawer->done_ns < until_ns ? drawer->done_ns : until_ns);
		if (drawer->done_ns > clock_now(&virtual_clock.clock))
			return false;
	}
	play_wire();
	drawer->under_way = false;
	*swap = (struct drawer_swap){.time_ns = drawer->done_ns, .source = PRESENTER_TIME_ESTIMATED};
	if (drawer->swaps >= 4)
		swap->interval_ns = (drawer->done_ns - drawer->ordered_ns) / drawer->swaps;
	return true;
}

/* ---- whoever presents: a picture for each vblank, two ahead ---- */

static bool present(uint64_t vblank)
{
	struct presenter_image image;
	if (presenter->impl->acquire(presenter, 16, 16, &image) < 0)
		return false;
	if (presenter->impl->present(presenter, &image, vblank, vblank, vblank) == 0)
		return true;
	presenter->impl->release(presenter, &image);
	return false;
}

static void on_flip(void *data, const struct presenter_flip *flip)
{
	(void)data;
	if (atomic_load(&done))
		return;
	play_wire();
	flips += 1 + flip->skipped;
	if (wire && flips > VBLANKS / 2) {
		const uint64_t off_ns = (flip->target_ns + PERIOD_NS / 2) % PERIOD_NS;
		const bool on = off_ns > PERIOD_NS / 2 - 50000 && off_ns < PERIOD_NS / 2 + 50000;
		dated += flip->time_source == PRESENTER_TIME_EXTERNAL && (flip->flip_ns + 50000) % PERIOD_NS < 100000;
		on_vblank += on;
		off_vblank += !on;
	}
	shown += flip->shown == PRESENTER_PICTURE;
	drawn += flip->time_source == PRESENTER_TIME_ESTIMATED;
	drawn_at_end += flips > VBLANKS - 100 && flip->time_source == PRESENTER_TIME_ESTIMATED;
	late_between += is_between() ? flip->late + flip->skipped : 0;
	if (hides && state.hidden != is_between()) {
		state.hidden = is_between();
		state.changes++;
		fake_window.params.changed(fake_window.params.data, &state);
	}
	presented += present(flip->vblank + 2);
	if (flips >= VBLANKS)
		atomic_store(&done, true);
}

static void on_key(void *data, const struct presenter_key *key)
{
	(void)data;
	(void)key;
}

static void on_lost(void *data, const char *sentence)
{
	(void)data;
	(void)sentence;
	CHECK(false);
}

static void run(uint64_t quick, uint64_t slow, bool hide)
{
	struct log log;
	struct error error;
	struct presenter_params params = {.log = &log,
									  .clock = &virtual_clock.clock,
									  .refresh_numerator = 120,
									  .refresh_denominator = 1,
									  .flip = on_flip,
									  .key = on_key,
									  .lost = on_lost,
									  .vsync = wire};
	log_init(&log, LOG_LEVEL_ERROR);
	clock_init_virtual(&virtual_clock, 1000 * MS);
	quick_ns = quick;
	slow_ns = slow;
	hides = hide;
	dated = on_vblank = off_vblank = 0;
	wire_next_ns = PERIOD_NS * 120;
	flips = drawn = late_between = shown = drawn_at_end = orders_between = 0;
	presented = 1; /* that which starts the keeper, below */
	atomic_store(&done, false);
	presenter = presenter_glfw.create(&params, &error);
	CHECK(presenter != NULL);
	const struct grid grid = presenter->impl->get_grid(presenter);
	CHECK(present(grid_at_or_after(&grid, clock_now(&virtual_clock.clock)) + 60));
	while (!atomic_load(&done))
		sched_yield();
	presenter->impl->destroy(presenter);
}

static void play(uint64_t quick, uint64_t slow, bool hide)
{
	run(quick, slow, hide);
	CHECK(drawn > 90);        /* at the beginning */
	CHECK(drawn_at_end > 60); /* and again when the swaps come back */
	CHECK(presented > VBLANKS - 60);
	CHECK(presented - shown < 40);
	CHECK(late_between < 40);
}

/* The window is hidden, and it says so: nothing is ordered. */
static void test_hidden(void)
{
	play(1 * MS, NEVER, true);
	CHECK(orders_between <= 1);
	CHECK(late_between <= 3);
}

/* It does not say so, and a swap never comes back. */
static void test_swap_that_hangs(void)
{
	play(1 * MS, NEVER, false);
	CHECK_INT(orders_between, 1);
}

/* Or swaps are let through ten times a second, or once. */
static void test_slow_swaps(void)
{
	play(1 * MS, 40 * MS, false);
	play(1 * MS, 100 * MS, false);
	play(1 * MS, 1000 * MS, false);
}

/* The same where they wait for the display. */
static void test_slow_swaps_of_a_display(void)
{
	play(DISPLAY, 40 * MS, false);
	play(DISPLAY, 1000 * MS, false);
	play(DISPLAY, NEVER, true);
}

/* Swaps that wait come back some time after their vblank: the wire says when that was. */
static void test_external_vsync_of_a_display(void)
{
	wire = vsync_create((double)PERIOD_NS, 0.0);
	run(DISPLAY, DISPLAY, false);
	CHECK(dated > VBLANKS / 2 - 10);
	CHECK(on_vblank > VBLANKS / 2 - 10 && off_vblank < 3);
	vsync_destroy(&wire);
}

/* Swaps that do not wait are ordered at the wire's vblanks; their own times stay estimates. */
static void test_external_vsync_by_the_clock(void)
{
	wire = vsync_create((double)PERIOD_NS, 0.0);
	run(1 * MS, 1 * MS, false);
	CHECK(on_vblank > VBLANKS / 2 - 10 && off_vblank < 3);
	CHECK_INT(dated, 0);
	CHECK(drawn_at_end > 90);
	vsync_destroy(&wire);
	/* Without it they are not. */
	run(1 * MS, 1 * MS, false);
	CHECK_INT(on_vblank, 0);
}

int main(void)
{
	RUN(test_hidden);
	RUN(test_swap_that_hangs);
	RUN(test_slow_swaps);
	RUN(test_slow_swaps_of_a_display);
	RUN(test_external_vsync_of_a_display);
	RUN(test_external_vsync_by_the_clock);
	return test_result();
}
