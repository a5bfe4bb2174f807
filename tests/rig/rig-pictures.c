/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The KMS presenter on the kernel's virtual display: pictures larger than it, pictures that the GPU is drawing still,
 * and one presenter after another in one process.
 */
#include <dirent.h>
#include <pthread.h>
#include <time.h>

#include "daemon/present/kms.h"
#include "tests/rig/fake-gl.h"
#include "tests/test.h"

#define MS UINT64_C(1000000)
#define SECOND (1000 * MS)
#define PATIENCE_S 5
#define FLIPS 64u

static struct {
	struct clock clock;
	struct log log;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	struct presenter_flip flips[FLIPS]; /* the newest */
	uint32_t count;
	bool lost;
} bench;

static void on_flip(void *data, const struct presenter_flip *flip)
{
	pthread_mutex_lock(&bench.lock);
	bench.flips[bench.count++ % FLIPS] = *flip;
	pthread_cond_signal(&bench.wake);
	pthread_mutex_unlock(&bench.lock);
}

static void on_lost(void *data, const char *sentence)
{
	pthread_mutex_lock(&bench.lock);
	fprintf(stderr, "lost: %s\n", sentence);
	bench.lost = true;
	pthread_mutex_unlock(&bench.lock);
}

static struct presenter *open_presenter(const char *mode, bool share_gl)
{
	struct error error = {""};
	const struct presenter_params params = {.clock = &bench.clock,
											.log = &bench.log,
											.refresh_numerator = 120,
											.refresh_denominator = 1,
											.options = {.mode = mode, .share_gl = share_gl},
											.flip = on_flip,
											.lost = on_lost};
	memset(bench.flips, 0, sizeof(bench.flips));
	bench.lost = false;
	struct presenter *presenter = presenter_create("kms", &params, &error);
	if (!presenter)
		fprintf(stderr, "%s\n", error.text);
	CHECK(presenter != NULL);
	return presenter;
}

/* What was told of this vblank. */
static struct presenter_flip wait_for(uint64_t vblank)
{
	struct timespec end;
	clock_gettime(CLOCK_REALTIME, &end);
	end.tv_sec += PATIENCE_S;
	struct presenter_flip flip = {.vblank = 0};
	int result = 0;
	pthread_mutex_lock(&bench.lock);
	while (flip.vblank != vblank && result == 0) {
		for (uint32_t i = 0; i < FLIPS; i++)
			if (bench.flips[i].vblank == vblank)
				flip = bench.flips[i];
		if (flip.vblank != vblank)
			result = pthread_cond_timedwait(&bench.wake, &bench.lock, &end);
	}
	pthread_mutex_unlock(&bench.lock);
	CHECK_INT(flip.vblank, vblank);
	return flip;
}

static uint64_t time_of(struct presenter *presenter, uint64_t vblank)
{
	const struct grid grid = presenter->impl->get_grid(presenter);
	return grid_time(&grid, vblank);
}

static uint64_t vblank_after(struct presenter *presenter, uint64_t ns)
{
	const struct grid grid = presenter->impl->get_grid(presenter);
	return grid_at_or_after(&grid, clock_now(&bench.clock) + ns);
}

/* ---- pictures that are larger than the display ---- */

/* Blocks of 20 x 20 pixels, each of one colour. */
static uint32_t colour_at(uint32_t x, uint32_t y, uint32_t scale)
{
	return 0xff000000u | (x / 20 / scale * 0x1d0000u) | (y / 20 / scale * 0x2f00u) | ((x / 20 / scale * 7 + 3) & 0xff);
}

static void fill(const struct presenter_image *image, uint32_t scale)
{
	for (uint32_t y = 0; y < image->height; y++)
		for (uint32_t x = 0; x < image->width; x++) {
			const uint32_t colour = colour_at(x, y, scale);
			memcpy(image->data + y * image->stride + (size_t)x * 4, &colour, sizeof(colour));
		}
}

static const struct kms_buffer *buffer_of(struct presenter *presenter, const struct presenter_image *image)
{
	return &((struct kms *)presenter)->pictures[image->index].memory.buffer;
}

