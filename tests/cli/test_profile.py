# SPDX-License-Identifier: MIT
"""pursuit profile: sections of applications in a configuration file, changed without touching the rest of it."""
import json
import os
import signal
import subprocess

import common

PURSUITD = os.environ["PURSUITD"]

WRITTEN = """# my settings
cell = 16

# the race
[application race]
blur = off      
# why this is so
cell = 32

# about the next one
[application other game]
method = hold
"""


class Profile(common.Case):
    def setUp(self):
        super().setUp()
        self.file = self.path("folder/pursuitd.conf")
        self.environment = {**os.environ, "PURSUIT_SOCKET": self.path("socket")}

    def write(self, text):
        os.makedirs(os.path.dirname(self.file), exist_ok=True)
        with open(self.file, "w", encoding="utf-8") as out:
            out.write(text)

    def read(self):
        with open(self.file, encoding="utf-8") as text:
            return text.read()

    def profile(self, *words, status=0):
        return self.must("profile", *words, "--config", self.file, status=status, env=self.environment)

    def test_from_nothing(self):
        self.assertEqual(self.profile().stdout, "")
        self.assertIn("no application has a profile", self.profile("list").stderr)
        self.profile("set", "race", "blur=off", "cell=32")
        self.assertEqual(self.read(), "[application race]\nblur = off\ncell = 32\n")
        self.profile("set", "other", "method=hold")
        self.assertEqual(self.read(), "[application race]\nblur = off\ncell = 32\n\n[application other]\nmethod = hold\n")
        self.assertEqual(self.profile("list").stdout, "race\n    blur = off\n    cell = 32\nother\n    method = hold\n")
        self.profile("remove", "race")
        self.profile("remove", "other")
        self.assertEqual(self.read().strip(), "")

    def test_all_else_stays(self):
        self.write(WRITTEN)
        self.profile("set", "race", "cell=40", "gamma=2.2")
        self.assertEqual(self.read(), WRITTEN.replace("cell = 32\n", "cell = 40\ngamma = 2.2\n"))
        self.profile("unset", "race", "cell", "gamma")
        self.assertEqual(self.read(), WRITTEN.replace("cell = 32\n", ""))
        self.profile("remove", "race")
        self.assertEqual(self.read(), "# my settings\ncell = 16\n\n# the race\n# why this is so\n\n# about the next one\n"
                                      "[application other game]\nmethod = hold\n")

    def test_the_last_of_several_holds(self):
        self.write("[application race]\ncell = 10\n# why\ncell = 12\nblur = off\n[application other]\ncell = 14\n")
        self.profile("set", "race", "cell=20")
        self.assertEqual(self.read(),
                         "[application race]\ncell = 20\n# why\nblur = off\n[application other]\ncell = 14\n")

    def test_what_is_read(self):
        self.write(WRITTEN)
        self.assertEqual(self.profile("show", "race").stdout, "blur = off\ncell = 32\n")
        self.assertEqual(json.loads(self.profile("show", "other game", "--json").stdout), {"method": "hold"})
        everything = json.loads(self.profile("--json").stdout)
        self.assertEqual(everything["applications"], {"race": {"blur": "off", "cell": "32"},
                                                      "other game": {"method": "hold"}})
        self.assertEqual(everything["file"], os.path.realpath(self.file))

    def test_refusals(self):
        self.write(WRITTEN)
        for words, status, sentence in [
            (["set", "race", "cell=3"], 2, "cell: 3 is below 4 px; it may be 4 to 64 px"),
            (["set", "race", "cel=8"], 2, "cel: there is no such setting; did you mean cell?"),
            (["set", "race", "max-clients=3"], 2, "max-clients is no setting of the picture"),
            (["set", "race", "method=magic"], 2, "method: \"magic\" is none of hold, black"),
            (["set", "race", "cell"], 2, "cell is not of the form NAME=VALUE"),
            (["set", "race"], 2, "it is: pursuit profile set APPLICATION NAME=VALUE..."),
            (["set", "", "cell=8"], 2, "application: has no name"),
            (["set", "/usr/bin/race", "cell=8"], 2, "must be the name of an executable, without folders"),
            (["set", "a\nb", "cell=8"], 2, "control character"),
            (["set", "x" * 256, "cell=8"], 2, "is longer than 255 bytes"),
            (["set", " a", "cell=8"], 2, "begins or ends with a space"),
            (["show", "nobody"], 1, "nobody has no profile in"),
            (["unset", "race", "gamma"], 1, "race has no gamma in its profile"),
            (["remove", "nobody"], 1, "nobody has no profile"),
            (["forget", "race"], 2, "there is no forget; there are list"),
        ]:
            with self.subTest(words=words):
                self.assertIn(sentence, self.profile(*words, status=status).stderr)
                self.assertEqual(self.read(), WRITTEN)

    def test_hostile_names(self):
        for name in "we[ir]d = # game", "[application x]", "a=b", "# no comment", "ein Spiel ö", "x" * 255, "--":
            self.must("profile", "--config", self.file, "--", "set", name, "cell=9", env=self.environment)
            shown = self.must("profile", "--config", self.file, "--json", "--", "show", name, env=self.environment)
            self.assertEqual(json.loads(shown.stdout), {"cell": "9"}, name)
        self.assertEqual(self.read().count("[application "), 8)

    def test_a_file_with_a_mistake_is_left_alone(self):
        text = WRITTEN + "nonsense\n"
        self.write(text)
        result = self.profile("set", "race", "cell=8", status=1)
        self.assertIn(f"{os.path.realpath(self.file)}:13: \"nonsense\" is not of the form name = value", result.stderr)
        self.assertEqual(self.read(), text)

    def test_mode_and_link_stay(self):
        self.write(WRITTEN)
        os.chmod(self.file, 0o640)
        os.rename(self.file, self.path("real"))
        os.symlink(self.path("real"), self.file)
        self.profile("set", "race", "cell=8")
        self.assertTrue(os.path.islink(self.file))
        self.assertEqual(os.stat(self.file).st_mode & 0o777, 0o640)
        self.assertEqual(os.listdir(os.path.dirname(self.file)), ["pursuitd.conf"])

    def test_a_link_to_nothing_stays(self):
        os.makedirs(os.path.dirname(self.file))
        os.symlink("nothing", self.file)
        self.assertIn("is a link that leads nowhere", self.profile("set", "race", "cell=8", status=1).stderr)
        self.assertEqual(os.readlink(self.file), "nothing")

    def test_many_at_once(self):
        self.write("# first\n")
        running = [subprocess.Popen([common.PURSUIT, "profile", "set", f"game{i}", f"cell={i + 10}", "--config", self.file],
                                    env=self.environment) for i in range(12)]
        self.assertEqual([process.wait(2 * common.PATIENCE) for process in running], [0] * 12)
        everything = json.loads(self.profile("--json").stdout)["applications"]
        self.assertEqual(everything, {f"game{i}": {"cell": str(i + 10)} for i in range(12)})

    def test_full_disk(self):
        """A limit on the size of files is met like a full disk: nothing has happened."""
        self.write(WRITTEN + "# " + "x" * 8000 + "\n")
        before = self.read()
        script = 'ulimit -f 4; exec "$0" profile set race cell=9 --config "$1"'
        result = subprocess.run(["bash", "-c", script, common.PURSUIT, self.file], capture_output=True, text=True,
                                env=self.environment)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("File too large", result.stderr)
        self.assertEqual(self.read(), before)
        self.assertEqual(os.listdir(os.path.dirname(self.file)), ["pursuitd.conf"])

    def test_running_daemon(self):
        self.write("cell = 16\n")
        socket = self.path("socket")
        with open(self.path("log"), "w") as log:
            daemon = subprocess.Popen([PURSUITD, "--socket", socket, "--config", self.file], stderr=log)
        try:
            common.started(daemon, socket)
            found = json.loads(self.must("profile", "--json", env=self.environment).stdout)
            self.assertEqual(found["file"], os.path.realpath(self.file))
            self.must("profile", "set", "race", "cell=20", env=self.environment)
            with open(self.path("log")) as log:
                self.assertIn("settings read again", log.read())
            self.assertIn("[application race]", self.read())
            other = self.must("profile", "set", "race", "cell=20", "--config", self.path("other"), env=self.environment)
            self.assertIn("the running daemon does not read", other.stderr)
        finally:
            daemon.send_signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(2 * common.PATIENCE), 0)


if __name__ == "__main__":
    common.main()
