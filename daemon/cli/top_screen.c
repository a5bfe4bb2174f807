/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "top_screen.h"
#include "daemon/clock.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#define DEFAULT_COLUMNS 100u
#define DEFAULT_ROWS 40u
#define PATIENCE_MS 5000u /* with a terminal that has answered before */

#define ENTER "\033[?1049h\033[?25l\033[2J"
#define LEAVE "\033[0m\033[?25h\033[?1049l"
#define ARE_YOU_THERE "\033[5n"
#define ANSWER "\033[0n"

static const int crashes[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};

/* ---- crashes ---- */

/* A signal handler has no other way to know what was there before. */
static struct {
	volatile sig_atomic_t entered, keys;
	struct termios before;
} terminal;

static void write_all(const char *text, size_t size)
{
	while (size > 0) {
		const ssize_t wrote = write(STDOUT_FILENO, text, size);
		if (wrote < 0 && errno != EINTR)
			return;
		text += wrote > 0 ? wrote : 0;
		size -= wrote > 0 ? (size_t)wrote : 0;
	}
}

static void restore(void)
{
	if (!terminal.entered)
		return;
	terminal.entered = 0;
	write_all(LEAVE, sizeof(LEAVE) - 1);
	if (terminal.keys)
		tcsetattr(STDIN_FILENO, TCSANOW, &terminal.before);
}

static void on_crash(int number)
{
	restore();
	signal(number, SIG_DFL);
	raise(number);
}

/* ---- entering and leaving ---- */

static void measure(struct top_screen *screen)
{
	struct winsize size;
	const bool told = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0;
	screen->columns = told && size.ws_col > 0 ? size.ws_col : DEFAULT_COLUMNS;
	screen->rows = told && size.ws_row > 0 ? size.ws_row : DEFAULT_ROWS;
}

static void forget_lines(struct top_screen *screen)
{
	for (size_t i = 0; i < screen->count; i++)
		free(screen->lines[i]);
	free(screen->lines);
	screen->lines = NULL;
	screen->count = 0;
}

/* Keys come one by one and unseen. */
static void enter(struct top_screen *screen)
{
	if (screen->keys) {
		struct termios raw = screen->before;
		raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
		raw.c_cc[VMIN] = 1;
		raw.c_cc[VTIME] = 0;
		tcsetattr(STDIN_FILENO, TCSANOW, &raw);
	}
	terminal.before = screen->before;
	terminal.keys = screen->keys;
	terminal.entered = 1;
	write_all(ENTER, sizeof(ENTER) - 1);
	forget_lines(screen);
	measure(screen);
	screen->waiting = false;
}

int top_screen_open(struct top_screen *screen, struct error *error)
{
	static const int watched[] = {SIGINT, SIGTERM, SIGHUP, SIGWINCH, SIGTSTP, SIGCONT};
	sigset_t signals;
	*screen = (struct top_screen){.signal_fd = -1};
	screen->keys = isatty(STDIN_FILENO) && tcgetattr(STDIN_FILENO, &screen->before) == 0;
	sigemptyset(&signals);
	for (size_t i = 0; i < sizeof(watched) / sizeof(watched[0]); i++)
		sigaddset(&signals, watched[i]);
	sigprocmask(SIG_BLOCK, &signals, NULL);
	screen->signal_fd = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
	if (screen->signal_fd < 0)
		return error_set(error, -errno, "signals cannot be watched: %s", strerror(errno));
	for (size_t i = 0; i < sizeof(crashes) / sizeof(crashes[0]); i++)
		signal(crashes[i], on_crash);
	enter(screen);
	return 0;
}

void top_screen_close(struct top_screen *screen)
{
	restore();
	for (size_t i = 0; i < sizeof(crashes) / sizeof(crashes[0]); i++)
		signal(crashes[i], SIG_DFL);
	forget_lines(screen);
	if (screen->signal_fd >= 0)
		close(screen->signal_fd);
	screen->signal_fd = -1;
}

/* ---- drawing ---- */

static uint64_t now_ms(void)
{
	return clock_monotonic_ns() / 1000000;
}

static bool must_wait(struct top_screen *screen)
{
	struct pollfd room = {.fd = STDOUT_FILENO, .events = POLLOUT};
	if (poll(&room, 1, 0) == 1 && !(room.revents & POLLOUT))
		return true;
	return screen->waiting && screen->answers && now_ms() - screen->sent_ms < PATIENCE_MS;
}

