/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The daemon as a service, against a manager that is this test: READY, the
 * watchdog of a loop that works, idles, or is stuck, and settings read again
 * while frames come.
 */

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"

#define INTERVAL_US "600000"
#define INTERVAL_MS 600
#define STUCK "the presentation loop is stuck, or its display"

static struct fixture fixture;
static int manager = -1;

static void listen_as_manager(void)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	snprintf(address.sun_path, sizeof(address.sun_path), "%s/notify", fixture.folder);
	manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	CHECK_INT(bind(manager, (struct sockaddr *)&address, sizeof(address)), 0);
	setenv("NOTIFY_SOCKET", address.sun_path, 1);
}

/* Waits for a message with this text; others are passed over. */
static bool told(const char *text, unsigned timeout_ms)
{
	const uint64_t end = now_ns() + (uint64_t)timeout_ms * 1000000;
	bool over;
	do {
		char state[256] = "";
		struct pollfd wait = {manager, POLLIN, 0};
		over = now_ns() >= end;
		while (poll(&wait, 1, 20) == 1 && recv(manager, state, sizeof(state) - 1, MSG_DONTWAIT) > 0)
			if (strstr(state, text))
				return true;
	} while (!over);
	return false;
}

static void forget_messages(void)
{
	char state[256];
	while (recv(manager, state, sizeof(state), MSG_DONTWAIT) > 0)
		;
}

/* ---- the watchdog ---- */

/* By the beginning of its name. */
static pid_t find_thread(const char *wanted)
{
	char path[300], name[32] = "";
	pid_t found = 0;
	snprintf(path, sizeof(path), "/proc/%d/task", (int)fixture.pid);
	DIR *folder = opendir(path);
	for (struct dirent *entry; folder && (entry = readdir(folder)) && !found;) {
		snprintf(path, sizeof(path), "/proc/%d/task/%s/comm", (int)fixture.pid, entry->d_name);
		const int fd = open(path, O_RDONLY | O_CLOEXEC);
		const ssize_t got = fd >= 0 ? read(fd, name, sizeof(name) - 1) : -1;
		if (fd >= 0)
			close(fd);
		name[got > 0 ? got : 0] = 0;
		if (strncmp(name, wanted, strlen(wanted)) == 0)
			found = (pid_t)atoi(entry->d_name);
	}
	if (folder)
		closedir(folder);
	return found;
}

/* Makes one thread stand still. False: that is not permitted here. */
static bool hold(pid_t thread)
{
	CHECK(thread > 0);
	if (ptrace(PTRACE_SEIZE, thread, NULL, NULL) < 0 || ptrace(PTRACE_INTERRUPT, thread, NULL, NULL) < 0) {
		printf("       ptrace is not permitted: threads that hang are not tried\n");
		return false;
	}
	waitpid(thread, NULL, __WALL);
	return true;
}

static void let_go(pid_t thread)
{
	CHECK_INT(ptrace(PTRACE_DETACH, thread, NULL, NULL), 0);
	CHECK(told("WATCHDOG=1", PATIENCE_MS));
}

static void check_not_fed(void)
{
	sleep_ms(INTERVAL_MS);
	forget_messages();
	CHECK(!told("WATCHDOG=1", 3 * INTERVAL_MS));
}

/* Only the presentation loop stands still; main goes on, and must not feed the watchdog for it. */
static void check_stuck_loop(void)
{
	const pid_t thread = find_thread("pursuit-render");
	const unsigned before = fixture_count_logged(&fixture, STUCK);
	if (!hold(thread))
		return;
	CHECK(fixture_logged_often(&fixture, STUCK, before + 1));
	check_not_fed();
	const int fd = raw_greet(fixture.socket); /* main is well, which is why a ping of main would not do */
	CHECK(fd >= 0);
	close(fd);
	let_go(thread);
}

/* Only main stands still; pictures go on. */
static void check_stuck_main(void)
{
	if (!hold(fixture.pid))
		return;
	check_not_fed();
	let_go(fixture.pid);
}

static void play(struct raw_stream *stream, int frames);

/* Frames that nobody waits for. */
static void pump(struct raw_stream *stream, unsigned ms)
{
	for (const uint64_t end = now_ns() + ms * UINT64_C(1000000); now_ns() < end; sleep_ms(12)) {
		raw_fill(stream);
		raw_publish(stream);
	}
}

