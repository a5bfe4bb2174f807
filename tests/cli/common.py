# SPDX-License-Identifier: MIT
"""What the tests of the command share: running it, small recordings, a skip where there is no GL."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

PURSUIT = os.environ.get("PURSUIT", "pursuit")


def run(*arguments, **options):
    """Runs the command; the result has returncode, stdout and stderr."""
    options.setdefault("timeout", 240)
    return subprocess.run([PURSUIT, *map(str, arguments)], capture_output=True, text=True, **options)


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="pursuit-test-")

    def tearDown(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def must(self, *arguments, status=0, **options):
        """Runs the command and expects an exit status."""
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, status, f"{arguments}: {result.stdout}{result.stderr}")
        return result

    def wait_for_frames(self, count, *arguments, **options):
        """Until a daemon has had more real frames than that, however long it takes where others have the processors."""
        for _ in range(600):
            result = run("status", "--json", *arguments, **options)
            if result.returncode == 0 and json.loads(result.stdout)["real_frames"] > count:
                return
            time.sleep(0.1)
        self.fail("no frames arrive")

    def record(self, name, **options):
        """A small recording of a scene; options as --name value, underscores for dashes."""
        chosen = {"scene": "colonnade", "size": "64x36", "fps": 120, "seconds": 0.25, **options}
        flat = [text for key, value in chosen.items() for text in ("--" + key.replace("_", "-"), value)]
        self.must("record", self.path(name), *flat)
        return self.path(name)

    def figures(self, *arguments, status=0):
        return json.loads(self.must(*arguments, "--json", "-", status=status).stdout)


def main():
    probe = tempfile.mkdtemp(prefix="pursuit-test-")
    result = run("record", os.path.join(probe, "x.pursuit"), "--scene", "still", "--size", "16x16", "--seconds", "0.02")
    shutil.rmtree(probe)
    if "no GL context" in result.stderr:
        print("skipped: no GL context for scenes here")
        sys.exit(77)
    unittest.main(verbosity=2)
