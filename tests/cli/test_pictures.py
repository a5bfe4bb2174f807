# SPDX-License-Identifier: MIT
"""The pictures of the documents are those that make_pictures.py makes of the engine as it is."""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import browser
import common
import make_pictures

DOCS = os.path.dirname(os.environ["MAN_SOURCES"])
BUILD = os.path.dirname(os.path.dirname(os.path.dirname(common.PURSUIT)))
# One of each kind, all of them take minutes; and a mean difference, in code values. Without its mistake the second has 0.5.
MADE = {"eye.png": 4.0, "mistake-jitter-motion.png": 0.3}
CAPTION = 30  # rows at the bottom: another font is no other picture


def mean_difference(a, b):
    """Of the part that both have; letters below are not looked at."""
    height, width = min(len(a), len(b)) - CAPTION, min(len(a[0]), len(b[0]))
    sums = sum(abs(x - y) for left, right in zip(a[:height:3], b[:height:3]) for x, y in zip(left[:width], right[:width]))
    return sums / (len(range(0, height, 3)) * width)


class Pictures(unittest.TestCase):
    def test_all_come_from_the_program_and_are_shown(self):
        pictures = sorted(os.listdir(os.path.join(DOCS, "pictures")))
        self.assertEqual(pictures, sorted([*make_pictures.NAMES, "architecture.svg"]))
        pages = [os.path.join(DOCS, name) for name in os.listdir(DOCS) if name.endswith(".md")]
        text = "".join(open(page, encoding="utf-8").read() for page in [*pages, os.path.join(DOCS, "../README.md")])
        self.assertEqual(sorted(set(re.findall(r"!\[[^]]+\]\((?:docs/)?pictures/([^)]+)\)", text))), pictures)

    def test_they_are_up_to_date(self):
        if not browser.find():
            self.skipTest("there is no chromium")
        with tempfile.TemporaryDirectory(prefix="pursuit-test-") as out:
            script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "make_pictures.py")
            made = subprocess.run([sys.executable, script, BUILD, out, *MADE], capture_output=True, text=True)
            self.assertEqual(made.returncode, 0, made.stderr)
            for name, far_off in MADE.items():
                new, kept = (make_pictures.read_png(f"{folder}/{name}") for folder in (out, DOCS + "/pictures"))
                self.assertLess(abs(len(new) - len(kept)), CAPTION, name)
                self.assertLess(abs(len(new[0]) - len(kept[0])), 3 * CAPTION, name)
                self.assertLess(mean_difference(new, kept), far_off, name)


if __name__ == "__main__":
    if not browser.find():
        print("skipped: there is no chromium")
        sys.exit(77)
    common.main()
