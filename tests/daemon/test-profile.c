/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Settings of applications: whose executable it is decides, not what a client
 * says; they hold from the first frame that is shown to the last one; what was
 * asked for goes before them. The program is its own clients, under other names.
 */

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/configuration.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"

static struct fixture fixture;
static struct raw_reply reply;
static char config[128];
static int fd; /* of a client that asks only */

/* ---- a client that does as it is told ---- */

static int play_one(struct raw_stream *stream)
{
	struct pursuit_feedback report;
	float *motion;
	raw_fill(stream);
	motion = raw_motion(stream);
	for (uint32_t i = 0; i < RAW_WIDTH * RAW_HEIGHT; i++)
		motion[2 * i] = i % RAW_WIDTH > RAW_WIDTH / 2 ? 6.0f : 0.0f;
	raw_publish(stream);
	return raw_feedback(stream, &report) ? (int)report.state : 'x';
}

/* A frame for each byte of standard input, answered with a byte. Says that it is somebody else. */
static int be_client(const char *path, const char *socket, bool gone)
{
	struct raw_stream stream;
	static struct raw_reply answer;
	struct pursuit_message_hello hello = raw_hello();
	char byte = 'o';
	const int connection = raw_connect(socket);
	if (gone)
		unlink(path);
	snprintf(hello.name, sizeof(hello.name), "first-game");
	if (connection < 0 || raw_send(connection, &hello, sizeof(hello), NULL, 0) < 0 || !raw_receive(connection, &answer))
		return 1;
	raw_stream_init(&stream, connection, 1);
	if (!raw_stream_open(&stream, &answer) || write(STDOUT_FILENO, &byte, 1) != 1)
		return 1;
	while (read(STDIN_FILENO, &byte, 1) == 1) {
		byte = play_one(&stream) == PURSUIT_FEEDBACK_SHOWN ? 's' : 'n';
		if (write(STDOUT_FILENO, &byte, 1) != 1)
			return 1;
	}
	raw_stream_finish(&stream);
	return 0;
}

/* ---- clients, from outside ---- */

struct client {
	pid_t pid;
	int to, from;
	char path[400];
};

static char hear(const struct client *client)
{
	char byte = 0;
	return read(client->from, &byte, 1) == 1 ? byte : 0;
}

static void copy_program(const char *path)
{
	char buffer[65536];
	FILE *in = fopen("/proc/self/exe", "rb"), *out = fopen(path, "wb");
	CHECK(in && out);
	for (size_t got; in && out && (got = fread(buffer, 1, sizeof(buffer), in)) > 0;)
		CHECK(fwrite(buffer, 1, got, out) == got);
	if (in)
		fclose(in);
	CHECK(out && fclose(out) == 0 && chmod(path, 0700) == 0);
}

/* Starts the program under this name and waits until its stream is open, and so shown. */
static void client_start(struct client *client, const char *name, const char *how)
{
	int to[2], from[2];
	snprintf(client->path, sizeof(client->path), "%s/%s", fixture.folder, name);
	copy_program(client->path);
	CHECK(pipe2(to, O_CLOEXEC) == 0 && pipe2(from, O_CLOEXEC) == 0);
	client->pid = fork();
	if (client->pid == 0) {
		dup2(to[0], STDIN_FILENO);
		dup2(from[1], STDOUT_FILENO);
		execl(client->path, client->path, how, fixture.socket, (char *)NULL);
		_exit(127);
	}
	close(to[0]);
	close(from[1]);
	client->to = to[1];
	client->from = from[0];
	CHECK_INT(hear(client), 'o');
}

static void client_play(const struct client *client, int frames)
{
	for (int i = 0; i < frames; i++) {
		CHECK_INT(write(client->to, "f", 1), 1);
		CHECK_INT(hear(client), 's');
	}
}

static void client_end(struct client *client)
{
	close(client->to);
	close(client->from);
	CHECK_INT(waitpid(client->pid, NULL, 0), client->pid);
	unlink(client->path);
}

/* ---- what the daemon says ---- */