static uint32_t pixel_at(const struct kms_buffer *buffer, uint32_t x, uint32_t y)
{
	uint32_t pixel;
	memcpy(&pixel, buffer->data + y * buffer->stride + (size_t)x * 4, sizeof(pixel));
	return pixel & 0xffffffu;
}

/* In the middle of the display's 160 x 120, at this size, nothing but black around it. */
static void check_picture(const struct kms_buffer *buffer, uint32_t width, uint32_t height)
{
	const uint32_t left = (160 - width) / 2 / 16 * 16, top = (120 - height) / 2;
	uint32_t wrong = 0;
	for (uint32_t y = 0; y < 120; y++)
		for (uint32_t x = 0; x < 160; x++) {
			const bool in = x >= left && x < left + width && y >= top && y < top + height;
			const uint32_t want = in ? colour_at(x - left, y - top, 1) & 0xffffffu : 0;
			wrong += pixel_at(buffer, x, y) != want;
		}
	CHECK_INT(wrong, 0);
}

static void show_picture(struct presenter *presenter, uint32_t width, uint32_t height, uint32_t scale, uint64_t serial)
{
	struct presenter_image image;
	CHECK_INT(presenter->impl->acquire(presenter, width, height, &image), 0);
	CHECK(image.width == width && image.height == height && image.holds == 0);
	fill(&image, scale);
	const uint64_t vblank = vblank_after(presenter, 20 * MS);
	CHECK_INT(presenter->impl->present(presenter, &image, vblank, serial, serial), 0);
	check_picture(buffer_of(presenter, &image), width / scale, height / scale);
	const struct presenter_flip flip = wait_for(vblank);
	CHECK_INT(flip.serial, serial);
	CHECK(!flip.late);
}

static void test_larger_pictures(void)
{
	struct presenter *presenter = open_presenter("160x120@120", false);
	if (!presenter)
		return;
	uint64_t serial = 0;
	for (uint32_t i = 0; i < FLIPS_IMAGES / 2; i++) {
		show_picture(presenter, 320, 240, 2, ++serial);
		show_picture(presenter, 480, 180, 3, ++serial);
		show_picture(presenter, 120, 120, 1, ++serial);
		show_picture(presenter, 160, 60, 1, ++serial);
		show_picture(presenter, 180, 360, 3, ++serial);
	}
	presenter_destroy(&presenter);
}

/* What its user has not changed since is not made smaller once more; what others wrote meanwhile is not taken for it.
 */
static void test_a_larger_picture_that_stays(void)
{
	struct presenter *presenter = open_presenter("160x120@120", false);
	struct presenter_image first, image;
	if (!presenter)
		return;
	CHECK_INT(presenter->impl->acquire(presenter, 320, 240, &first), 0);
	fill(&first, 2);
	first.holds = 77;
	presenter->impl->set_standby(presenter, &first, 1, 1);
	presenter->impl->clear_standby(presenter);
	const struct kms_buffer *buffer = buffer_of(presenter, &first);
	check_picture(buffer, 160, 120);
	memset(buffer->data, 9, 4);
	CHECK_INT(presenter->impl->acquire(presenter, 320, 240, &image), 0);
	CHECK(image.index == first.index && image.holds == 77);
	presenter->impl->set_standby(presenter, &image, 2, 2);
	presenter->impl->clear_standby(presenter);
	CHECK_INT(pixel_at(buffer, 0, 0), 0x90909);
	CHECK_INT(presenter->impl->acquire(presenter, 160, 120, &image), 0);
	CHECK(image.index == first.index && image.holds == 0);
	presenter->impl->release(presenter, &image);
	CHECK_INT(presenter->impl->acquire(presenter, 320, 240, &image), 0);
	fill(&image, 2);
	image.holds = 77;
	presenter->impl->set_standby(presenter, &image, 3, 3);
	check_picture(buffer, 160, 120);
	presenter_destroy(&presenter);
}

/* ---- pictures that are drawn still ---- */

