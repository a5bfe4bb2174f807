# SPDX-License-Identifier: MIT
"""One style for all verbs: each in turn helps, speaks JSON, refuses, and writes no more than text where nobody looks."""
import json
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import tempfile
import time

import common

PURSUITD, EXAMPLE = os.environ["PURSUITD"], os.environ["EXAMPLE_MEMORY"]

# A small piece of work for each verb; IN is a recording, OUT a name of its own, SOCKET a daemon's.
WORK = {
    "demo": ["--seconds", "1", "--size", "64x36", "--out", "OUT"],
    "record": ["OUT", "--scene", "still", "--size", "16x16", "--seconds", "0.05"],
    "replay": ["IN", "--every", "2"],
    "report": ["--scenes", "still", "--methods", "hold", "--n", "2", "--sizes", "64x36", "--antialias", "1", "--out", "OUT"],
    "import": ["OUT", "--color", "FOLDER/c_%04d.png", "--fps", "30"],
    "export": ["IN", "--color", "OUT_%04d.png"],
    "check-stream": ["IN"],
    "latency": ["--socket", "SOCKET"],
    "doctor": ["--socket", "SOCKET"],
    "top": ["--once", "--interval-ms", "300", "--socket", "SOCKET"],
    "get": ["method", "--socket", "SOCKET"],
    "set": ["blur=off", "--socket", "SOCKET"],
    "profile": ["--socket", "SOCKET", "--config", "FOLDER/none.conf"],
    "status": ["--socket", "SOCKET"],
}
JSON = {"replay": ["--json", "-"]}
# What cannot be done, and is told with exit status 1.
FAILS = {
    "demo": ["--seconds", "1", "--out", "/dev/null/x"],
    "record": ["/dev/null/x", "--scene", "still"],
    "replay": ["/nonexistent"],
    "report": ["--scenes", "none", "--recordings", "/nonexistent", "--out", "OUT"],
    "import": ["OUT", "--color", "/nonexistent/c_%d.png", "--fps", "30"],
    "export": ["/nonexistent", "--color", "OUT_%d.png"],
    "check-stream": ["/nonexistent"],
    "latency": ["/nonexistent"],
    "top": ["--socket", "/nonexistent"],
    "get": ["--socket", "/nonexistent"],
    "set": ["blur=off", "--socket", "/nonexistent"],
    "profile": ["show", "nobody", "--config", "/nonexistent"],
    "status": ["--socket", "/nonexistent"],
}
COLOR = re.compile(r"\x1b\[[0-9;]*m")


