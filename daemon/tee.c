/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/tee.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/open_at_once.h"
#include "daemon/record/image.h"
#include "daemon/record/pattern.h"
#include "daemon/record/y4m.h"
#include "daemon/worker.h"

#define PICTURES 20u
#define QUEUED 64u
#define PATIENCE_NS UINT64_C(5000000000)
#define PATIENCES 6u
/* Tried for an image. */
#define NAMES 100u

struct tee_picture {
	uint8_t *data;          /* packed */
	uint64_t group, serial; /* serial 0: free */
	uint32_t queued;        /* how often it waits to be written */
};

struct tee {
	struct tee_params params;
	char path[512];
	bool images; /* `path` is a pattern */
	FILE *times;
	struct worker *worker;
	pthread_mutex_t lock; /* for all below but `video` */
	pthread_cond_t wake;
	bool stop, failed, drop_said;
	uint32_t width, height;    /* of the first picture; 0: none yet */
	uint32_t rate, rate_scale; /* of the first vblank; 0: none yet */
	struct tee_picture pictures[PICTURES];
	struct {
		uint32_t picture;
		struct presenter_flip flip;
	} queue[QUEUED];
	uint32_t first, count;
	uint64_t written, dropped, other_size;
	uint64_t first_number; /* the thread's: of its images */
	struct y4m *video;     /* the thread's */
};

/* ---- the thread ---- */

/* Images that are there stay: the next one gets a number after theirs. */
static int number_on(struct tee *tee, struct error *error)
{
	uint64_t *numbers;
	size_t count;
	const int result = pattern_list(tee->path, &numbers, &count, error);
	if (result == 0 && count > 0)
		tee->first_number = numbers[count - 1] + 1 - tee->written;
	free(numbers);
	return result;
}

/* Makes the file, unless an image has that name. What else is wrong with it is told when it is written. */
static bool is_free(const char *name)
{
	struct stat file;
	const int fd = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
	if (fd >= 0)
		close(fd);
	return fd >= 0 || errno != EEXIST || lstat(name, &file) < 0 || !S_ISREG(file.st_mode);
}

/* A recording of before with the same pattern may still be writing. */
static int take_name(struct tee *tee, char name[PATTERN_MAX_PATH], struct error *error)
{
	for (unsigned i = 0; i < NAMES; i++) {
		if ((tee->written == 0 || i > 0) && number_on(tee, error) < 0)
			return -EIO;
		const uint64_t number = tee->first_number + tee->written;
		if (!pattern_name(tee->path, number, name))
			return error_set(error, -ENAMETOOLONG, "%s: the name of frame %" PRIu64 " is too long", tee->path, number);
		if (is_free(name))
			return 0;
	}
	return error_set(error, -EEXIST, "%s: others take all the names", tee->path);
}

static int write_image(struct tee *tee, const struct tee_picture *picture, struct error *error)
{
	char name[PATTERN_MAX_PATH];
	if (take_name(tee, name, error) < 0)
		return -EIO;
	const int result =
		image_write_png(name, picture->data, (size_t)tee->width * 4, tee->width, tee->height, false, error);
	if (result < 0)
		unlink(name); /* half an image is none */
	return result;
}

static int write_video(struct tee *tee, const struct tee_picture *picture, struct error *error)
{
	const struct y4m_params params = {.path = tee->path,
									  .width = tee->width,
									  .height = tee->height,
									  .rate = tee->rate,
									  .rate_scale = tee->rate_scale,
									  .chroma = 444};
	if (!tee->video)
		tee->video = y4m_create(&params, error);
	if (!tee->video)
		return -EIO;
	return y4m_frame(tee->video, picture->data, (size_t)tee->width * 4, error);
}

static int write_frame(struct tee *tee, const struct tee_picture *picture, const struct presenter_flip *flip,
					   struct error *error)
{
	static const char *const shown[] = {"picture", "standby", "kept"};
	const int result = tee->images ? write_image(tee, picture, error) : write_video(tee, picture, error);
	if (result == 0)
		fprintf(tee->times, "%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%s,%" PRIu64 ",%s,%" PRIu64 "\n",
				flip->vblank, flip->sequence, flip->target_ns, flip->flip_ns,
				presenter_time_source_name(flip->time_source), flip->serial, shown[flip->shown],
				tee->first_number + tee->written);
	return result;
}

