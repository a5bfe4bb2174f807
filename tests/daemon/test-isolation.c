/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Who may be a client, how much one client may have, and what the daemon itself may do no more. */

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/peer.h"
#include "daemon/seccomp.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"

#define STRANGER 54321u
#define THEIR_GROUP 54322u
#define OTHER_GROUP 54323u

static struct fixture fixture;

/* ---- users and groups ---- */

static bool allowed(const struct peer *peer, const char *users, const char *groups)
{
	struct error error = {""};
	struct peer_list list;
	CHECK_INT(peer_look_up(users, groups, &list, &error), 0);
	return peer_allowed(peer, -1, &list);
}

static void test_lists(void)
{
	struct error error = {""};
	struct peer_list list;
	const struct peer me = {getpid(), getuid(), getgid()}, stranger = {1, STRANGER, STRANGER},
					  unknown = {0, (uid_t)-1, (gid_t)-1};
	CHECK(allowed(&stranger, "", ""));
	CHECK(!allowed(&stranger, "1,2", ""));
	CHECK(allowed(&stranger, " 1, 54321 ,2", ""));
	CHECK(allowed(&stranger, "", "54321"));
	CHECK(!allowed(&stranger, ",", ""));
	CHECK(!allowed(&stranger, "5432,543210", "5432,543210"));
	CHECK(allowed(&me, "1", ""));
	CHECK(!allowed(&unknown, "4294967294", "4294967294"));
	CHECK_INT(peer_look_up("root,0,54321", ",, root", &list, &error), 0);
	CHECK_INT(list.user_count, 3);
	CHECK_INT(list.group_count, 1);
	static const char *const wrong[] = {"no-such-user-here", "54321x", "-54321", "0x54321", "4294967295", "-1"};
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		char sentence[96], words[64];
		snprintf(words, sizeof(words), "root,%s", wrong[i]);
		snprintf(sentence, sizeof(sentence), "allow-users: there is no user \"%s\"", wrong[i]);
		CHECK(peer_has_names(words));
		CHECK_INT(peer_look_up(words, "", &list, &error), -EINVAL);
		CHECK_STRING(error.text, sentence);
	}
	CHECK_INT(peer_look_up("", "no-such-group", &list, &error), -EINVAL);
	CHECK_STRING(error.text, "allow-groups: there is no group \"no-such-group\"");
	CHECK(!peer_has_names(" 1, 54321 ,2,,"));
}

