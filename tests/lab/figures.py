# SPDX-License-Identifier: MIT
"""Prints the lab's figures of docs/figures.md: figures.py BUILD_FOLDER. Ten minutes; on an idle machine."""
import json
import os
import subprocess
import sys

BUILD = os.path.abspath(sys.argv[1])
HERE = os.path.dirname(os.path.abspath(__file__))
RIG, RIG_LAB = os.path.join(HERE, "../rig/run"), f"{BUILD}/tests/lab/rig-lab"
FLIPS = 1200


def rig(title, *arguments):
    """A case of rig_job.py, in the rig."""
    real = ["--real"] if arguments[0] == "realtime_figures" else []
    command = [RIG, *real, "python3", f"{HERE}/rig_job.py", RIG_LAB, *arguments]
    print(f"\n## {title}", flush=True)
    return subprocess.run(command, check=False).returncode


def threads(*arguments):
    """Microseconds of processor's time a flip: of each thread, and of all."""
    command = [RIG_LAB, "--flips", str(FLIPS), *arguments]
    out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    status = json.loads(out.splitlines()[-1])
    return status["threads"], status["cpu_us_per_flip"]


def cost():
    """Here, not in the rig, where a system call costs ten times as much; so without a line, whose ioctl comes on top."""
    print("\n## cost of a frame, microseconds of processor's time, headless, three runs each", flush=True)
    log = os.path.join(os.environ.get("TMPDIR", "/tmp"), "pursuit-figures.bin")
    cases = {"off": [], "a bare thread that is woken": ["--bare"], "on": ["--latency"],
             "on, ordinary priority": ["--latency", "--lab-priority", "0"],
             "on, log and patch": ["--latency-log", log, "--patch", "sequence"]}
    runs = {name: [] for name in cases}
    for _ in range(3):
        for name, arguments in cases.items():
            runs[name].append(threads(*arguments))
    for name, results in runs.items():
        own = min(result.get("pursuit-lab", result.get("bare", 0.0)) for result, _ in results)
        flip = min(result["pursuit-flip"] for result, _ in results)
        everything = min(total for _, total in results)
        print(f"{name:28} all threads {everything:6.1f}   the presenter's {flip:6.1f}   the lab's (or bare) {own:6.1f}", flush=True)
    os.unlink(log)


def main():
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    failed = rig("virtual time, 72,000 flips on the virtual display", "soak", "kms")
    failed |= rig("virtual time, headless: patterns", "patterns")
    failed |= rig("time stamps of the daemon's log against tracepoints", "daemon", "kms")
    failed |= rig("real time, virtual display", "realtime_figures", "kms")
    failed |= rig("real time, headless", "realtime_figures")
    cost()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
