/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/latency_log.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "daemon/lab/latency_format.h"
#include "daemon/open_at_once.h"

#define WAITING 4096u /* rows: half a minute at 120 Hz */
#define ROUND_MS 250
#define SYNC_ROUNDS 4u

struct latency_log {
	const struct log *log;
	char path[512];
	bool binary;
	int fd, stop_fd;
	pthread_t thread;
	_Atomic uint64_t pushed, taken, written, dropped;
	uint64_t dropped_told; /* that the file says */
	bool broken;           /* an error was met and said: nothing more is written */
	struct points rows[WAITING];
	uint8_t block[LATENCY_BLOCK_HEAD + LATENCY_BLOCK_ROWS * LATENCY_LINE];
};

int latency_log_check(const char *path, struct error *error)
{
	const char *dot = strrchr(path, '.');
	if (dot && (strcmp(dot, ".csv") == 0 || strcmp(dot, ".bin") == 0))
		return 0;
	return error_set(error, -EINVAL, "latency-log: %.256s ends in neither .csv nor .bin", path);
}

/* ---- writing ---- */

static void write_all(struct latency_log *log, const uint8_t *bytes, size_t size)
{
	while (size > 0 && !log->broken) {
		const ssize_t wrote = write(log->fd, bytes, size);
		if (wrote < 0 && errno == EINTR)
			continue;
		if (wrote <= 0) {
			log_error(log->log, "latency-log: %s: %s; the log ends here", log->path, strerror(wrote < 0 ? errno : EIO));
			log->broken = true;
			return;
		}
		bytes += wrote;
		size -= (size_t)wrote;
	}
}

static size_t fill_binary(struct latency_log *log, uint64_t first, uint32_t count, uint64_t dropped)
{
	uint8_t *rows = log->block + LATENCY_BLOCK_HEAD;
	const size_t size = (size_t)count * LATENCY_ROW_BYTES;
	for (uint32_t i = 0; i < count; i++)
		latency_pack_row(&log->rows[(first + i) % WAITING], rows + (size_t)i * LATENCY_ROW_BYTES);
	memcpy(log->block, LATENCY_BLOCK_MAGIC, 4);
	latency_put_u32(log->block + 4, count);
	latency_put_u64(log->block + 8, dropped);
	latency_put_u64(log->block + 16, latency_checksum(rows, size));
	return LATENCY_BLOCK_HEAD + size;
}

static size_t fill_csv(struct latency_log *log, uint64_t first, uint32_t count, uint64_t dropped)
{
	char *text = (char *)log->block;
	size_t size = 0;
	if (dropped != log->dropped_told)
		size += (size_t)snprintf(text, LATENCY_LINE, "# dropped: %llu rows so far, some of them about here\n",
								 (unsigned long long)dropped);
	for (uint32_t i = 0; i < count; i++)
		size += latency_print_row(&log->rows[(first + i) % WAITING], text + size);
	return size;
}

/* One block, with one write. False: nothing was waiting. */
static bool write_block(struct latency_log *log)
{
	const uint64_t taken = atomic_load_explicit(&log->taken, memory_order_relaxed);
	const uint64_t waiting = atomic_load_explicit(&log->pushed, memory_order_acquire) - taken;
	const uint64_t dropped = atomic_load(&log->dropped);
	const uint32_t most = LATENCY_BLOCK_ROWS - 1, count = waiting < most ? (uint32_t)waiting : most;
	if (count == 0)
		return false;
	write_all(log, log->block,
			  log->binary ? fill_binary(log, taken, count, dropped) : fill_csv(log, taken, count, dropped));
	log->dropped_told = dropped;
	atomic_store_explicit(&log->taken, taken + count, memory_order_release);
	atomic_fetch_add(log->broken ? &log->dropped : &log->written, count);
	return true;
}

