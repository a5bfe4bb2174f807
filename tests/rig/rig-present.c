/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * KMS presenter and pacer against the kernel's virtual display, without engine
 * and client: a stream in step with the display (a real frame every third
 * vblank), tiny pictures, each queued for its vblank. What the kernel said of
 * each flip is compared with what was asked for.
 *
 *   rig-present [--flips F] [--mode WxH@R] [--on-time SHARE] [--slow-probe MS]
 *
 * With --slow-probe each look at the cable takes so long (virtual) time, as with displays that are real.
 * Without --on-time nothing may be missed, doubled, out of order or out of
 * phase. With it (real time) that share of the vblanks must show their picture.
 */
#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#include "daemon/clock.h"
#include "daemon/present/kms_device.h"
#include "daemon/present/pacer.h"
#include "daemon/present/presenter.h"
#include "tests/test.h"

#define PICTURE 32u
#define VBLANKS_PER_FRAME 3u
/* Vblanks until grid and display delay are known; what is exact is checked from then on. */
#define SETTLE 300u
#define PHASE_TOLERANCE 0.001
#define SKEW_TOLERANCE_NS 2000
#define RING 64u
#define BINS 21u
#define BIN_NS 200000.0

/* A picture is queued so long before the presenter wants it. */
#define LEAD_NS UINT64_C(3000000)
/* A frame reaches the daemon so long before the vblank that shows it first. */
#define AGE_NS UINT64_C(6000000)

struct bench_result {
	uint64_t flips, missed, doubled, disordered, skipped, late, sequence_gaps, refused;
	uint64_t last_serial, least_interval_ns, most_interval_ns;
	int64_t most_skew_ns;
	double most_phase_error;
	uint64_t intervals[BINS];
	char loss[512];
};

struct bench {
	struct clock clock;
	struct log log;
	struct presenter *presenter;
	struct pacer pacer;
	struct grid grid;
	struct bench_result result;
	uint64_t first_vblank, last_vblank, serial, group;

	pthread_mutex_t lock;
	pthread_cond_t wake;
	bool lost;
	uint64_t flipped;       /* vblanks reported */
	uint64_t serials[RING]; /* queued for a vblank */
	uint64_t last_flip_ns, last_sequence;
};

static void count_interval(struct bench_result *result, uint64_t interval_ns, double period_ns)
{
	const double bin = ((double)interval_ns - period_ns) / BIN_NS + BINS / 2.0;
	result->intervals[bin < 0.0 ? 0 : bin >= BINS ? BINS - 1 : (unsigned)bin]++;
	if (result->least_interval_ns == 0 || interval_ns < result->least_interval_ns)
		result->least_interval_ns = interval_ns;
	if (interval_ns > result->most_interval_ns)
		result->most_interval_ns = interval_ns;
}

static void count_flip(struct bench *bench, const struct presenter_flip *flip)
{
	struct bench_result *result = &bench->result;
	const uint64_t expected = bench->serials[flip->vblank % RING];
	const int64_t skew_ns = (int64_t)(flip->flip_ns - flip->target_ns);

	result->flips++;
	result->skipped += flip->skipped;
	result->late += flip->late;
	result->missed += expected != 0 && (flip->shown != PRESENTER_PICTURE || flip->serial != expected);
	result->doubled += flip->shown == PRESENTER_PICTURE && flip->serial == result->last_serial;
	result->disordered += flip->serial < result->last_serial;
	result->last_serial = flip->serial;
	if (bench->last_flip_ns != 0 && flip->vblank > bench->first_vblank) {
		count_interval(result, flip->flip_ns - bench->last_flip_ns, grid_period_ns(&bench->grid));
		result->sequence_gaps += flip->sequence != bench->last_sequence + 1;
	}
	bench->last_flip_ns = flip->flip_ns;
	bench->last_sequence = flip->sequence;
	if (flip->vblank < bench->first_vblank + SETTLE)
		return;
	if (skew_ns > result->most_skew_ns || -skew_ns > result->most_skew_ns)
		result->most_skew_ns = skew_ns < 0 ? -skew_ns : skew_ns;
}

static void on_flip(void *data, const struct presenter_flip *flip)
{
	struct bench *bench = data;
	pthread_mutex_lock(&bench->lock);
	count_flip(bench, flip);
	bench->flipped = flip->vblank;
	pthread_cond_signal(&bench->wake);
	pthread_mutex_unlock(&bench->lock);
}

