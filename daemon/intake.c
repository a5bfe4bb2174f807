/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/intake.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <linux/magic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#define PAGE UINT64_C(4096)
#define SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL)

/* ---- set-up ---- */

static int check_params(const struct stream_params *p, struct refusal *refusal)
{
	if (p->stream_id == 0)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_VALUE, "stream_id", 0,
					  "stream_id is 0, must be another number");
	if (p->slot_count < PURSUIT_MIN_SLOTS || p->slot_count > PURSUIT_MAX_SLOTS)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_VALUE, "slot_count", p->slot_count,
					  "slot_count is %" PRIu32 ", must be %u to %u", p->slot_count, PURSUIT_MIN_SLOTS,
					  PURSUIT_MAX_SLOTS);
	if (p->slot_bytes == 0 || p->slot_bytes % PAGE != 0)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_VALUE, "slot_bytes", p->slot_bytes,
					  "slot_bytes is %" PRIu64 ", must be a multiple of 4096 and not 0", p->slot_bytes);
	if (p->slot_bytes > p->max_slot_bytes)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_LIMIT, "slot_bytes", p->slot_bytes,
					  "slot_bytes is %" PRIu64 ", must be at most %" PRIu64 " (max-frame-mb)", p->slot_bytes,
					  p->max_slot_bytes);
	return 0;
}

/* `what` is "control" or "planes"; fields of refusals are static. */
static int check_memory(int fd, bool is_control, uint64_t bytes, struct refusal *refusal)
{
	const char *what = is_control ? "control" : "planes";
	const char *size_field = is_control ? "control.size" : "planes.size";
	const char *seals_field = is_control ? "control.seals" : "planes.seals";
	struct stat status;
	struct statfs file_system;
	const int seals = fcntl(fd, F_GET_SEALS);

	if (seals < 0)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_MEMORY, what, (uint64_t)errno,
					  "%s is no memfd (F_GET_SEALS: %s)", what, strerror(errno));
	if (fstatfs(fd, &file_system) < 0 || fstat(fd, &status) < 0)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_MEMORY, what, (uint64_t)errno, "%s: %s", what, strerror(errno));
	if (file_system.f_type != TMPFS_MAGIC || !S_ISREG(status.st_mode))
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_MEMORY, what, (uint64_t)file_system.f_type,
					  "%s is not ordinary shared memory (file system 0x%lx); make it with memfd_create and without "
					  "MFD_HUGETLB",
					  what, (unsigned long)file_system.f_type);
	if ((seals & SEALS) != SEALS)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_MEMORY, seals_field, (uint64_t)seals,
					  "%s.seals is 0x%x, must have F_SEAL_SEAL, F_SEAL_SHRINK and F_SEAL_GROW (0x%x)", what,
					  (unsigned)seals, (unsigned)SEALS);
	if (status.st_size < 0 || (uint64_t)status.st_size < bytes)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_MEMORY, size_field, (uint64_t)status.st_size,
					  "%s.size is %lld, must be at least %" PRIu64, what, (long long)status.st_size, bytes);
	return 0;
}

static int map_memory(struct stream *stream, int control_fd, int planes_fd, struct refusal *refusal)
{
	void *control = mmap(NULL, sizeof(*stream->control), PROT_READ | PROT_WRITE, MAP_SHARED, control_fd, 0);
	if (control == MAP_FAILED)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_MEMORY, "control", (uint64_t)errno,
					  "control cannot be mapped for writing: %s", strerror(errno));
	stream->control = control;
	void *planes = mmap(NULL, stream->planes_bytes, PROT_READ, MAP_SHARED, planes_fd, 0);
	if (planes == MAP_FAILED)
		return refuse(refusal, -EINVAL, PURSUIT_REFUSED_MEMORY, "planes", (uint64_t)errno,
					  "planes cannot be mapped for reading: %s", strerror(errno));
	/* The guard of a strobe's line may be forked later, and must not keep a client's memory. */
	madvise(planes, stream->planes_bytes, MADV_DONTFORK);
	stream->planes = planes;
	return 0;
}

static int check_field(const char *field, uint64_t value, uint64_t want, struct refusal *refusal)
{
	if (value == want)
		return 0;
	return refuse(refusal, -EINVAL, PURSUIT_REFUSED_VALUE, field, value, "%s is %" PRIu64 ", must be %" PRIu64, field,
				  value, want);
}

