# SPDX-License-Identifier: MIT
"""pursuit top in a pseudo terminal: what is sent, what keys do, and that the terminal comes back, whatever happens."""
import fcntl
import json
import os
import pty
import re
import select
import shutil
import signal
import struct
import subprocess
import termios
import time

import common

PURSUITD, EXAMPLE = os.environ["PURSUITD"], os.environ["EXAMPLE_MEMORY"]
ASK, ANSWER = b"\x1b[5n", b"\x1b[0n"
ECHO = b"^[[0n"  # of an answer that comes when top has left the terminal
ENTER, LEAVE = b"\x1b[?1049h\x1b[?25l", b"\x1b[?25h\x1b[?1049l"


class Screen:
    """A terminal of just the commands that top uses."""

    def __init__(self, columns, rows):
        self.resize(columns, rows)

    def resize(self, columns, rows):
        self.columns, self.rows, self.lines, self.at = columns, rows, [""] * rows, (0, 0)

    def put(self, text):
        for part in re.findall(r"\x1b\[\??[0-9;]*[A-Za-z]|[^\x1b]+", text):
            if not part.startswith("\x1b"):
                row, column = self.at
                assert row < self.rows and column + len(part) <= self.columns, repr(part)
                line = self.lines[row].ljust(column)
                self.lines[row] = line[:column] + part + line[column + len(part):]
                self.at = row, column + len(part)
            elif part.endswith("H"):
                self.at = int(part[2:-1] or 1) - 1, 0
            elif part == "\x1b[K":
                self.lines[self.at[0]] = self.lines[self.at[0]][:self.at[1]]
            elif part == "\x1b[J":
                self.lines[self.at[0]:] = [""] * (self.rows - self.at[0])
            elif part == "\x1b[2J":
                self.lines = [""] * self.rows