static bool profile_is(const char *name)
{
	json_t *all = question_ask(fd, "status");
	const char *profile = json_string_value(json_object_get(all, "profile"));
	const bool is = profile && strcmp(profile, name) == 0;
	if (!is)
		fprintf(stderr, "the profile is %s, not %s\n", profile ? profile : "nothing", name);
	json_decref(all);
	return is;
}

/* Waits: a client that has ended is noticed a moment later. */
static bool setting_comes(const char *line)
{
	for (unsigned waited = 0; waited < PATIENCE_MS; waited += 20) {
		if (question_setting(fd, line))
			return true;
		sleep_ms(20);
	}
	return false;
}

/* Shows the client of this executable. */
static void focus(const char *application)
{
	json_t *all = question_ask(fd, "status"), *streams = json_object_get(all, "streams");
	char request[64] = "set focus=nobody";
	for (size_t i = 0; i < json_array_size(streams); i++) {
		const json_t *stream = json_array_get(streams, i);
		if (strcmp(json_string_value(json_object_get(stream, "application")), application) == 0)
			snprintf(request, sizeof(request), "set focus=%d",
					 (int)json_integer_value(json_object_get(stream, "client_id")));
	}
	json_decref(all);
	CHECK_INT(raw_control(fd, request, -1, &reply), 0);
}

static void write_config(const char *text)
{
	FILE *file = fopen(config, "w");
	CHECK(file && fputs(text, file) >= 0);
	if (file)
		fclose(file);
}

static void ask(const char *request)
{
	const int result = raw_control(fd, request, -1, &reply);
	if (result != 0)
		fprintf(stderr, "%s: %s\n", request, (const char *)reply.raw + sizeof(reply.control));
	CHECK_INT(result, 0);
}

/* ---- tests ---- */

/* Each frame of the second game is analysed, and none of the first one's. A report is counted when the next begins. */
static void test_two_clients(void)
{
	struct client first, second;
	client_start(&first, "first-game", "--client");
	CHECK(profile_is("first-game") && question_setting(fd, "\nblur = off\n"));
	client_play(&first, 4);
	client_start(&second, "second game", "--client");
	CHECK(profile_is("second game") && question_setting(fd, "method = grid\n") &&
		  question_setting(fd, "\nblur = doubtful\n"));
	client_play(&second, 5);
	focus("first-game");
	CHECK(profile_is("first-game") && question_setting(fd, "method = hold\n"));
	client_play(&first, 3);
	CHECK_INT(question_figure(fd, "status", "passes.analyse"), 5);
	focus("second game");
	client_play(&second, 2);
	client_end(&second);
	CHECK(setting_comes("method = hold\n") && profile_is("first-game"));
	client_play(&first, 3);
	/* one more where its last frame was shown again, when it was focused, before the first new one came */
	const json_int_t analysed = question_figure(fd, "status", "passes.analyse");
	CHECK(analysed == 7 || analysed == 8);
	client_end(&first);
	CHECK(setting_comes("\nblur = everywhere\n") && profile_is(""));
	CHECK_INT(question_figure(fd, "status", "lost_real_frames"), 0);
}

/* What was asked for goes before the profile, whichever is shown, until it is taken back. */
static void test_asked_goes_first(void)
{
	struct client first, second;
	client_start(&first, "first-game", "--client");
	ask("set method=scatter");
	client_start(&second, "second game", "--client");
	CHECK(profile_is("second game") && question_setting(fd, "method = scatter\n"));
	focus("first-game");
	CHECK(question_setting(fd, "method = scatter\n") && question_setting(fd, "\nblur = off\n"));
	ask("unset method");
	CHECK(question_setting(fd, "method = hold\n"));
	focus("second game");
	CHECK(question_setting(fd, "method = grid\n"));
	CHECK_INT(raw_control(fd, "unset method", -1, &reply), EINVAL);
	client_play(&second, 2);
	client_end(&first);
	client_end(&second);
}

/* Changed while it is shown; taken away while it is shown. */
static void test_changed_profile(void)
{
	struct client first;
	client_start(&first, "first-game", "--client");
	CHECK(question_setting(fd, "\nblur = off\n"));
	write_config("blur = everywhere\n[application first-game]\nblur = doubtful\ncell = 32\n");
	ask("reload");
	CHECK(question_setting(fd, "\nblur = doubtful\n") && question_setting(fd, "\ncell = 32\n"));
	client_play(&first, 2);
	write_config("blur = everywhere\n");
	ask("reload");
	CHECK(profile_is("") && question_setting(fd, "\nblur = everywhere\n") && question_setting(fd, "\ncell = 8\n"));
	client_play(&first, 2);
	client_end(&first);
}