static int check_control(const struct stream *stream, struct refusal *refusal)
{
	const volatile struct pursuit_shm_control *control = stream->control;
	int result = check_field("control.magic", control->magic, PURSUIT_SHM_MAGIC, refusal);
	if (result == 0)
		result = check_field("control.version", control->version, PURSUIT_SHM_VERSION, refusal);
	if (result == 0)
		result = check_field("control.slot_count", control->slot_count, stream->slot_count, refusal);
	if (result == 0)
		result = check_field("control.slot_bytes", control->slot_bytes, stream->slot_bytes, refusal);
	return result;
}

static int set_up(struct stream *stream, const struct stream_params *params, int control_fd, int planes_fd,
				  struct refusal *refusal)
{
	int result = check_params(params, refusal);
	if (result == 0)
		result = check_memory(control_fd, true, sizeof(*stream->control), refusal);
	if (result == 0)
		result = check_memory(planes_fd, false, stream->planes_bytes, refusal);
	if (result == 0)
		result = map_memory(stream, control_fd, planes_fd, refusal);
	if (result == 0)
		result = check_control(stream, refusal);
	if (result < 0)
		return result;
	stream->wake_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	if (stream->wake_fd < 0)
		return refuse(refusal, -EMFILE, PURSUIT_REFUSED_LIMIT, "", (uint64_t)errno, "no eventfd: %s", strerror(errno));
	return 0;
}

struct stream *stream_create(const struct stream_params *params, int control_fd, int planes_fd, struct refusal *refusal)
{
	struct stream *stream = calloc(1, sizeof(*stream));
	if (!stream) {
		refuse(refusal, -ENOMEM, PURSUIT_REFUSED_LIMIT, "", 0, "the daemon is out of memory");
		return NULL;
	}
	atomic_init(&stream->references, 1);
	stream->client_id = params->client_id;
	stream->stream_id = params->stream_id;
	stream->number = (params->client_id + 1) << 32 | params->opened;
	snprintf(stream->client_name, sizeof(stream->client_name), "%s", params->client_name);
	snprintf(stream->application, sizeof(stream->application), "%s", params->application ? params->application : "");
	stream->wake_fd = -1;
	stream->slot_count = params->slot_count;
	stream->slot_bytes = params->slot_bytes;
	stream->planes_bytes = params->slot_bytes * params->slot_count;
	if (set_up(stream, params, control_fd, planes_fd, refusal) < 0)
		stream_release(&stream);
	return stream;
}

struct stream *stream_reference(struct stream *stream)
{
	atomic_fetch_add(&stream->references, 1);
	return stream;
}

void stream_release(struct stream **stream)
{
	struct stream *last = *stream;
	*stream = NULL;
	if (!last || atomic_fetch_sub(&last->references, 1) != 1)
		return;
	if (last->control)
		munmap(last->control, sizeof(*last->control));
	if (last->planes)
		munmap((void *)(uintptr_t)last->planes, last->planes_bytes);
	if (last->wake_fd >= 0)
		close(last->wake_fd);
	free(last);
}

/* ---- frames ---- */

bool stream_has_frame(const struct stream *stream)
{
	return (__atomic_load_n(&stream->control->latest, __ATOMIC_ACQUIRE) & PURSUIT_SLOT_FRESH) != 0;
}

/* A wake-up that was seen after the frame was submitted is when the daemon saw it; otherwise it is now. */
static uint64_t intake_time(const struct stream *stream, uint64_t submit_ns, uint64_t now_ns)
{
	const uint64_t wake_ns = atomic_load(&stream->wake_ns);
	return submit_ns != 0 && wake_ns >= submit_ns && wake_ns < now_ns ? wake_ns : now_ns;
}

static void count_frame(struct stream *stream, const struct pursuit_frame_header *header)
{
	struct stream_counters *counters = &stream->counters;
	const int color = frame_find_plane(header, PURSUIT_ROLE_COLOR);
	const uint64_t interval = header->real_interval_ns ? header->real_interval_ns
							  : stream->last_time_ns && header->time_ns > stream->last_time_ns
								  ? header->time_ns - stream->last_time_ns
								  : 0;
	atomic_fetch_add(&counters->real_frames, 1);
	if (stream->last_id != 0 && header->frame_id > stream->last_id + 1 && header->frame_id - stream->last_id < 1000000)
		atomic_fetch_add(&counters->lost_frames, header->frame_id - stream->last_id - 1);
	stream->last_id = header->frame_id;
	stream->last_time_ns = header->time_ns;
	atomic_store(&counters->last_frame_id, header->frame_id);
	atomic_store(&counters->width, header->planes[color].width);
	atomic_store(&counters->height, header->planes[color].height);
	atomic_store(&counters->interval_ns, interval);
}

