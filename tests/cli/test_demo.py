# SPDX-License-Identifier: MIT
"""The demo end to end, tiny and short; nothing here depends on how fast this machine is."""
import json
import os
import signal
import struct
import subprocess
import time
import xml.etree.ElementTree

import common

FIGURES = ["real_frames", "in_between_frames", "displayed_frames", "displayed_hz", "late_in_betweens",
           "lost_real_frames", "engine_ms", "submit_to_flip_ms", "passes", "left_out", "quality", "client", "settings",
           "method", "renderer", "scene", "width", "height"]


def children(pid):
    try:
        with open(f"/proc/{pid}/task/{pid}/children") as file:
            return [int(child) for child in file.read().split()]
    except FileNotFoundError:
        return []


class Demo(common.Case):
    def setUp(self):
        super().setUp()
        self.environment = {**os.environ, "TMPDIR": self.folder}

    def demo(self, *arguments, status=0):
        return self.must("demo", "--size", "64x36", "--out", self.path("out"), *arguments, status=status,
                         env=self.environment)

    def socket(self):
        """Of the daemon of the demo that runs; None before it is there."""
        paths = [self.path(name + "/socket") for name in os.listdir(self.folder) if name.startswith("pursuit-")]
        return next(filter(os.path.exists, paths), None)

    def start(self, *arguments):
        """A demo that runs, as soon as frames of it are shown."""
        demo = subprocess.Popen([common.PURSUIT, "demo", "--size", "64x36", "--out", self.path("out"), *arguments],
                                env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(600):
            status = self.socket() and common.run("status", "--json", "--socket", self.socket()).stdout
            if status and json.loads(status)["real_frames"] > 20:
                return demo
            time.sleep(0.1)
        demo.kill()
        self.fail("no frame of the demo is shown")

    def assert_nothing_left(self):
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("pursuit-")], [])

    def check_results(self):
        with open(self.path("out/report.json")) as file:
            report = json.load(file)
        for name in FIGURES:
            self.assertIn(name, report)
        self.assertGreater(report["displayed_frames"], 0)
        with open(self.path("out/contact.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
            width, height = struct.unpack(">8xII", file.read(16))
        self.assertGreater(width, 4 * 320)
        self.assertGreater(height, 180)
        root = xml.etree.ElementTree.parse(self.path("out/timeline.svg")).getroot()
        self.assertGreater(len(root.findall("{http://www.w3.org/2000/svg}rect")), 20)
        return report

    def test_two_seconds(self):
        result = self.demo("--seconds", "2", "--method", "grid", "--cell", "16")
        self.assertIn("Hz displayed for", result.stdout)
        report = self.check_results()
        self.assertEqual((report["method"], report["settings"]["cell"]), ("grid", "16"))
        self.assertGreater(report["quality"]["frames"], 0)
        self.assertGreater(report["quality"]["psnr"], 15)
        self.assert_nothing_left()
        common.run("replay", self.path("out/burst.pursuit"), "--method", "hold").check_returncode()

    def test_json(self):
        report = json.loads(self.demo("--seconds", "1", "--fps", "40", "--refresh", "90", "--json").stdout)
        self.assertEqual((report["fps"], report["refresh"]), (40, 90))

    def test_each_method_is_known_before_it_starts(self):
        for option, value, wrong in (("--method", "sharp", "sharp"), ("--methods", "hold,sharp,grid", "sharp"), ("--methods", "hold,", "")):
            result = common.run("demo", option, value, "--seconds", "1", "--out", self.path("out"))
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertRegex(result.stderr, f'"{wrong}" is none of hold, |{option} is {wrong}, must be one of hold, ')
            self.assertFalse(os.path.exists(self.path("out")))

    def test_interrupt_still_reports(self):
        demo = self.start("--seconds", "600")
        nices = [os.getpriority(os.PRIO_PROCESS, child) for child in children(demo.pid)]
        self.assertEqual(len(nices), 2, "the daemon and who scores")
        self.assertLessEqual(max(nices), os.getpriority(os.PRIO_PROCESS, 0))
        self.assertEqual(os.getpriority(os.PRIO_PROCESS, demo.pid), 19)
        demo.send_signal(signal.SIGINT)
        output, errors = demo.communicate(timeout=120)
        self.assertEqual(demo.returncode, 0, output + errors)
        self.check_results()
        self.assert_nothing_left()

    def test_daemon_that_dies_is_a_failure(self):
        demo = self.start("--seconds", "600")
        for child in children(demo.pid):
            os.kill(child, signal.SIGKILL)
        _, errors = demo.communicate(timeout=120)
        self.assertEqual(demo.returncode, 1)
        self.assertIn("pursuitd", errors)
        self.assert_nothing_left()

    def test_killed_demo_leaves_no_daemon(self):
        demo = self.start("--seconds", "600")
        daemons = children(demo.pid)
        self.assertTrue(daemons)
        demo.kill()
        demo.communicate()
        for _ in range(200):
            if not any(os.path.exists(f"/proc/{pid}") for pid in daemons):
                return
            time.sleep(0.05)
        for pid in daemons:
            os.kill(pid, signal.SIGKILL)
        self.fail("the daemon outlived the demo")

    def test_unwritable_folder(self):
        result = common.run("demo", "--size", "64x36", "--out", self.path("no/where"), env=self.environment)
        self.assertEqual(result.returncode, 1)
        self.assertIn("no/where", result.stderr)

    def record_twice(self, socket):
        """Who is told that a recording runs has not cut off what it holds."""
        arguments = ["record", self.path("twice.pursuit"), "--seconds", "600", "--socket", socket]
        first = subprocess.Popen([common.PURSUIT, *arguments], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for _ in range(600):
            if json.loads(self.must("status", "--json", "--socket", socket).stdout).get("recording", {}).get("frames", 0) > 2:
                break
            time.sleep(0.1)
        self.assertIn("already", self.must(*arguments, status=1).stderr)
        first.send_signal(signal.SIGINT)
        first.communicate(timeout=120)
        self.assertEqual(first.returncode, 0)
        self.assertGreater(self.figures("replay", self.path("twice.pursuit"), "--method", "hold")["real_frames"], 2)

    def test_record_and_status_of_a_running_daemon(self):
        demo = self.start("--seconds", "600")
        socket = self.socket()
        try:
            self.must("record", self.path("live.pursuit"), "--seconds", "1", "--socket", socket)
            status = json.loads(self.must("status", "--json", "--socket", socket).stdout)
            self.assertGreater(status["real_frames"], 0)
            self.assertIn("displayed_hz", self.must("status", "--socket", socket).stdout)
            self.record_twice(socket)
        finally:
            demo.send_signal(signal.SIGINT)
            demo.communicate(timeout=120)
        self.assertGreater(self.figures("replay", self.path("live.pursuit"), "--method", "hold")["real_frames"], 0)


if __name__ == "__main__":
    common.main()
