# SPDX-License-Identifier: MIT
"""The report's page in a real browser: nothing is fetched, nothing complains, all of it works from the keyboard."""
import os
import shutil
import sys
import tempfile
import unittest

import browser
import common
import make_pictures

ARGUMENTS = ["--scenes", "fan,rings", "--methods", "hold,black,grid", "--sizes", "96x54", "--n", "2", "--vary", "none",
             "--antialias", "1"]
CONTROLS = ["viewer-scene", "viewer-left", "viewer-right", "viewer-show", "viewer-split", "viewer-previous",
            "viewer-frame", "viewer-next", "viewer-play"]
# What has the focus, and whether one sees that.
FOCUS = """(() => {
    const one = document.activeElement, style = getComputedStyle(one);
    return [one.id || one.className || one.tagName, style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 2];
})()"""
# Red, green and blue of a part of the viewer's picture, from LEFT to RIGHT of its width.
PIXELS = """(() => {
    const picture = document.getElementById('viewer-picture'), {width, height} = picture;
    const copy = Object.assign(document.createElement('canvas'), {width, height}).getContext('2d', {willReadFrequently: true});
    copy.drawImage(picture, 0, 0);
    const left = Math.round(LEFT * width), data = copy.getImageData(left, 0, Math.round(RIGHT * width) - left, height).data;
    return Array.from(data).filter((value, index) => index % 4 !== 3);
})()"""


