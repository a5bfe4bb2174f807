# SPDX-License-Identifier: MIT
"""Every command that README, docs/ and --help show is run as it is written, made small, or is on a list with the reason."""
import json
import os
import re
import shutil
import signal
import stat
import subprocess
import sys

import common

TOP = os.path.dirname(os.path.dirname(os.environ["MAN_SOURCES"]))
BUILD = os.path.dirname(os.path.dirname(os.path.dirname(common.PURSUIT)))
PURSUITD, EXAMPLE = os.environ["PURSUITD"], os.environ["EXAMPLE_MEMORY"]

# Later options go before earlier ones, so these keep everything but the amount.
SMALL = {
    "demo": "--size 64x36 --seconds 1",
    "record": "--seconds 0.2",
    "report": "--sizes 96x54 --antialias 1 --n 2 --vary none --methods hold,grid",
    "check-stream": "--seconds 1",
    "top": "--once --interval-ms 300",
}
SCENES = "--size 64x36"  # of `record --scene`, whose sizes would take minutes
# What is shown but not run here: how it begins, and why.
NOT_RUN = {
    "./check": "runs all tests, this one too",
    "./demo --present glfw": "wants a desktop; tests/daemon shows windows",
    "pursuitd --present kms": "wants a bare display; tests/rig has one",
    "pursuit latency --loopback": "wants a wire between two lines; tests/rig has one",
    "pursuit set gpio-line=": "wants a GPIO chip; tests/rig has one",
    "sudo ": "changes the machine",
    "echo 'SUBSYSTEM": "changes the machine",
    "ssh ": "wants another machine",
    "tests/": "is about the tests; that the program is there is looked at",
    "build-check/": "is about the tests, and long",
    "meson test": "is about the tests",
    "meson setup": "installs; tests/install does so into a root of its own",
    "systemctl ": "wants a manager of services; tests/systemd looks at the units",
}
# An option of a verb is named in a sentence, without what it works on.
NAMED = {"pursuit replay --json", "pursuit replay --predict"}
# They fail where small pictures cannot be as good, or a machine lacks something.
MAY_FAIL = ("pursuit doctor", "pursuit set focus=", "pursuit replay walk.pursuit --every 2 --fail-under", "pursuit replay colonnade.pursuit --every 2",
            "pursuit report --scenes colonnade --methods grid --n 2 --fail-under")
COMMAND = r"(?:pursuitd?|\./demo|\./check|tests/[a-z/]+|build-check/\S+|meson test|meson setup|systemctl|sudo|echo 'SUB\S*|ssh)(?: [^`\n]*)?"


def commands_of_page(path):
    """Those on lines of their own, and those in a sentence that have more than a verb."""
    with open(path, encoding="utf-8") as page:
        text = page.read()
    own = re.findall(rf"(?m)^ {{4,}}({COMMAND})$", text)
    within = re.findall(rf"(?<!`)`({COMMAND})`(?!`)", re.sub(r"\n +", " ", text))
    return [re.split(r"  +# ", one)[0].strip() for one in own + [one for one in within if len(one.split()) > 2]]


def commands_of_verb(verb):
    examples = common.run(verb, "--help").stdout.split("\nexamples\n")[1]
    return [line.strip() for line in examples.splitlines() if re.match(r"  (pursuit|ssh)", line)]


