# SPDX-License-Identifier: MIT
"""The kernel's own view of the flips, without any help of the program under test; runs inside the rig (see run).

usage: test_flips.py RIG_PRESENT FLIPS

Tracepoints see every vblank of the virtual display and every event that the kernel delivers: each vblank must follow
the one before by one period, and bring one flip and one count to the program.
"""
import re
import subprocess
import sys

TRACING = "/sys/kernel/tracing/"
PROGRAM, FLIPS = sys.argv[1], int(sys.argv[2])
# The first and the last vblanks come before and after the flips.
EDGE = 8


def write(name, text):
    with open(TRACING + name, "w", encoding="utf-8") as file:
        file.write(text)


def main():
    write("trace_clock", "mono")
    write("buffer_size_kb", "16384")
    write("events/drm/drm_vblank_event/enable", "1")
    write("events/drm/drm_vblank_event_delivered/enable", "1")
    status = subprocess.run([PROGRAM, "--flips", str(FLIPS), "--mode", "160x120@120"], check=False).returncode
    write("tracing_on", "0")
    times, delivered = {}, {}
    with open(TRACING + "trace", encoding="utf-8") as trace:
        for line in trace:
            match = re.search(r"drm_vblank_event: crtc=0, seq=(\d+), time=(\d+)", line)
            if match:
                times[int(match.group(1))] = int(match.group(2))
            match = re.search(r"drm_vblank_event_delivered: .*seq=(\d+)", line)
            if match:
                delivered[int(match.group(1))] = delivered.get(int(match.group(1)), 0) + 1
    numbers = sorted(times)
    intervals = {times[b] - times[a] for a, b in zip(numbers, numbers[1:])}
    pairs = sum(1 for number in numbers if delivered.get(number, 0) == 2)
    print(f"tracepoints: {len(numbers)} vblanks, intervals {sorted(intervals)} ns, {pairs} with a flip and a count")
    fine = status == 0
    fine &= len(numbers) >= FLIPS and numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    fine &= max(intervals) - min(intervals) <= 1
    fine &= pairs == FLIPS
    middle = numbers[EDGE:-EDGE]
    fine &= sum(1 for number in middle if delivered.get(number, 0) != 2) <= EDGE
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
