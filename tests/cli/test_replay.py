# SPDX-License-Identifier: MIT
"""Record and replay: scores, determinism, expectations, damage."""
import json
import os
import re
import resource

import common


class Record(common.Case):
    def test_formats(self):
        for options in [
            {"motion": "forward"},
            {"color_format": "rgba8", "depth_format": "unorm24", "motion_format": "f32"},
            {"color_format": "rgb10a2", "depth_format": "unorm16"},
            {"color_format": "rgba16f"},
            {"scene": "hud"},
            {"size": "1x1"},
            {"size": "67x35", "fps": "60000/1001"},
        ]:
            path = self.record("x.pursuit", seconds=0.1, **options)
            figures = self.figures("replay", path, "--every", "2", "--method", "grid")
            self.assertGreater(figures["real_frames"], 2, options)
            self.assertGreater(figures["quality"]["psnr"], 15, options)

    def test_colour_formats_show_the_same(self):
        """Ten bits and linear halves hold 8-bit codes, so the pictures are equal but for their rounding."""
        self.record("a.pursuit", seconds=0.05)
        self.must("replay", self.path("a.pursuit"), "--method", "hold", "--write-frames", self.path("a_%03d.png"))
        for name in ["rgba8", "rgb10a2", "rgba16f"]:
            path = self.record("b.pursuit", seconds=0.05, color_format=name)
            self.must("replay", path, "--method", "hold", "--expect", self.path("a_%03d.png"), "--expect-tolerance", "1")

    def test_full_disk(self):
        limit = 200_000
        result = self.must("record", self.path("x.pursuit"), "--scene", "colonnade", "--size", "128x72", status=1,
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.assertIn("x.pursuit", result.stderr)
        self.assertIn("frames written", result.stderr)
        self.assertGreaterEqual(self.figures("replay", self.path("x.pursuit"), "--method", "hold")["real_frames"], 1)

    def test_unwritable(self):
        self.assertIn("nowhere", self.must("record", self.path("nowhere/x"), "--scene", "still", status=1).stderr)


class Replay(common.Case):
    def psnr(self, path, method, *more):
        return self.figures("replay", path, "--method", method, *more)["quality"]["psnr"]

    def test_grid_is_better_than_hold(self):
        for motion in ["backward", "forward"]:
            path = self.record("x.pursuit", size="160x90", seconds=0.4, motion=motion)
            for every in [2, 3]:
                hold, grid = (self.psnr(path, method, "--every", every) for method in ("hold", "grid"))
                self.assertGreater(grid, hold + 0.5, (motion, every))
            self.assertGreater(self.psnr(path, "grid", "--predict"), self.psnr(path, "hold", "--predict") + 0.5)

    def test_composed_motion_is_worth_more_than_none(self):
        """Over five frames the composed motion must still lead to the right place."""
        path = self.record("x.pursuit", size="160x90", seconds=0.5)
        self.assertGreater(self.psnr(path, "grid", "--every", 5), self.psnr(path, "hold", "--every", 5) + 1.5)

    def test_still_is_identical(self):
        path = self.record("x.pursuit", scene="still")
        quality = self.figures("replay", path, "--every", "2")["quality"]
        self.assertEqual((quality["psnr"], quality["ssim"]), (100, 1))

    def test_figures(self):
        path = self.record("x.pursuit", fps=60, seconds=0.5)
        figures = self.figures("replay", path, "--refresh", "120", "--method", "grid")
        self.assertEqual(figures["real_frames"], 30)
        self.assertEqual(figures["in_between_frames"], 30)
        self.assertEqual(figures["displayed_frames"], 60)
        self.assertAlmostEqual(figures["displayed_hz"], 120, places=3)
        self.assertEqual((figures["late_in_betweens"], figures["lost_real_frames"]), (0, 0))
        self.assertGreaterEqual(figures["engine_ms"]["p99"], figures["engine_ms"]["p50"])
        self.assertGreater(figures["engine_ms"]["p50"], 0)
        self.assertEqual(figures["passes"]["upload"], 30)
        self.assertEqual(figures["left_out"]["ui"], 30)
        self.assertEqual(figures["quality"], {"psnr": None, "ssim": None, "psnr_min": None, "frames": 0})
        self.assertEqual((figures["method"], figures["settings"]["cell"]), ("grid", "8"))
        self.assertEqual(len(figures["frames"]), 30)
        self.assertEqual([shown["show"] for shown in figures["frames"][3]["displayed"]], ["real", "in-between"])
        self.assertEqual(figures["frames"][3]["plan"]["width"], 64)

    def test_summary_names_the_figures(self):
        path = self.record("x.pursuit")
        self.assertRegex(self.must("replay", path, "--every", "2").stdout, r"PSNR \d+\.\d\d dB")

    def test_settings_reach_the_engine(self):
        path = self.record("x.pursuit")
        figures = self.figures("replay", path, "--every", "2", "--method", "grid", "--cell", "16", "--blur", "off")
        self.assertEqual(figures["frames"][3]["plan"]["cell"], 16)
        self.assertEqual(figures["frames"][3]["left_out"]["blur"], "off")

    def test_two_replays_are_equal(self):
        path = self.record("x.pursuit", size="160x90")
        for method in ["hold", "grid", "pursuit"]:
            for name in ["a", "b"]:
                self.must("replay", path, "--every", "2", "--method", method, "--write-expect", self.path(name))
            with open(self.path("a")) as a, open(self.path("b")) as b:
                text = a.read()
                self.assertEqual(text, b.read(), method)
            self.assertRegex(text, r"(?s)^# pursuit expect 1\n# renderer .*# version .*# size 160x90\n0 [0-9a-f]{16}\n")

    def test_expectation(self):
        path = self.record("x.pursuit")
        hashes = self.path("hashes")
        self.must("replay", path, "--every", "2", "--write-expect", hashes)
        self.must("replay", path, "--every", "2", "--expect", hashes)
        self.assertIn("displayed frame 1 differs",
                      self.must("replay", path, "--every", "2", "--method", "hold", "--expect", hashes, status=1).stderr)
        with open(hashes) as file:
            text = file.read()
        changed = re.sub(r"(?m)^7 .", lambda match: "7 " + ("1" if match[0][-1] == "0" else "0"), text)
        for name, content, words in [
            ("changed", changed, "displayed frame 7 differs"),
            ("short", "".join(text.splitlines(True)[:-1]), "is not expected"),
            ("long", text + "999 0123456789abcdef\n", "1 expected frames were not displayed"),
            ("foreign", changed.replace("# renderer ", "# renderer other "), "made by another renderer"),
        ]:
            with open(self.path(name), "w") as file:
                file.write(content)
            result = self.must("replay", path, "--every", "2", "--expect", self.path(name), status=1)
            self.assertIn(words, result.stderr)
        for name, content, words in [("bad", "hello\n", "not `# pursuit expect 1`"),
                                     ("line", text + "x\n", "not a line of `number hash`"),
                                     ("none", "# pursuit expect 1\n", "no hash in it")]:
            with open(self.path(name), "w") as file:
                file.write(content)
            self.assertIn(words, self.must("replay", path, "--expect", self.path(name), status=1).stderr)

    def test_images_as_expectation(self):
        path = self.record("x.pursuit")
        frames = self.path("frames")
        os.mkdir(frames)
        self.must("replay", path, "--every", "2", "--method", "grid", "--write-frames", frames + "/f_%04d.png")
        self.assertEqual(len(os.listdir(frames)), 30)
        for expected in [frames, frames + "/f_%04d.png"]:
            self.must("replay", path, "--every", "2", "--method", "grid", "--expect", expected)
            self.must("replay", path, "--every", "2", "--method", "hold", "--expect", expected, status=1)
        for tolerance, status in [("255", 0), ("1", 1), ("10dB", 0), ("99dB", 1)]:
            self.must("replay", path, "--every", "2", "--method", "hold", "--expect", frames, "--expect-tolerance",
                      tolerance, status=status)

    def test_images_that_were_not_displayed(self):
        """A recording that has lost its end does not pass for what it was."""
        path, frames = self.record("x.pursuit"), self.path("frames")
        os.mkdir(frames)
        self.must("replay", path, "--write-frames", frames + "/f_%04d.png")
        os.truncate(path, os.path.getsize(path) // 2)
        for expected in [frames, frames + "/f_%04d.png"]:
            result = self.must("replay", path, "--expect", expected, "--expect-tolerance", "255", status=1)
            self.assertRegex(result.stderr, r"[0-9]+ expected frames were not displayed")
            self.assertNotIn("another renderer", result.stderr)

    def test_predictions_are_numbered_by_what_they_predict(self):
        path = self.record("x.pursuit", seconds=0.05)
        self.must("replay", path, "--predict", "--write-frames", self.path("p_%02d.png"))
        written = sorted(name for name in os.listdir(self.folder) if name.startswith("p_"))
        self.assertEqual(written, [f"p_{number:02d}.png" for number in range(1, 6)])

    def test_fail_under(self):
        path = self.record("x.pursuit")
        self.must("replay", path, "--every", "2", "--fail-under", "psnr=10,ssim=0.1")
        self.assertIn("is under 99", self.must("replay", path, "--every", "2", "--fail-under", "psnr=99", status=1).stderr)
        self.must("replay", path, "--every", "2", "--fail-under", "psnr=10,ssim=1.1", status=1)
        self.assertIn("nothing could be scored", self.must("replay", path, "--fail-under", "psnr=1", status=1).stderr)

    def test_damage(self):
        path = self.record("x.pursuit")
        whole = self.figures("replay", path, "--method", "hold")["real_frames"]
        with open(path, "rb") as file:
            content = file.read()
        cut = self.path("cut.pursuit")
        with open(cut, "wb") as file:
            file.write(content[: len(content) // 2])
        result = self.must("replay", cut, "--method", "hold", "--json", self.path("cut.json"))
        self.assertIn(f"{cut}: chunk", result.stderr)
        self.assertIn("cut off", result.stderr)
        with open(self.path("cut.json")) as file:
            figures = json.load(file)
        self.assertTrue(0 < figures["real_frames"] < whole and figures["truncated"])
        flipped = bytearray(content)
        flipped[len(content) // 2] ^= 1
        with open(cut, "wb") as file:
            file.write(flipped)
        result = self.must("replay", cut, "--every", "2", "--method", "grid", "--json", self.path("cut.json"))
        self.assertRegex(result.stderr, r"byte|checksum|damaged")
        with open(self.path("cut.json")) as file:
            self.assertGreater(json.load(file)["real_frames"], 3)
        with open(cut, "wb") as file:
            file.write(content[:300])
        self.must("replay", cut, status=1)
        self.assertIn("none.pursuit", self.must("replay", self.path("none.pursuit"), status=1).stderr)


if __name__ == "__main__":
    common.main()