/* Queues one in GL that will be drawn when the test says so. */
static uint64_t present_fenced(struct presenter *presenter, uint64_t serial)
{
	struct presenter_image image;
	CHECK_INT(presenter->impl->acquire_texture(presenter, 64, 48, &image), 0);
	CHECK(image.fenced);
	const uint64_t vblank = vblank_after(presenter, 20 * MS);
	CHECK_INT(presenter->impl->present(presenter, &image, vblank, serial, serial), 0);
	return vblank;
}

static void wait_until(uint64_t time_ns)
{
	clock_wait_until(&bench.clock, time_ns);
}

/* Done after the kernel was given it, before its vblank: on time. */
static void check_drawn_in_time(struct presenter *presenter, uint64_t serial)
{
	const uint64_t vblank = present_fenced(presenter, serial);
	wait_until(time_of(presenter, vblank) - MS / 2);
	fake_gl_signal();
	const struct presenter_flip flip = wait_for(vblank);
	CHECK(flip.serial == serial && flip.shown == PRESENTER_PICTURE && !flip.late);
}

/* Done three vblanks late: so it is told, and nothing else is lost. */
static void check_drawn_late(struct presenter *presenter, uint64_t serial)
{
	const uint64_t vblank = present_fenced(presenter, serial);
	wait_until(time_of(presenter, vblank + 2) + MS);
	fake_gl_signal();
	CHECK_INT(wait_for(vblank + 2).serial, serial - 1);
	const struct presenter_flip flip = wait_for(vblank + 3);
	CHECK(flip.serial == serial && flip.late);
}

static struct presenter *open_with_gl(void)
{
	if (!fake_gl_open_fences())
		SKIP("the kernel has no fences for tests");
	struct presenter *presenter = open_presenter("160x120@120", true);
	const struct presenter_context *context = presenter ? presenter->impl->get_context(presenter) : NULL;
	if (!context || !context->enter(context->data))
		SKIP("there is no GL on this display");
	return presenter;
}

static void close_with_gl(struct presenter *presenter)
{
	const struct presenter_context *context = presenter->impl->get_context(presenter);
	context->release(context->data);
	presenter_destroy(&presenter);
	CHECK(!bench.lost);
	fake_gl.has_fences = fake_gl.breaks = false;
}

static void test_fences(void)
{
	fake_gl.has_fences = true;
	struct presenter *presenter = open_with_gl();
	fake_gl.waits = 0;
	for (uint64_t serial = 1; serial < 2 * FLIPS_IMAGES; serial += 2) {
		check_drawn_in_time(presenter, serial);
		check_drawn_late(presenter, serial + 1);
	}
	CHECK_INT(fake_gl.waits, 0);
	CHECK_INT(fake_gl.fences, 2 * FLIPS_IMAGES);
	close_with_gl(presenter);
}

/* A fence that cannot be had after all: the picture is waited for. */
static void test_broken_fences(void)
{
	fake_gl.has_fences = true;
	struct presenter *presenter = open_with_gl();
	fake_gl.breaks = true;
	fake_gl.waits = 0;
	const uint64_t vblank = present_fenced(presenter, 1);
	CHECK_INT(fake_gl.waits, 1);
	CHECK_INT(wait_for(vblank).serial, 1);
	close_with_gl(presenter);
}

static void *signal_after_a_second(void *data)
{
	(void)data;
	wait_until(clock_now(&bench.clock) + SECOND);
	fake_gl_signal();
	return NULL;
}

/* The GPU hangs for longer than a flip may take otherwise; then all goes on. So does it when the presenter ends. */
static void test_the_gpu_hangs(void)
{
	pthread_t thread;
	fake_gl.has_fences = true;
	struct presenter *presenter = open_with_gl();
	const uint64_t vblank = present_fenced(presenter, 1);
	wait_until(time_of(presenter, vblank) + 4 * SECOND);
	CHECK(!bench.lost);
	fake_gl_signal();
	show_picture(presenter, 120, 120, 1, 2);
	wait_until(time_of(presenter, present_fenced(presenter, 3)) + MS);
	CHECK_INT(pthread_create(&thread, NULL, signal_after_a_second, NULL), 0);
	close_with_gl(presenter);
	pthread_join(thread, NULL);
	presenter = open_presenter("160x120@120", false);
	show_picture(presenter, 120, 120, 1, 1);
	presenter_destroy(&presenter);
}

