# SPDX-License-Identifier: MIT
"""The whole daemon on the kernel's virtual display; runs inside the rig (see run).

usage: test_daemon.py PURSUITD PURSUIT EXAMPLE [FENCES.so] [TEST...]

FENCES.so, loaded before the daemon, gives it fences of a GPU (fake-gl.h).

Each test says what it looks at from outside: the kernel's own state of the display, the daemon's status and log.
"""
import fcntl
import json
import os
import re
import signal
import subprocess
import sys
import time

PURSUITD, PURSUIT, EXAMPLE = sys.argv[1:4]
FENCES = [argument for argument in sys.argv[4:] if argument.endswith(".so")]
TESTS = [argument for argument in sys.argv[4:] if argument not in FENCES]
FOLDER = os.environ["TMPDIR"]
SOCKET = os.path.join(FOLDER, "socket")
STATE = "/sys/kernel/debug/dri/0/state"
CABLE = "/sys/class/drm/card0-Virtual-1/status"
CARD = "/dev/dri/card0"
CHECKSUMS = "/sys/kernel/debug/dri/0/crtc-0/crc"
MODE = "640x400@120"
PATIENCE = 20.0
DRM_SET_MASTER, DRM_DROP_MASTER = 0x641E, 0x641F
VT_ACTIVATE, TIOCSCTTY = 0x5606, 0x540E

failures = []


def check(condition, what):
    if not condition:
        print(f"FAILED: {what}")
        failures.append(what)


def wait_for(condition):
    """The clock is virtual, and costs nothing."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


def read(path):
    with open(path, encoding="utf-8", errors="replace") as file:
        return file.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def on_display():
    """Whose buffer the primary plane shows, and the active mode."""
    state = read(STATE)
    plane = state.split("plane[")[1]
    owner = re.search(r"allocated by = (\S+)", plane)
    mode = re.search(r'mode: "([^"]*)"', state)
    active = re.search(r"active=(\d)", state)
    return (owner.group(1) if owner else "nobody"), (mode.group(1) if active and active.group(1) == "1" else "dark")


class Daemon:
    def __init__(self, *arguments, present="kms", terminal=None, user=None, environment=None):
        self.log_path = os.path.join(FOLDER, "log")

        def prepare():
            if terminal:
                os.setsid()
                os.dup2(os.open(terminal, os.O_RDWR), 0)
                fcntl.ioctl(0, TIOCSCTTY, 0)
            if user:
                os.setgid(user)
                os.setuid(user)

        with open(self.log_path, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen(
                [PURSUITD, "--present", present, "--method", "hold", "--socket", SOCKET, *arguments],
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, preexec_fn=prepare,
                env={**os.environ, **(environment or {})})

    def log(self):
        return read(self.log_path)

    def says(self, text):
        return wait_for(lambda: text in self.log())

    def is_ready(self):
        return self.says("listening at")

    def status(self):
        answer = subprocess.run([PURSUIT, "status", "--json"], env={**os.environ, "PURSUIT_SOCKET": SOCKET},
                                stdout=subprocess.PIPE, check=False)
        return json.loads(answer.stdout or "{}")

    def set(self, name, value):
        answer = subprocess.run([PURSUIT, "set", f"{name}={value}"], env={**os.environ, "PURSUIT_SOCKET": SOCKET},
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if answer.returncode:
            print(" ", answer.stdout.strip())
        return answer.returncode == 0

    def end(self, number=signal.SIGTERM):
        self.process.send_signal(number)
        return self.process.wait(PATIENCE)

    def fails(self):
        """Its exit status is 1 and this is its log."""
        check(self.process.wait(PATIENCE) == 1, f"ends with status 1, not {self.process.returncode}")
        return self.log()


def find(tree, name):
    """The first value of this name, however deep."""
    if isinstance(tree, dict):
        if name in tree:
            return tree[name]
        tree = list(tree.values())
    if isinstance(tree, list):
        for value in tree:
            found = find(value, name)
            if found is not None:
                return found
    return None


def light_console():
    """The console's own buffer on display."""
    write("/sys/class/graphics/fb0/blank", "0")
    check(on_display()[0] == "[fbcon]", f"the console is on display before: {on_display()}")


def run_client(seconds):
    return subprocess.Popen([EXAMPLE, "--seconds", str(seconds)], env={**os.environ, "PURSUIT_SOCKET": SOCKET},
                            stdout=subprocess.PIPE)