/* The presenter's thread stands still while a client shows frames; the loop goes round, to no avail. */
static void check_stuck_presenter(void)
{
	static struct raw_reply reply;
	struct raw_stream stream;
	const pid_t thread = find_thread("pursuit-flip");
	const int fd = raw_greet(fixture.socket);
	CHECK(fd >= 0);
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	play(&stream, 3);
	if (hold(thread)) {
		const unsigned before = fixture_count_logged(&fixture, STUCK);
		for (int i = 0; i < 300 && fixture_count_logged(&fixture, STUCK) == before; i++)
			pump(&stream, 200);
		CHECK(fixture_count_logged(&fixture, STUCK) > before);
		forget_messages();
		pump(&stream, 3 * INTERVAL_MS);
		CHECK(!told("WATCHDOG=1", 1));
		let_go(thread);
		pump(&stream, 100);
		CHECK(told("WATCHDOG=1", PATIENCE_MS));
	}
	raw_stream_finish(&stream);
	close(fd);
}

static void test_watchdog(void)
{
	setenv("WATCHDOG_USEC", INTERVAL_US, 1);
	fixture_start(&fixture, NULL);
	CHECK(told("READY=1", PATIENCE_MS));
	/* Idle: no client, nothing to show. */
	for (int i = 0; i < 4; i++)
		CHECK(told("WATCHDOG=1", PATIENCE_MS));
	check_stuck_presenter();
	check_stuck_main();
	check_stuck_loop();
	forget_messages();
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	CHECK(told("STOPPING=1", PATIENCE_MS));
	unsetenv("WATCHDOG_USEC");
}

/* A watchdog that is meant for another process is not fed by this one. */
static void test_watchdog_of_another(void)
{
	setenv("WATCHDOG_USEC", INTERVAL_US, 1);
	setenv("WATCHDOG_PID", "1", 1);
	fixture_start(&fixture, NULL);
	CHECK(told("READY=1", PATIENCE_MS));
	CHECK(!told("WATCHDOG=1", 2 * INTERVAL_MS));
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	unsetenv("WATCHDOG_USEC");
	unsetenv("WATCHDOG_PID");
}

/* ---- reload ---- */

static char config[96];

static void write_config(const char *text)
{
	FILE *file = fopen(config, "w");
	CHECK(file && fputs(text, file) >= 0);
	if (file)
		fclose(file);
}

static void play(struct raw_stream *stream, int frames)
{
	struct pursuit_feedback report;
	for (int i = 0; i < frames; i++) {
		raw_fill(stream);
		raw_publish(stream);
		CHECK(raw_feedback(stream, &report));
		CHECK_INT(report.state, PURSUIT_FEEDBACK_SHOWN);
	}
}

/* Frames come all the while; what was changed counts at once, and none is lost. */
static void test_reload(void)
{
	const char *const arguments[] = {"--config", config, NULL};
	struct raw_stream stream;
	static struct raw_reply reply;
	write_config("max-clients = 2\n");
	fixture_start(&fixture, arguments);
	const int fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	play(&stream, 3);
	const int second = raw_greet(fixture.socket);
	CHECK(second >= 0);
	CHECK(raw_greet(fixture.socket) < 0);
	write_config("max-clients = 3\nblur = off\nrefresh = 60\nlog-level = debug\n");
	forget_messages();
	kill(fixture.pid, SIGHUP);
	play(&stream, 3);
	CHECK(told("RELOADING=1\nMONOTONIC_USEC=", PATIENCE_MS));
	CHECK(told("READY=1", PATIENCE_MS));
	CHECK(fixture_logged(&fixture, "max-clients is 3 now, was 2"));
	CHECK(fixture_logged(&fixture, "blur is off now, was doubtful"));
	CHECK(fixture_logged(&fixture, "refresh is 60 now, was 120"));
	const int third = raw_greet(fixture.socket);
	CHECK(third >= 0);
	/* A mistake changes nothing, and ends nothing. */
	write_config("max-clients = 1\nnonsense = 5\n");
	kill(fixture.pid, SIGHUP);
	CHECK(fixture_logged(&fixture, "config:2: nonsense: there is no such setting; the settings stay as they are"));
	play(&stream, 3);
	CHECK_INT(question_figure(fd, "status", "lost_real_frames"), 0);
	CHECK_INT(question_figure(fd, "status", "refused_frames"), 0);
	raw_stream_finish(&stream);
	close(fd);
	close(second);
	close(third);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, argv[1]);
	snprintf(config, sizeof(config), "%s/config", fixture.folder);
	listen_as_manager();
	RUN(test_watchdog);
	RUN(test_watchdog_of_another);
	RUN(test_reload);
	close(manager);
	fixture_finish(&fixture);
	return test_result();
}
