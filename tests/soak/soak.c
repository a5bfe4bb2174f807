/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * As long as one likes: clients join, leave, die half-way through a frame,
 * change size and format, flood, and talk nonsense, while the daemon presents
 * at 120 Hz. Every picture on its way to the display must be exactly one whole
 * frame of one client; memory and descriptors of the daemon must stay.
 *
 *   soak [SECONDS [SEED]]     60 seconds by default
 */

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/soak/soak.h"
#include "tests/test.h"

#define CLIENTS 5
#define MEMORY_SLACK_KB 16384u

static struct soak *soak;
static char folder[] = "/tmp/pursuit-soak-XXXXXX";

static uint64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

/* ---- what the daemon takes ---- */

/* Of its status: "RssAnon" is its own memory, "VmRSS" has what it shares in it: clients' frames, libraries. */
static unsigned long status_kb(pid_t pid, const char *name)
{
	char path[64], line[128];
	const size_t length = strlen(name);
	unsigned long value = 0;
	snprintf(path, sizeof(path), "/proc/%d/status", (int)pid);
	FILE *file = fopen(path, "re");
	while (file && fgets(line, sizeof(line), file))
		if (strncmp(line, name, length) == 0 && sscanf(line + length, ": %lu", &value) == 1)
			break;
	if (file)
		fclose(file);
	return value;
}

static unsigned count_fds(pid_t pid)
{
	char path[64];
	unsigned count = 0;
	snprintf(path, sizeof(path), "/proc/%d/fd", (int)pid);
	DIR *entries = opendir(path);
	while (entries && readdir(entries))
		count++;
	if (entries)
		closedir(entries);
	return count;
}

/* The fewest in a while, until there are as few as that: what was just closed may take some time to go. */
static unsigned fewest_fds(pid_t pid, unsigned wanted)
{
	unsigned fewest = count_fds(pid);
	for (int i = 0; i < 200 || (i < 6000 && fewest > wanted); i++) {
		const unsigned count = count_fds(pid);
		fewest = count < fewest ? count : fewest;
		usleep(10000);
	}
	return fewest;
}

/* ---- processes ---- */

static bool answers(void)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", soak->socket);
	const bool connected = connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0;
	close(fd);
	return connected;
}

static pid_t start_daemon(void)
{
	const pid_t pid = fork();
	if (pid == 0)
		exit(soak_daemon(soak));
	for (int waited = 0; waited < 60000 && !answers(); waited += 10) {
		if (waitpid(pid, NULL, WNOHANG) == pid)
			SKIP("no GL context can be made on this machine");
		usleep(10000);
	}
	return pid;
}

static void start_client(pid_t *pid, uint64_t seed)
{
	const uint32_t number = atomic_fetch_add(&soak->clients, 1) + 1;
	*pid = fork();
	if (*pid == 0) {
		soak_client(soak, number, seed + number);
		_exit(0);
	}
}

/* Who has ended is followed by another; now and then one is ended. */
static void keep_clients(pid_t clients[CLIENTS], uint64_t seed, bool more)
{
	for (int i = 0; i < CLIENTS; i++) {
		int status = 0;
		if (clients[i] != 0 && waitpid(clients[i], &status, WNOHANG) == 0)
			continue;
		if (clients[i] != 0 && WIFSIGNALED(status)) {
			CHECK_INT(WTERMSIG(status), SIGKILL);
			atomic_fetch_add(&soak->killed, 1);
		}
		clients[i] = 0;
		if (more)
			start_client(&clients[i], seed);
	}
	const uint32_t victim = atomic_load(&soak->clients) % 7;
	if (victim < CLIENTS && clients[victim] != 0 && now_ns() / 1000000 % 11 == 0)
		kill(clients[victim], SIGKILL);
}

static void end_clients(pid_t clients[CLIENTS])
{
	for (int i = 0; i < CLIENTS; i++) {
		if (clients[i] == 0)
			continue;
		kill(clients[i], SIGKILL);
		waitpid(clients[i], NULL, 0);
	}
}

/* ---- the test ---- */

/* What the daemon has. */
struct taken {
	unsigned long own_kb, resident_kb;
	unsigned fds;
};

static struct taken taken_by(pid_t daemon, unsigned wanted_fds)
{
	const unsigned fds = fewest_fds(daemon, wanted_fds);
	return (struct taken){status_kb(daemon, "RssAnon"), status_kb(daemon, "VmRSS"), fds};
}

static void say(const struct taken *before, const struct taken *after, unsigned long early_kb)
{
	printf("%llu pictures verified, %llu spoilt; %llu frames of %u clients submitted, %llu killed, %llu left, %llu "
		   "talked nonsense\n",
		   (unsigned long long)soak->verified, (unsigned long long)soak->spoilt, (unsigned long long)soak->submitted,
		   soak->clients, (unsigned long long)soak->killed, (unsigned long long)soak->left,
		   (unsigned long long)soak->nonsense);
	printf("the daemon's own memory: %lu kB before, %lu kB at most in the first third, %lu kB after; resident in all: "
		   "%lu kB before, %lu kB after; descriptors: %u before, %u after\n",
		   before->own_kb, early_kb, after->own_kb, before->resident_kb, after->resident_kb, before->fds, after->fds);
	if (soak->spoilt)
		fprintf(stderr, "a picture said client %u, frame %u\n", soak->spoilt_client, soak->spoilt_frame);
}

static void run(unsigned seconds, uint64_t seed)
{
	const pid_t daemon = start_daemon();
	const struct taken before = taken_by(daemon, UINT32_MAX);
	const uint64_t start = now_ns(), end = start + seconds * UINT64_C(1000000000);
	pid_t clients[CLIENTS] = {0};
	unsigned long early_kb = 0;
	while (now_ns() < end && atomic_load(&soak->spoilt) == 0) {
		keep_clients(clients, seed, true);
		const unsigned long own_kb = status_kb(daemon, "RssAnon");
		if (now_ns() < start + (end - start) / 3 && own_kb > early_kb)
			early_kb = own_kb;
		usleep(20000);
	}
	end_clients(clients);
	const struct taken after = taken_by(daemon, before.fds);
	int status = -1;
	kill(daemon, SIGTERM);
	waitpid(daemon, &status, 0);

	say(&before, &after, early_kb);
	CHECK_INT(status, 0);
	CHECK_INT(soak->spoilt, 0);
	CHECK(soak->verified > seconds);
	CHECK(soak->attached > 0);
	CHECK_INT(after.fds, before.fds);
	CHECK(after.own_kb <= early_kb + MEMORY_SLACK_KB);
}

int main(int argc, char **argv)
{
	const unsigned seconds = argc > 1 ? (unsigned)atoi(argv[1]) : 60;
	const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
	soak = mmap(NULL, sizeof(*soak), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (soak == MAP_FAILED || !mkdtemp(folder)) {
		perror("soak");
		return 1;
	}
	setbuf(stdout, NULL);
	signal(SIGPIPE, SIG_IGN);
	snprintf(soak->socket, sizeof(soak->socket), "%s/socket", folder);
	run(seconds, seed);
	rmdir(folder);
	return test_result();
}
