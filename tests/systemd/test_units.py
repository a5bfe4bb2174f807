# SPDX-License-Identifier: MIT
"""The units: well-formed, hardened with a reason for each line, and run by a real manager of its own.

usage: test_units.py static|manager PURSUITD SYSTEM_SERVICE USER_SERVICE TOP
"""
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

WHAT, PURSUITD, SYSTEM_SERVICE, USER_SERVICE, TOP = sys.argv[1:6]
WATCHDOG = 8  # seconds, for which other programs hardly ever keep one from running
PATIENCE = 60
MOST_EXPOSURE = 15  # tenths, as systemd-analyze counts: 0 to 100
SKIP = 77
failures = []


def check(holds, sentence):
    print("ok    " if holds else "FAILED", sentence)
    if not holds:
        failures.append(sentence)


def skip(sentence):
    print("SKIP: " + sentence)
    sys.exit(SKIP)


def read(path):
    with open(path, encoding="utf-8") as source:
        return source.read()


def unit_folder(folder, service, socket_unit, changes=()):
    """Copies of both units that name the program that was built."""
    text = re.sub(r"^ExecStart=\S+/pursuitd.*$", f"ExecStart={PURSUITD} --method hold", read(service), flags=re.M)
    for old, new in changes:
        text = re.sub(old, new, text, flags=re.M)
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "pursuit.service"), "w", encoding="utf-8") as out:
        out.write(text)
    shutil.copy(os.path.join(TOP, "systemd", socket_unit), os.path.join(folder, "pursuit.socket"))


def check_reasons(path):
    """Each line of the hardening has a comment before it."""
    before, hardening = "", False
    for line in read(path).splitlines():
        if line.startswith("# -- "):
            hardening = True
        elif line.startswith("["):
            hardening = False
        elif hardening and "=" in line and not line.startswith(("#", "Limit", "Tasks")):
            check(before.startswith("# ") and not before.startswith("# --"), f"{os.path.basename(path)}: {line} has its reason")
        before = line


def static():
    if not shutil.which("systemd-analyze"):
        skip("systemd-analyze is missing")
    with tempfile.TemporaryDirectory() as folder:
        for name, service, listen in (("system", SYSTEM_SERVICE, "pursuit.socket"), ("user", USER_SERVICE, "user/pursuit.socket")):
            units = os.path.join(folder, name)
            unit_folder(units, service, listen)
            mode = ["--user"] if name == "user" else []
            verify = subprocess.run(["systemd-analyze", *mode, "--man=no", "verify", os.path.join(units, "pursuit.service")],
                                    capture_output=True, text=True, timeout=PATIENCE,
                                    env={**os.environ, "XDG_RUNTIME_DIR": folder})
            ours = [line for line in verify.stderr.splitlines() if "pursuit" in line]
            if "Failed to" in verify.stderr and not ours:
                print("      ", verify.stderr.strip().splitlines()[-1])
            check(not ours, f"{name} units verify: {ours}")
            check_reasons(service)
        security = subprocess.run(["systemd-analyze", "security", "--offline=true", "--no-pager", f"--threshold={MOST_EXPOSURE}",
                                   os.path.join(folder, "system", "pursuit.service")], capture_output=True, text=True, timeout=60)
        score = re.search(r"exposure level for pursuit.service: ([\d.]+)", security.stdout)
        check(security.returncode == 0 and score is not None, f"exposure {score and score.group(1)}, at most {MOST_EXPOSURE / 10}")
    for name in ("sysusers.conf", "tmpfiles.conf"):
        lines = [line.split() for line in read(os.path.join(TOP, "systemd", name)).splitlines() if line and line[0] != "#"]
        check(all(line[0] in ("u", "m", "d") for line in lines), f"{name} has lines of known types")


# ---- a manager ----