def test_shows_and_restores():
    for number, status in ((signal.SIGTERM, 0), (signal.SIGKILL, -signal.SIGKILL)):
        light_console()
        before = on_display()
        daemon = Daemon("--mode", MODE, "--kms-device", CARD, "--connector", "Virtual-1")
        check(daemon.is_ready(), "the daemon starts on the display")
        client = run_client(3)
        time.sleep(2)
        answer = daemon.status()
        check(find(answer, "presenter") == "kms", "status names the presenter")
        check(str(find(answer, "display")).startswith(MODE + " on Virtual-1 of " + CARD), "status names mode and connector")
        check(find(answer, "flip_time_source") == "kernel", "flips are dated by the kernel")
        check(on_display() == ("pursuitd", MODE), f"the daemon's picture is on display: {on_display()}")
        check(b" 0 late" in client.communicate()[0], "the client hears of its frames")
        answer = daemon.status()
        print(f"  {find(answer, 'real_frames')} real frames, {find(answer, 'vblanks')} vblanks, "
              f"{find(answer, 'vblanks_on_time')} on time, {find(answer, 'lost_real_frames')} lost")
        check(find(answer, "real_frames") >= 100, "the real frames are shown")
        check(find(answer, "lost_real_frames") == 0, "no real frame is lost")
        check(find(answer, "vblanks") == find(answer, "vblanks_on_time"), "every vblank is on time on a virtual clock")
        check(daemon.end(number) == status, f"it ends by {number}")
        check(wait_for(lambda before=before: on_display() == before),
              f"after {number.name} the console is back: {before}, {on_display()}")


def scan_out(context, environment=None, mode=MODE):
    """What the controller made of a client's frames, vblank by vblank, as its checksums; and the daemon's status."""
    daemon = Daemon("--mode", mode, "--context", context, environment=environment)
    check(daemon.is_ready(), f"the daemon starts with context {context}")
    write(CHECKSUMS + "/control", "auto")
    data = os.open(CHECKSUMS + "/data", os.O_RDONLY | os.O_NONBLOCK)
    client = run_client(2)
    seen = []
    end = time.monotonic() + 3
    while time.monotonic() < end:
        try:
            while True:
                seen += re.findall(r"\S+ (0x[0-9a-f]+)", os.read(data, 4096).decode())
        except BlockingIOError:
            time.sleep(0.1)
    os.close(data)
    client.wait()
    answer = daemon.status()
    check(daemon.end() == 0, "it ends")
    return seen, answer, daemon.log()


def test_pictures_in_gl():
    seen, answer, log = scan_out("egl")
    if "pictures stay in GL" not in log:
        print("  skipped: no GL on this display:", log)
        return
    passes = find(answer, "passes")
    check(passes["read"] <= 1 and passes["copy"] > 60,
          f"nothing is read back but the last picture, to be kept when its client has gone: {passes}")
    check(find(answer, "vblanks") == find(answer, "vblanks_on_time"), "every vblank is on time")
    through_memory, answer, log = scan_out("cpu")
    check(find(answer, "passes")["copy"] == 0, "on the CPU there is nothing to copy in GL")
    check(len(set(seen)) > 40 and set(seen) == set(through_memory),
          f"the display gets the same bits: {len(seen)} and {len(through_memory)} vblanks, "
          f"{len(set(seen))} and {len(set(through_memory))} pictures, {len(set(seen) & set(through_memory))} alike")


def test_fences():
    """Each fence signals a millisecond after its picture was drawn: between flip and vblank."""
    if not FENCES:
        print("  skipped: there are no fences without GL")
        return
    plain, answer, log = scan_out("egl")
    if "pictures stay in GL" not in log:
        print("  skipped: no GL on this display:", log)
        return
    check("by its fences" not in log, "software has none")
    seen, answer, log = scan_out("egl", {"LD_PRELOAD": FENCES[0], "FAKE_FENCES_MS": "1"})
    check("by its fences" in log, f"they are used: {log}")
    check(find(answer, "passes")["copy"] > 60, "pictures are drawn by GL")
    check(find(answer, "vblanks") == find(answer, "vblanks_on_time"), "every vblank is on time")
    check(find(answer, "lost_real_frames") == 0, "no real frame is lost")
    check(len(set(seen)) > 40 and set(seen) == set(plain), f"the display gets the same bits: {len(set(seen))} pictures, "
          f"{len(set(seen) & set(plain))} of {len(set(plain))} alike")
    seen, answer, _ = scan_out("egl", {"LD_PRELOAD": FENCES[0], "FAKE_FENCES_MS": "20"})
    check(find(answer, "late_flips") > 60, "flips that the GPU is late for are told as late")
    check(find(answer, "lost_real_frames") == 0, "and no real frame is lost by it")
    check(set(plain) <= set(seen), "all of them are shown")


