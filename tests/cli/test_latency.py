# SPDX-License-Identifier: MIT
"""`pursuit latency` on logs that are written here, so what they hold is known; `latency` and `top` on a daemon."""
import json
import os
import subprocess
import unittest
import xml.etree.ElementTree

from common import PURSUIT, Case, listens, soon

COLUMNS = ("vblank,frame_id,show,phase,method,code,level,submit_ns,intake_ns,target_ns,ready_ns,flip_ns,event_ns,"
           "edge_ns,photon_ns,trigger_ns,set_ns,flip_source,late,skipped,edge_lost,photon_lost")
START, PERIOD = 5_000_000_000, 8_333_333


def log_text(rows=1200, edge_us=50, source="kernel"):
    """120 Hz, every third frame real; the edge comes edge_us to edge_us + 9 us after the flip, light 3 ms after."""
    lines = ["# a comment", COLUMNS]
    for i in range(rows):
        flip = START + i * PERIOD
        submit = flip - 12_000_000 if i % 3 == 0 else ""
        edge = flip + edge_us * 1000 + i % 10 * 1000 if i % 100 else ""
        lines.append(f"{i},{i // 3},{'in-between' if i % 3 else 'real'},0.5,grid,{i},0,{submit},,{flip},,{flip},"
                     f"{flip + 5000},{edge},{flip + 3_000_000},,2000,{source},0,0,{0 if i % 100 else 1},0")
    return "\n".join(lines) + "\n"


class Latency(Case):
    def log(self, name, **options):
        with open(self.path(name), "w", encoding="utf-8") as out:
            out.write(log_text(**options))
        return self.path(name)

    def json(self, *arguments):
        return json.loads(self.must("latency", "--json", *arguments).stdout)

    def test_known_figures(self):
        figures = self.json(self.log("a.csv"))
        spans = figures["spans"]
        self.assertEqual(figures["rows"], 1200)
        self.assertEqual(figures["lost_edges"], 12)
        self.assertEqual(figures["shows"]["real"], 400)
        self.assertEqual(spans["flip_to_edge"]["count"], 1188)
        self.assertAlmostEqual(spans["flip_to_edge"]["mean_us"], 54.5, delta=0.1)
        self.assertAlmostEqual(spans["flip_to_edge"]["p50_us"], 54.5, delta=1.0)
        self.assertEqual(spans["flip_to_edge"]["max_us"], 59)
        self.assertEqual(spans["submit_to_flip"]["count"], 400)
        self.assertEqual(spans["submit_to_photon"]["max_us"], 15000)
        self.assertAlmostEqual(spans["refresh"]["mean_us"], 8333.333, delta=0.01)
        self.assertNotIn("trigger_to_photon", spans)

    def test_external_vsync_is_no_estimate(self):
        uncertainty = self.json(self.log("a.csv", source="external vsync"))["uncertainty"]
        self.assertEqual(uncertainty["flip_sources"], {"external vsync": 1200})
        self.assertEqual(uncertainty["estimated"], [])
        self.assertIn("a vblank of the external vsync", self.must("latency", self.path("a.csv")).stdout)

    def test_says_how_sure_it_is(self):
        self.assertEqual(self.json(self.log("a.csv"))["uncertainty"]["estimated"], [])
        uncertain = self.json(self.log("b.csv", source="timer"))["uncertainty"]
        self.assertEqual(uncertain["estimated"], ["flip"])
        self.assertEqual(uncertain["gpio_set_max_us"], 2)
        text = self.must("latency", self.path("b.csv")).stdout
        for word in ("CLOCK_MONOTONIC", "ESTIMATED", "event jitter", "the pin changed up to 2.0 us before"):
            self.assertIn(word, text)

    def test_compares(self):
        logs = [self.log("a.csv"), self.log("b.csv", edge_us=80)]
        change = self.json(*logs)["change"]
        self.assertAlmostEqual(change["flip_to_edge"]["mean_us"], 30, delta=0.1)
        self.assertLess(change["flip_to_edge"]["mean_interval_us"], 1)
        self.assertEqual(change["flip_to_photon"]["mean_us"], 0)
        text = self.must("latency", *logs).stdout
        self.assertRegex(text, r"flip_to_edge +\+0\.030 ")
        self.assertIn("may be chance", text)

    def test_plots(self):
        logs = [self.log("a <&>.csv"), self.log("b.csv", edge_us=80)]
        self.must("latency", *logs, "--svg", self.path("p.svg"))
        tree = xml.etree.ElementTree.parse(self.path("p.svg"))
        names = [text.text for text in tree.iter("{http://www.w3.org/2000/svg}text")]
        self.assertIn("flip_to_edge", names)
        self.assertIn(f"{logs[0]}: 1200 refreshes in 10.0 s", names)
        # Spans that never vary too have a bar within their axis.
        histograms = [path.get("d") for path in tree.iter("{http://www.w3.org/2000/svg}path") if path.get("fill-opacity")]
        self.assertGreater(len(histograms), 8)
        for path in histograms:
            self.assertGreater(len({point.split()[1] for point in path[1:-1].split("L")}), 1)

    def test_cut_log_is_read(self):
        path = self.log("a.csv")
        os.truncate(path, os.path.getsize(path) - 40)
        figures = self.json(path)
        self.assertEqual(figures["rows"], 1199)
        self.assertGreater(figures["cut_bytes"], 0)

    def test_bad_logs_are_named(self):
        path = self.log("a.csv")
        with open(path, "a", encoding="utf-8") as out:
            out.write("nonsense\n")
        self.assertIn("a.csv:1203: is no row", self.must("latency", path, status=1).stderr)
        self.assertIn("no latency log", self.must("latency", "/dev/null", status=1).stderr)
        empty = self.log("empty.csv", rows=0)
        self.assertIn("has no row yet", self.must("latency", empty, status=1).stderr)
        self.must("latency", path, path, path, status=2)
        self.must("latency", "--loopback", "1", status=2)
        self.must("latency", "--loopback", "1:2", path, status=2)
        self.assertIn("say of which chip", self.must("latency", "--loopback", "1:2", status=1).stderr)


