# SPDX-License-Identifier: MIT
"""The worked example of docs/integration.md: each step runs, and what the last ones send is found right."""
import json
import os
import subprocess
import sys
import time
import unittest

import common

STEPS = os.environ["INTEGRATION_STEPS"].split(":")
PURSUITD = os.environ["PURSUITD"]


def start(arguments, environment):
    return subprocess.Popen(arguments, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Integration(common.Case):
    def environment(self):
        return {**os.environ, "PURSUIT_SOCKET": self.path("socket")}

    def test_without_a_daemon(self):
        for step in STEPS:
            with self.subTest(step=step):
                result = subprocess.run([step, "--seconds", "0.3"], env=self.environment(), timeout=240)
                self.assertEqual(result.returncode, 0)

    def check(self, step):
        daemon = start([PURSUITD, "--present", "headless"], self.environment())
        game = None
        try:
            time.sleep(0.5)
            game = start([step, "--seconds", "200"], self.environment())
            self.wait_for_frames(10, env=self.environment())
            path = self.path("game.pursuit")
            self.must("record", path, "--seconds", 1.5, env=self.environment())
            result = common.run("check-stream", path, "--json")
            self.assertEqual(result.returncode, 0, result.stdout)
            return json.loads(result.stdout)
        finally:
            for process in filter(None, (game, daemon)):
                process.terminate()
                process.wait(60)

    def test_motion(self):
        found = self.check(STEPS[3])
        self.assertGreater(found["pairs"], 2)
        self.assertLess(found["unexplained"], 0.6 * found["change"])

    def test_ui(self):
        self.assertGreater(self.check(STEPS[4])["pairs"], 2)


if __name__ == "__main__":
    if not os.environ.get("DISPLAY"):
        print("skipped: no display")
        sys.exit(77)
    unittest.main(verbosity=2)