/* Larger ones in GL: without fences they are waited for, as GL makes them smaller after its user has done with them. */
static void test_larger_pictures_in_gl(void)
{
	struct presenter *presenter = open_with_gl();
	struct presenter_image image;
	fake_gl.waits = 0;
	for (uint64_t serial = 1; serial <= 3; serial++) {
		CHECK_INT(presenter->impl->acquire_texture(presenter, 320, 240, &image), 0);
		CHECK(!image.fenced && image.texture != 0 && image.texture_x == 0 && image.texture_y == 0);
		const uint64_t vblank = vblank_after(presenter, 20 * MS);
		CHECK_INT(presenter->impl->present(presenter, &image, vblank, serial, serial), 0);
		CHECK_INT(fake_gl.waits, serial);
		CHECK_INT(wait_for(vblank).serial, serial);
	}
	close_with_gl(presenter);
}

/* ---- one after another ---- */

static uint32_t open_files(void)
{
	uint32_t count = 0;
	DIR *folder = opendir("/proc/self/fd");
	while (readdir(folder))
		count++;
	closedir(folder);
	return count;
}

/* A line of this process's /proc/self/status. */
static long status_of(const char *name)
{
	FILE *file = fopen("/proc/self/status", "re");
	char line[256];
	long value = -1;
	while (file && fgets(line, sizeof(line), file))
		if (strncmp(line, name, strlen(name)) == 0)
			value = atol(line + strlen(name));
	if (file)
		fclose(file);
	return value;
}

static void show_one_and_go(const char *mode, bool share_gl)
{
	struct presenter *presenter = open_presenter(mode, share_gl);
	struct presenter_image image;
	if (!presenter)
		return;
	CHECK(strncmp(presenter->impl->get_display(presenter), mode, 7) == 0);
	CHECK_INT(presenter->impl->acquire(presenter, 100, 80, &image), 0);
	const uint64_t vblank = vblank_after(presenter, 20 * MS);
	CHECK_INT(presenter->impl->present(presenter, &image, vblank, 1, 1), 0);
	CHECK_INT(wait_for(vblank).serial, 1);
	presenter_destroy(&presenter);
	CHECK(!bench.lost);
}

/* A connector that is not there: said, and the next one works. */
static void check_no_such_connector(void)
{
	struct error error = {""};
	const struct presenter_params params = {.clock = &bench.clock,
											.log = &bench.log,
											.refresh_numerator = 120,
											.refresh_denominator = 1,
											.options = {.connector = "HDMI-A-1"},
											.flip = on_flip,
											.lost = on_lost};
	CHECK(presenter_create("kms", &params, &error) == NULL);
	CHECK(strstr(error.text, "has no connector \"HDMI-A-1\"; it has Virtual-1") != NULL);
}

/* Another mode, with GL and without: nothing stays open or on display. */
static void test_one_after_another(void)
{
	static const char *const modes[] = {"160x120@120", "640x480@60", "320x240@100"};
	show_one_and_go(modes[0], true);
	const uint32_t before = open_files();
	for (uint32_t i = 0; i < 9; i++) {
		check_no_such_connector();
		show_one_and_go(modes[i % 3], i % 2 == 0);
	}
	CHECK_INT(open_files(), before);
	CHECK_INT(status_of("Threads:"), 1);
	CHECK_INT(status_of("VmLck:"), 0);
}

int main(void)
{
	clock_init_real(&bench.clock);
	log_init(&bench.log, LOG_LEVEL_INFO);
	pthread_mutex_init(&bench.lock, NULL);
	pthread_cond_init(&bench.wake, NULL);
	RUN(test_larger_pictures);
	RUN(test_a_larger_picture_that_stays);
	RUN(test_fences);
	RUN(test_broken_fences);
	RUN(test_the_gpu_hangs);
	RUN(test_larger_pictures_in_gl);
	RUN(test_one_after_another);
	return test_result();
}