class Live(Case):
    def daemon(self, *arguments):
        """A daemon of our own; its socket's path."""
        path = self.path("socket")
        command = [os.path.join(os.path.dirname(PURSUIT), "..", "pursuitd"), "--socket", path, *arguments]
        running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        self.addCleanup(running.stderr.close)
        self.addCleanup(running.wait)
        self.addCleanup(running.terminate)
        soon(lambda: listens(path) or running.poll() is not None)
        if running.poll() is not None:
            self.skipTest("the daemon does not start here: " + running.stderr.read())
        self.assertTrue(listens(path))
        return path

    def test_without_lab(self):
        socket = self.daemon()
        said = self.must("latency", "--socket", socket, status=1).stderr
        self.assertIn("start pursuitd with --latency", said)
        top = json.loads(self.must("top", "--json", "--socket", socket, "--interval-ms", "100").stdout)
        self.assertNotIn("lab", top["status"])
        self.assertIsNone(top["now"]["displayed_hz"])

    def test_with_lab(self):
        socket = self.daemon("--latency", "--gpio-line", "17", "--gpio-chip", "no-such-chip")
        self.assertIn("has no row yet", self.must("latency", "--socket", socket, status=1).stderr)

        def look():
            return self.must("top", "--once", "--socket", socket, "--interval-ms", "100").stdout

        soon(lambda: "no-such-chip" in look())  # a thread of its own has looked for the line
        text = look()
        self.assertIn("no stream", text)
        self.assertRegex(text, "marker    MISSING: gpio-line 17: gpio-chip: there is no chip \"no-such-chip\"")
        self.assertNotIn("\033", text)

    def test_no_daemon(self):
        self.assertIn("no daemon at", self.must("top", "--socket", self.path("none"), status=1).stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
