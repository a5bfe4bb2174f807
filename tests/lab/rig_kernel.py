# SPDX-License-Identifier: MIT
"""What the rig's kernel has for the lab: a chip of gpio-sim, and tracepoints that tell what really happened."""
import bisect
import glob
import os
import re
import sys

SIM = "/sys/kernel/config/gpio-sim/lab"
TRACE = "/sys/kernel/tracing"
VALUE = re.compile(r"(\d+\.\d+): gpio_value: (\d+) set (\d)")
VBLANK = re.compile(r"drm_vblank_event: crtc=0, seq=(\d+), time=(\d+)")
LINES = 28
# offset: name, and a line that the kernel itself holds
NAMES = {17: "MARKER", 18: "REAL", 19: "BETWEEN", 4: "PHOTODIODE", 5: "TRIGGER", 6: "STROBE", 7: "VSYNC"}
HOG = 27
PERIOD_US = 1e6 / 120

failures = []


def check(true, *words):
    if not true:
        failures.append(" ".join(map(str, words)))
        print("FAILED:", *words, flush=True)


def write(path, text):
    with open(path, "w") as out:
        out.write(text)


def read(path):
    with open(path) as source:
        return source.read()


# ---- the chip ----


def make_chip():
    """A chip with named lines; gives its folder in sysfs back."""
    os.makedirs(f"{SIM}/bank")
    write(f"{SIM}/bank/num_lines", str(LINES))
    write(f"{SIM}/bank/label", "lab-chip")
    for offset, name in NAMES.items():
        os.mkdir(f"{SIM}/bank/line{offset}")
        write(f"{SIM}/bank/line{offset}/name", name)
    os.makedirs(f"{SIM}/bank/line{HOG}/hog")
    write(f"{SIM}/bank/line{HOG}/hog/name", "someone-else")
    write(f"{SIM}/bank/line{HOG}/hog/direction", "input")
    plug(True)
    folder = f"/sys/devices/platform/{read(SIM + '/dev_name').strip()}/{read(SIM + '/bank/chip_name').strip()}"
    if not glob.glob("/dev/gpiochip*"):
        sys.exit("no /dev/gpiochip*")
    return folder


def plug(there):
    write(f"{SIM}/live", "1" if there else "0")


def chip_base():
    for folder in glob.glob("/sys/class/gpio/gpiochip*"):
        if read(f"{folder}/label").strip() == "lab-chip":
            return int(read(f"{folder}/base"))
    return 0


# ---- tracepoints ----


def trace_start(vblanks):
    write(f"{TRACE}/trace_clock", "mono")
    write(f"{TRACE}/buffer_size_kb", "32000")
    write(f"{TRACE}/trace", "")
    write(f"{TRACE}/events/gpio/gpio_value/enable", "1")
    if vblanks:
        write(f"{TRACE}/events/drm/drm_vblank_event/enable", "1")


def trace_read():
    """
    (sets [(us, offset, level)], vblanks {us: number}): all calls that set a line, and the display's vblanks with the time
    stamps that the kernel itself gives them.
    """
    sets, vblanks, base = [], {}, chip_base()
    with open(f"{TRACE}/trace") as source:
        for line in source:
            value, vblank = VALUE.search(line), VBLANK.search(line)
            if value:
                sets.append((float(value.group(1)) * 1e6, int(value.group(2)) - base, int(value.group(3))))
            elif vblank:
                vblanks[int(vblank.group(2)) / 1e3] = int(vblank.group(1))
    return sets, vblanks


def edges_of(sets):
    """Only real changes of level; lines begin low."""
    edges, levels = [], {}
    for time_us, offset, level in sets:
        if levels.get(offset, 0) != level:
            edges.append((time_us, offset, level))
        levels[offset] = level
    return edges


def of_line(edges, offset, level=None):
    return [time_us for time_us, line, value in edges if line == offset and level in (None, value)]


# ---- what is right ----


def check_steady(times, name, periods=1, count=None):
    """As many as wanted, in order, none twice, each so many refreshes after the one before."""
    if count is not None:
        check(len(times) == count, name, "edges", len(times), "not", count)
    steps = [b - a for a, b in zip(times, times[1:])]
    odd = [step for step in steps if abs(step - periods * PERIOD_US) > 60]
    check(not odd, name, len(odd), "of", len(steps), "steps are not", periods, "refreshes:", odd[:3])


def check_at_vblanks(times, vblanks, name, periods=1, after_us=0.0, within_us=200.0):
    """
    Each belongs to a vblank of the kernel's own, at most so long after it, one to one, every one (or every third ...) in
    order. Gives the delays back. Without a display there are none to compare with.
    """
    if not vblanks:
        return []
    stamps, numbers, delays = sorted(vblanks), [], []
    for time_us in times:
        at = bisect.bisect_right(stamps, time_us - after_us) - 1
        numbers.append(vblanks[stamps[at]] if at >= 0 else -1)
        delays.append(time_us - after_us - stamps[max(at, 0)])
    late = [delay for delay in delays if not 0 <= delay < within_us]
    check(not late, name, len(late), "of", len(times), "edges are not at a vblank of the kernel:", late[:3])
    steps = [b - a for a, b in zip(numbers, numbers[1:])]
    odd = [step for step in steps if step != periods]
    check(not odd, name, len(odd), "of", len(steps), "edges skip or double a vblank of the kernel:", odd[:3])
    return delays
