# SPDX-License-Identifier: MIT
"""The report: files, limits, an interrupt, a baseline, recordings, a machine without gnuplot."""
import csv
import html
import html.parser
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import common

SMALL = ["--scenes", "fan", "--methods", "hold,grid", "--sizes", "96x54", "--n", "2", "--vary", "none", "--antialias", "1"]


class Page(html.parser.HTMLParser):
    """What must hold of a page that opens without a network: tags close, nothing is fetched."""

    def __init__(self):
        super().__init__()
        self.open, self.fetched, self.images, self.text = [], [], 0, ""

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("src", "href") and not value.startswith("data:"):
                self.fetched.append(value)
        self.images += tag == "img"
        if tag not in ("img", "meta", "br", "input"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            raise ValueError(f"</{tag}> closes nothing")

    def handle_data(self, data):
        self.text += data


class Report(common.Case):
    made, text = None, None

    @classmethod
    def tearDownClass(cls):
        if cls.made:
            shutil.rmtree(cls.made)

    def small(self, out="out"):
        """A copy of the report SMALL, which is made once; what it printed."""
        if not Report.made:
            Report.made = tempfile.mkdtemp(prefix="pursuit-test-")
            Report.text = self.must("report", *SMALL, "--out", Report.made + "/out").stdout
        shutil.copytree(Report.made + "/out", self.path(out))
        return Report.text

    def report(self, *arguments, status=0, out="out", **options):
        return self.must("report", *arguments, "--out", self.path(out), status=status, **options)

    def load(self, out="out"):
        with open(self.path(out + "/report.json")) as file:
            report = json.load(file)
        with open(self.path(out + "/report.csv"), newline="") as file:
            rows = list(csv.DictReader(file))
        page = Page()
        with open(self.path(out + "/report.html")) as file:
            page.feed(file.read())
        self.assertEqual((page.open, page.fetched), ([], []))
        for row in rows[:1]:
            self.assertEqual(list(row), [*report["columns"], *report["measures"]])
        return report, rows, page

    def value(self, report, method, measure, setting="default"):
        (row,) = [row for row in report["rows"] if row["method"] == method and row["setting"] == setting]
        return row["measures"][measure]["value"]

    def test_files(self):
        text = self.small()
        report, rows, page = self.load()
        self.assertEqual([row["method"] for row in rows], ["hold", "grid", "rendered"])
        self.assertTrue(report["complete"])
        for in_json, in_csv in zip(report["rows"], rows):
            self.assertEqual((in_csv["source"], in_csv["setting"], in_csv["n"]), ("fan", "default", "2"))
            for name, measure in in_json["measures"].items():
                if measure["value"] is not None:
                    self.assertAlmostEqual(float(in_csv[name]), measure["value"], delta=1e-4 * abs(measure["value"]) + 1e-9)
        self.assertGreater(report["rows"][1]["engine_ms"]["p50"], 0)
        self.assertGreaterEqual(report["rows"][1]["engine_ms"]["frames"], 30)
        self.assertGreater(report["rows"][1]["bytes_down"], 96 * 54 * 4 - 1)
        for words in ["grid", "perceived error", "What the measures are", "truth, 960 Hz"]:
            self.assertIn(words, page.text)
        self.assertGreaterEqual(page.images, 4)
        self.assertIn("grid", text)

    def test_measures_tell_methods_apart(self):
        """What each measure is for: a wrong one would not keep these orders. Motion of some pixels a real frame."""
        self.report("--scenes", "colonnade", "--methods", "hold,black,blur-hold,grid", "--sizes", "240x135", "--n", "4",
                    "--vary", "none")
        report, _, _ = self.load()
        self.assertLess(self.value(report, "grid", "perceived_error"), self.value(report, "hold", "perceived_error"))
        self.assertLess(self.value(report, "rendered", "perceived_error"), self.value(report, "grid", "perceived_error"))
        for method in ["black", "blur-hold"]:
            self.assertLess(self.value(report, "grid", "perceived_error"), self.value(report, method, "perceived_error"))
        self.assertAlmostEqual(self.value(report, "hold", "perceived_lag_ms"), 1000 / 60, delta=1.1)
        self.assertEqual(self.value(report, "black", "ripple"), 1)
        self.assertAlmostEqual(self.value(report, "rendered", "perceived_lag_ms"), 500 / 120, delta=1.1)
        self.assertEqual(self.value(report, "rendered", "psnr"), 100)
        self.assertEqual(self.value(report, "rendered", "tpsnr"), 100)
        self.assertEqual(self.value(report, "hold", "ripple"), 0)
        for measure in ["psnr", "psnr_moving", "tpsnr", "ssim"]:
            self.assertGreater(self.value(report, "grid", measure), self.value(report, "hold", measure), measure)
        self.assertLess(self.value(report, "grid", "energy_error"), self.value(report, "hold", "energy_error"))

    def test_still_is_perfect(self):
        self.report("--scenes", "still", *SMALL[2:])
        report, _, _ = self.load()
        for method in ["hold", "grid"]:
            self.assertEqual(self.value(report, method, "perceived_psnr"), 100)
            self.assertEqual(self.value(report, method, "psnr"), 100)
            self.assertLess(self.value(report, method, "energy_error"), 1e-6)
            self.assertIsNone(self.value(report, method, "psnr_moving"))

    def test_settings_and_n(self):
        self.report("--scenes", "fan", "--methods", "grid", "--sizes", "64x36", "--n", "2,3", "--settings",
                    "cell=16,cell=4+blur=off", "--antialias", "1", "--cell", "12")
        report, rows, _ = self.load()
        self.assertEqual([(row["setting"], row["n"]) for row in rows],
                         [("default", "2"), ("cell=16", "2"), ("cell=4+blur=off", "2"), ("default", "2"),
                          ("default", "3"), ("default", "3")])
        self.assertEqual([row["settings"]["cell"] for row in report["rows"][:3]], ["12", "16", "4"])
        self.assertEqual(report["rows"][2]["settings"]["blur"], "off")

    def test_limits_name_the_case(self):
        """This is how a broken pass turns a named case red."""
        self.report(*SMALL, "--fail-under", "psnr=5,perceived_error=100")
        result = self.report(*SMALL, "--fail-under", "psnr=99", status=1)
        self.assertRegex(result.stderr, r"fan, grid, default, N = 2, 96x54: psnr is \d+\.\d+, the limit is 99")
        self.assertNotIn("rendered", result.stderr)
        result = self.report(*SMALL, "--fail-under", "perceived_error=0.01", status=1)
        self.assertIn("perceived_error is", result.stderr)

    def test_baseline(self):
        self.small()
        baseline = self.path("out/report.json")
        same = self.report(*SMALL, "--baseline", baseline, "--fail-worse", "0.5", out="same").stdout
        self.assertIn("3 of 3 rows are in both", same)
        self.assertNotIn("perceived", same.split("Since")[1])
        changed = self.report(*SMALL, "--cell", "32", "--baseline", baseline, "--fail-worse", "0.5", out="changed", status=1)
        after = changed.stdout.split("Since")[1]
        self.assertRegex(after, r"fan, grid, default, N = 2, 96x54\n(  .*\n)*  psnr +\d+\.\d+ -> \d+\.\d+ dB .worse; spread .*TOO MUCH")
        self.assertNotIn("fan, rendered", after)
        with open(self.path("bad.json"), "w") as file:
            file.write("{}")
        self.assertIn("is no report.json", self.report(*SMALL, "--baseline", self.path("bad.json"), status=1).stderr)

    def test_baseline_that_is_written_over(self):
        """The folder may be the same: what counts is the report that was there before."""
        self.small()
        changed = self.report(*SMALL, "--cell", "32", "--baseline", self.path("out/report.json"), "--fail-worse", "0.5", status=1)
        self.assertIn("TOO MUCH", changed.stdout)

    def test_what_is_not_there_is_not_good(self):
        """A demand that nothing was measured for is not met."""
        self.small(out="old")
        other = [*SMALL[:5], "48x27", *SMALL[6:], "--baseline", self.path("old/report.json")]
        self.assertIn("0 of 3 rows are in both", self.report(*other).stdout)
        self.assertIn("no row is in", self.report(*other, "--fail-worse", "5", status=1).stderr)
        self.must("record", self.path("fan.pursuit"), "--scene", "fan", "--size", "96x54", "--fps", "60", "--seconds", "0.2")
        recorded = ["--scenes", "none", "--recordings", self.path("fan.pursuit"), "--methods", "hold"]
        result = self.report(*recorded, "--fail-under", "psnr=5,perceived_error=50", status=1)
        self.assertIn("no row has perceived_error, the limit is 50", result.stderr)
        with open(self.path("out/report.json")) as file:
            old = json.load(file)
        old["rows"][0]["measures"]["perceived_error"]["value"] = 4.5
        with open(self.path("more.json"), "w") as file:
            json.dump(old, file)
        result = self.report(*recorded, "--baseline", self.path("more.json"), "--fail-worse", "5", status=1)
        self.assertRegex(result.stdout, "perceived_error +4.50 -> none  TOO MUCH")

    def test_an_interrupt_keeps_rows(self):
        # Far more than can be done before anybody looks.
        command = [common.PURSUIT, "report", "--scenes", "fan,rings,trees,tower,creature,colonnade", *SMALL[2:6], "--n",
                   "2,3,4,5,6,7,8", *SMALL[8:], "--out", self.path("out")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            path, deadline = self.path("out/report.csv"), time.monotonic() + 600
            while time.monotonic() < deadline and process.poll() is None:
                if os.path.exists(path) and os.path.getsize(path) > 900:
                    break
                time.sleep(0.02)
            process.send_signal(signal.SIGINT)
            _, error = process.communicate(timeout=600)
        self.assertEqual(process.returncode, 1, error)
        self.assertIn("interrupted", error)
        report, rows, page = self.load()
        self.assertFalse(report["complete"])
        self.assertEqual(len(report["rows"]), len(rows))
        self.assertTrue(3 <= len(rows) < 6 * 7 * 3, len(rows))
        self.assertIn("interrupted", page.text)

    def test_a_recording(self):
        name = "walk-through-the-whole-garden"
        path = self.record(name + ".pursuit", size="96x54")
        said = self.report("--scenes", "none", "--recordings", path, "--methods", "hold,grid", "--vary", "none").stdout
        self.assertEqual(len({len(line) for line in said.splitlines()[:3]}), 1, said)
        report, rows, page = self.load()
        self.assertEqual([(row["source"], row["kind"], row["method"]) for row in rows],
                         [(name, "recording", "hold"), (name, "recording", "grid")])
        self.assertEqual((rows[0]["width"], rows[0]["perceived_error"]), ("96", ""))
        psnr = self.figures("replay", path, "--predict", "--method", "grid")
        first = [frame["displayed"][0]["psnr"] for frame in psnr["frames"][:12]]
        self.assertAlmostEqual(self.value(report, "grid", "psnr"), sum(first) / len(first), places=4)
        self.assertIn("guessed", page.text)
        none = self.report("--scenes", "all", "--recordings", self.path("none.pursuit"), "--methods", "hold", out="none",
                           status=1).stderr
        self.assertIn("none.pursuit: cannot be opened", none)
        self.assertNotIn("rendering", none)

    def check_line(self, line, count):
        """Slope, intercept and R2 are those of the points."""
        xs, ys = zip(*line["points"])
        self.assertEqual(len(xs), count)
        self.assertGreater(min(ys), 0)
        x, y = sum(xs) / count, sum(ys) / count
        xx, yy = sum((a - x) ** 2 for a in xs), sum((b - y) ** 2 for b in ys)
        xy = sum((a - x) * (b - y) for a, b in zip(xs, ys))
        self.assertAlmostEqual(line["slope_ms"], xy / xx, delta=1e-3 * abs(xy / xx) + 1e-6)
        self.assertAlmostEqual(line["intercept_ms"], y - x * xy / xx, delta=1e-3 * y)
        self.assertAlmostEqual(line["r2"], xy * xy / (xx * yy), delta=1e-3)

    def test_cost(self):
        self.small()
        report, _, page = self.load()
        cost = report["cost"]
        self.assertEqual((cost["method"], cost["width"], cost["height"], cost["n"]), ("grid", 96, 54, 2))
        self.check_line(cost["share"], 11)
        self.assertEqual([round(10 * x) for x, _ in cost["share"]["points"]], list(range(10, -1, -1)))
        self.check_line(cost["pixels"], 6)
        self.assertAlmostEqual(cost["pixels"]["points"][3][0], 96 * 54 * 1e-6, delta=1e-9)
        self.assertIn("What the time grows with", page.text)

    def test_tables_of_others(self):
        table = {"title": "Stability & bounds", "columns": ["case", "worst"], "rows": [["a < b", 0.25], ["c", None]]}
        with open(self.path("table.json"), "w") as file:
            json.dump(table, file)
        suite = {"suite": "motion", "context": "cpu", "cases": [
            {"case": "flips", "worst": 0.5, "where": "frame 3", "bound": 1.0, "kept": True},
            {"case": "turns", "worst": 2.0, "where": "frame 9", "bound": 1.0, "kept": False}]}
        with open(self.path("suite.json"), "w") as file:
            json.dump(suite, file)
        self.report(*SMALL, "--tables", self.path("table.json") + "," + self.path("suite.json"))
        report, _, page = self.load()
        self.assertEqual(report["tables"][0], table)
        self.assertEqual(report["tables"][1]["rows"][1], ["turns", 2.0, 1.0, "BROKEN", "frame 9"])
        self.assertIn("Stability: motion, cpu", page.text)
        self.assertIn("Stability & bounds", page.text)
        self.assertIn("a < b", page.text)
        self.assertNotIn("curve & one", page.text)
        with open(self.path("table.json"), "w") as file:
            json.dump([{"title": "Plot < one", "columns": [], "rows": [], "plot": {
                "x": "s", "y": "error & more", "steps": True,
                "curves": [{"name": "curve & one", "points": [[0, 1], [1, 3], [2, 2]]}, {"name": "none", "points": [[0]]}]}},
                {"title": "Nothing", "columns": [], "rows": [], "plot": {"curves": [7]}}], file)
        self.report(*SMALL, "--tables", self.path("table.json"))
        page = self.load()[2]
        self.assertIn("curve & one", page.text)
        self.assertIn("error & more", page.text)
        with open(self.path("out/report.html")) as file:
            html = file.read()
        self.assertEqual(html.count('<svg viewBox="0 0 900 380"'), 1)
        self.assertIn('aria-label="Plot &lt; one"', html)
        self.assertIn('H375.0L', html)
        with open(self.path("table.json"), "w") as file:
            json.dump({"title": "x"}, file)
        self.assertIn("a table needs", self.report(*SMALL, "--tables", self.path("table.json"), status=1).stderr)

    def test_without_gnuplot(self):
        """A folder of links to everything but gnuplot would be long: an empty PATH does."""
        result = self.report(*SMALL, env={**os.environ, "PATH": self.path("empty")})
        self.assertIn("gnuplot-nox", result.stderr)
        _, rows, page = self.load()
        self.assertEqual(len(rows), 3)
        self.assertIn("gnuplot is not installed", page.text)

    def test_plots(self):
        if not shutil.which("gnuplot"):
            self.skipTest("gnuplot is not installed")
        self.small()
        for name in ["overall", "speed", "error-0-n2-96x54", "time-0-n2-96x54"]:
            with open(self.path(f"out/plots/{name}.svg")) as file:
                svg = file.read()
            self.assertIn("</svg>", svg)
            self.assertIn("grid", svg)

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not installed")
    def test_nothing_covers_anything_in_plots(self):
        """What is far off is told beside the plot, settings have marks instead of words, and gaps of time take no place."""
        self.report("--scenes", "fan", "--methods", "hold,black,grid", "--sizes", "96x54", "--n", "2", "--antialias", "1",
                    "--settings", "cell=4,cell=16")
        scripts = {}
        for name in "overall", "time-0-n2-96x54", "error-0-n2-96x54":
            with open(self.path(f"out/plots/{name}.gp")) as script:
                scripts[name] = script.read()
        for name in "overall", "error-0-n2-96x54":
            self.assertRegex(scripts[name], r"title 'black \([\d.]+, above\)'")
            self.assertRegex(scripts[name], r"set yrange \[\*:\d")
            self.assertNotIn("with labels", scripts[name])
            marks = re.findall(r"linecolor '#d55e00' pointtype (\d+)|linecolor '#56b4e9' pointtype (\d+)", scripts[name])
            self.assertEqual(len(set(marks)), 3, scripts[name])
        self.assertRegex(scripts["time-0-n2-96x54"], r"set xtics \('1\.\d+ s' 0, '3\.\d+ s' \d+.*'5\.\d+ s' \d+")

    def test_wrong_arguments(self):
        for arguments, words in [
            (["--scenes", "nowhere"], "there is no scene nowhere"),
            (["--methods", "girl"], "girl"),
            (["--sizes", "640"], "--sizes: 640"),
            (["--sizes", "640x0"], "--sizes: 640x0"),
            (["--n", "1"], "--n: 1"),
            (["--settings", "cell"], "name=value"),
            (["--settings", "cell=3"], "cell: 3 is below 4"),
            (["--settings", "sell=4"], "did you mean cell?"),
            (["--fail-under", "psnr"], "--fail-under is psnr"),
            (["--fail-under", "prettiness=3"], "perceived_error"),
            (["--fail-worse", "1"], "goes with --baseline"),
            (["--scenes", "none"], "nothing to report on"),
            (["--antialias", "9"], "--antialias is 9"),
        ]:
            self.assertIn(words, self.report(*arguments, status=2).stderr, arguments)
        blocked = self.path("file")
        with open(blocked, "w"):
            pass
        self.assertIn("file", self.must("report", *SMALL, "--out", blocked + "/x", status=1).stderr)

    def test_names_of_recordings_may_be_anything(self):
        """What is no text, or too long for one, is cut and cleaned; nothing of the report is lost for it."""
        long = "\u00e4" * 60
        for name, shown in (b"r\xff\xfe.pursuit", "r??"), (long.encode() + b".pursuit", long[:31]):
            path = os.path.join(os.fsencode(self.folder), name)
            made = common.run("record", "x", "--scene", "fan", "--size", "96x54", "--fps", "60", "--seconds", "0.2",
                              cwd=self.folder)
            self.assertEqual(made.returncode, 0, made.stderr)
            os.rename(self.path("x"), path)
            self.must("report", "--scenes", "none", "--recordings", os.fsdecode(path), "--methods", "hold", "--out",
                      self.path("out"))
            with open(self.path("out/report.json"), encoding="utf-8") as file:
                self.assertEqual([row["source"] for row in json.load(file)["rows"]], [shown])
            with open(self.path("out/report.html"), encoding="utf-8") as page:
                self.assertIn(shown + ", N = 2", page.read())

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not installed")
    def test_names_of_recordings_are_no_script(self):
        made = self.record("x.pursuit", size="96x54")
        for name in "a'; system \"touch owned\" #", "b`touch owned`@c$d \\":
            shutil.copy(made, self.path(name + ".pursuit"))
            self.report("--scenes", "none", "--recordings", self.path(name + ".pursuit"), "--methods", "hold")
            plots = os.listdir(self.path("out/plots"))
            self.assertNotIn("owned", plots)
            self.assertIn("time-0-n2-96x54.svg", plots)
            with open(self.path("out/plots/time-0-n2-96x54.svg"), encoding="utf-8") as file:
                self.assertIn(html.escape(name, quote=False), html.escape(html.unescape(file.read()), quote=False))

    def test_contact_sheets_do_not_replace_each_other(self):
        """Of recordings whose names begin with the same; the page says which is whose, in whole characters."""
        made = self.record("x.pursuit", size="96x54")
        names = ["a" + "\u20ac" * 10 + one for one in "12"]
        paths = [self.path(name + ".pursuit") for name in names]
        for path in paths:
            shutil.copy(made, path)
        self.report("--scenes", "none", "--recordings", ",".join(paths), "--methods", "hold", "--vary", "none")
        _, _, page = self.load()
        sheets = [name for name in os.listdir(self.path("out/pictures")) if name.startswith("contact-")]
        self.assertEqual(len(sheets), 2)
        for sheet in sheets:
            self.assertIn("pictures/" + sheet, page.text)

    def test_nothing_moves(self):
        result = self.must("report", "--scenes", "still", "--sizes", "64x36", "--n", "2", "--methods", "hold,grid", "--vary",
                           "none", "--antialias", "1", "--out", self.path("out"))
        self.assertIn("No scene of the first N and size moves", result.stdout)
        self.assertNotIn("arning", result.stderr)
        if shutil.which("gnuplot"):
            self.assertNotIn("no plots", result.stderr)

    def test_baseline_is_looked_for_first(self):
        result = self.must("report", "--baseline", self.path("none.json"), "--out", self.path("out"), status=1)
        self.assertIn("none.json: No such file", result.stderr)
        self.assertFalse(os.path.exists(self.path("out")))


if __name__ == "__main__":
    common.main()