static int refuse_frame(struct stream *stream, const struct pursuit_frame_header *header, const char *field,
						uint64_t value, const struct error *error, struct refusal *refusal)
{
	const struct pursuit_feedback report = {
		.frame_id = header->frame_id, .submit_ns = header->submit_ns, .state = PURSUIT_FEEDBACK_REFUSED};
	stream_feedback(stream, &report);
	atomic_fetch_add(&stream->counters.refused_frames, 1);
	if (header->frame_id > stream->last_id)
		stream->last_id = header->frame_id;
	return refuse(refusal, -EINVAL, PURSUIT_REFUSED_FRAME, field, value, "%.159s", error->text);
}

int stream_take(struct stream *stream, uint64_t now_ns, struct frame *frame, struct refusal *refusal)
{
	const char *field = "";
	uint64_t value = 0;
	struct error error;

	if (!stream_has_frame(stream))
		return 0;
	const uint32_t latest = __atomic_exchange_n(&stream->control->latest, stream->held_slot, __ATOMIC_ACQ_REL);
	const uint32_t slot = latest & ~PURSUIT_SLOT_FRESH;
	if (slot >= stream->slot_count || slot == stream->held_slot)
		return refuse(refusal, -EPROTO, PURSUIT_REFUSED_VALUE, "control.latest", latest,
					  "control.latest names slot %" PRIu32 ", must be below %" PRIu32
					  " and not the daemon's own (%" PRIu32 "); the stream is ended",
					  slot, stream->slot_count, stream->held_slot);
	stream->held_slot = slot;
	stream->held.header.plane_count = 0;
	/* FRESH cannot come back unset between the two: only the client writes it, and a lie about it costs only a look. */
	memset(frame, 0, sizeof(*frame));
	memcpy(&frame->header, &stream->control->headers[slot], sizeof(frame->header));
	if (frame_validate(&frame->header, stream->slot_bytes, &field, &value, &error) < 0)
		return refuse_frame(stream, &frame->header, field, value, &error, refusal);
	for (uint32_t i = 0; i < frame->header.plane_count; i++)
		frame->planes[i] = stream->planes + slot * stream->slot_bytes + frame->header.planes[i].offset;
	frame->volatile_memory = true;
	frame->stream = stream->number;
	frame->intake_ns = intake_time(stream, frame->header.submit_ns, now_ns);
	count_frame(stream, &frame->header);
	stream->held = *frame;
	return 1;
}

bool stream_get_held(const struct stream *stream, struct frame *frame)
{
	*frame = stream->held;
	return frame->header.plane_count > 0;
}

/* ---- feedback ---- */

void stream_feedback(struct stream *stream, const struct pursuit_feedback *report)
{
	const uint64_t number = stream->feedback_count++;
	struct pursuit_feedback *entry = &stream->control->feedback[number % PURSUIT_FEEDBACK_ENTRIES];
	const size_t first = offsetof(struct pursuit_feedback, frame_id);

	__atomic_store_n(&entry->sequence, 2 * number + 1, __ATOMIC_RELAXED);
	__atomic_thread_fence(__ATOMIC_RELEASE);
	memcpy((char *)entry + first, (const char *)report + first, offsetof(struct pursuit_feedback, reserved) - first);
	__atomic_store_n(&entry->sequence, 2 * number + 2, __ATOMIC_RELEASE);
	__atomic_store_n(&stream->control->feedback_count, number + 1, __ATOMIC_RELEASE);
}

void stream_hint(struct stream *stream, uint64_t frame_id, uint64_t next_submit_ns, uint64_t interval_ns)
{
	struct pursuit_hint *hint = &stream->control->hint;
	const uint64_t sequence = 2 * stream->hint_count++;
	__atomic_store_n(&hint->sequence, sequence + 1, __ATOMIC_RELAXED);
	__atomic_thread_fence(__ATOMIC_RELEASE);
	__atomic_store_n(&hint->frame_id, frame_id, __ATOMIC_RELAXED);
	__atomic_store_n(&hint->next_submit_ns, next_submit_ns, __ATOMIC_RELAXED);
	__atomic_store_n(&hint->interval_ns, interval_ns, __ATOMIC_RELAXED);
	__atomic_store_n(&hint->sequence, sequence + 2, __ATOMIC_RELEASE);
}
