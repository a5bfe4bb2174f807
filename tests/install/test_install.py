# SPDX-License-Identifier: MIT
"""Installed into an empty root: everything in its place, used from there, and gone again."""
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE, MESON, CC, VERSION = (os.environ[name] for name in ("BUILD", "SOURCE", "MESON", "CC", "VERSION"))
sys.path.insert(0, os.path.join(SOURCE, "tests/cli"))
import common
SANITIZED = os.environ["SANITIZE"] != "none"
# What meson remembers of the last `meson install`, for `ninja uninstall`.
LOG = os.path.join(BUILD, "meson-logs/install-log.txt")


class KeptLog:
    """Whoever installed from this build folder can still uninstall that after the test."""

    def __init__(self):
        self.text = None
        if os.path.exists(LOG):
            with open(LOG, encoding="utf-8") as log:
                self.text = log.read()

    def put_back(self):
        if self.text is None:
            os.remove(LOG)
        else:
            with open(LOG, "w", encoding="utf-8") as log:
                log.write(self.text)


def install(root):
    return run(MESON, "install", "-C", BUILD, "--no-rebuild", "--destdir", root)


def files_of(root):
    return [os.path.relpath(os.path.join(folder, name), root) for folder, _, names in os.walk(root) for name in names]


def slug(heading):
    """What a link to a heading says."""
    return re.sub(r"[^a-z0-9 -]", "", heading.lstrip("#").strip().lower()).replace(" ", "-")


