# SPDX-License-Identifier: MIT
"""Every mistake planted in every scene: which pursuit check-stream finds. Prints the table of docs/figures.md.

usage: check-stream-table.py PURSUIT PLANT_MISTAKE [SCENE...]     exit status 1 if there is a false alarm
"""
import json
import os
import subprocess
import sys
import tempfile

from test_check_stream import FOUND, SCENES

SIZE, RATE, SECONDS = "480x270", "30", "1"


def codes(pursuit, path):
    result = subprocess.run([pursuit, "check-stream", path, "--json"], capture_output=True, text=True)
    return [finding["code"] for finding in json.loads(result.stdout)["findings"]]


def look(pursuit, plant, folder, scene):
    """For each kind: "found", "also CODE", "as CODE" or "not found"; for the good stream its alarms."""
    good, bad = os.path.join(folder, "good.pursuit"), os.path.join(folder, "bad.pursuit")
    subprocess.run([pursuit, "record", good, "--scene", scene, "--size", SIZE, "--fps", RATE, "--seconds", SECONDS],
                   check=True, stdout=subprocess.DEVNULL)
    row = {"good": codes(pursuit, good)}
    for kind, code in FOUND.items():
        subprocess.run([plant, kind, good, bad], check=True)
        got = codes(pursuit, bad)
        others = [other for other in got if other != code]
        if code in got:
            row[kind] = "found" if not others else "also " + " ".join(others)
        else:
            row[kind] = "as " + " ".join(got) if got else "-"
    return row


def main():
    pursuit, plant, *scenes = sys.argv[1:]
    scenes = scenes or [*SCENES, "still"]
    rows = {}
    for scene in scenes:
        with tempfile.TemporaryDirectory() as folder:
            rows[scene] = look(pursuit, plant, folder, scene)
        print(scene, rows[scene], file=sys.stderr, flush=True)
    print("| planted | " + " | ".join(scenes) + " |\n|" + " --- |" * (len(scenes) + 1))
    for kind in FOUND:
        print(f"| {kind} | " + " | ".join(rows[scene][kind] for scene in scenes) + " |")
    alarms = {scene: row["good"] for scene, row in rows.items() if row["good"]}
    print("\nfalse alarms on the good streams:", alarms or "none")
    return 1 if alarms else 0


if __name__ == "__main__":
    sys.exit(main())