def test_larger_frames():
    for context in ("cpu", "egl"):
        seen, answer, log = scan_out(context, mode="320x180@120")
        check("on 320x180: made smaller, to 3" in log, f"it is said: {log}")
        check(find(answer, "vblanks") == find(answer, "vblanks_on_time"), "every vblank is on time")
        check(find(answer, "lost_real_frames") == 0, "no real frame is lost")
        check(len(set(seen)) > 40, f"{context}: pictures are shown: {len(set(seen))}")


def test_another_mode():
    daemon = Daemon("--mode", MODE)
    check(daemon.is_ready(), "the daemon starts")
    client = run_client(30)
    for mode in ("320x180@120", "800x600@100", MODE):
        check(daemon.set("mode", mode), f"the mode {mode} is taken")
        size = mode.split("@", maxsplit=1)[0] + "@"
        check(wait_for(lambda size=size: on_display()[1].startswith(size)), f"and set: {on_display()}, not {mode}")
        check(on_display()[0] == "pursuitd", f"with the daemon's picture: {on_display()}")
        shown = find(daemon.status(), "real_frames")
        check(wait_for(lambda shown=shown: find(daemon.status(), "real_frames") > shown + 40), "frames are shown there")
    daemon.set("connector", "HDMI-A-1")
    shown = find(daemon.status(), "real_frames")
    check(wait_for(lambda: find(daemon.status(), "real_frames") > shown + 40), "a connector that is not there changes nothing")
    check(on_display() == ("pursuitd", MODE), f"nothing: {on_display()}")
    check(find(daemon.status(), "lost_real_frames") == 0, f"no real frame is lost: {find(daemon.status(), 'lost_real_frames')}")
    client.kill()
    check(daemon.end() == 0, "it ends")


def test_no_gl_on_the_display():
    seen, _, log = scan_out("auto", {"LIBGL_DRIVERS_PATH": "/nonexistent"})
    check("no buffers that GL can draw into" in log or "without GBM" in log, f"it is said: {log}")
    check(len(set(seen)) > 40, "and pictures are shown all the same")


def test_refusals():
    for arguments, sentence in (
            (("--kms-device", "/dev/dri/card7"), "kms: /dev/dri/card7: No such file or directory"),
            (("--kms-device", "/dev/null"), "drives no display"),
            (("--connector", "HDMI-A-1"), 'has no connector "HDMI-A-1"; it has Virtual-1'),
            (("--mode", "ten"), '"ten" is not a mode like'),
            (("--mode", "9000x9000@60"), "9000x9000")):
        log = Daemon(*arguments).fails()
        check(sentence in log, f"{' '.join(arguments)} is answered with '{sentence}': {log}")
        daemon = Daemon(*arguments, present="kms,headless")
        check(daemon.is_ready(), f"{' '.join(arguments)}: falls back to headless")
        check(find(daemon.status(), "presenter") == "headless", "status names headless")
        check(daemon.end() == 0, "it ends")


def test_busy():
    other = os.open(CARD, os.O_RDWR)  # who opens it first is its master
    log = Daemon().fails()
    check("is in use by another display server" in log, f"busy is said: {log}")
    os.close(other)


def test_permission():
    os.chmod(FOLDER, 0o777)
    log = Daemon(user=65534).fails()
    check("permission denied" in log and "video" in log, f"the group is named: {log}")
    os.chown(CARD, 0, 44)
    os.chmod(CARD, 0o660)

    daemon = Daemon("--mode", MODE, user=65534)
    check("permission denied" in daemon.fails(), "still not in the group")
    os.chown(CARD, 0, 65534)
    daemon = Daemon("--mode", MODE, user=65534)
    check(daemon.is_ready(), "an ordinary user of the right group is served")
    print("  " + "\n  ".join(line for line in daemon.log().splitlines() if "flips without" in line))
    check(daemon.end() == 0, "it ends")
    os.chown(CARD, 0, 0)


