# SPDX-License-Identifier: MIT
"""What the tests of the command share: running it, small recordings, a skip where there is no GL."""
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

PURSUIT = os.environ.get("PURSUIT", "pursuit")
# Seconds that something may take on a machine that has much else to do; who waits so long has failed.
PATIENCE = 60


def hurry(pid):
    """
    Makes a process and its children no nicer than this one, where that is permitted. `pursuit demo` makes itself as nice
    as can be, and who works beside it may leave it next to nothing.
    """
    ours = os.getpriority(os.PRIO_PROCESS, 0)
    try:
        for task in os.listdir(f"/proc/{pid}/task"):
            if os.getpriority(os.PRIO_PROCESS, int(task)) > ours:
                os.setpriority(os.PRIO_PROCESS, int(task), ours)
        with open(f"/proc/{pid}/task/{pid}/children", encoding="utf-8") as children:
            for child in children.read().split():
                hurry(child)
    except OSError:
        pass  # it has ended, or that is not permitted


def finish(process, patience=600):
    """Waits for the end of a process that is waited for; its output and what it said of errors."""
    end = time.monotonic() + patience
    while True:
        hurry(process.pid)
        try:
            return process.communicate(timeout=0.5)
        except subprocess.TimeoutExpired:
            if time.monotonic() > end:
                process.kill()
                raise


def run(*arguments, patience=600, **options):
    """Runs the command; the result has returncode, stdout and stderr."""
    with subprocess.Popen([PURSUIT, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, **options) as process:
        output, errors = finish(process, patience)
    return subprocess.CompletedProcess(process.args, process.returncode, output, errors)


def soon(question, patience=PATIENCE):
    """What a function gives as soon as that is true, or what it gives when patience has ended."""
    end = time.monotonic() + patience
    while True:
        last = time.monotonic() > end
        answer = question()
        if answer or last:
            return answer
        time.sleep(0.05)


def listens(path):
    """Whether somebody takes connections at a socket; it is there a moment before that."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as link:
        return link.connect_ex(path) == 0


def started(daemon, path):
    """A daemon, as soon as it takes connections."""
    soon(lambda: listens(path) or daemon.poll() is not None)
    if not listens(path):
        daemon.kill()
        raise AssertionError(f"no daemon at {path}, exit status {daemon.wait()}")
    return daemon


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
        def shown():
            result = run("status", "--json", *arguments, **options)
            return result.returncode == 0 and json.loads(result.stdout)["real_frames"] > count

        self.assertTrue(soon(shown, 5 * PATIENCE), "no frames arrive")

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
