# SPDX-License-Identifier: MIT
"""The demo end to end, tiny and short; nothing here depends on how fast this machine is."""
import json
import os
import re
import signal
import struct
import subprocess
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
        self.gave_way = False

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

        def shown():
            self.see_it_give_way(demo.pid)
            status = self.socket() and common.run("status", "--json", "--socket", self.socket()).stdout
            return status and json.loads(status)["real_frames"] > 20

        if not common.soon(shown, patience=5 * common.PATIENCE):
            demo.kill()
            self.fail(f"no frame of the demo is shown: {demo.communicate()}")
        self.see_it_give_way(demo.pid)
        return demo

    def see_it_give_way(self, pid):
        if os.getpriority(os.PRIO_PROCESS, pid) == 19:
            self.gave_way = True
            common.hurry(pid)

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
        said = " ".join(filter(None, (text.text for text in root.iter("{http://www.w3.org/2000/svg}text"))))
        vblanks = int(re.search(r"counted over the last (\d+) vblanks", said)[1])
        self.assertGreater(vblanks, 0)
        self.assertGreater(len(root.findall("{http://www.w3.org/2000/svg}rect")), min(vblanks, 600))
        return report

    def until_scored(self, attempt):
        """
        What `attempt` gives, a demo's output and what it said of errors. Where the daemon is kept from running all in-betweens
        of a second may be late, and the demo says that there is nothing to score.
        """
        for _ in range(10):
            output, errors = attempt()
            if "nothing is scored" not in errors:
                return output
        self.fail("nothing is scored in ten demos: " + errors)

    def test_two_seconds(self):
        def attempt():
            result = self.demo("--seconds", "2", "--method", "grid", "--cell", "16")
            return result.stdout, result.stderr

        self.assertIn("Hz displayed for", self.until_scored(attempt))
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
        def attempt():
            demo = self.start("--seconds", "3000")
            nices = [os.getpriority(os.PRIO_PROCESS, child) for child in children(demo.pid)]
            self.assertEqual(len(nices), 2, "the daemon and who scores")
            self.assertLessEqual(max(nices), os.getpriority(os.PRIO_PROCESS, 0))
            self.assertTrue(self.gave_way)
            demo.send_signal(signal.SIGINT)
            output, errors = common.finish(demo)
            self.assertEqual(demo.returncode, 0, output + errors)
            return output, errors

        self.until_scored(attempt)
        self.check_results()
        self.assert_nothing_left()

    def test_daemon_that_dies_is_a_failure(self):
        demo = self.start("--seconds", "3000")
        for child in children(demo.pid):
            os.kill(child, signal.SIGKILL)
        _, errors = common.finish(demo)
        self.assertEqual(demo.returncode, 1)
        self.assertIn("pursuitd", errors)
        self.assert_nothing_left()

    def test_killed_demo_leaves_no_daemon(self):
        demo = self.start("--seconds", "3000")
        daemons = children(demo.pid)
        self.assertTrue(daemons)
        demo.kill()
        demo.communicate()
        if common.soon(lambda: not any(os.path.exists(f"/proc/{pid}") for pid in daemons)):
            return
        for pid in daemons:
            os.kill(pid, signal.SIGKILL)
        self.fail("the daemon outlived the demo")

    def test_unwritable_folder(self):
        result = common.run("demo", "--size", "64x36", "--out", self.path("no/where"), env=self.environment)
        self.assertEqual(result.returncode, 1)
        self.assertIn("no/where", result.stderr)

    def record_twice(self, socket):
        """Who is told that a recording runs has not cut off what it holds."""
        arguments = ["record", self.path("twice.pursuit"), "--seconds", "3000", "--socket", socket]
        first = subprocess.Popen([common.PURSUIT, *arguments], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

        def recorded():
            status = json.loads(self.must("status", "--json", "--socket", socket).stdout)
            return status.get("recording", {}).get("frames", 0) > 2

        self.assertTrue(common.soon(recorded))
        self.assertIn("already", self.must(*arguments, status=1).stderr)
        first.send_signal(signal.SIGINT)
        common.finish(first)
        self.assertEqual(first.returncode, 0)
        self.assertGreater(self.figures("replay", self.path("twice.pursuit"), "--method", "hold")["real_frames"], 2)

    def test_record_and_status_of_a_running_daemon(self):
        demo = self.start("--seconds", "3000")
        socket = self.socket()

        def record():
            self.must("record", self.path("live.pursuit"), "--seconds", "1", "--socket", socket)
            return common.run("replay", self.path("live.pursuit"), "--method", "hold").returncode == 0

        try:
            self.assertTrue(common.soon(record))
            status = json.loads(self.must("status", "--json", "--socket", socket).stdout)
            self.assertGreater(status["real_frames"], 0)
            self.assertIn("displayed_hz", self.must("status", "--socket", socket).stdout)
            self.record_twice(socket)
        finally:
            demo.send_signal(signal.SIGINT)
            common.finish(demo)
        self.assertGreater(self.figures("replay", self.path("live.pursuit"), "--method", "hold")["real_frames"], 0)


if __name__ == "__main__":
    common.main()