/* Executables may be called anything; one that is called otherwise has no part in a section, whatever it says. */
static void test_hostile_names(void)
{
	static char longest[256], text[2048];
	const char *const fine[] = {"we[ir]d = # game", "[application x]", "\xff\xfe not UTF-8", "a=b", longest};
	const char *const none[] = {"tab\there", "line\n[application x]", " first-game", "first-game "};
	struct client client;
	memset(longest, 'n', 255);
	for (size_t i = 0; i < sizeof(fine) / sizeof(fine[0]); i++) {
		snprintf(text, sizeof(text), "[application %s]\ncell = %zu\n", fine[i], 10 + i);
		write_config(text);
		ask("reload");
		client_start(&client, fine[i], "--client");
		snprintf(text, sizeof(text), "\ncell = %zu\n", 10 + i);
		CHECK(question_setting(fd, text));
		client_play(&client, 1);
		client_end(&client);
	}
	write_config(
		"[application first-game]\ncell = 20\n[application x]\ncell = 21\n[application tab?here]\ncell = 22\n");
	ask("reload");
	for (size_t i = 0; i < sizeof(none) / sizeof(none[0]); i++) {
		client_start(&client, none[i], "--client");
		CHECK(question_setting(fd, "\ncell = 8\n") && profile_is(""));
		client_end(&client);
	}
	client_start(&client, "first-game", "--client-gone");
	CHECK(question_setting(fd, "\ncell = 20\n")); /* updated while it runs */
	client_end(&client);
}

static void test_bad_sections(void)
{
	static const char *const wrong[][2] = {
		{"[application a]\n[application b]\ncell=9\n[application a]\n",
		 ":4: application a has a section already, at line 1"},
		{"[application a]\nmax-clients = 3\n", ":2: max-clients is no setting of the picture"},
		{"[application a]\ncell = 3\n", ":2: cell: 3 is below 4 px"},
		{"[application a]\nmethod = magic\n", ":2: method: \"magic\" is none of hold, black"},
		{"\n[program a]\n", ":2: \"[program a]\" is not of the form [application NAME]"},
		{"[application a\n", ":1: \"[application a\" is not of the form [application NAME]"},
		{"[application]\n", ":1: \"[application]\" is not of the form"},
		{"[application  ]\n", ":1: application: has no name"},
		{"[application /bin/a]\n", ":1: application: \"/bin/a\" must be the name of an executable, without folders"},
		{"[application a\tb]\n", ":1: application: the name holds a control character (9)"},
	};
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		write_config(wrong[i][0]);
		CHECK_INT(raw_control(fd, "reload", -1, &reply), EINVAL);
		const char *answer = (const char *)reply.raw + sizeof(reply.control);
		if (!strstr(answer, wrong[i][1]))
			fprintf(stderr, "answered %s\n", answer);
		CHECK(strstr(answer, wrong[i][1]) != NULL);
	}
}

int main(int argc, char **argv)
{
	if (argc == 3 && strncmp(argv[1], "--client", 8) == 0)
		return be_client(argv[0], argv[2], strcmp(argv[1], "--client-gone") == 0);
	if (argc < 2)
		return 2;
	const char *const arguments[] = {"--config", config, "--governor", "off", NULL};
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, argv[1]);
	snprintf(config, sizeof(config), "%s/config", fixture.folder);
	write_config("blur = everywhere\n\n[application first-game]\nblur = off\n[application second game]\n"
				 "method = grid\nblur = doubtful\n");
	fixture_start(&fixture, arguments);
	fd = raw_greet(fixture.socket);
	RUN(test_two_clients);
	RUN(test_asked_goes_first);
	RUN(test_changed_profile);
	RUN(test_hostile_names);
	RUN(test_bad_sections);
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	fixture_finish(&fixture);
	return test_result();
}