class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="pursuit-test-")
        cls.page = os.path.join(cls.folder, "out/report.html")
        result = common.run("report", *ARGUMENTS, "--out", cls.folder + "/out")
        assert result.returncode == 0, result.stderr
        cls.browser = browser.Browser(browser.find())

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.browser.window(1280, 900)
        self.browser.open(self.page)
        self.shown()

    def shown(self, but=""):
        """What the viewer says that it shows, as soon as that is not `but`."""
        text = self.browser.wait_for(f"""((viewer) => !viewer.hasAttribute('aria-busy') && viewer.dataset.shown !== {but!r} &&
                                         viewer.dataset.shown)(document.getElementById('viewer'))""")
        scene, left, right, show, frame, edge = text.split(";")
        return {"text": text, "scene": scene, "left": left, "right": right, "show": show, "frame": int(frame),
                "edge": int(edge)}

    def pixels(self, left=0.0, right=1.0):
        """Of a part of the picture: red, green, blue, ... as bytes, since those are compared quickly."""
        return bytes(self.browser.evaluate(PIXELS.replace("LEFT", str(left)).replace("RIGHT", str(right))))

    def focus(self, name):
        self.browser.evaluate(f"document.getElementById('viewer-{name}').focus()")

    def keys(self, name, *keys):
        """Presses keys on a control; what is shown then."""
        before = self.shown()
        self.focus(name)
        for key in keys:
            self.browser.press(key)
        return self.shown(but=before["text"])

    def choose(self, name, value):
        """Chooses in a list by keys alone."""
        before = self.shown()
        if self.browser.evaluate(f"document.getElementById('viewer-{name}').value") == value:
            return before
        self.focus(name)
        self.browser.press("Home")
        for _ in range(20):
            if self.browser.evaluate(f"document.getElementById('viewer-{name}').value") == value:
                return self.shown(but=before["text"])
            self.browser.press("ArrowDown")
        self.fail(f"{value} cannot be chosen")

    def test_loads(self):
        self.assertEqual(self.browser.problems, [])
        self.assertEqual({url for url in self.browser.requests if not url.startswith("data:")}, {"file://" + self.page})
        self.browser.evaluate("document.querySelectorAll('details').forEach((one) => one.open = true)")
        self.browser.wait_for("Array.from(document.images).every((one) => one.complete)")
        images = self.browser.evaluate("""Array.from(document.images).map((one) => {
            const box = one.getBoundingClientRect();
            return [one.alt, one.complete && one.naturalWidth > 0 && box.width > 20 && box.height > 20];
        })""")
        plots = [name for name, _ in images if name.startswith("error ")]
        self.assertEqual(len(plots), 6 if shutil.which("gnuplot") else 0, plots)
        self.assertEqual([name for name, seen in images if not seen], [])

    def test_every_control_is_reached_by_tab(self):
        reached, invisible = [], []
        for _ in range(60):
            self.browser.press("Tab")
            name, visible = self.browser.evaluate(FOCUS)
            if name == "BODY" or name in reached and name.startswith("viewer"):
                break
            reached.append(name)
            if not visible:
                invisible.append(name)
        self.assertEqual([name for name in reached if name.startswith("viewer")], CONTROLS)
        self.assertEqual(reached.count("SUMMARY"), 1, reached)
        self.assertEqual(reached.count("wide"), 3, reached)
        self.assertEqual(invisible, [])
        self.browser.press("Tab", shift=True)
        self.browser.press("Tab", shift=True)
        self.assertIn(self.browser.evaluate(FOCUS)[0], reached[-2:])

    def test_everything_has_a_name(self):
        nodes = self.browser.call("Accessibility.getFullAXTree")["nodes"]
        controls = [node for node in nodes if node.get("role", {}).get("value") in
                    ("button", "slider", "combobox", "image", "region", "DisclosureTriangle")]
        self.assertGreaterEqual(len(controls), len(CONTROLS))
        self.assertEqual([node for node in controls if not node["name"].get("value")], [])

    def test_the_edge_moves(self):
        self.choose("left", "black")
        self.choose("right", "hold")
        self.assertEqual(max(self.pixels(0, 0.5)), 0)
        self.assertGreater(max(self.pixels(0.5, 1)), 50)
        before = self.shown()["edge"]
        after = self.keys("split", *["ArrowRight"] * 20)["edge"]
        self.assertEqual((before, after), (48, 67))
        self.assertEqual(max(self.pixels(0, 0.69)), 0)
        self.keys("split", "Home")
        self.assertGreater(max(self.pixels(0, 0.5)), 50)
        text = self.browser.evaluate("document.getElementById('viewer-split').getAttribute('aria-valuetext')")
        self.assertEqual(text, "0 % black")

    def test_the_edge_is_dragged(self):
        before = self.shown()["text"]
        box = self.browser.evaluate("""(() => {
            document.getElementById('viewer').scrollIntoView();
            const box = document.getElementById('viewer-picture').getBoundingClientRect();
            return [box.left, box.top, box.width, box.height];
        })()""")
        at = {"y": box[1] + box[3] / 2, "button": "left", "clickCount": 1}
        self.browser.call("Input.dispatchMouseEvent", type="mousePressed", x=box[0] + box[2] / 2, **at)
        self.browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=box[0] + box[2] / 4, buttons=1, **at)
        self.browser.call("Input.dispatchMouseEvent", type="mouseReleased", x=box[0] + box[2] / 4, **at)
        self.assertEqual(self.shown(but=before)["edge"], 24)

    def test_pictures_one_after_the_other(self):
        self.choose("left", "hold")
        self.keys("split", "End")
        self.keys("frame", "Home")
        real = self.pixels()
        state = self.keys("next", "Enter")
        self.assertEqual(state["frame"], 1)
        self.assertTrue(self.pixels() == real, "hold shows each real frame twice, to the bit")
        state = self.keys("next", " ")
        self.assertEqual(state["frame"], 2)
        self.assertNotEqual(self.pixels(), real)
        self.assertEqual(self.keys("previous", "Enter")["frame"], 1)
        self.assertEqual(self.keys("frame", "ArrowRight")["frame"], 2)
        self.assertEqual(self.keys("split", ".")["frame"], 3)
        self.assertEqual(self.keys("split", ",")["frame"], 2)
        self.assertEqual(self.keys("frame", "End")["frame"], 5)
        self.assertEqual(self.keys("next", "Enter")["frame"], 0)
        status = self.browser.evaluate("document.getElementById('viewer-status').textContent")
        self.assertRegex(status, r"picture 1 of 6, real frame, 1\.\d+ s: hold \| grid")

    def test_play(self):
        self.keys("play", "Enter")
        # Where drawing takes longer than a picture is shown there is always one more to draw.
        shown = "document.getElementById('viewer').dataset.shown"
        self.browser.wait_for(f"{shown} !== {self.browser.evaluate(shown)!r}")
        pressed = "document.getElementById('viewer-play').getAttribute('aria-pressed')"
        self.assertEqual(self.browser.evaluate(pressed), "true")
        self.browser.press("Enter")
        self.assertEqual(self.browser.evaluate(pressed), "false")

    def test_difference_from_the_truth(self):
        self.choose("left", "truth")
        self.choose("right", "truth")
        truth = self.pixels()
        self.choose("right", "hold")
        self.keys("split", "Home")
        hold = self.pixels()
        self.assertNotEqual(truth, hold)
        for factor in 4, 16:
            self.choose("show", str(factor))
            expected = bytes(min(255, factor * abs(a - b)) for a, b in zip(truth, hold))
            self.assertTrue(self.pixels() == expected, factor)
        self.choose("right", "truth")
        self.assertEqual(max(self.pixels()), 0)

    def test_pursuit_camera(self):
        before = self.pixels()
        self.assertEqual(self.choose("show", "seen")["show"], "seen")
        self.assertNotEqual(self.pixels(), before)
        self.assertTrue(self.browser.evaluate("document.getElementById('viewer-frame').disabled"))
        self.choose("show", "displayed")
        self.assertFalse(self.browser.evaluate("document.getElementById('viewer-frame').disabled"))

    def test_the_other_scene(self):
        before = self.pixels()
        self.assertIn("rings", self.choose("scene", "rings, N = 2, 96x54")["scene"])
        self.assertNotEqual(self.pixels(), before)

    def test_a_recording(self):
        """Predictions of a recording, whose name is not to be trusted; there is no pursuit camera."""
        path, out = os.path.join(self.folder, 'a"<b>&.pursuit'), self.folder + "/recording"
        made = common.run("record", path, "--scene", "fan", "--size", "96x54", "--fps", "60", "--seconds", "0.2")
        self.assertEqual(made.returncode, 0, made.stderr)
        made = common.run("report", "--scenes", "none", "--recordings", path, "--methods", "hold,grid", "--vary", "none",
                          "--out", out)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.browser.open(out + "/report.html")
        self.assertIn('a"<b>&, N = 2, 96x54', self.shown()["scene"])
        self.assertTrue(self.browser.evaluate("document.querySelector('#viewer-show [value=seen]').disabled"))
        self.choose("left", "grid")
        self.choose("right", "grid")
        before = self.pixels()
        self.keys("next", "Enter")
        self.assertFalse(self.pixels() == before)
        status = self.browser.evaluate("document.getElementById('viewer-status').textContent")
        self.assertIn("prediction", status)
        self.browser.requests.clear()
        self.assertEqual(self.browser.problems, [])

    def test_pictures_are_those_of_the_engine(self):
        """To the bit, however they are put together from each other: what replay writes is what the viewer shows."""
        path, out = os.path.join(self.folder, "fan.pursuit"), self.folder + "/exact"
        methods = ["hold", "black", "mcif", "scatter", "grid", "adaptive-grid", "pursuit"]
        for command in (["record", path, "--scene", "fan", "--size", "96x54", "--fps", "60", "--seconds", "0.2"],
                        ["report", "--scenes", "none", "--recordings", path, "--methods", ",".join(methods), "--vary", "none",
                         "--out", out]):
            made = common.run(*command)
            self.assertEqual(made.returncode, 0, made.stderr)
        self.browser.open(out + "/report.html")
        self.shown()
        self.keys("split", "Home")
        for method in methods:
            frames = os.path.join(self.folder, method)
            os.mkdir(frames)
            made = common.run("replay", path, "--predict", "--method", method, "--write-frames", frames + "/%d.png")
            self.assertEqual(made.returncode, 0, made.stderr)
            self.choose("right", method)
            self.keys("frame", "End")
            for _ in range(3):
                state = self.keys("previous", "Enter")
                moment = float(self.browser.evaluate(
                    "JSON.parse(document.getElementById('viewer-data').textContent)[0].pictures"
                    f"[{state['frame']}].time"))
                written = make_pictures.read_png(f"{frames}/{round(60 * moment)}.png")
                self.assertTrue(self.pixels() == b"".join(written), (method, state))

    def test_it_is_light(self):
        """What repeats itself takes nothing, and no picture is read before it is looked at."""
        strips = self.browser.evaluate("""JSON.parse(document.getElementById('viewer-data').textContent).flatMap(
            (work) => work.methods.map((one) => [one.name, one.differing, one.strip.length]))""")
        for name, differing, length in strips:
            self.assertLessEqual(differing, {"hold": 0, "black": 1}.get(name, 6), strips)  # black: but for a UI
            self.assertEqual(length == 0, differing == 0, strips)
        self.assertLess(os.path.getsize(self.page), 650000)

    def test_narrow_and_dark(self):
        def background():
            return self.browser.evaluate("getComputedStyle(document.body).backgroundColor")

        light = background()
        self.browser.window(380, 700, dark=True)
        self.assertNotEqual(background(), light)
        self.assertLessEqual(*self.browser.evaluate("[document.documentElement.scrollWidth, innerWidth]"))

    def test_nothing_complained(self):
        self.assertEqual(self.browser.problems, [])


if __name__ == "__main__":
    if not browser.find():
        print("skipped: there is no chromium")
        sys.exit(77)
    common.main()
