# SPDX-License-Identifier: MIT
"""What others could write from docs/protocol.md and docs/recording.md alone: a client and a reader, in Python."""
import json
import os
import re
import signal
import struct
import subprocess
import sys
import threading
import unittest

import common
import recording

HALF, FLOAT, DEPTH = 32, 33, 18


def read_pfm(path):
    """Rows from top to bottom, each a list of floats."""
    with open(path, "rb") as file:
        kind, size, scale = file.readline().strip(), file.readline().split(), float(file.readline())
        width, height, channels = int(size[0]), int(size[1]), 3 if kind == b"PF" else 1
        assert scale < 0
        rows = [struct.unpack(f"<{width * channels}f", file.read(4 * width * channels)) for _ in range(height)]
    return rows[::-1]


@unittest.skipUnless(recording.ZSTD and recording.XXHASH, "no libzstd or no libxxhash to load")
class ReadRecordings(common.Case):
    def test_frames(self):
        """The planes are those that `pursuit export` writes."""
        path = self.record("walk.pursuit", size="40x22")
        read = recording.Recording(path)
        self.assertEqual((read.version, read.cut, read.lost), (1, False, 0))
        self.assertEqual((read.info["scene"], read.info["fps"]), ("colonnade", "120/1"))
        self.assertEqual((len(read.frames), read.end["frames"]), (30, "30"))
        self.must("export", path, "--depth", self.path("d_%02d.pfm"), "--motion", self.path("m_%02d.pfm"))
        for i in (0, 7, 29):
            frame = read.frames[i]
            width, height, code, rows = frame.planes["depth"]
            self.assertEqual((width, height, code), (40, 22, DEPTH))
            depth = [struct.unpack_from("<40f", rows, 160 * y) for y in range(22)]
            self.assertEqual(depth, read_pfm(self.path(f"d_{i:02d}.pfm")))
            _, _, code, rows = frame.planes["motion"]
            letter = {HALF: "e", FLOAT: "f"}[code]
            numbers = struct.unpack(f"<{2 * 40 * 22}{letter}", rows)
            exported = [row for rows in read_pfm(self.path(f"m_{i:02d}.pfm")) for row in rows]
            self.assertEqual(numbers[0::2], tuple(exported[0::3]))
            self.assertEqual(numbers[1::2], tuple(exported[1::3]))
            self.assertEqual(len(frame.planes["color"][3]), 40 * 22 * 4)
        for before, after in zip(read.frames, read.frames[1:]):
            self.assertEqual(after.frame_id, before.frame_id + 1)
            self.assertAlmostEqual(after.time_ns - before.time_ns, 1e9 / 120, delta=1)

    def test_damage(self):
        """Cut off, or with a byte changed: what is whole is read."""
        path = self.record("walk.pursuit", size="40x22")
        with open(path, "rb") as file:
            data = bytearray(file.read())
        with open(self.path("cut.pursuit"), "wb") as file:
            file.write(data[:len(data) * 2 // 3])
        cut = recording.Recording(self.path("cut.pursuit"))
        self.assertTrue(cut.cut and cut.end is None and 15 <= len(cut.frames) < 30)
        data[len(data) // 2] ^= 0x10
        with open(self.path("changed.pursuit"), "wb") as file:
            file.write(data)
        changed = recording.Recording(self.path("changed.pursuit"))
        self.assertEqual((changed.lost, len(changed.frames), changed.end["frames"]), (1, 29, "30"))


@unittest.skipUnless(recording.library("atomic"), "no libatomic to load")
class PythonClient(common.Case):
    def setUp(self):
        super().setUp()
        self.environment = {**os.environ, "PURSUIT_SOCKET": self.path("socket")}
        self.daemon = None

    def tearDown(self):
        if self.daemon:
            self.daemon.send_signal(signal.SIGTERM)
            self.daemon.wait(2 * common.PATIENCE)
        super().tearDown()

    def start(self):
        self.daemon = common.started(
            subprocess.Popen([os.environ["PURSUITD"], "--present", "headless", "--refresh", "60"], env=self.environment,
                             stderr=subprocess.DEVNULL), self.path("socket"))

    def client(self, *arguments):
        return subprocess.Popen([sys.executable, os.environ["PYTHON_CLIENT"], *arguments], env=self.environment, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def test_frames_are_shown(self):
        self.start()
        for seconds in 4, 40, 120:  # where others have the processors, few frames come of many seconds
            client = self.client("--seconds", str(seconds), "--fps", "20")
            output, error = client.communicate(timeout=600)
            self.assertEqual(client.returncode, 0, error)
            shown = re.findall(r"frame (\d+): shown ([\d.]+) ms after its submit, (\d+) vblanks, (\d+) in-betweens", output)
            in_betweens = sum(int(one[3]) for one in shown)
            if len(shown) > 20 and in_betweens > 10:
                break
        self.assertIn("attached to pursuitd", output)
        self.assertIn("display: 60.00 Hz", output)
        self.assertGreater(len(shown), 20)
        self.assertGreater(in_betweens, 10)
        ids = [int(one) for one in re.findall(r"^frame (\d+)", output, re.M)]
        self.assertEqual(ids, sorted(set(ids)))
        self.assertNotIn("refused", output)
        status = json.loads(common.run("status", "--json", env=self.environment).stdout)
        self.assertEqual(status["refused_frames"], 0)

    def test_its_motion_is_right(self):
        """check-stream compares motion with what the picture does."""
        self.start()
        client = self.client("--seconds", "3000", "--fps", "20")
        reader = threading.Thread(target=client.communicate)  # or the client would wait for somebody who reads
        reader.start()
        try:
            self.wait_for_frames(5, env=self.environment)
            for seconds in 3, 20, 100:  # where others have the processors, few frames come of many seconds
                found = common.run("check-stream", "--seconds", str(seconds), "--json", env=self.environment)
                report = json.loads(found.stdout or '{"pairs": 0}')
                if report["pairs"] > 5:
                    break
        finally:
            client.terminate()
            reader.join()
        self.assertGreater(report["pairs"], 5, found.stdout + found.stderr)
        mistakes = [one for one in report["findings"] if one["code"].startswith(("motion", "depth", "jitter", "no-"))]
        self.assertEqual(mistakes, [], found.stdout + found.stderr)

    def test_without_a_daemon(self):
        client = self.client("--seconds", "1")
        _, error = client.communicate(timeout=600)
        self.assertEqual(client.returncode, 1)
        self.assertIn("no daemon answers", error)


class Guide(unittest.TestCase):
    def test_lines_that_each_step_adds(self):
        """As docs/integration.md says them."""
        examples = os.path.dirname(os.environ["PYTHON_CLIENT"])
        with open(os.path.join(examples, "../../docs/integration.md"), encoding="utf-8") as page:
            text = page.read()
        said = [int(number) for number in re.findall(r"^\| [1-4] \| .* \| (\d+) \|$", text, re.M)]
        added = []
        for step in range(4):
            steps = [os.path.join(examples, f"integration/step-{step + i}.c") for i in (0, 1)]
            difference = subprocess.run(["diff", *steps], capture_output=True, text=True).stdout
            added.append(len(re.findall("^>", difference, re.M)))
        self.assertEqual(said, added)
        self.assertIn(f"\n{sum(added)} lines in all", text)


if __name__ == "__main__":
    common.main()
