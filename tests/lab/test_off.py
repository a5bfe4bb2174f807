# SPDX-License-Identifier: MIT
"""Without an option of the lab there is no lab: no thread, no process, nothing open. usage: test_off.py PURSUITD"""
import glob
import os
import subprocess
import sys
import tempfile
import time


PATIENCE = 60


def texts(pattern):
    """Of the files; threads that come and go have none."""
    for path in glob.glob(pattern):
        try:
            with open(path, encoding="utf-8") as file:
                yield file.read()
        except OSError:
            pass


class Daemon:
    """It runs; `names` of its threads, its `children` and its number of open `files` are those of the last look()."""

    def __init__(self, folder, *arguments):
        environment = dict(os.environ, PURSUIT_SOCKET=f"{folder}/socket", XDG_RUNTIME_DIR=folder, HOME=folder)
        command = [sys.argv[1], "--present", "headless", "--context", "cpu", *arguments]
        self.arguments, self.names, self.children, self.files = arguments, [], [], 0
        self.process = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)

    def look(self):
        process = f"/proc/{self.process.pid}"
        self.names = sorted(text.strip() for text in texts(f"{process}/task/*/comm"))
        self.children = "".join(texts(f"{process}/task/*/children")).split()
        self.files = len(os.listdir(f"{process}/fd"))

    def end(self):
        print(self.arguments, self.names, len(self.children), "children", self.files, "files")
        self.process.terminate()
        return self.process.wait(timeout=2 * PATIENCE)


def differ_by_the_lab(off, on, guarded):
    fine = "pursuit-lab" not in off.names and not off.children
    fine &= [name for name in on.names if name != "pursuit-lab"] == off.names and "pursuit-lab" in on.names
    return fine and on.files == off.files + 1 and not on.children and len(guarded.children) == 1


def main():
    """Three daemons side by side, looked at until all of their threads have begun and have said their names."""
    with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second, \
            tempfile.TemporaryDirectory() as third:
        daemons = [Daemon(first), Daemon(second, "--latency"), Daemon(third, "--strobe-line", "NONE")]
        end, fine = time.monotonic() + PATIENCE, 0  # looks, one after the other; one may come too early to see a thread
        while fine < 3 and time.monotonic() < end:
            time.sleep(0.2)
            if all(os.path.exists(f"{folder}/socket") for folder in (first, second, third)):
                for daemon in daemons:
                    daemon.look()
                fine = fine + 1 if "pursuit-render" in daemons[0].names and differ_by_the_lab(*daemons) else 0
        statuses = [daemon.end() for daemon in daemons]
    return 0 if fine == 3 and statuses == [0, 0, 0] else 1


if __name__ == "__main__":
    sys.exit(main())
