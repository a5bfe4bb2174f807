# SPDX-License-Identifier: MIT
"""get and set against a daemon of their own."""
import json
import os
import signal
import subprocess

import common

PURSUITD = os.environ["PURSUITD"]


class Settings(common.Case):
    def setUp(self):
        super().setUp()
        self.socket = self.path("socket")
        self.log = open(self.path("log"), "w+")
        self.file = self.path("config")
        with open(self.file, "w"):
            pass
        self.daemon = subprocess.Popen([PURSUITD, "--socket", self.socket, "--method", "hold", "--config", self.file],
                                       stderr=self.log)
        common.started(self.daemon, self.socket)

    def tearDown(self):
        self.daemon.send_signal(signal.SIGTERM)
        status = self.daemon.wait(2 * common.PATIENCE)
        self.log.close()
        super().tearDown()
        self.assertEqual(status, 0)

    def get(self, *names):
        return self.must("get", *names, "--socket", self.socket).stdout

    def set(self, *changes, status=0):
        return self.must("set", *changes, "--socket", self.socket, status=status).stderr

    def test_get(self):
        self.assertEqual(self.get("method"), "hold\n")
        self.assertEqual(self.get("cell", "blur"), "cell = 8\nblur = doubtful\n")
        self.assertIn("\nviewing-distance-mm = 600\n", self.get())
        chosen = self.must("get", "cell", "present", "--json", "--socket", self.socket).stdout
        self.assertEqual(json.loads(chosen), {"cell": "8", "present": "headless"})
        wrong = self.must("get", "cel", "--socket", self.socket, status=2).stderr
        self.assertIn("cel: there is no such setting; did you mean cell?", wrong)

    def test_set(self):
        self.set("method=grid", "cell=16")
        self.assertEqual(self.get("method", "cell"), "method = grid\ncell = 16\n")
        self.assertIn("it may be 4 to 64 px", self.set("blur=off", "cell=1", status=1))
        self.assertEqual(self.get("blur"), "doubtful\n")
        self.assertIn("no-such", self.set("tee=/no-such/folder/x.y4m", status=1))

    def test_spaces(self):
        path = self.path("a file with spaces and \\ in it") + "x" * 200
        self.set("stats=" + path, "cell=16")
        self.assertEqual(self.get("stats"), path + "\n")
        self.assertEqual(self.get("cell"), "16\n")
        self.set("stats=")

    def test_long(self):
        """As long as they may be, all at once: nothing is cut."""
        folder = self.path("a" + " " * 60 + "b")
        os.mkdir(folder)
        names = ["stats", "record", "tee", "latency-log"]
        values = [folder + "/" + "./" * ((500 - len(folder)) // 2) + name[:3] + (".y4m" if name == "tee" else ".csv")
                  for name in names]
        self.set(*[f"{name}={value}" for name, value in zip(names, values)])
        for name, value in zip(names, values):
            self.assertEqual(self.get(name), value + "\n")
        self.assertIn("stats: ", self.set("stats=" + "x" * 512, status=1))
        path = self.path("Größe")
        self.set("stats=" + path)
        self.assertEqual(self.get("stats"), path + "\n")
        self.assertIn("stats: is no UTF-8 text", self.set(os.fsdecode(b"stats=/tmp/\xff"), status=1))
        self.set("stats=", "record=", "tee=", "latency-log=")

    def test_get_long(self):
        """Where each value comes from, and what may be set."""
        def origin(name):
            found = json.loads(self.must("get", name, "--long", "--json", "--socket", self.socket).stdout)[name]
            return [found[key] for key in ("value", "from")]

        self.assertEqual(origin("method"), ["hold", "command line"])
        self.assertEqual(origin("cell"), ["8", "default"])
        with open(self.file, "w") as out:
            out.write("# a comment\ncell = 16\nrefresh = 60\n")
        common.soon(lambda: origin("refresh") == ["60", "configuration"])
        self.assertEqual(origin("refresh"), ["60", "configuration"])
        text = self.get("cell", "--long")
        self.assertIn(f"# from: configuration file {self.file}:2\n", text)
        self.assertIn("# 4 to 64 px; default 8; when set: with the next real frame\ncell = 16\n", text)
        self.set("cell=32")
        self.assertIn("# from: set by pursuit set\n", self.get("--long", "cell"))
        self.set("--undo", "cell")
        self.assertEqual(origin("cell"), ["16", "configuration"])
        everything = json.loads(self.must("get", "--long", "--json", "--socket", self.socket).stdout)
        self.assertEqual(everything["blur"]["choices"], ["doubtful", "everywhere", "off"])
        self.assertEqual([everything["cell"][key] for key in ("least", "most", "unit", "default")], [4, 64, "px", "8"])
        for name, setting in everything.items():
            self.assertIn("live", setting, name)
        self.assertEqual(everything["seccomp"]["live"], "taken over, but not switched off again")

    def test_undo(self):
        self.set("method=grid", "cell=16")
        self.set("--undo", "method")
        self.assertEqual(self.get("method", "cell"), "method = hold\ncell = 16\n")
        self.assertIn("was not asked for", self.set("--undo", "cell", "method", status=1))
        self.assertEqual(self.get("cell"), "16\n")
        self.assertIn("its NAME is enough", self.set("--undo", "cell=16", status=2))
        changed = self.must("set", "--json", "cell=32", "--socket", self.socket).stdout
        self.assertEqual(json.loads(changed), {"cell": "32"})
        changed = self.must("set", "--json", "--undo", "cell", "--socket", self.socket).stdout
        self.assertEqual(json.loads(changed), {"cell": "8"})

    def test_doctor_sees_the_mistake(self):
        def look():
            report = json.loads(self.must("doctor", "--json", "--socket", self.socket).stdout)["findings"]
            for finding in report:
                self.assertTrue(finding["mend"] or finding["state"] in ("works", "note"), finding)
            return [(finding["state"], finding["mend"]) for finding in report if finding["area"] == "daemon"]

        self.assertEqual([state for state, _ in look()], ["works", "works"])
        with open(self.file, "w") as out:
            out.write("cell = 16\ncell = none\n")
        common.soon(lambda: look()[1][0] != "works")
        self.assertEqual(look()[1], ("limit", f"${{EDITOR:-vi}} +2 {self.file}"))

    def test_no_daemon(self):
        for verb in (["get"], ["set", "cell=8"]):
            self.assertIn("Start one: pursuitd", self.must(*verb, "--socket", self.path("none"), status=1).stderr)


if __name__ == "__main__":
    common.main()
