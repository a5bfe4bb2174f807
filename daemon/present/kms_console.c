/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms_console.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/vt.h>
#include <signal.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#define LEAVE_SIGNAL SIGUSR1
#define RETURN_SIGNAL SIGUSR2

static bool signals_are_blocked(void)
{
	sigset_t blocked;
	return pthread_sigmask(SIG_BLOCK, NULL, &blocked) == 0 && sigismember(&blocked, LEAVE_SIGNAL) == 1 &&
		   sigismember(&blocked, RETURN_SIGNAL) == 1;
}

static int open_signals(void)
{
	sigset_t set;
	sigemptyset(&set);
	sigaddset(&set, LEAVE_SIGNAL);
	sigaddset(&set, RETURN_SIGNAL);
	return signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
}

/* Of a terminal that was watched before: nobody waits for an answer any more. */
static void forget_signals(int signals)
{
	struct signalfd_siginfo info;
	while (read(signals, &info, sizeof(info)) == (ssize_t)sizeof(info))
		continue;
}

static int set_mode(int tty, char mode)
{
	const struct vt_mode wanted = {.mode = mode, .relsig = LEAVE_SIGNAL, .acqsig = RETURN_SIGNAL};
	return ioctl(tty, VT_SETMODE, &wanted);
}

void kms_console_init(struct kms_console *console, const struct log *log)
{
	struct vt_mode mode;
	console->signals = -1;
	console->tty = open("/dev/tty", O_RDWR | O_CLOEXEC | O_NOCTTY);
	if (console->tty >= 0 && ioctl(console->tty, VT_GETMODE, &mode) == 0 && signals_are_blocked()) {
		console->signals = open_signals();
		forget_signals(console->signals);
		if (console->signals >= 0 && set_mode(console->tty, VT_PROCESS) == 0)
			return;
		log_warning(log, "kms: switching between consoles is not watched: %s", strerror(errno));
	}
	log_debug(log, "kms: not started on a virtual terminal");
	if (console->signals >= 0)
		close(console->signals);
	if (console->tty >= 0)
		close(console->tty);
	console->tty = console->signals = -1;
}

void kms_console_finish(struct kms_console *console)
{
	if (console->tty < 0)
		return;
	set_mode(console->tty, VT_AUTO);
	close(console->signals);
	close(console->tty);
	console->tty = console->signals = -1;
}

int kms_console_get_fd(const struct kms_console *console)
{
	return console->signals;
}

enum kms_console_event kms_console_read(struct kms_console *console)
{
	struct signalfd_siginfo info;
	/* Not what somebody else sends. */
	if (read(console->signals, &info, sizeof(info)) != (ssize_t)sizeof(info) || info.ssi_code != SI_KERNEL)
		return KMS_CONSOLE_NOTHING;
	if (info.ssi_signo == LEAVE_SIGNAL)
		return KMS_CONSOLE_LEAVE;
	ioctl(console->tty, VT_RELDISP, VT_ACKACQ);
	return KMS_CONSOLE_RETURN;
}

void kms_console_left(struct kms_console *console)
{
	ioctl(console->tty, VT_RELDISP, 1);
}