static void on_lost(void *data, const char *sentence)
{
	struct bench *bench = data;
	pthread_mutex_lock(&bench->lock);
	snprintf(bench->result.loss, sizeof(bench->result.loss), "%s", sentence);
	bench->lost = true;
	pthread_cond_signal(&bench->wake);
	pthread_mutex_unlock(&bench->lock);
}

/* A tiny picture; drawing it costs next to nothing. */
static void draw(const struct presenter_image *image, uint64_t number)
{
	for (uint32_t y = 0; y < image->height; y++)
		memset(image->data + y * image->stride, (int)(number * 37 & 0xff), (size_t)image->width * 4);
}

/* A client in step with the display: real frames for every n-th vblank. */
static void add_frame(struct bench *bench, uint64_t vblank)
{
	const uint64_t time_ns = grid_time(&bench->grid, vblank) - AGE_NS;
	const struct pacer_frame frame = {.frame_id = ++bench->group, .time_ns = time_ns, .intake_ns = time_ns};
	pacer_add_frame(&bench->pacer, &frame);
}

static void check_phase(struct bench *bench, const struct pacer_decision *decision, uint64_t vblank)
{
	const double expected = (double)((vblank - bench->first_vblank) % VBLANKS_PER_FRAME) / VBLANKS_PER_FRAME;
	const double error = fabs(decision->phase - expected);
	if (vblank >= bench->first_vblank + SETTLE && error > bench->result.most_phase_error)
		bench->result.most_phase_error = error;
}

static int show(struct bench *bench, uint64_t vblank)
{
	struct presenter *presenter = bench->presenter;
	struct presenter_image image;

	if ((vblank - bench->first_vblank) % VBLANKS_PER_FRAME == 0)
		add_frame(bench, vblank);
	const struct pacer_decision decision = pacer_decide(&bench->pacer, vblank);
	check_phase(bench, &decision, vblank);
	int result = presenter->impl->acquire(presenter, PICTURE, PICTURE, &image);
	if (result < 0)
		return result;
	draw(&image, vblank);
	const uint64_t serial = ++bench->serial;
	pthread_mutex_lock(&bench->lock);
	bench->serials[vblank % RING] = serial;
	pthread_mutex_unlock(&bench->lock);
	result = presenter->impl->present(presenter, &image, vblank, bench->group, serial);
	if (result == 0)
		return 0;
	presenter->impl->release(presenter, &image);
	bench->result.refused++;
	return result == -ETIME ? 0 : result;
}

static void take_grid(struct bench *bench)
{
	bench->grid = bench->presenter->impl->get_grid(bench->presenter);
	pacer_set_grid(&bench->pacer, &bench->grid);
}

/* Waits until this vblank was reported; the grid may have moved by then. */
static bool wait_for(struct bench *bench, uint64_t vblank)
{
	pthread_mutex_lock(&bench->lock);
	while (bench->flipped < vblank && !bench->lost)
		pthread_cond_wait(&bench->wake, &bench->lock);
	const bool fine = !bench->lost;
	pthread_mutex_unlock(&bench->lock);
	return fine;
}

static void drive(struct bench *bench, uint64_t flips)
{
	const uint64_t lead_ns = LEAD_NS + bench->presenter->impl->get_lead(bench->presenter);
	bench->first_vblank = grid_at_or_after(&bench->grid, clock_now(&bench->clock) + 2 * lead_ns) + 1;
	bench->last_vblank = bench->first_vblank + flips - 1;
	bench->flipped = bench->first_vblank - 1;
	for (uint64_t vblank = bench->first_vblank; vblank <= bench->last_vblank; vblank++) {
		take_grid(bench);
		clock_wait_until(&bench->clock, grid_time(&bench->grid, vblank) - lead_ns);
		if (show(bench, vblank) < 0 || (vblank >= bench->first_vblank + 2 && !wait_for(bench, vblank - 2)))
			return;
	}
	wait_for(bench, bench->last_vblank);
	bench->presenter->impl->pause(bench->presenter);
}

/* ---- a display whose cable is looked at slowly ---- */

static unsigned slow_probe_ms;
static atomic_uint slow_probes;

bool __real_kms_device_is_connected(struct kms_device *device, bool probe);
bool __wrap_kms_device_is_connected(struct kms_device *device, bool probe);

bool __wrap_kms_device_is_connected(struct kms_device *device, bool probe)
{
	const struct timespec while_it_answers = {slow_probe_ms / 1000, (long)(slow_probe_ms % 1000) * 1000000};
	if (slow_probe_ms > 0 && nanosleep(&while_it_answers, NULL) == 0)
		atomic_fetch_add(&slow_probes, 1);
	return __real_kms_device_is_connected(device, probe);
}