MANAGER = """mount -t tmpfs tmpfs /run && mount -t proc proc /proc && mkdir -p /run/systemd/system {run}/systemd &&
chmod 700 {run} && env -i PATH="$PATH" HOME={folder} XDG_RUNTIME_DIR={run} SYSTEMD_UNIT_PATH={folder}/units \
SYSTEMD_LOG_TARGET=console /lib/systemd/systemd --user --unit=pursuit.socket
exit 1 # not by exec: a manager with number 1 takes itself for the system's
"""


def start_manager(folder):
    """A user's manager in namespaces of its own, which end with it."""
    if not os.path.exists("/lib/systemd/systemd") or not shutil.which("unshare"):
        skip("systemd or unshare is missing")
    log = open(os.path.join(folder, "manager.log"), "w", encoding="utf-8")
    script = MANAGER.format(run="/run/user/test", folder=folder)
    return subprocess.Popen(["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c", script], stdout=log,
                            stderr=log, stdin=subprocess.DEVNULL)


def greet(path):
    """Says HELLO; True if WELCOME came. The manager starts the daemon for it."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as client:
        client.settimeout(PATIENCE)
        client.connect(path)
        hello = struct.pack("<IIII", 1, 96, 1, 0) + struct.pack("<IIII", 0x54495550, 1, 1, 0) + b"units".ljust(64, b"\0")
        client.send(hello)
        answer = client.recv(65536)
        return len(answer) >= 4 and struct.unpack("<I", answer[:4])[0] == 2


def daemon_pid(folder):
    """Of the daemon whose home is this folder, None if there is none."""
    for name in os.listdir("/proc"):
        try:
            with open(f"/proc/{name}/environ", "rb") as source:
                environment = source.read()
            with open(f"/proc/{name}/comm", encoding="utf-8") as source:
                command = source.read().strip()
        except (OSError, ValueError):
            continue
        if command == "pursuitd" and f"HOME={folder}".encode() in environment.split(b"\0"):
            return int(name)
    return None


def wait_for(question, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        answer = question()
        if answer:
            return answer
        time.sleep(0.05)
    return None


def manager():
    folder = tempfile.mkdtemp(prefix="pursuit-units-")
    path = os.path.join(folder, "socket")
    unit_folder(os.path.join(folder, "units"), USER_SERVICE, "user/pursuit.socket",
                [(r"^WatchdogSec=.*$", f"WatchdogSec={WATCHDOG}s"), (r"^After=.*$", "After=pursuit.socket\nDefaultDependencies=no"),
                 (r"^StartLimitBurst=.*$", "StartLimitBurst=50")])
    listen = os.path.join(folder, "units", "pursuit.socket")
    text = read(listen).replace("%t/pursuit/socket", path).replace("[Unit]", "[Unit]\nDefaultDependencies=no")
    with open(listen, "w", encoding="utf-8") as out:
        out.write(text)
    process = start_manager(folder)
    try:
        if not wait_for(lambda: os.path.exists(path) or process.poll() is not None, PATIENCE) or process.poll() is not None:
            skip("no manager of our own can be started here (namespaces, control groups): "
                 + read(os.path.join(folder, "manager.log"))[-200:].strip())
        check(daemon_pid(folder) is None, "nothing runs before the first client")
        welcomed = greet(path)
        if not welcomed and "ontext" in read(os.path.join(folder, "manager.log")):
            skip("no GL context can be made on this machine")
        check(welcomed, "the first client starts the daemon and is welcome")
        first = daemon_pid(folder)
        time.sleep(1.5 * WATCHDOG)
        check(daemon_pid(folder) == first, "an idle daemon outlives its watchdog's interval")
        os.kill(first, signal.SIGSTOP)
        second = wait_for(lambda: daemon_pid(folder) not in (None, first) and daemon_pid(folder), PATIENCE)
        check(second is not None, "a stuck daemon is started anew")
        check(greet(path), "and welcomes clients at the same place")
        third = daemon_pid(folder)
        os.kill(third, signal.SIGKILL)
        check(greet(path), "after kill -9 the next client waits for the new one, and is welcome")
    finally:
        process.kill()
        process.wait()
        shutil.rmtree(folder, ignore_errors=True)


{"static": static, "manager": manager}[WHAT]()
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
