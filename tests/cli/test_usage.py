# SPDX-License-Identifier: MIT
"""Help, exit statuses and the sentences of a wrong command line."""
import os
import re

import common

VERBS = ["demo", "record", "replay", "report", "import", "export", "status", "latency", "top", "get", "set"]


class Usage(common.Case):
    def test_help_names_every_verb(self):
        text = self.must("--help").stdout
        for verb in VERBS:
            self.assertRegex(text, rf"(?m)^  {verb} ")

    def test_every_verb_teaches(self):
        for verb in VERBS:
            text = self.must(verb, "--help").stdout
            self.assertIn(f"usage: pursuit {verb}", text)
            self.assertIn("examples", text)
            self.assertLessEqual(max(map(len, text.splitlines())), 140, verb)

    def test_version(self):
        self.assertRegex(self.must("--version").stdout, r"^pursuit \d+\.\d+\.\d+\n$")

    def test_nothing_at_all_is_wrong(self):
        self.assertIn("usage", self.must(status=2).stderr)

    def test_unknown_verb_gets_the_nearest(self):
        self.assertIn("did you mean replay?", self.must("repaly", status=2).stderr)
        self.assertNotIn("did you mean", self.must("xxxxxxxxxxxx", status=2).stderr)

    def test_unknown_option_gets_the_nearest(self):
        self.assertIn("did you mean --fail-under?", self.must("replay", "x", "--fail-undr", "3", status=2).stderr)
        self.assertIn("did you mean --method?", self.must("replay", "x", "--mehtod=grid", status=2).stderr)

    def test_wrong_values_are_named(self):
        for arguments, words in [
            (["record", "x", "--scene", "still", "--size", "640"], "--size is 640, must be WIDTHxHEIGHT"),
            (["record", "x", "--scene", "still", "--size", "0x9"], "--size is 0x9"),
            (["record", "x", "--scene", "still", "--fps", "0"], "--fps is 0"),
            (["record", "x", "--scene", "still", "--motion", "up"], "one of backward, forward"),
            (["record", "x", "--scene", "stil"], "there is no scene stil; there are"),
            (["record"], "an argument is missing"),
            (["record", "x", "y"], "y is one argument too many"),
            (["replay", "x", "--every", "0"], "a whole number from 1 to 64"),
            (["export", "x", "--color", "c_%d.jpg"], "--color: pattern 'c_%d.jpg': must end in .png"),
            (["export", "x", "--depth", "d_%d.exr"], "--depth: pattern 'd_%d.exr': must end in .pfm"),
            (["replay", "x", "--write-frames", "f_%d"], "must end in .png"),
            (["replay", "x", "--every"], "--every needs a value"),
            (["replay", "x", "--predict=1"], "--predict takes no value"),
            (["replay", "x", "--level", "5"], "level: 5 is above 4"),
            (["replay", "x", "--every", "2", "--predict"], "use one"),
            (["replay", "x", "--fail-under", "psnr"], "--fail-under is psnr"),
            (["replay", "x", "--write-frames", "f.png"], "--write-frames"),
            (["replay", "x", "--expect-tolerance", "2"], "goes with --expect"),
            (["replay", "x", "--expect", "y", "--expect-tolerance", "2x"], "such as 2 or 45dB"),
            (["replay", "x", "--method", "girl"], "girl"),
            (["replay", "x", "--cell", "3"], "cell"),
            (["demo", "--scene", "nowhere"], "there is no scene nowhere"),
            (["demo", "--seconds", "-1"], "--seconds is -1"),
            (["latency", "--loopback", "GPIO17"], "--loopback is GPIO17, must be OUT:IN"),
            (["set"], "an argument is missing"),
            (["set", "blur"], "blur is not of the form NAME=VALUE"),
        ]:
            result = self.must(*arguments, status=2)
            self.assertIn(words, result.stderr, arguments)
            self.assertRegex(result.stderr, re.escape(f"`pursuit {arguments[0]} --help`"), arguments)

    def test_no_daemon_is_said_plainly(self):
        environment = {**os.environ, "PURSUIT_SOCKET": self.path("none")}
        result = self.must("status", status=1, env=environment)
        self.assertIn(self.path("none"), result.stderr)
        self.assertIn("pursuitd", result.stderr)
        result = self.must("record", self.path("x.pursuit"), status=1, env=environment)
        self.assertIn("--scene", result.stderr)
        self.assertFalse(os.path.exists(self.path("x.pursuit")))


if __name__ == "__main__":
    common.main()
