# SPDX-License-Identifier: MIT
"""Counts the results in meson's testlog.json: prints `passed failed skipped` and names skips with their reasons."""
import json
import sys

PASSED = {"OK", "EXPECTEDFAIL"}
SKIPPED = {"SKIP"}


def main(path):
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    with open(path, encoding="utf-8") as log:
        for line in log:
            test = json.loads(line)
            result = test["result"]
            kind = "passed" if result in PASSED else "skipped" if result in SKIPPED else "failed"
            counts[kind] += 1
            if kind == "skipped":
                reason = [text for text in test.get("stdout", "").splitlines() if text.startswith("skipped:")]
                print(f"{test['name']}: {reason[-1] if reason else 'skipped, no reason given'}", file=sys.stderr)
    print(counts["passed"], counts["failed"], counts["skipped"])


if __name__ == "__main__":
    main(sys.argv[1])