/* NULL: out of memory; the line is sent again next time then. */
static void keep_line(struct top_screen *screen, size_t at, const char *line, size_t length)
{
	if (at >= screen->count) {
		char **lines = realloc(screen->lines, (at + 1) * sizeof(*lines));
		if (!lines)
			return;
		screen->lines = lines;
		screen->lines[screen->count++] = NULL;
	}
	free(screen->lines[at]);
	screen->lines[at] = strndup(line, length);
}

static bool is_shown(const struct top_screen *screen, size_t at, const char *line, size_t length)
{
	return at < screen->count && screen->lines[at] && strlen(screen->lines[at]) == length &&
		   memcmp(screen->lines[at], line, length) == 0;
}

static void print_changes(struct top_screen *screen, const char *text, FILE *out)
{
	size_t at = 0;
	for (; *text && at < screen->rows; at++) {
		const size_t length = strcspn(text, "\n");
		if (!is_shown(screen, at, text, length)) {
			fprintf(out, "\033[%zuH%.*s\033[K", at + 1, (int)length, text);
			keep_line(screen, at, text, length);
		}
		text += length + (text[length] == '\n');
	}
	if (at < screen->count)
		fprintf(out, "\033[%zuH\033[J", at + 1);
	for (; screen->count > at; screen->count--)
		free(screen->lines[screen->count - 1]);
}

bool top_screen_draw(struct top_screen *screen, const char *text)
{
	char *changes = NULL;
	size_t size = 0;
	if (must_wait(screen))
		return false;
	FILE *out = open_memstream(&changes, &size);
	if (!out)
		return false;
	print_changes(screen, text, out);
	if (ftell(out) > 0 && screen->keys) {
		fputs(ARE_YOU_THERE, out);
		screen->waiting = true;
		screen->sent_ms = now_ms();
	}
	if (fclose(out) == 0)
		write_all(changes, size);
	free(changes);
	return true;
}

/* ---- waiting ---- */

/* True: a key. Answers of the terminal are taken out; a key that begins like one (arrows) is none of ours. */
static bool take_byte(struct top_screen *screen, char byte)
{
	if (screen->escape == 0 && byte == ANSWER[0]) {
		screen->escape = 1;
		return false;
	}
	if (screen->escape == 0)
		return true;
	if (screen->escape == 1 && byte != '[') {
		screen->escape = 0;
		return false;
	}
	screen->escape++;
	if (screen->escape > 2 && byte >= '@' && byte <= '~') {
		screen->answers |= byte == 'n';
		screen->waiting &= byte != 'n';
		screen->escape = 0;
	}
	return false;
}

static enum top_event take_signal(struct top_screen *screen)
{
	struct signalfd_siginfo info;
	if (read(screen->signal_fd, &info, sizeof(info)) != (ssize_t)sizeof(info))
		return TOP_NOTHING;
	switch (info.ssi_signo) {
	case SIGWINCH:
		measure(screen);
		forget_lines(screen);
		write_all("\033[2J", 4);
		return TOP_CHANGED;
	case SIGTSTP:
		restore();
		raise(SIGSTOP);
		enter(screen);
		return TOP_CHANGED;
	case SIGCONT:
		return TOP_CHANGED;
	default:
		return TOP_OVER;
	}
}

enum top_event top_screen_wait(struct top_screen *screen, uint32_t ms, char *key)
{
	const uint64_t end = now_ms() + ms;
	for (;;) {
		const uint64_t now = now_ms();
		struct pollfd wait[2] = {{.fd = screen->signal_fd, .events = POLLIN},
								 {.fd = screen->keys ? STDIN_FILENO : -1, .events = POLLIN}};
		const int ready = poll(wait, 2, now < end ? (int)(end - now) : 0);
		if (ready == 0 || (ready < 0 && errno != EINTR))
			return ready == 0 ? TOP_NOTHING : TOP_OVER;
		if (ready > 0 && wait[0].revents) {
			const enum top_event event = take_signal(screen);
			if (event != TOP_NOTHING)
				return event;
		}
		if (ready > 0 && wait[1].revents) {
			if (read(STDIN_FILENO, key, 1) != 1)
				return TOP_OVER;
			if (take_byte(screen, *key))
				return TOP_KEY;
		}
	}
}