static void *run(void *data)
{
	struct latency_log *log = data;
	struct pollfd stop = {.fd = log->stop_fd, .events = POLLIN};
	pthread_setname_np(pthread_self(), "pursuit-latency");
	for (unsigned round = 0;; round++) {
		const bool stopping = poll(&stop, 1, ROUND_MS) > 0;
		while (write_block(log))
			;
		if (round % SYNC_ROUNDS == 0 && !log->broken)
			fdatasync(log->fd);
		if (stopping)
			return NULL;
	}
}

/* ---- life ---- */

static void write_header(struct latency_log *log, const char *header)
{
	char *text = NULL;
	size_t size = 0;
	uint8_t length[4];
	FILE *out = open_memstream(&text, &size);
	if (!out)
		return;
	latency_print_explanation(out);
	for (const char *line = header; *line; line += *line == '\n') {
		const size_t width = strcspn(line, "\n");
		fputs("# ", out);
		fwrite(line, 1, width, out);
		fputc('\n', out);
		line += width;
	}
	if (!log->binary)
		fputs(latency_column_line(), out);
	fclose(out);
	latency_put_u32(length, (uint32_t)size);
	if (log->binary) {
		write_all(log, (const uint8_t *)LATENCY_MAGIC, 8);
		write_all(log, length, sizeof(length));
	}
	write_all(log, (const uint8_t *)text, size);
	free(text);
}

static void free_log(struct latency_log *log)
{
	if (log->fd >= 0)
		close(log->fd);
	if (log->stop_fd >= 0)
		close(log->stop_fd);
	free(log);
}

struct latency_log *latency_log_create(const char *path, const char *header, const struct log *log, struct error *error)
{
	struct latency_log *self;
	if (latency_log_check(path, error) < 0)
		return NULL;
	self = calloc(1, sizeof(*self));
	if (!self) {
		error_set(error, -ENOMEM, "latency-log: out of memory");
		return NULL;
	}
	self->log = log;
	snprintf(self->path, sizeof(self->path), "%s", path);
	self->binary = strcmp(strrchr(path, '.'), ".bin") == 0;
	self->stop_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	if (self->stop_fd < 0)
		error_set(error, -errno, "latency-log: %s", strerror(errno));
	self->fd = self->stop_fd < 0 ? -1 : open_at_once("latency-log", path, O_TRUNC, error);
	if (self->fd < 0) {
		free_log(self);
		return NULL;
	}
	write_header(self, header ? header : "");
	const int result = pthread_create(&self->thread, NULL, run, self);
	if (result != 0) {
		error_set(error, -result, "latency-log: no thread to write it: %s", strerror(result));
		free_log(self);
		return NULL;
	}
	return self;
}

void latency_log_destroy(struct latency_log **log)
{
	struct latency_log *self = *log;
	const uint64_t one = 1;
	*log = NULL;
	if (!self)
		return;
	while (write(self->stop_fd, &one, sizeof(one)) < 0 && errno == EINTR)
		;
	pthread_join(self->thread, NULL);
	if (fdatasync(self->fd) < 0 && errno != EINVAL && errno != EROFS)
		log_error(self->log, "latency-log: %s: %s", self->path, strerror(errno));
	log_info(self->log, "latency-log: %s: %llu rows, %llu dropped", self->path, (unsigned long long)self->written,
			 (unsigned long long)self->dropped);
	free_log(self);
}

void latency_log_push(struct latency_log *log, const struct points *points)
{
	if (!log)
		return;
	const uint64_t pushed = atomic_load_explicit(&log->pushed, memory_order_relaxed);
	if (pushed - atomic_load_explicit(&log->taken, memory_order_acquire) == WAITING) {
		atomic_fetch_add(&log->dropped, 1);
		return;
	}
	log->rows[pushed % WAITING] = *points;
	atomic_store_explicit(&log->pushed, pushed + 1, memory_order_release);
}

uint64_t latency_log_written(const struct latency_log *log)
{
	return log ? atomic_load(&log->written) : 0;
}

uint64_t latency_log_dropped(const struct latency_log *log)
{
	return log ? atomic_load(&log->dropped) : 0;
}
