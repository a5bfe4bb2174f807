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

    def test_the_page_of_the_command_names_every_verb(self):
        page = pages("man", MAN + "/pursuit.1.scd")
        self.assertEqual(re.findall(r"(?m)^\*([a-z-]+)\*$", page), self.verbs())
        for verb in self.verbs():
            self.assertEqual(page.count(f"*pursuit-{verb}*(1)"), 2, verb)

    def test_every_verb_has_its_page_installed(self):
        with open(os.path.join(os.path.dirname(MAN), "meson.build"), encoding="utf-8") as source:
            listed = re.search(r"(?s)verbs = \[(.*?)\]", source.read()).group(1)
        self.assertEqual(re.findall(r"'([a-z-]+)'", listed), sorted(self.verbs()))

    def test_the_page_of_a_verb_says_what_help_says(self):
        for verb in self.verbs():
            page = pages("verb", MAN + "/verb.1.scd", verb)
            text = self.must(verb, "--help").stdout
            for section in "NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXAMPLES", "EXIT STATUS", "SEE ALSO":
                self.assertIn(f"# {section}\n", page, verb)
            for option in self.options(text):
                self.assertRegex(page, rf"(?m)^\*--(\[no-\])?{option}\*", verb)
            plain = page.replace("\\", "")
            for line in text.split("\nexamples\n")[1].splitlines():
                self.assertIn(line.strip(), page, verb)
            for line in text.split("\n\n")[1].splitlines():
                self.assertIn(line, plain, verb)
            related = re.findall(r"\*pursuit-([a-z-]+)\*\(1\)", page.split("# SEE ALSO")[1])
            self.assertTrue(related and set(related) <= set(self.verbs()) - {verb}, verb)

    def test_the_page_of_the_daemon_has_every_option(self):
        page = pages("man", MAN + "/pursuitd.1.scd")
        text = subprocess.run([PURSUITD, "--help"], capture_output=True, text=True, check=True).stdout
        options = self.options(text)
        self.assertIn("cell", options)
        for option in options - {"config", "print-config", "version"}:
            self.assertRegex(page, rf"(?m)^\*--(\[no-\])?{option}\*")

    def test_nobody_complains_of_the_pages(self):
        if not shutil.which("scdoc"):
            self.skipTest("scdoc is not installed")
        sources = {name: pages("man", f"{MAN}/{name}.1.scd") for name in ("pursuit", "pursuitd")}
        sources |= {f"pursuit-{verb}": pages("verb", MAN + "/verb.1.scd", verb) for verb in self.verbs()}
        for name, source in sources.items():
            path = self.path(name + ".1")
            with open(path + ".scd", "w", encoding="utf-8") as out:
                out.write(source)
            made = subprocess.run([sys.executable, PAGES, "roff", "scdoc", path + ".scd"], capture_output=True, text=True)
            self.assertEqual((made.returncode, made.stderr), (0, ""), name)
            with open(path, "w", encoding="utf-8") as out:
                out.write(made.stdout)
            for judge in ["man", "--warnings", "-l", "-Tutf8", "-Z"], ["mandoc", "-Tlint"]:
                if shutil.which(judge[0]):
                    said = subprocess.run([*judge, path], capture_output=True, text=True,
                                          env={**os.environ, "LC_ALL": "C.UTF-8"})
                    self.assertEqual(said.stderr, "", name)
                    self.assertNotIn("STYLE", said.stdout, name)
                    self.assertNotIn("WARNING", said.stdout, name)

    def test_bash(self):
        self.assertIn("replay", self.complete("pursuit", "re"))
        self.assertNotIn("demo", self.complete("pursuit", "re"))
        self.assertEqual(self.complete("pursuit", "replay", "--pre"), ["--predict"])
        self.assertEqual(self.complete("pursuit", "replay", "--blur", ""), ["doubtful", "everywhere", "off"])
        self.assertEqual(self.complete("pursuit", "replay", "--method", "adap"), ["adaptive-grid"])
        self.assertEqual(self.complete("pursuit", "demo", "--scene", "t"), ["tower", "trees"])
        self.assertEqual(self.complete("pursuit", "report", "--methods", "mc"), ["mcif"])
        self.assertEqual(self.complete("pursuitd", "--present", ""), ["headless", "glfw", "kms"])
        self.assertEqual(self.complete("pursuit", "set", "context", "=", ""), ["auto", "egl", "osmesa", "cpu"])
        self.assertIn("--no-compensation", self.complete("pursuit", "replay", "--no"))
        self.assertIn("debug", self.complete("pursuitd", "--log-level", "de"))

    def table(self):
        """Names of the daemon's settings, and the values of those that have a list."""
        lines = subprocess.run([os.environ["PURSUITD"], "--print-options"], capture_output=True, text=True, check=True)
        rows = [line.split("\t") for line in lines.stdout.splitlines() if line.startswith("option\t")]
        return {row[1].replace("[no-]", ""): ["yes", "no"] if "[no-]" in row[1] else row[3].split(",") if row[3] else []
                for row in rows}

    def test_bash_completes_settings(self):
        table = self.table()
        self.assertGreater(len(table), 60)
        self.assertEqual(sorted(self.complete("pursuit", "get", "''")), sorted(table))
        self.assertEqual(sorted(self.complete("pursuit", "set", "''")), sorted(name + "=" for name in table))
        wanted = {name: values for name, values in table.items() if values}
        self.assertIn("blur", wanted)
        with open(self.path("completion"), "w") as file:
            file.write(pages("bash"))
        script = f". {self.path('completion')}\n" + "\n".join(
            f"COMP_WORDS=(pursuit set {name} = ''); COMP_CWORD=4; COMPREPLY=(); _pursuit; echo {name} \"${{COMPREPLY[@]}}\""
            for name in wanted)
        said = subprocess.run(["bash", "-c", script], capture_output=True, text=True)
        self.assertEqual(said.stderr, "")
        self.assertEqual({line.split()[0]: line.split()[1:] for line in said.stdout.splitlines()}, wanted)

    def test_bash_completes_profile(self):
        said = subprocess.run([common.PURSUIT, "profile", "nonsense"], capture_output=True, text=True).stderr
        there = re.search(r"there are (.*)", said).group(1).replace(" and ", ", ").split(", ")
        self.assertEqual(self.complete("pursuit", "profile", "''"), there)
        self.assertEqual(self.complete("pursuit", "profile", "set", "game", "motion-m"), ["motion-model="])
        self.assertEqual(self.complete("pursuit", "profile", "set", "game", "blur", "=", "ev"), ["everywhere"])

    def test_zsh_and_fish_know_the_same(self):
        texts = {shell: pages(shell) for shell in ("zsh", "fish")}
        for name, values in self.table().items():
            for text in texts.values():
                self.assertRegex(text, rf"\b{name}\b")
            if values:
                self.assertIn(f"\t\t{name}) compadd -- {' '.join(values)} ;;", texts["zsh"])
            for value in values:
                self.assertIn(f"-a '{name}={value}'", texts["fish"])
        for text in texts.values():
            self.assertIn("list show set unset remove", text)

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

    def test_zsh_loads_it(self):
        if not shutil.which("zsh"):
            self.skipTest("zsh is not installed")
        with open(self.path("_pursuit"), "w") as file:
            file.write(pages("zsh"))
        script = f"fpath=({self.folder} $fpath); autoload -Uz compinit; compinit -u -D; autoload +X -Uz _pursuit; " \
                 "print $_comps[pursuit] $_comps[pursuitd]"
        result = subprocess.run(["zsh", "-f", "-c", script], capture_output=True, text=True)
        self.assertEqual((result.stdout, result.stderr), ("_pursuit _pursuit\n", ""))

    def test_fish_completes(self):
        if not shutil.which("fish"):
            self.skipTest("fish is not installed")
        with open(self.path("pursuit.fish"), "w") as file:
            file.write(pages("fish"))
        environment = {**os.environ, "HOME": self.folder, "XDG_CONFIG_HOME": self.folder}
        for words, expected in [("pursuit repl", "replay"), ("pursuit replay --pred", "--predict"),
                                ("pursuit replay --blur eve", "everywhere"), ("pursuitd --log-level de", "debug"),
                                ("pursuit get motion-m", "motion-model"), ("pursuit set blur=eve", "blur=everywhere"),
                                ("pursuit profile un", "unset"), ("pursuit profile set game gov", "governor=auto")]:
            script = f"source {self.path('pursuit.fish')}; complete -C '{words}'"
            result = subprocess.run(["fish", "-N", "-c", script], capture_output=True, text=True, env=environment)
            self.assertEqual(result.stderr, "")
            self.assertIn(expected, [line.split("\t")[0] for line in result.stdout.splitlines()], words)


if __name__ == "__main__":
    common.main()
