# SPDX-License-Identifier: MIT
"""Without an option of the lab there is no lab: no thread, no process, nothing open. usage: test_off.py PURSUITD"""
import glob
import os
import subprocess
import sys
import tempfile
import time


def look(*arguments):
    """Names of the daemon's threads, its children and its open files."""
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, PURSUIT_SOCKET=f"{folder}/socket", XDG_RUNTIME_DIR=folder, HOME=folder)
        command = [sys.argv[1], "--present", "headless", "--context", "cpu", *arguments]
        with subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL) as daemon:
            for _ in range(600):
                if os.path.exists(f"{folder}/socket"):
                    break
                time.sleep(0.1)
            process = f"/proc/{daemon.pid}"
            names = sorted(open(path).read().strip() for path in glob.glob(f"{process}/task/*/comm"))
            children = "".join(open(path).read() for path in glob.glob(f"{process}/task/*/children")).split()
            files = len(os.listdir(f"{process}/fd"))
            daemon.terminate()
            status = daemon.wait(timeout=60)
    print(arguments, names, len(children), "children", files, "files")
    return names, children, files, status


def main():
    off, off_children, off_files, off_status = look()
    on, on_children, on_files, on_status = look("--latency")
    _, guard, _, _ = look("--strobe-line", "NONE")
    fine = off_status == 0 and on_status == 0
    fine &= "pursuit-lab" not in off and not off_children
    fine &= [name for name in on if name != "pursuit-lab"] == off and "pursuit-lab" in on
    fine &= on_files == off_files + 1 and not on_children and len(guard) == 1
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
