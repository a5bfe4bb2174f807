# SPDX-License-Identifier: MIT
"""pursuit check-stream: each planted mistake is found, and no other; good streams raise no alarm."""
import json
import os
import subprocess
import unittest

import common

PLANT = os.environ.get("PLANT_MISTAKE", "")

# those that move
SCENES = ["colonnade", "tower", "fan", "trees", "creature", "rings", "hud"]

FOUND = {
    "sign": "motion-sign",
    "x-sign": "motion-x-sign",
    "y-sign": "motion-y-sign",
    "swapped": "motion-swapped",
    "half": "motion-scale",
    "twice": "motion-scale",
    "ndc": "motion-unit",
    "uv": "motion-unit",
    "zero": "motion-zero",
    "nan": "motion-invalid",
    "frozen-motion": "motion-frozen",
    "depth-reversed": "depth-direction",
    "depth-range": "depth-range",
    "depth-constant": "depth-constant",
    "frozen-depth": "depth-frozen",
    "frozen-color": "color-frozen",
    "jitter-motion": "jitter-in-motion",
    "jitter-motion-declared": "jitter-in-motion",
    "jitter-picture": "jitter-in-picture",
    "jitter-picture-declared": "jitter-in-picture",
    "interval": "interval",
    "time-order": "time-order",
}
WARNINGS = {"nan", "depth-constant", "frozen-depth", "frozen-color"}


class CheckStream(common.Case):
    def codes(self, path, status):
        result = self.must("check-stream", path, "--json", status=status)
        return [finding["code"] for finding in json.loads(result.stdout)["findings"]]

    def plant(self, kind, path):
        planted = self.path(kind + "-planted.pursuit")
        subprocess.run([PLANT, kind, path, planted], check=True, timeout=240)
        return planted

    def test_good_streams(self):
        for scene in SCENES:
            motion = "forward" if scene in ("fan", "hud") else "backward"
            path = self.record("good.pursuit", scene=scene, size="240x135", fps=60, seconds=0.25, motion=motion)
            with self.subTest(scene=scene, motion=motion):
                self.assertEqual(self.codes(path, 0), [])

    def test_good_coarse_streams(self):
        """Fine things in few pixels, and long steps: what motion leaves over is no mistake."""
        for scene, fps in ("rings", 30), ("rings", 15), ("fan", 15), ("trees", 30):
            path = self.record("good.pursuit", scene=scene, size="160x90", fps=fps, seconds=0.6)
            with self.subTest(scene=scene, fps=fps):
                self.assertEqual(self.codes(path, 0), [])

    def test_mistakes_that_hide(self):
        """Much that no motion explains, motion along one axis, slow motion: small differences in every pair count."""
        for scene, kind in ("trees", "y-sign"), ("fan", "half"), ("tower", "half"), ("tower", "ndc"):
            path = self.record("good.pursuit", scene=scene, size="480x270", fps=30, seconds=0.6)
            with self.subTest(scene=scene, kind=kind):
                self.assertEqual(self.codes(path, 0), [])
                self.assertEqual(self.codes(self.plant(kind, path), 1), [FOUND[kind]])

    def test_still(self):
        path = self.record("still.pursuit", scene="still", size="96x54", fps=60, seconds=0.2)
        self.assertNotIn("mistake", self.must("check-stream", path).stdout.replace("no mistake", ""))

    def test_planted(self):
        path = self.record("good.pursuit", scene="rings", size="480x270", fps=60, seconds=0.3)
        for kind, code in FOUND.items():
            with self.subTest(kind=kind):
                self.assertEqual(self.codes(self.plant(kind, path), 0 if kind in WARNINGS else 1), [code])

    def test_planted_into_forward_motion(self):
        path = self.record("good.pursuit", scene="colonnade", size="320x180", fps=60, seconds=0.25, motion="forward")
        for kind in "sign", "ndc", "jitter-picture":
            with self.subTest(kind=kind):
                self.assertEqual(self.codes(self.plant(kind, path), 1), [FOUND[kind]])

    def test_other_kind(self):
        """Motion of the other kind differs from the declared one only by its change: visible at low rates."""
        path = self.record("good.pursuit", scene="creature", size="320x180", fps=15, seconds=1, motion_format="f32")
        self.assertEqual(self.codes(path, 0), [])
        self.assertEqual(self.codes(self.plant("kind", path), 1), ["motion-kind"])

    def test_text(self):
        path = self.record("good.pursuit", scene="colonnade", size="240x135", fps=60, seconds=0.2)
        text = self.must("check-stream", self.plant("sign", path), status=1).stdout
        self.assertIn("mistake: motion-sign", text)
        self.assertIn("-> backward motion is position now minus position before", text)
        self.assertIn("no mistake found", self.must("check-stream", path).stdout)

    def test_bad_input(self):
        with open(self.path("text"), "w", encoding="utf-8") as out:
            out.write("no recording\n" * 100)
        self.assertIn("text", self.must("check-stream", self.path("text"), status=1).stderr)
        self.assertIn("there is no file", self.must("check-stream", self.path("none"), status=1).stderr.replace(
            "No such file", "there is no file"))
        none = self.must("check-stream", "--socket", self.path("none"), status=1).stderr
        self.assertRegex(none, r"^pursuit check-stream: no daemon at .*none")
        self.assertNotIn("pursuit record", none)
        self.must("check-stream", "a", "b", status=2)
        one = self.record("one.pursuit", scene="still", size="16x16", fps=60, seconds=0.01)
        self.assertIn("at least two", self.must("check-stream", one, status=1).stderr)


if __name__ == "__main__":
    common.main()