def run(*arguments, **options):
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options) as process:
        output, errors = common.finish(process)
    return subprocess.CompletedProcess(arguments, process.returncode, output, errors)


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = tempfile.mkdtemp(prefix="pursuit-install-")
        cls.log = KeptLog()
        result = install(cls.root)
        assert result.returncode == 0, result.stdout + result.stderr
        cls.files = files_of(cls.root)

    @classmethod
    def tearDownClass(cls):
        cls.log.put_back()
        shutil.rmtree(cls.root)

    def find(self, end):
        found = [name for name in self.files if name.endswith(end)]
        self.assertEqual(len(found), 1, f"{end}: {found}")
        return os.path.join(self.root, found[0])

    def test_places(self):
        for end in (
            "/bin/pursuit", "/bin/pursuitd", "/include/pursuit.h", "/libpursuit.so", "/libpursuit.so.0",
            "/pkgconfig/libpursuit.pc", "/doc/pursuit/LICENSE", "/doc/pursuit/CHANGELOG.md", "/doc/pursuit/README.md", "/doc/pursuit/CONTRIBUTING.md",
            "/bash-completion/completions/pursuit", "/zsh/site-functions/_pursuit",
            "/fish/vendor_completions.d/pursuit.fish",
            "/doc/pursuit/examples/example-memory.c", "/doc/pursuit/pictures/mistake-sign.png",
            "/lib/systemd/system/pursuit.service", "/lib/systemd/system/pursuit.socket",
            "/lib/systemd/user/pursuit.service", "/lib/systemd/user/pursuit.socket", "/lib/sysusers.d/pursuit.conf",
            "/lib/tmpfiles.d/pursuit.conf", "/udev/rules.d/70-pursuit.rules",
        ):
            self.assertTrue(os.path.exists(self.find(end)))
        for page in os.listdir(os.path.join(SOURCE, "docs")):
            if page.endswith(".md"):
                self.find("/doc/pursuit/" + page)

    @unittest.skipUnless(shutil.which("scdoc"), "no scdoc")
    def test_manual_pages(self):
        for page in "pursuit.1", "pursuitd.1":
            with open(self.find("/man/man1/" + page), encoding="utf-8") as text:
                self.assertIn(".TH", text.read())

    def test_links_of_pages(self):
        """What an installed page leads to was installed too, down to the heading."""
        seen = 0
        for name in self.files:
            if not name.endswith(".md") or "/doc/pursuit/" not in name:
                continue
            with open(os.path.join(self.root, name), encoding="utf-8") as page:
                links = re.findall(r"\]\((?!https?:)([^)]+)\)", page.read())
            for link in links:
                path, _, heading = link.partition("#")
                where = os.path.normpath(os.path.join(self.root, os.path.dirname(name), path) if path else
                                         os.path.join(self.root, name))
                self.assertTrue(os.path.exists(where), f"{name}: {link}")
                if heading:
                    with open(where, encoding="utf-8") as led_to:
                        self.assertIn(heading, [slug(line) for line in led_to if line.startswith("#")], f"{name}: {link}")
                seen += 1
        self.assertGreater(seen, 25)

    def test_nothing_else(self):
        for name in self.files:
            self.assertNotIn("=", name)
            self.assertFalse(name.endswith(("meson.build", ".in")), name)
            self.assertTrue("/examples/" in name or not name.endswith(".py"), name)
        headers = [name for name in self.files if "/include/" in name]
        self.assertEqual([os.path.basename(name) for name in headers], ["pursuit.h"])

    def test_units_name_the_program(self):
        prefix = next(name for name in self.files if name.endswith("bin/pursuitd"))
        for scope in "system", "user":
            with open(self.find(f"/lib/systemd/{scope}/pursuit.service"), encoding="utf-8") as unit:
                self.assertIn(f"ExecStart=/{prefix}", unit.read())

    def test_outside_program(self):
        """An example, built from where it was installed, through pkg-config alone, against the installed library."""
        environment = {**os.environ, "PKG_CONFIG_SYSROOT_DIR": self.root,
                       "PKG_CONFIG_LIBDIR": os.path.dirname(self.find("/libpursuit.pc"))}
        flags = run("pkg-config", "--cflags", "--libs", "libpursuit", env=environment)
        self.assertEqual(flags.returncode, 0, flags.stderr)
        self.assertEqual(run("pkg-config", "--modversion", "libpursuit", env=environment).stdout.strip(), VERSION)
        self.assertNotIn(SOURCE, flags.stdout)
        program = os.path.join(self.root, "outside")
        built = run(CC, "-std=c11", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Werror", self.find("/example-memory.c"), "-o",
                    program, *flags.stdout.split(), "-lm")
        self.assertEqual(built.returncode, 0, built.stderr)
        if SANITIZED:
            return
        libraries = {**os.environ, "LD_LIBRARY_PATH": os.path.dirname(self.find("/libpursuit.so")),
                     "PURSUIT_SOCKET": os.path.join(self.root, "socket")}
        self.assertEqual(run(program, "--seconds", "0.2", env=libraries).returncode, 0)

    @unittest.skipUnless(shutil.which("ninja"), "no ninja")
    def test_uninstall(self):
        """Another root, and a file of somebody else in it: all of ours is gone again, and that one is still there."""
        with tempfile.TemporaryDirectory(prefix="pursuit-uninstall-") as root, open(LOG, encoding="utf-8") as log:
            before = log.read()
            self.assertEqual(install(root).returncode, 0)
            self.assertEqual(len(files_of(root)), len(self.files))
            with open(os.path.join(root, "other"), "w", encoding="utf-8"):
                pass
            result = run("ninja", "-C", BUILD, "uninstall")
            with open(LOG, "w", encoding="utf-8") as log:
                log.write(before)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertEqual(files_of(root), ["other"])

    def test_runs_from_there(self):
        """The command finds the daemon that lies beside it."""
        out = os.path.join(self.root, "out")
        result = run(self.find("/bin/pursuit"), "demo", "--scene", "still", "--size", "64x36", "--seconds", "1", "--out",
                     out, cwd="/")
        if "no GL context" in result.stderr:
            self.skipTest("no GL context for scenes")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertTrue(os.path.exists(os.path.join(out, "report.json")))

    def test_daemon_from_there(self):
        environment = {**os.environ, "PURSUIT_SOCKET": os.path.join(self.root, "socket")}
        daemon = subprocess.Popen([self.find("/bin/pursuitd"), "--present", "headless"], env=environment,
                                  stderr=subprocess.DEVNULL)
        try:
            answers = common.soon(lambda: run(self.find("/bin/pursuit"), "status", env=environment).returncode == 0)
        finally:
            daemon.send_signal(signal.SIGTERM)
        self.assertTrue(answers, "the daemon does not answer")
        self.assertEqual(daemon.wait(2 * common.PATIENCE), 0)


if __name__ == "__main__":
    if not shutil.which("pkg-config") or not MESON:
        print("skipped: no pkg-config or no meson")
        sys.exit(77)
    unittest.main(verbosity=2)
