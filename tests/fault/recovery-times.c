/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * How long recovery takes: the daemon is killed with -9 under a game of 60 frames a second, and clients beside one,
 * a hundred times each. Prints percentiles; a measurement, not a test.
 *
 *   recovery-times PURSUITD [ROUNDS]
 */

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"

#define FRAME_NS UINT64_C(16666667)
#define PATIENCE_NS UINT64_C(20000000000)
#define MOST_ROUNDS 10000u

static struct fixture fixture;
static unsigned rounds = 100;

/* ---- a game, on a thread or in a process of its own ---- */

static struct {
	atomic_bool stop, attached;
	_Atomic uint64_t attached_ns; /* when it was seen to be so last */
	_Atomic uint64_t longest_ns;  /* call of the shim, since somebody set it to 0 */
	_Atomic uint64_t frames, shown;
} game;

static void play_one(struct pursuit_stream *stream)
{
	struct pursuit_feedback_report report;
	struct pursuit_status status;
	const uint64_t start = now_ns();
	struct pursuit_frame *frame = pursuit_acquire(stream);
	if (frame)
		pursuit_submit(stream, frame);
	const uint64_t end = now_ns();
	if (end - start > atomic_load(&game.longest_ns))
		atomic_store(&game.longest_ns, end - start);
	pursuit_get_status(stream, &status);
	const bool attached = status.state == PURSUIT_STATE_ATTACHED;
	if (attached && !atomic_load(&game.attached))
		atomic_store(&game.attached_ns, end);
	atomic_store(&game.attached, attached);
	atomic_fetch_add(&game.frames, 1);
	while (pursuit_poll_feedback(stream, &report))
		atomic_fetch_add(&game.shown, report.shown == PURSUIT_SHOWN);
}

static void *play(void *data)
{
	const struct pursuit_stream_params params = {.width = 640,
												 .height = 360,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT16,
												 .socket_path = fixture.socket};
	struct pursuit_stream *stream = pursuit_open(&params);
	(void)data;
	for (uint64_t next_ns = now_ns(); stream && !atomic_load(&game.stop); next_ns += FRAME_NS) {
		play_one(stream);
		const uint64_t now = now_ns();
		if (next_ns + FRAME_NS > now)
			usleep((useconds_t)((next_ns + FRAME_NS - now) / 1000));
		else
			next_ns = now;
	}
	pursuit_close(&stream);
	return NULL;
}

/* False: it never was. */
static bool wait_until_attached(bool attached)
{
	for (const uint64_t end = now_ns() + PATIENCE_NS; now_ns() < end; usleep(200))
		if (atomic_load(&game.attached) == attached)
			return true;
	return false;
}

/* ---- figures ---- */

static int by_size(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double percentile(const double *sorted, unsigned count, double share)
{
	const unsigned at = (unsigned)(share * (count - 1) + 0.5);
	return sorted[at < count ? at : count - 1];
}

static void print(const char *what, double *ms, unsigned count)
{
	qsort(ms, count, sizeof(ms[0]), by_size);
	printf("%-52s p50 %8.3f ms  p99 %8.3f  max %8.3f  (%u times)\n", what, percentile(ms, count, 0.50),
		   percentile(ms, count, 0.99), ms[count - 1], count);
	fflush(stdout);
}

/* ---- the daemon is killed ---- */

static bool listens(void)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", fixture.socket);
	const bool connected = connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0;
	close(fd);
	return connected;
}

/* Starts it; when it was first there to be connected to. */
static uint64_t start_daemon(void)
{
	fixture_spawn(&fixture, NULL);
	for (const uint64_t end = now_ns() + PATIENCE_NS; now_ns() < end; usleep(200)) {
		const uint64_t before = now_ns();
		if (listens())
			return before;
	}
	return 0;
}

static bool kill_daemon(double *attach_ms, double *hitch_ms)
{
	usleep(100000);
	atomic_store(&game.longest_ns, 0);
	fixture_stop(&fixture, SIGKILL);
	usleep(100000);
	if (!wait_until_attached(false))
		return false;
	const uint64_t back_ns = start_daemon();
	if (!back_ns || !wait_until_attached(true))
		return false;
	const uint64_t attached_ns = atomic_load(&game.attached_ns);
	*attach_ms = attached_ns > back_ns ? (double)(attached_ns - back_ns) / 1e6 : 0.0;
	*hitch_ms = (double)atomic_load(&game.longest_ns) / 1e6;
	return true;
}

