# SPDX-License-Identifier: MIT
"""The worked example of docs/integration.md: each step runs, and what the last ones send is found right."""
import json
import os
import subprocess
import sys
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
                result = subprocess.run([step, "--seconds", "0.3"], env=self.environment(), timeout=600)
                self.assertEqual(result.returncode, 0)

    def check(self, step):
        daemon = start([PURSUITD, "--present", "headless"], self.environment())
        game = None
        try:
            common.started(daemon, self.path("socket"))
            game = start([step, "--seconds", "3000"], self.environment())
            self.wait_for_frames(10, env=self.environment())
            for seconds in 1.5, 15, 60:  # where others have the processors, few frames come of many seconds
                path = self.path("game.pursuit")
                self.must("record", path, "--seconds", seconds, env=self.environment())
                result = common.run("check-stream", path, "--json")
                found = json.loads(result.stdout or '{"pairs": 0}')
                if found["pairs"] > 2:
                    break
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertGreater(found["pairs"], 2)
            return found
        finally:
            for process in filter(None, (game, daemon)):
                process.terminate()
                process.wait(2 * common.PATIENCE)

    def test_motion(self):
        found = self.check(STEPS[3])
        self.assertLess(found["unexplained"], 0.6 * found["change"])

    def test_ui(self):
        self.check(STEPS[4])


if __name__ == "__main__":
    if not os.environ.get("DISPLAY"):
        print("skipped: no display")
        sys.exit(77)
    unittest.main(verbosity=2)
