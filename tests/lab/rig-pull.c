/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/lab/rig-pull.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define FLIPS 64u
#define BOUNCE_NS UINT64_C(100000)

struct rig_pull {
	struct clock *clock;
	int fd;
	FILE *truth;
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	struct presenter_flip flips[FLIPS];
	uint32_t count;
	bool stop;
	bool level; /* of the line; starts pulled down */
};

static void pull_to(struct rig_pull *pull, bool high)
{
	const char *word = high ? "pull-up" : "pull-down";
	if (pwrite(pull->fd, word, strlen(word), 0) < 0)
		fprintf(stderr, "pull: %s\n", strerror(errno));
}

static void shine(struct rig_pull *pull, const struct presenter_flip *flip)
{
	const uint64_t due_ns = flip->flip_ns + 2000000 + flip->vblank * 7919 % 4000 * 1000;
	const bool level = flip->vblank & 1, lost = flip->vblank % 17 == 0 || level == pull->level,
			   bounces = flip->vblank % 23 == 0;
	uint64_t before_ns = 0, after_ns = 0;
	clock_wait_until(pull->clock, due_ns);
	if (!lost) {
		before_ns = clock_now(pull->clock);
		pull_to(pull, level);
		pull->level = level;
		after_ns = clock_now(pull->clock);
	}
	for (int i = 0; i < 2 && bounces && !lost; i++) {
		clock_wait_until(pull->clock, after_ns + BOUNCE_NS * (uint64_t)(i + 1));
		pull_to(pull, level == (i == 1));
	}
	fprintf(pull->truth, "%" PRIu64 " %" PRIu64 " %" PRIu64 "\n", flip->vblank, before_ns, after_ns);
}

static void *run(void *data)
{
	struct rig_pull *pull = data;
	pthread_mutex_lock(&pull->lock);
	while (!pull->stop || pull->count > 0) {
		if (pull->count == 0) {
			pthread_cond_wait(&pull->wake, &pull->lock);
			continue;
		}
		const struct presenter_flip flip = pull->flips[0];
		pull->count--;
		memmove(&pull->flips[0], &pull->flips[1], pull->count * sizeof(pull->flips[0]));
		pthread_mutex_unlock(&pull->lock);
		shine(pull, &flip);
		pthread_mutex_lock(&pull->lock);
	}
	pthread_mutex_unlock(&pull->lock);
	return NULL;
}

struct rig_pull *rig_pull_create(struct clock *clock, const char *pull_path, const char *truth_path)
{
	struct rig_pull *pull = calloc(1, sizeof(*pull));
	if (!pull)
		return NULL;
	pull->clock = clock;
	pull->fd = open(pull_path, O_WRONLY | O_CLOEXEC);
	pull->truth = fopen(truth_path, "we");
	pthread_mutex_init(&pull->lock, NULL);
	pthread_cond_init(&pull->wake, NULL);
	if (pull->fd >= 0 && pull->truth && pthread_create(&pull->thread, NULL, run, pull) == 0)
		return pull;
	if (pull->truth)
		fclose(pull->truth);
	free(pull);
	return NULL;
}

void rig_pull_flip(struct rig_pull *pull, const struct presenter_flip *flip)
{
	if (!pull || flip->shown != PRESENTER_PICTURE)
		return;
	pthread_mutex_lock(&pull->lock);
	if (pull->count < FLIPS)
		pull->flips[pull->count++] = *flip;
	pthread_cond_signal(&pull->wake);
	pthread_mutex_unlock(&pull->lock);
}

void rig_pull_destroy(struct rig_pull **pull)
{
	struct rig_pull *self = *pull;
	*pull = NULL;
	if (!self)
		return;
	pthread_mutex_lock(&self->lock);
	self->stop = true;
	pthread_cond_signal(&self->wake);
	pthread_mutex_unlock(&self->lock);
	pthread_join(self->thread, NULL);
	fclose(self->truth);
	close(self->fd);
	free(self);
}