/* What a process of another user is answered: the refusal's code, 0 welcome, -1 neither. */
static int answer_to(uid_t uid, gid_t gid, gid_t other)
{
	fflush(stdout);
	const pid_t child = fork();
	if (child == 0) {
		const struct pursuit_message_hello hello = raw_hello();
		static struct raw_reply reply;
		if (setgroups(1, &other) < 0 || setgid(gid) < 0 || setuid(uid) < 0)
			_exit(99);
		const int fd = raw_connect(fixture.socket);
		raw_send(fd, &hello, sizeof(hello), NULL, 0);
		if (fd < 0 || !raw_receive(fd, &reply))
			_exit(98);
		_exit(reply.header.type == PURSUIT_MESSAGE_REFUSED   ? (int)reply.refused.code
			  : reply.header.type == PURSUIT_MESSAGE_WELCOME ? 0
															 : 97);
	}
	int status = 0;
	waitpid(child, &status, 0);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void start_for_all(const char *option, const char *value)
{
	const char *const arguments[] = {option, value, NULL};
	fixture_start(&fixture, arguments);
	chmod(fixture.folder, 0755);
	chmod(fixture.socket, 0777);
}

static void test_strangers(void)
{
	if (geteuid() != 0) {
		printf("       not root: other users are not tried\n");
		return;
	}
	start_for_all("--allow-users", "54321");
	CHECK_INT(answer_to(STRANGER, THEIR_GROUP, OTHER_GROUP), 0);
	CHECK_INT(answer_to(STRANGER + 10, STRANGER, STRANGER), PURSUIT_REFUSED_PERMISSION);
	CHECK(fixture_logged(&fixture, "uid is 54331, which may not be a client"));
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	start_for_all("--allow-groups", "54323");
	CHECK_INT(answer_to(STRANGER, THEIR_GROUP, OTHER_GROUP), 0);
	CHECK_INT(answer_to(STRANGER, OTHER_GROUP, THEIR_GROUP), 0);
	CHECK_INT(answer_to(STRANGER, THEIR_GROUP, THEIR_GROUP), PURSUIT_REFUSED_PERMISSION);
	const int own = raw_greet(fixture.socket); /* the daemon's own user */
	CHECK(own >= 0);
	close(own);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* What a process of another user is answered to a request: an errno, 0 done. */
static int ask_as_stranger(const char *request)
{
	fflush(stdout);
	const pid_t child = fork();
	if (child == 0) {
		static struct raw_reply reply;
		const gid_t none = OTHER_GROUP;
		if (setgroups(1, &none) < 0 || setgid(THEIR_GROUP) < 0 || setuid(STRANGER) < 0)
			_exit(249);
		_exit(raw_control(raw_greet(fixture.socket), request, -1, &reply) & 0xff);
	}
	int status = 0;
	waitpid(child, &status, 0);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* A limit that a client may lift itself is none, nor may it end what others use. */
static void test_strangers_change_no_limits(void)
{
	static const char *const refused[] = {"set max-client-mb=4096",
										  "set allow-users=54331",
										  "set blur=off max-clients=1",
										  "set log-level=error",
										  "record",
										  "record-stop",
										  "key q",
										  "key escape"};
	static struct raw_reply reply;
	if (geteuid() != 0)
		return;
	start_for_all("--allow-users", "54321");
	const int own = raw_greet(fixture.socket);
	for (size_t i = 0; i < sizeof(refused) / sizeof(refused[0]); i++)
		CHECK_INT(ask_as_stranger(refused[i]), EPERM);
	CHECK_INT(ask_as_stranger("set method=hold"), 0);
	CHECK_INT(ask_as_stranger("key i"), 0);
	CHECK_INT(raw_control(own, "set max-clients=5", -1, &reply), 0);
	CHECK_INT(raw_control(own, "ping", -1, &reply), 0);
	close(own);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

static void test_unknown_names(void)
{
	const char *const arguments[] = {"--allow-users", "no-such-user-here", NULL};
	fixture_spawn(&fixture, arguments);
	CHECK_INT(fixture_join(&fixture), 2);
	CHECK(fixture_logged(&fixture, "pursuitd: allow-users: there is no user \"no-such-user-here\""));

	char config[96], want[192];
	snprintf(config, sizeof(config), "%s/config", fixture.folder);
	snprintf(want, sizeof(want), "pursuitd: %s:2: allow-groups: there is no group \"no-such-group\"", config);
	FILE *file = fopen(config, "w");
	CHECK(file && fputs("# who\nallow-groups = no-such-group\n", file) >= 0 && fclose(file) == 0);
	const char *const with_file[] = {"--config", config, NULL};
	fixture_spawn(&fixture, with_file);
	CHECK_INT(fixture_join(&fixture), 2);
	CHECK(fixture_logged(&fixture, want));
}

/* ---- limits ---- */

static void check_refused_stream(int fd, uint64_t id, const char *field)
{
	struct raw_stream stream;
	struct raw_reply reply;
	raw_stream_init(&stream, fd, id);
	CHECK(!raw_stream_open(&stream, &reply));
	CHECK_INT(reply.header.type, PURSUIT_MESSAGE_REFUSED);
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_LIMIT);
	CHECK_STRING(reply.refused.field, field);
	raw_stream_finish(&stream);
}

static void test_streams_and_bytes(void)
{
	const char *const arguments[] = {"--max-streams", "2", "--max-client-mb", "1", NULL};
	struct raw_stream streams[4];
	struct raw_reply reply;
	fixture_start(&fixture, arguments);
	const int fd = raw_greet(fixture.socket), other = raw_greet(fixture.socket);
	for (uint64_t i = 0; i < 2; i++) {
		raw_stream_init(&streams[i], fd, i + 1);
		CHECK(raw_stream_open(&streams[i], &reply));
	}
	check_refused_stream(fd, 3, "stream_id");
	/* Nobody else is short of anything. */
	raw_stream_init(&streams[2], other, 1);
	CHECK(raw_stream_open(&streams[2], &reply));
	const int large = raw_memfd(UINT64_C(8) << 20, RAW_ALL_SEALS);
	const struct pursuit_message_open_stream open = raw_open(7, 4, UINT64_C(1) << 20);
	const int fds[2] = {streams[2].control_fd, large};
	CHECK_INT(raw_send(other, &open, sizeof(open), fds, 2), 0);
	CHECK(raw_receive(other, &reply));
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_LIMIT);
	CHECK_STRING(reply.refused.field, "slot_bytes");
	CHECK(strstr(reply.refused.text, "max-client-mb") != NULL);
	/* What was closed does not count any more. */
	for (uint64_t i = 0; i < 40; i++) {
		const struct pursuit_message_close_stream message = {
			.header = {.type = PURSUIT_MESSAGE_CLOSE_STREAM, .size = sizeof(message)}, .stream_id = 10 + i};
		raw_stream_init(&streams[3], other, 10 + i);
		CHECK(raw_stream_open(&streams[3], &reply));
		CHECK_INT(raw_send(other, &message, sizeof(message), NULL, 0), 0);
		CHECK(raw_receive(other, &reply));
		CHECK_INT(reply.header.type, PURSUIT_MESSAGE_STREAM_CLOSED);
		raw_stream_finish(&streams[3]);
	}
	for (int i = 0; i < 3; i++)
		raw_stream_finish(&streams[i]);
	close(large);
	close(fd);
	close(other);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* A flood ends the connection of the one who floods. */
static void test_message_rate(void)
{
	const char *const arguments[] = {"--max-messages", "50", NULL};
	const struct pursuit_message_close_stream message = {
		.header = {.type = PURSUIT_MESSAGE_CLOSE_STREAM, .size = sizeof(message)}, .stream_id = 5};
	static struct raw_reply reply;
	fixture_start(&fixture, arguments);
	const int fd = raw_greet(fixture.socket), other = raw_greet(fixture.socket);
	bool refused = false;
	/* More than 50 a second on any machine, since no answer is waited for. */
	for (int i = 0; i < 30 && !refused; i++) {
		int sent = 0;
		while (sent < 200 && raw_send(fd, &message, sizeof(message), NULL, 0) == 0)
			sent++;
		for (; sent > 0 && !refused && raw_receive(fd, &reply); sent--)
			refused = reply.header.type == PURSUIT_MESSAGE_REFUSED && strcmp(reply.refused.field, "messages") == 0;
	}
	CHECK(refused);
	CHECK_INT(reply.refused.fatal, 1);
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_LIMIT);
	CHECK(raw_is_gone(fd));
	CHECK_INT(raw_control(other, "ping", -1, &reply), 0);
	close(fd);
	close(other);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* One who keeps connecting to a daemon without descriptors is hung up on and does not fill the log. */
static void test_no_descriptors(void)
{
	enum { HELD = 20, TRIES = 300 };
	static const char said[] = "out of file descriptors: a client was turned away";
	static struct raw_reply reply;
	char line[512];
	int held[HELD], lines = 0;
	fixture_start(&fixture, NULL);
	struct rlimit before;
	CHECK_INT(prlimit(fixture.pid, RLIMIT_NOFILE, NULL, &before), 0);
	const struct rlimit few = {(rlim_t)fixture_settled_fds(&fixture) + 4, before.rlim_max};
	CHECK_INT(prlimit(fixture.pid, RLIMIT_NOFILE, &few, NULL), 0);
	const uint64_t start_ns = now_ns();
	for (int i = 0; i < HELD; i++)
		held[i] = raw_connect(fixture.socket);
	for (int i = 0; i < TRIES; i++) {
		const int fd = raw_connect(fixture.socket);
		CHECK(raw_is_gone(fd));
		close(fd);
	}
	const uint64_t seconds = (now_ns() - start_ns) / UINT64_C(1000000000) + 2;
	CHECK_INT(prlimit(fixture.pid, RLIMIT_NOFILE, &before, NULL), 0);
	for (int i = 0; i < HELD; i++)
		close(held[i]);
	const int fd = raw_greet(fixture.socket);
	CHECK_INT(raw_control(fd, "ping", -1, &reply), 0);
	close(fd);
	FILE *log = fopen(fixture.log, "re");
	while (log && fgets(line, sizeof(line), log))
		lines += strstr(line, said) != NULL;
	if (log)
		fclose(log);
	CHECK(lines > 0);
	CHECK(lines <= (int)(4 * seconds));
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* ---- seccomp ---- */

static void *do_nothing(void *data)
{
	return data;
}

/* Errors of what is refused, and success of what is not; an exit status that says which failed. */
static int try_calls(void)
{
	char *const arguments[] = {(char *)(uintptr_t) "true", NULL};
	struct error error;
	pthread_t thread;
	if (seccomp_apply(&error) < 0)
		return 77;
	if (execv("/bin/true", arguments) == 0 || errno != EPERM)
		return 1;
	if (fork() >= 0 || errno != EPERM)
		return 2;
	if (socket(AF_INET, SOCK_STREAM, 0) >= 0 || errno != EPERM)
		return 3;
	if (setuid(getuid()) == 0 || errno != EPERM)
		return 4;
	if (pthread_create(&thread, NULL, do_nothing, NULL) != 0 || pthread_join(thread, NULL) != 0)
		return 5;
	const int local = socket(AF_UNIX, SOCK_DGRAM, 0), file = open("/dev/null", O_RDONLY);
	return local < 0 || file < 0 ? 6 : 0;
}

static void test_filter(void)
{
	int status = 0;
	fflush(stdout);
	const pid_t child = fork();
	if (child == 0)
		_exit(try_calls());
	waitpid(child, &status, 0);
	if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
		printf("       no seccomp on this machine\n");
	else
		CHECK_INT(status, 0);
}

/* The daemon does all its work behind the filter: streams, frames, a recording, its end. */
static void test_daemon_behind_filter(void)
{
	const char *const arguments[] = {"--seccomp", "--method", "pursuit", NULL};
	struct raw_stream stream;
	struct raw_reply reply;
	struct pursuit_feedback report;
	char path[64], line[128], record[96];
	/* The leak sanitizer traces from a process of its own, which is what the filter refuses. */
	setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
	fixture_start(&fixture, arguments);
	unsetenv("ASAN_OPTIONS");
	const int fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 1);
	CHECK(raw_stream_open(&stream, &reply));
	snprintf(record, sizeof(record), "%s/filtered.pursuit", fixture.folder);
	const int file = open(record, O_CREAT | O_RDWR | O_CLOEXEC, 0600);
	CHECK_INT(raw_control(fd, "record", file, &reply), 0);
	for (int i = 0; i < 5; i++) {
		raw_fill(&stream);
		raw_publish(&stream);
		CHECK(raw_feedback(&stream, &report));
	}
	CHECK_INT(raw_control(fd, "record-stop", -1, &reply), 0);
	snprintf(path, sizeof(path), "/proc/%d/status", (int)fixture.pid);
	FILE *status = fopen(path, "r");
	bool filtered = false;
	while (status && fgets(line, sizeof(line), status))
		filtered |= strncmp(line, "Seccomp:\t2", 10) == 0;
	if (status)
		fclose(status);
	CHECK(filtered);
	close(file);
	raw_stream_finish(&stream);
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, argv[1]);
	RUN(test_lists);
	RUN(test_strangers);
	RUN(test_strangers_change_no_limits);
	RUN(test_unknown_names);
	RUN(test_streams_and_bytes);
	RUN(test_message_rate);
	RUN(test_no_descriptors);
	RUN(test_filter);
	RUN(test_daemon_behind_filter);
	fixture_finish(&fixture);
	return test_result();
}