/* ---- */

struct arguments {
	uint64_t flips;
	const char *mode;
	double on_time; /* 0: all, exactly */
	unsigned slow_probe_ms;
};

static void print(const struct bench *bench)
{
	const struct bench_result *result = &bench->result;
	printf("%" PRIu64 " flips at %.4f Hz: %" PRIu64 " missed, %" PRIu64 " doubled, %" PRIu64 " out of order, %" PRIu64
		   " late, %" PRIu64 " vblanks skipped, %" PRIu64 " gaps in the kernel's count, %" PRIu64 " refused\n",
		   result->flips, 1e9 / grid_period_ns(&bench->grid), result->missed, result->doubled, result->disordered,
		   result->late, result->skipped, result->sequence_gaps, result->refused);
	printf("largest skew against the grid %" PRId64 " ns, largest error of a phase %.6f, intervals %" PRIu64
		   " to %" PRIu64 " ns\n",
		   result->most_skew_ns, result->most_phase_error, result->least_interval_ns, result->most_interval_ns);
	for (unsigned i = 0; i < BINS; i++)
		if (result->intervals[i])
			printf("interval %+5.1f ms %8" PRIu64 "\n", ((double)i - BINS / 2) * BIN_NS / 1e6, result->intervals[i]);
	if (result->loss[0])
		printf("lost: %s\n", result->loss);
}

static void check(const struct bench *bench, const struct arguments *arguments)
{
	const struct bench_result *result = &bench->result;
	CHECK_STRING(result->loss, "");
	CHECK_INT(result->doubled, 0);
	CHECK_INT(result->disordered, 0);
	if (arguments->on_time > 0.0) {
		const uint64_t bad = result->missed + result->late + result->skipped + result->refused;
		CHECK((double)bad <= (1.0 - arguments->on_time) * (double)arguments->flips);
		return;
	}
	CHECK_INT(result->flips, arguments->flips);
	CHECK_INT(result->missed, 0);
	CHECK_INT(result->late, 0);
	CHECK_INT(result->skipped, 0);
	CHECK_INT(result->refused, 0);
	CHECK_INT(result->sequence_gaps, 0);
	CHECK_NEAR(result->most_phase_error, 0.0, PHASE_TOLERANCE);
	CHECK(result->most_skew_ns <= SKEW_TOLERANCE_NS);
}

static bool parse(int count, char **values, struct arguments *arguments)
{
	static const struct option options[] = {{"flips", required_argument, NULL, 'f'},
											{"mode", required_argument, NULL, 'm'},
											{"on-time", required_argument, NULL, 'o'},
											{"slow-probe", required_argument, NULL, 's'},
											{0}};
	int option;
	*arguments = (struct arguments){.flips = 1200, .mode = "1024x768@120"};
	while ((option = getopt_long(count, values, "", options, NULL)) != -1) {
		if (option == 'f')
			arguments->flips = strtoull(optarg, NULL, 10);
		else if (option == 'm')
			arguments->mode = optarg;
		else if (option == 'o')
			arguments->on_time = strtod(optarg, NULL);
		else if (option == 's')
			arguments->slow_probe_ms = (unsigned)strtoul(optarg, NULL, 10);
		else
			return false;
	}
	return optind == count;
}

int main(int count, char **values)
{
	struct arguments arguments;
	struct bench bench = {0};
	struct error error = {""};

	if (!parse(count, values, &arguments))
		return 2;
	slow_probe_ms = arguments.slow_probe_ms;
	clock_init_real(&bench.clock);
	log_init(&bench.log, LOG_LEVEL_INFO);
	pthread_mutex_init(&bench.lock, NULL);
	pthread_cond_init(&bench.wake, NULL);
	const struct presenter_params params = {.clock = &bench.clock,
											.log = &bench.log,
											.refresh_numerator = 120,
											.refresh_denominator = 1,
											.options = {.mode = arguments.mode},
											.flip = on_flip,
											.lost = on_lost,
											.data = &bench};
	bench.presenter = presenter_create("kms", &params, &error);
	CHECK(bench.presenter != NULL);
	if (bench.presenter) {
		bench.grid = bench.presenter->impl->get_grid(bench.presenter);
		const struct pacer_params pacer_params = {.grid = bench.grid};
		pacer_init(&bench.pacer, &pacer_params);
		drive(&bench, arguments.flips);
		presenter_destroy(&bench.presenter);
		print(&bench);
		check(&bench, &arguments);
		CHECK(slow_probe_ms == 0 || atomic_load(&slow_probes) >= 3);
	}
	return test_result();
}