/* With the lock, which is given up while it writes. */
static void write_next(struct tee *tee)
{
	struct tee_picture *picture = &tee->pictures[tee->queue[tee->first].picture];
	const struct presenter_flip flip = tee->queue[tee->first].flip;
	struct error error;
	int result = -EIO;
	if (!tee->failed) {
		pthread_mutex_unlock(&tee->lock);
		result = write_frame(tee, picture, &flip, &error);
		if (result < 0)
			log_error(tee->params.log, "tee: %s; nothing more is recorded", error.text);
		pthread_mutex_lock(&tee->lock);
	}
	tee->failed = result < 0;
	tee->written += result == 0;
	tee->dropped += result < 0;
	picture->queued--;
	tee->first = (tee->first + 1) % QUEUED;
	tee->count--;
}

static void run(void *data)
{
	struct tee *tee = data;
	pthread_setname_np(pthread_self(), "pursuit-tee");
	pthread_mutex_lock(&tee->lock);
	while (!tee->stop || tee->count > 0) {
		if (tee->count > 0)
			write_next(tee);
		else
			pthread_cond_wait(&tee->wake, &tee->lock);
	}
	pthread_mutex_unlock(&tee->lock);
}

/* ---- the drawing thread ---- */

/* With the lock. */
static struct tee_picture *free_picture(struct tee *tee)
{
	for (uint32_t i = 0; i < PICTURES; i++)
		if (tee->pictures[i].serial == 0 && tee->pictures[i].queued == 0)
			return &tee->pictures[i];
	return NULL;
}

void tee_add(struct tee *tee, const struct presenter_image *image, uint64_t group, uint64_t serial)
{
	pthread_mutex_lock(&tee->lock);
	if (tee->width == 0) {
		tee->width = image->width;
		tee->height = image->height;
	}
	const bool fits = image->width == tee->width && image->height == tee->height;
	struct tee_picture *picture = fits && !tee->failed ? free_picture(tee) : NULL;
	tee->other_size += !fits;
	pthread_mutex_unlock(&tee->lock);
	/* A free picture is nobody else's until it has a serial. */
	const size_t row = (size_t)image->width * 4;
	if (picture && !picture->data)
		picture->data = malloc(row * image->height);
	if (!picture || !picture->data)
		return;
	for (uint32_t y = 0; y < image->height; y++)
		memcpy(picture->data + y * row, image->data + y * image->stride, row);
	pthread_mutex_lock(&tee->lock);
	picture->group = group;
	picture->serial = serial;
	pthread_mutex_unlock(&tee->lock);
}

/* That of a grid that was learned, in thousandths of a hertz. */
static void set_rate(struct tee *tee, const struct grid *grid)
{
	const bool fits = grid->numerator <= UINT32_MAX && grid->denominator <= UINT32_MAX;
	const uint32_t thousandths = (uint32_t)lround(1e12 / grid_period_ns(grid)), scale = thousandths % 1000 ? 1000 : 1;
	tee->rate = fits ? (uint32_t)grid->numerator : thousandths / (1000 / scale);
	tee->rate_scale = fits ? (uint32_t)grid->denominator : scale;
}

void tee_flip(struct tee *tee, const struct presenter_flip *flip, const struct grid *grid)
{
	bool first_drop = false;
	if (flip->serial == 0)
		return;
	pthread_mutex_lock(&tee->lock);
	if (tee->rate == 0)
		set_rate(tee, grid);
	uint32_t found = PICTURES;
	for (uint32_t i = 0; i < PICTURES; i++) {
		if (tee->pictures[i].serial == flip->serial)
			found = i;
		else if (tee->pictures[i].group < flip->group)
			tee->pictures[i].serial = 0; /* of a real frame that is over */
	}
	if (found < PICTURES && tee->count < QUEUED) {
		const uint32_t last = (tee->first + tee->count++) % QUEUED;
		tee->queue[last].picture = found;
		tee->queue[last].flip = *flip;
		tee->pictures[found].queued++;
		pthread_cond_signal(&tee->wake);
	} else {
		tee->dropped++;
		first_drop = !tee->failed && !tee->drop_said;
		tee->drop_said |= first_drop;
	}
	pthread_mutex_unlock(&tee->lock);
	if (first_drop)
		log_warning(tee->params.log, "tee: %s does not keep up, frames are dropped from vblank %" PRIu64 " on",
					tee->path, flip->vblank);
}

/* ---- life ---- */

void tee_times_path(const char *path, char times[TEE_TIMES_BYTES])
{
	const char *slash = strrchr(path, '/');
	if (strchr(path, '%'))
		snprintf(times, TEE_TIMES_BYTES, "%.*stimes.csv", slash ? (int)(slash + 1 - path) : 0, path);
	else
		snprintf(times, TEE_TIMES_BYTES, "%s.csv", path);
}