class Top(common.Case):
    def setUp(self):
        super().setUp()
        self.socket = self.path("socket")
        self.log = open(self.path("log"), "w+")
        self.daemon = common.started(
            subprocess.Popen([PURSUITD, "--socket", self.socket, "--method", "hold"], stderr=self.log), self.socket)
        self.top = None

    def tearDown(self):
        if self.top and self.top.poll() is None:
            self.top.kill()
            self.top.wait()
        self.daemon.send_signal(signal.SIGTERM)
        self.daemon.wait(2 * common.PATIENCE)
        self.log.close()
        super().tearDown()

    def start(self, columns=100, rows=40, answering=True, interval=100, **environment):
        self.master, slave = pty.openpty()
        self.slave = slave
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.before = termios.tcgetattr(slave)
        self.screen, self.bytes, self.pictures, self.answering = Screen(columns, rows), b"", [], answering
        self.top = subprocess.Popen([common.PURSUIT, "top", "--socket", self.socket, "--interval-ms", str(interval)],
                                    stdin=slave, stdout=slave, stderr=subprocess.DEVNULL, start_new_session=True,
                                    env={**os.environ, "TERM": "xterm", **environment},
                                    preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))

    def pump(self, seconds):
        """What comes within this time, answered as a terminal does."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0 and select.select([self.master], [], [], left)[0]:
            try:
                got = os.read(self.master, 65536)
            except OSError:
                return
            self.bytes += got
            while ASK in self.bytes:
                picture, self.bytes = self.bytes.split(ASK, 1)
                self.pictures.append(picture)
                self.screen.put(picture.replace(ECHO, b"").decode())
                if self.answering:
                    os.write(self.master, ANSWER)

    def wait_for(self, words, seconds=60):
        end = time.monotonic() + seconds
        while words not in "\n".join(self.screen.lines):
            self.assertLess(time.monotonic(), end, f"{words} is not in\n" + "\n".join(self.screen.lines))
            self.pump(0.1)

    def wait_until_it_fits(self, columns, rows, seconds=60):
        end = time.monotonic() + seconds
        while not ("p" in "".join(self.screen.lines) and max(map(len, self.screen.lines)) <= columns
                   and not any(self.screen.lines[rows:])):
            self.assertLess(time.monotonic(), end, f"not within {columns}x{rows}:\n" + "\n".join(self.screen.lines))
            self.pump(0.1)

    def wait_for_pictures(self, count, seconds=60):
        """What is shown of a daemon without clients changes once a second, with the time since it started."""
        end = time.monotonic() + seconds
        while len(self.pictures) < count:
            self.assertLess(time.monotonic(), end, f"{len(self.pictures)} pictures, not {count}")
            self.pump(0.1)

    def has_left(self):
        """As often as it has entered."""
        sent = b"".join(self.pictures) + self.bytes
        return sent.count(LEAVE) == sent.count(ENTER)

    def steps(self, pictures):
        """Seconds from one picture to the next, by the time that they show, which is all that changes without clients."""
        seconds = [int(shown[1]) for picture in pictures if (shown := re.search(rb"up (\d+) s", picture))]
        return [later - earlier for earlier, later in zip(seconds, seconds[1:])]

    def press(self, keys):
        os.write(self.master, keys.encode())

    def ends(self, status):
        """The terminal is as it was before."""
        end = time.monotonic() + common.PATIENCE
        while self.top.poll() is None and time.monotonic() < end:
            self.pump(0.05)
        self.assertEqual(self.top.poll(), status)
        while not self.has_left() and time.monotonic() < end:
            self.pump(0.05)
        self.pump(0.2)
        self.assertTrue(self.has_left())
        self.assertEqual(termios.tcgetattr(self.slave), self.before)
        os.close(self.master)
        os.close(self.slave)

    def setting(self, name):
        return self.must("get", name, "--socket", self.socket).stdout.strip()

    def test_what_is_shown(self):
        self.start()
        for words in ("pursuitd ", "no stream", "governor  auto, level 0", "settings  blur doubtful, compensation yes",
                      "lab       off", "m method  b blur", "missed", "passes", "left out"):
            self.wait_for(words)
        self.press("q")
        self.ends(0)

    def test_keys(self):
        self.start()
        self.wait_for("m method")
        self.press("m")
        self.wait_for("done: set method=")
        self.assertNotEqual(self.setting("method"), "hold")
        for key, words, name, value in [("b", "blur everywhere", "blur", "everywhere"),
                                        ("c", "compensation no", "compensation", "no"),
                                        ("n", "motion-model quadratic", "motion-model", "quadratic"),
                                        ("g", "governor  off", "governor", "off"),
                                        ("l", "done: set level=1", "level", "1")]:
            self.press(key)
            self.wait_for(words)
            self.assertEqual(self.setting(name), value)
        self.wait_for("set: method motion-mod")
        self.press("u")
        self.wait_for("blur doubtful, compensation yes")
        self.assertEqual((self.setting("method"), self.setting("governor")), ("hold", "auto"))
        self.press("u")
        self.wait_for("undo: there is nothing to change")
        self.press("f")
        self.wait_for("next client: there is nothing to change")
        self.press("i")
        self.wait_for("done: key i")
        self.press(" ")
        self.wait_for("held: space goes on")
        self.press("\x1b[A\x1bOAq")  # arrows are nothing
        self.ends(0)

    def test_only_what_changed_is_sent(self):
        self.start(interval=200)
        self.wait_for("m method")
        self.wait_for_pictures(5)
        first, later = len(self.pictures[0]), self.pictures[3:]
        self.assertGreater(first, 500)
        self.assertLess(max(map(len, later)), first // 2)
        for picture in later:
            self.assertNotIn(b"m method", picture)
        self.press("q")
        self.ends(0)

    def test_a_slow_line_gets_no_more_than_it_shows(self):
        self.start(answering=True)
        self.wait_for("m method")
        self.wait_for_pictures(3)
        self.answering = False
        before = len(self.pictures)
        self.wait_for_pictures(before + 3)
        # It waits five seconds for each answer; who is kept from running sees some of them late.
        steps = self.steps(self.pictures[before:])
        self.assertGreater(max(steps), 3, steps)
        self.answering = True
        os.write(self.master, ANSWER)
        before = len(self.pictures)
        self.wait_for_pictures(before + 4)
        steps = self.steps(self.pictures[before:])
        self.assertLess(min(steps), 4, steps)
        self.press("q")
        self.ends(0)

    def test_a_terminal_that_answers_nothing(self):
        self.start(answering=False)
        self.wait_for("m method")
        self.wait_for_pictures(4)
        # Each picture would take five seconds if top waited for an answer.
        self.assertLess(min(self.steps(self.pictures)), 4)
        self.press("q")
        self.ends(0)

    def test_resize(self):
        self.start()
        self.wait_for("m method")
        for columns, rows in (30, 50), (200, 4), (1, 1), (120, 40):
            self.pump(0.3)
            self.screen.resize(max(columns, self.screen.columns), max(rows, self.screen.rows))
            fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
            self.wait_until_it_fits(columns, rows)
        self.wait_for("m method")
        self.press("q")
        self.ends(0)

    def test_signals(self):
        for number in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
            self.start()
            self.wait_for("m method")
            self.top.send_signal(number)
            self.ends(0)

    def test_crash(self):
        for number in signal.SIGSEGV, signal.SIGABRT:
            self.start(ASAN_OPTIONS="handle_segv=0:handle_abort=0:allow_user_segv_handler=1")
            self.wait_for("m method")
            self.top.send_signal(number)
            self.ends(-number)

    def test_stopped_and_continued(self):
        self.start()
        self.wait_for("m method")
        self.press("\x1a")

        def stopped():
            self.pump(0.05)
            return os.waitid(os.P_PID, self.top.pid, os.WSTOPPED | os.WNOHANG | os.WNOWAIT)

        self.assertTrue(common.soon(stopped))
        self.assertEqual(termios.tcgetattr(self.slave), self.before)
        self.screen.resize(100, 40)
        self.top.send_signal(signal.SIGCONT)
        self.wait_for("m method")
        self.press("q")
        self.ends(0)

    def test_daemon_that_goes(self):
        self.start()
        self.wait_for("m method")
        self.daemon.send_signal(signal.SIGTERM)
        self.ends(1)

    def test_colors(self):
        self.start()
        self.wait_for("m method")
        self.press("q")
        self.ends(0)
        self.assertIn(b"\x1b[1m", self.pictures[0])
        self.start(NO_COLOR="1")
        self.wait_for("m method")
        self.press("q")
        self.ends(0)
        self.assertFalse([picture for picture in self.pictures if b"m" in re.findall(rb"\x1b\[[0-9;]*([a-zA-Z])", picture)])

    def test_hostile_names(self):
        """What clients are called is nothing that the terminal would obey."""
        game = shutil.copy(EXAMPLE, self.path("ga\x1b[2Jme\n\x07"))
        client = subprocess.Popen([game, "--seconds", "600"], env={**os.environ, "PURSUIT_SOCKET": self.socket},
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            self.start(columns=140, NO_COLOR="1")
            self.wait_for("ga?[2Jme??")
            self.wait_for("> example-memory")
            self.wait_for("submit to flip, ms")
            self.wait_for("displayed Hz")
            self.press("q")
            self.ends(0)
            self.assertNotIn(b"\x1b[2Jme", b"".join(self.pictures))
            text = self.must("top", "--once", "--interval-ms", "500", "--socket", self.socket).stdout
            self.assertNotIn("\x1b", text)
            self.assertNotIn("\x07", text)

            def figures():
                now = json.loads(self.must("top", "--json", "--interval-ms", "500", "--socket", self.socket).stdout)["now"]
                return (now["real_hz"] or 0) > 0 and (now["submit_to_flip_p99_ms"] or 0) > 0

            self.assertTrue(common.soon(figures))
        finally:
            client.terminate()
            client.wait()


if __name__ == "__main__":
    common.main()
