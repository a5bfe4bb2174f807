# SPDX-License-Identifier: MIT
"""Man pages and shell completions name what --help names, since both come from one table."""
import os
import re
import shutil
import subprocess
import sys

import common

PAGES, MAN, PURSUITD = os.environ["PAGES"], os.environ["MAN_SOURCES"], os.environ["PURSUITD"]


def pages(*arguments):
    result = subprocess.run([sys.executable, PAGES, *arguments, common.PURSUIT, PURSUITD], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return result.stdout


class Pages(common.Case):
    def verbs(self):
        return [line.split("\t")[0] for line in self.must("--print-verbs").stdout.splitlines()]

    def options(self, text):
        """As --help lists them."""
        return set(re.findall(r"(?m)^ {1,4}--(?:\[no-\])?([a-z0-9-]+)", text)) - {"help"}

    def complete(self, *words):
        with open(self.path("completion"), "w") as file:
            file.write(pages("bash"))
        script = f". {self.path('completion')}; COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; " \
                 f"_{words[0]}; echo \"${{COMPREPLY[@]}}\""
        result = subprocess.run(["bash", "-c", script], capture_output=True, text=True)
        self.assertEqual(result.stderr, "")
        return result.stdout.split()

    def test_every_verb_is_helped_with(self):
        listed = re.findall(r"(?m)^  ([a-z-]+)  ", self.must("--help").stdout)
        self.assertEqual(listed, self.verbs())

    def test_the_page_of_the_command_has_every_option_of_every_verb(self):
        page = pages("man", MAN + "/pursuit.1.scd")
        sections = dict(re.findall(r"(?ms)^## pursuit ([a-z-]+) (.*?)(?=^##? |\Z)", page))
        self.assertEqual(list(sections), self.verbs())
        for verb in self.verbs():
            options = self.options(self.must(verb, "--help").stdout)
            self.assertGreater(len(options), 0, verb)
            for option in options:
                self.assertRegex(sections[verb], rf"(?m)^\*--(\[no-\])?{option}\*", verb)

    def test_the_page_of_the_daemon_has_every_option(self):
        page = pages("man", MAN + "/pursuitd.1.scd")
        text = subprocess.run([PURSUITD, "--help"], capture_output=True, text=True, check=True).stdout
        options = self.options(text)
        self.assertIn("cell", options)
        for option in options - {"config", "print-config", "version"}:
            self.assertRegex(page, rf"(?m)^\*--(\[no-\])?{option}\*")

    def test_scdoc_takes_the_pages(self):
        if not shutil.which("scdoc"):
            self.skipTest("scdoc is not installed")
        for name in ["pursuit.1.scd", "pursuitd.1.scd"]:
            result = subprocess.run(["scdoc"], input=pages("man", f"{MAN}/{name}"), capture_output=True, text=True)
            self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_bash(self):
        self.assertIn("replay", self.complete("pursuit", "re"))
        self.assertNotIn("demo", self.complete("pursuit", "re"))
        self.assertEqual(self.complete("pursuit", "replay", "--pre"), ["--predict"])
        self.assertEqual(self.complete("pursuit", "replay", "--blur", ""), ["doubtful", "everywhere", "off"])
        self.assertIn("--no-compensation", self.complete("pursuit", "replay", "--no"))
        self.assertIn("debug", self.complete("pursuitd", "--log-level", "de"))

    def test_other_shells(self):
        for shell, arguments in [("zsh", ["-n"]), ("fish", ["--no-execute"])]:
            text = pages(shell)
            self.assertIn("replay", text)
            self.assertIn("predict", text)
            if shutil.which(shell):
                with open(self.path(shell), "w") as file:
                    file.write(text)
                result = subprocess.run([shell, *arguments, self.path(shell)], capture_output=True, text=True)
                self.assertEqual((result.returncode, result.stderr), (0, ""))


if __name__ == "__main__":
    common.main()