/* 0 or a negative errno with a sentence. */
static int open_times(struct tee *tee, struct error *error)
{
	char times[TEE_TIMES_BYTES];
	struct stat file;
	tee_times_path(tee->path, times);
	const int fd = open_at_once("tee", times, O_TRUNC, error);
	if (fd < 0)
		return fd;
	tee->times = fdopen(fd, "w");
	if (!tee->times) {
		close(fd);
		return error_set(error, -ENOMEM, "tee: out of memory");
	}
	fprintf(tee->times, "vblank,sequence,target_ns,flip_ns,time_source,picture,shown,number\n");
	/* So that who is to write there next puts it aside, where rows may still come; an empty file nobody would. */
	if (fstat(fd, &file) == 0 && S_ISREG(file.st_mode))
		fflush(tee->times);
	return 0;
}

struct tee *tee_create(const struct tee_params *params, struct error *error)
{
	struct tee *tee = calloc(1, sizeof(*tee));
	if (!tee) {
		error_set(error, -ENOMEM, "tee: out of memory");
		return NULL;
	}
	tee->params = *params;
	snprintf(tee->path, sizeof(tee->path), "%s", params->path);
	tee->images = strchr(tee->path, '%') != NULL;
	if ((tee->images && pattern_check("tee", tee->path, error) < 0) || open_times(tee, error) < 0) {
		free(tee);
		return NULL;
	}
	pthread_mutex_init(&tee->lock, NULL);
	pthread_cond_init(&tee->wake, NULL);
	const int result = worker_create(&tee->worker, run, tee);
	if (result == 0)
		return tee;
	error_set(error, result, "tee: cannot start a thread: %s", strerror(-result));
	fclose(tee->times);
	pthread_cond_destroy(&tee->wake);
	pthread_mutex_destroy(&tee->lock);
	free(tee);
	return NULL;
}

static int close_files(struct tee *tee, struct error *error)
{
	int result = y4m_destroy(&tee->video, error);
	const bool wrong = ferror(tee->times) != 0;
	if ((fclose(tee->times) != 0 || wrong) && result == 0)
		result = error_set(error, -EIO, "the times of %.300s were not written whole", tee->path);
	return result;
}

static void free_tee(struct tee *tee)
{
	for (uint32_t i = 0; i < PICTURES; i++)
		free(tee->pictures[i].data);
	pthread_cond_destroy(&tee->wake);
	pthread_mutex_destroy(&tee->lock);
	free(tee);
}

/* On the thread, once the disk has answered after all; the log may be gone by then. */
static void finish_late(void *data)
{
	struct tee *tee = data;
	struct error error;
	close_files(tee, &error);
	free_tee(tee);
}

static uint64_t count_done(struct tee *tee)
{
	pthread_mutex_lock(&tee->lock);
	const uint64_t done = tee->written + tee->dropped;
	pthread_mutex_unlock(&tee->lock);
	return done;
}

/* False: the disk does not answer; the thread has its memory until it does. */
static bool wait_for_thread(struct tee *tee)
{
	struct worker *worker = tee->worker; /* what is the thread's is gone when that has ended */
	const uint64_t patience_ns = tee->params.patience_ns ? tee->params.patience_ns : PATIENCE_NS;
	uint64_t before = UINT64_MAX, done = count_done(tee);
	bool ended = false;
	for (unsigned i = 0; i < PATIENCES && !ended && done != before; i++) {
		before = done;
		ended = worker_wait(worker, patience_ns);
		done = count_done(tee);
	}
	if (!ended) {
		pthread_mutex_lock(&tee->lock);
		log_error(tee->params.log,
				  "tee: %s does not take what is written; given up after %" PRIu64 " frames, %" PRIu64 " dropped",
				  tee->path, tee->written, tee->dropped + tee->count);
		pthread_mutex_unlock(&tee->lock);
	}
	return worker_destroy(&worker, 0, finish_late);
}

void tee_destroy(struct tee **tee)
{
	struct tee *self = *tee;
	struct error error;
	*tee = NULL;
	if (!self)
		return;
	pthread_mutex_lock(&self->lock);
	self->stop = true;
	pthread_cond_signal(&self->wake);
	pthread_mutex_unlock(&self->lock);
	if (!wait_for_thread(self))
		return;
	if (close_files(self, &error) < 0)
		log_error(self->params.log, "tee: %s", error.text);
	log_info(self->params.log,
			 "tee: %" PRIu64 " frames in %s, %" PRIu64 " dropped, %" PRIu64 " pictures of another size", self->written,
			 self->path, self->dropped, self->other_size);
	free_tee(self);
}