class Commands(common.Case):
    def setUp(self):
        super().setUp()
        self.environment = {**os.environ, "PURSUIT_SOCKET": self.path("socket"), "HOME": self.folder, "XDG_CONFIG_HOME": "",
                            "PATH": os.pathsep.join([self.folder + "/bin", os.environ["PATH"]])}
        os.mkdir(self.path("bin"))
        for name, path in ("pursuit", common.PURSUIT), ("pursuitd", PURSUITD):
            os.symlink(path, self.path("bin/" + name))
        self.tool("jq", "import json, sys\nvalue = json.load(sys.stdin)\n"
                        "for key in sys.argv[1].lstrip('.').split('.'):\n    value = value[key]\nprint(value)\n")
        self.tool("ffmpeg", "import sys\nassert sys.stdin.buffer.read(9) == b'YUV4MPEG2'\nwhile sys.stdin.buffer.read(1 << 16):\n"
                            "    pass\n")

    def tool(self, name, script):
        """In the place of a program that need not be installed."""
        path = self.path("bin/" + name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"#!{sys.executable}\n{script}")
        os.chmod(path, stat.S_IRWXU)

    def shell(self, command):
        with subprocess.Popen(["bash", "-o", "pipefail", "-c", command], cwd=self.folder, env=self.environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            output, errors = common.finish(process)
        return subprocess.CompletedProcess(command, process.returncode, output, errors)

    def prepare(self):
        """What the examples take for granted: recordings, sequences of images, logs, an earlier report."""
        for name in "walk", "colonnade", "game":
            self.record(name + ".pursuit", size="96x54", fps=60, seconds=0.2)
        for placeholder in "S.pursuit", "STREAM":
            shutil.copy(self.path("walk.pursuit"), self.path(placeholder))
        for number in range(12, 100):  # the recording has 12
            for name in "c_%d.png", "v_%d.pfm":
                os.symlink(name % 3, self.path(name % number))
        made = self.shell("pursuit export walk.pursuit --color 'c_%04d.png' --depth 'd_%04d.pfm' --motion 'm_%04d.pfm' && "
                          "pursuit export walk.pursuit --color 'c_%d.png' --motion 'v_%d.pfm' && "
                          "pursuit report --scenes fan --out before " + SMALL["report"])
        self.assertEqual(made.returncode, 0, made.stderr)
        for name in "run.csv", "before.bin", "after.bin":
            self.daemon(f"pursuitd --latency-log {name}")

    def daemon(self, command):
        """Starts one, shows it some frames of a client, ends it."""
        environment = {**self.environment, "PURSUIT_SOCKET": self.path("other")}
        process = subprocess.Popen(["bash", "-c", "exec " + command], cwd=self.folder, stderr=subprocess.PIPE, text=True,
                                   env=environment)
        game = None
        try:
            common.started(process, self.path("other"))
            game = subprocess.Popen([EXAMPLE, "--seconds", "3000"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                    env=environment)
            self.wait_for_frames(40, env=environment)
        finally:
            if game:
                game.kill()
                game.wait()
            process.send_signal(signal.SIGTERM)
            said = process.communicate(timeout=2 * common.PATIENCE)[1]
        self.assertEqual(process.returncode, 0, f"{command}: {said}")

    def record_live(self, command):
        """Of a daemon: until there are frames in it, for which nobody knows how long it takes."""
        process = subprocess.Popen(["bash", "-c", "exec " + re.sub("--seconds .*", "--seconds 3000", command)], cwd=self.folder,
                                   env=self.environment, stderr=subprocess.PIPE, text=True)

        def recorded():
            status = json.loads(common.run("status", "--json", env=self.environment).stdout)
            return process.poll() is not None or status.get("recording", {}).get("frames", 0) > 5

        self.assertTrue(common.soon(recorded), command)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=2 * common.PATIENCE)[1]
        self.assertEqual(process.returncode, 0, f"{command}: {said}")

    def smaller(self, command):
        command = command.replace(".exr", ".pfm").replace("./demo", "pursuit demo", 1)
        words = command.split(" | ")[0].split()
        if words[:1] != ["pursuit"] or len(words) < 2:
            return command
        extra = SMALL.get(words[1], "")
        if words[1] == "record" and "--scene" in words:
            extra += " " + SCENES
        if words[1] == "report" and "--scenes" not in words:
            extra += " --scenes fan"
        if words[1] == "check-stream" and len(words) > 2 and not words[2].startswith("-"):
            extra = ""
        first, pipe, rest = command.partition(" | ")
        return f"{first} {extra}{pipe}{rest}"

    def try_with_frames(self, command):
        """Again if a daemon had too few frames in so short a time."""
        def attempt():
            results.append(self.shell(command))
            return not re.search("no frame came|at least two are needed", results[-1].stderr)

        results = []
        common.soon(attempt)
        return results[-1]

    def try_command(self, command):
        if command in NAMED:
            self.used.add(command)
            return
        for beginning, _ in NOT_RUN.items():
            if command.startswith(beginning):
                self.used.add(beginning)
                if beginning == "tests/":
                    self.assertTrue(os.path.exists(os.path.join(TOP, command.split()[0])) or "-" in command, command)
                return
        if command.startswith("pursuitd") and not re.search("--(help|print-config|version)", command):
            self.daemon(command)
            return
        if command.startswith("pursuit record") and "--scene" not in command:
            self.record_live(command)
            return
        result = self.try_with_frames(self.smaller(command))
        allowed = (0, 1) if command.startswith(MAY_FAIL) else (0,)
        self.assertIn(result.returncode, allowed, f"{command}\n{result.stdout[-600:]}{result.stderr[-1200:]}")

    def test_what_the_whole_report_builds(self):
        """tests/report names targets to build, and runs programs: those that there are."""
        with open(os.path.join(TOP, "tests/report"), encoding="utf-8") as script:
            named = set(re.findall(r"(?:\s|\$BUILD/)(tests/[a-z]+/[a-z-]+)", script.read()))
        with open(os.path.join(BUILD, "build.ninja"), encoding="utf-8") as targets:
            built = set(re.findall(r"(?m)^build (\S+):", targets.read()))
        self.assertEqual(len(named), 5)
        self.assertEqual(named - built, set())

    def test_all(self):
        self.prepare()
        pages = ["README.md", *sorted("docs/" + name for name in os.listdir(os.path.join(TOP, "docs")) if name.endswith(".md"))]
        found = [(page, command) for page in pages for command in commands_of_page(os.path.join(TOP, page))]
        found += [(verb + " --help", command) for verb in
                  [line.split("\t")[0] for line in self.must("--print-verbs").stdout.splitlines()]
                  for command in commands_of_verb(verb)]
        self.assertGreater(len(found), 80)
        self.used = set()
        with open(self.path("log"), "w", encoding="utf-8") as log:
            daemon = subprocess.Popen([PURSUITD, "--latency"], env=self.environment, stderr=log)
            game = subprocess.Popen([EXAMPLE, "--seconds", "3000"], env=self.environment, stdout=log, stderr=log)
        try:
            self.wait_for_frames(60, env=self.environment)
            for where, command in found:
                with self.subTest(where=where, command=command):
                    self.try_command(command)
        finally:
            game.kill()
            game.wait()
            daemon.send_signal(signal.SIGTERM)
            daemon.wait(2 * common.PATIENCE)
        self.assertEqual(self.used, set(NOT_RUN) | NAMED, "a reason that nothing needs any more")


if __name__ == "__main__":
    if not shutil.which("bash"):
        print("skipped: there is no bash")
        sys.exit(77)
    common.main()