static bool measure_daemon(void)
{
	static double attach_ms[MOST_ROUNDS], hitch_ms[MOST_ROUNDS];
	pthread_t thread;
	atomic_store(&game.stop, false);
	if (!start_daemon() || pthread_create(&thread, NULL, play, NULL) != 0)
		return false;
	bool fine = wait_until_attached(true);
	for (unsigned i = 0; i < rounds && fine; i++)
		fine = kill_daemon(&attach_ms[i], &hitch_ms[i]);
	atomic_store(&game.stop, true);
	pthread_join(thread, NULL);
	fixture_stop(&fixture, SIGTERM);
	if (!fine)
		return false;
	print("daemon killed: attached again after its return", attach_ms, rounds);
	print("daemon killed: longest call of the shim in each round", hitch_ms, rounds);
	return true;
}

/* ---- clients are killed ---- */

/* Shared memory of clients that the daemon has mapped. */
static unsigned count_mappings(void)
{
	char path[64], line[512];
	unsigned count = 0;
	snprintf(path, sizeof(path), "/proc/%d/maps", (int)fixture.pid);
	FILE *maps = fopen(path, "re");
	while (maps && fgets(line, sizeof(line), maps))
		count += strstr(line, "/memfd:") != NULL;
	if (maps)
		fclose(maps);
	return count;
}

static bool wait_for_mappings(unsigned count)
{
	for (const uint64_t end = now_ns() + PATIENCE_NS; now_ns() < end; usleep(100))
		if (count_mappings() == count)
			return true;
	return false;
}

/* Mapped, and with frames on the way. */
static pid_t start_client(unsigned before)
{
	fflush(stdout);
	const pid_t child = fork();
	if (child == 0) {
		play(NULL);
		_exit(0);
	}
	for (const uint64_t end = now_ns() + PATIENCE_NS; now_ns() < end && count_mappings() == before; usleep(500))
		;
	usleep(50000);
	return child;
}

static bool kill_client(unsigned before, double *released_ms)
{
	const pid_t child = start_client(before);
	const uint64_t start_ns = now_ns();
	kill(child, SIGKILL);
	const bool released = wait_for_mappings(before);
	*released_ms = (double)(now_ns() - start_ns) / 1e6;
	waitpid(child, NULL, 0);
	return released;
}

static bool measure_clients(void)
{
	static double released_ms[MOST_ROUNDS], hitch_ms[MOST_ROUNDS];
	pthread_t thread;
	atomic_store(&game.stop, false);
	atomic_store(&game.attached, false);
	if (!start_daemon() || pthread_create(&thread, NULL, play, NULL) != 0)
		return false;
	bool fine = wait_until_attached(true);
	usleep(200000);
	const unsigned before = count_mappings();
	for (unsigned i = 0; i < rounds && fine; i++) {
		atomic_store(&game.longest_ns, 0);
		fine = kill_client(before, &released_ms[i]);
		hitch_ms[i] = (double)atomic_load(&game.longest_ns) / 1e6;
	}
	atomic_store(&game.stop, true);
	pthread_join(thread, NULL);
	fixture_stop(&fixture, SIGTERM);
	if (!fine)
		return false;
	print("client killed: all its memory given back after", released_ms, rounds);
	print("client killed: longest call of its neighbour's shim", hitch_ms, rounds);
	return true;
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	rounds = argc > 2 ? (unsigned)atoi(argv[2]) : rounds;
	rounds = rounds < 1 ? 1 : rounds > MOST_ROUNDS ? MOST_ROUNDS : rounds;
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, argv[1]);
	const bool fine = measure_daemon() && measure_clients();
	if (!fine)
		fprintf(stderr, "recovery-times: something did not come back in %llu s\n",
				(unsigned long long)(PATIENCE_NS / 1000000000u));
	fixture_finish(&fixture);
	return fine ? 0 : 1;
}