class Style(common.Case):
    number = 0

    @classmethod
    def setUpClass(cls):
        """One folder, recording, daemon and client for all: no test changes them but by what `set` sets."""
        cls.folder = tempfile.mkdtemp(prefix="pursuit-test-")
        cls.socket, cls.recording = cls.folder + "/socket", cls.folder + "/in.pursuit"
        for made in (["record", cls.recording, "--scene", "still", "--size", "16x16", "--fps", "120", "--seconds", "0.05"],
                     ["export", cls.recording, "--color", cls.folder + "/c_%04d.png"]):
            common.run(*made).check_returncode()
        cls.log = open(cls.folder + "/log", "w")
        cls.daemon = subprocess.Popen([PURSUITD, "--socket", cls.socket, "--latency"], stderr=cls.log)
        common.started(cls.daemon, cls.socket)
        cls.client = subprocess.Popen([EXAMPLE, "--seconds", "3000"], stdout=cls.log, stderr=cls.log,
                                      env={**os.environ, "PURSUIT_SOCKET": cls.socket})

        def shown():
            return json.loads(common.run("status", "--json", "--socket", cls.socket).stdout)["real_frames"] > 60

        assert common.soon(shown, 5 * common.PATIENCE), "no frames arrive"

    @classmethod
    def tearDownClass(cls):
        cls.client.terminate()
        cls.client.wait()
        cls.daemon.send_signal(signal.SIGTERM)
        cls.daemon.wait(2 * common.PATIENCE)
        cls.log.close()
        shutil.rmtree(cls.folder, ignore_errors=True)

    def setUp(self):
        pass

    def tearDown(self):
        self.assertIsNone(self.daemon.poll(), "the daemon is gone")

    def verbs(self):
        return [line.split("\t")[0] for line in self.must("--print-verbs").stdout.splitlines()]

    def words(self, listed):
        Style.number += 1
        known = {"IN": self.recording, "SOCKET": self.socket, "FOLDER": self.folder, "OUT": self.path(f"out{self.number}")}
        return [re.sub("^(IN|SOCKET|FOLDER|OUT)", lambda found: known[found.group(1)], word) for word in listed]

    def in_terminal(self, *arguments, **environment):
        """Output and exit status where somebody looks."""
        master, slave = pty.openpty()
        process = subprocess.Popen([common.PURSUIT, *arguments], stdin=subprocess.DEVNULL, stdout=slave, stderr=slave,
                                   env={**os.environ, "TERM": "xterm", **environment})
        os.close(slave)
        text, end = b"", time.monotonic() + 600
        while time.monotonic() < end:
            common.hurry(process.pid)
            if not select.select([master], [], [], 0.5)[0]:
                continue
            try:
                text += os.read(master, 65536)
            except OSError:
                break
        os.close(master)
        return text.decode(), process.wait(600)

    def test_every_verb_is_here(self):
        self.assertEqual(sorted(self.verbs()), sorted(WORK))

    def test_help(self):
        for verb in self.verbs():
            with self.subTest(verb=verb):
                result = self.must(verb, "--help")
                self.assertEqual(result.stderr, "")
                self.assertTrue(result.stdout.startswith(f"usage: pursuit {verb} "))
                for part in "\noptions\n", "\nexamples\n", "exit status: 0 done, 1 failed, 2 used wrongly", "--json":
                    self.assertIn(part, result.stdout)
                self.assertLessEqual(max(map(len, result.stdout.splitlines())), 140)
                self.assertIn(f"  pursuit {verb}", result.stdout.split("\nexamples\n")[1] + "  pursuitd")
                text, status = self.in_terminal(verb, "--help")
                self.assertEqual((text.replace("\r\n", "\n"), status), (result.stdout, 0))

    def test_json_and_nothing_else(self):
        for verb, listed in WORK.items():
            with self.subTest(verb=verb):
                result = self.must(verb, *self.words(listed), *JSON.get(verb, ["--json"]))
                self.assertIsInstance(json.loads(result.stdout), dict)
                self.assertNotRegex(result.stdout + result.stderr, "[\x1b\r]")

    def test_text_where_nobody_looks(self):
        for verb, listed in WORK.items():
            with self.subTest(verb=verb):
                result = self.must(verb, *self.words(listed))
                self.assertNotRegex(result.stdout + result.stderr, "[\x1b\r]")

    def test_terminal_without_color(self):
        for verb, listed in WORK.items():
            with self.subTest(verb=verb):
                text, status = self.in_terminal(verb, *self.words(listed), NO_COLOR="1")
                self.assertEqual(status, 0, text)
                self.assertNotRegex(text, COLOR)
                self.assertNotRegex(self.in_terminal(verb, *self.words(listed), TERM="dumb")[0] if verb != "report" else "",
                                    COLOR)

    def test_terminal_with_color(self):
        self.assertRegex(self.in_terminal("doctor")[0], COLOR)
        self.assertRegex(self.in_terminal("doctor", NO_COLOR="")[0], COLOR)

    def test_wrong_option(self):
        for verb in self.verbs():
            for wrong in ["--no-such-thing"], ["-x"], ["--json=perhaps"] if verb != "replay" else ["--json"]:
                with self.subTest(verb=verb, wrong=wrong):
                    result = self.must(verb, *self.words(WORK[verb]), *wrong, status=2)
                    self.assertEqual(result.stdout, "")
                    self.assertTrue(result.stderr.startswith(f"pursuit {verb}: "), result.stderr)
                    self.assertTrue(result.stderr.endswith(f"Try `pursuit {verb} --help`.\n"), result.stderr)

    def test_failure(self):
        for verb, listed in FAILS.items():
            with self.subTest(verb=verb):
                result = self.must(verb, *self.words(listed), status=1)
                self.assertRegex(result.stderr, rf"(?m)^pursuit {verb}: ")
                self.assertEqual(result.stdout, "")

    def test_full_disk(self):
        """What could not be written is not done."""
        for verb, listed in WORK.items():
            with self.subTest(verb=verb), open("/dev/full", "w") as full:
                words = [verb, *self.words(listed), *JSON.get(verb, ["--json"])]
                with subprocess.Popen([common.PURSUIT, *words], stdout=full, stderr=subprocess.PIPE, text=True) as process:
                    errors = common.finish(process)[1]
                result = subprocess.CompletedProcess(words, process.returncode, None, errors)
                self.check_unwritten(f"pursuit {verb}", result, "No space left on device")

    def check_unwritten(self, program, result, reason):
        """One sentence, whatever else was said, and the last."""
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stderr.count("cannot be written"), 1, result.stderr)
        self.assertTrue(result.stderr.endswith(f"{program}: standard output cannot be written: {reason}\n"), result.stderr)

    def test_json_of_replay_on_a_full_disk(self):
        words = ["replay", *self.words(WORK["replay"]), "--json"]
        with open("/dev/full", "w") as full:
            result = subprocess.run([common.PURSUIT, *words, "-"], stdout=full, stderr=subprocess.PIPE, text=True,
                                    timeout=600)
            self.check_unwritten("pursuit replay", result, "No space left on device")
        result = self.must(*words, "/dev/full", status=1)
        self.assertRegex(result.stderr, r"(?m)^pursuit replay: /dev/full: not written whole: No space left on device$")

    def test_no_standard_output(self):
        """What is opened does not take its place."""
        for verb in "record", "status", "replay":
            words = [common.PURSUIT, verb, *self.words(WORK[verb])]
            with self.subTest(verb=verb):
                result = subprocess.run(["sh", "-c", 'exec "$@" >&-', "sh", *words], stderr=subprocess.PIPE, text=True,
                                    timeout=600)
                self.check_unwritten(f"pursuit {verb}", result, "Bad file descriptor")
        for program in [common.PURSUIT, "--version"], [PURSUITD, "--version"]:
            result = subprocess.run(["sh", "-c", 'exec "$@" >&- 2>&-', "sh", *program], check=False)
            self.assertEqual(result.returncode, 1)

    def test_texts_on_a_full_disk(self):
        for program in [common.PURSUIT, "--help"], [common.PURSUIT, "--version"], [common.PURSUIT, "record", "--help"], \
                [PURSUITD, "--help"], [PURSUITD, "--version"], [PURSUITD, "--print-config"]:
            with self.subTest(program=program), open("/dev/full", "w") as full:
                result = subprocess.run(program, stdout=full, stderr=subprocess.PIPE, text=True, timeout=600)
                self.assertEqual(result.returncode, 1)
                self.assertRegex(result.stderr, r"^pursuit[a-z ]*: standard output cannot be written: No space left on device\n$")


if __name__ == "__main__":
    common.main()