def test_unplugged():
    daemon = Daemon("--mode", MODE)
    check(daemon.is_ready(), "the daemon starts")
    client = run_client(12)
    time.sleep(1)
    write(CABLE, "off")
    check(daemon.says("the display was unplugged"), "the loss is said")
    check(wait_for(lambda: find(daemon.status(), "presenter") == "none"), "status says that there is no display")
    write(CABLE, "on")
    check(wait_for(lambda: find(daemon.status(), "presenter") == "kms"), "and that it is back")
    shown = find(daemon.status(), "real_frames")
    check(wait_for(lambda: find(daemon.status(), "real_frames") > shown + 40), "frames are shown again")
    client.kill()
    check(daemon.end() == 0, "it ends")
    write(CABLE, "detect")


def test_unplugged_with_another_to_fall_back_on():
    write(CABLE, "off")
    daemon = Daemon("--mode", MODE, present="kms,headless")
    check(daemon.is_ready(), "the daemon starts without a display")
    check(find(daemon.status(), "presenter") == "headless", "headless, as nothing is plugged in")
    client = run_client(60)
    for _ in range(2):
        write(CABLE, "on")
        check(wait_for(lambda: find(daemon.status(), "presenter") == "kms"), "it goes to the display that is plugged in")
        shown = find(daemon.status(), "real_frames")
        check(wait_for(lambda: find(daemon.status(), "real_frames") > shown + 40), "frames are shown there")
        check(on_display() == ("pursuitd", MODE), f"really: {on_display()}")
        time.sleep(3)
        write(CABLE, "off")
        check(wait_for(lambda: find(daemon.status(), "presenter") == "headless"), "and back to headless without it")
        shown = find(daemon.status(), "real_frames")
        check(wait_for(lambda: find(daemon.status(), "real_frames") > shown + 40), "frames are shown there too")
    check("kms works again and takes over from headless" in daemon.log(), "the change is said")
    client.kill()
    check(daemon.end() == 0, "it ends")
    write(CABLE, "detect")


def activate(console):
    """Switches without waiting, as the keys do."""
    tty = os.open("/dev/tty0", os.O_RDWR | os.O_NOCTTY)
    fcntl.ioctl(tty, VT_ACTIVATE, console)
    os.close(tty)


def active():
    return read("/sys/class/tty/tty0/active").strip()


def test_other_console():
    daemon = Daemon("--mode", MODE, terminal="/dev/tty1")
    check(daemon.is_ready(), "the daemon starts on a console")
    client = run_client(30)
    time.sleep(1)
    daemon.process.send_signal(signal.SIGUSR1)
    time.sleep(1)
    check("another console" not in daemon.log(), "a signal that the terminal has not sent is not taken for a switch")
    activate(2)
    check(daemon.says("another console is on display"), "leaving is said")
    check(wait_for(lambda: active() == "tty2"), f"the other console is active: {active()}")
    other = os.open(CARD, os.O_RDWR)
    try:
        fcntl.ioctl(other, DRM_SET_MASTER, 0)
        fcntl.ioctl(other, DRM_DROP_MASTER, 0)
    except OSError as error:
        check(False, f"another program can have the display: {error}")
    os.close(other)
    unseen = find(daemon.status(), "real_frames")
    check(wait_for(lambda: find(daemon.status(), "real_frames") > unseen + 40), "frames go on unseen")
    activate(1)
    check(daemon.says("back on display"), "coming back is said")
    check(wait_for(lambda: active() == "tty1" and on_display() == ("pursuitd", MODE)), f"it is back: {on_display()}")
    seen = find(daemon.status(), "real_frames")
    check(wait_for(lambda: find(daemon.status(), "real_frames") > seen + 40), "frames are shown again")
    check(daemon.end(signal.SIGKILL) == -signal.SIGKILL, "it is killed")
    client.kill()
    activate(3)
    check(wait_for(lambda: active() == "tty3"), "the kernel takes the console of a dead process back")
    activate(1)
    check(wait_for(lambda: active() == "tty1"), "and gives it to others")


def main():
    for name, test in list(globals().items()):
        if name.startswith("test_") and (not TESTS or name in TESTS):
            before = len(failures)
            test()
            print("ok    " if len(failures) == before else "FAILED", name, flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
