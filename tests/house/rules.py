# SPDX-License-Identifier: MIT
"""Holds the house rules: who may include whom, licence headers, file sizes, and that each library is on the list
of docs/architecture.md.

usage: rules.py TOP          checks the tree; exit status 1 if a rule is broken
       rules.py --self-test  plants one breach of each rule in a small tree and sees it found
"""
import os
import re
import sys
import tempfile

MAX_LINES = 600
SOURCE = (".c", ".h")
SHADER = (".vert", ".frag", ".comp", ".glsl")
FOLDERS = ("proto", "client", "shaders", "daemon", "tests")

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)

# folder prefix -> prefixes that it may include from ours; the longest matching prefix rules
MAY_INCLUDE = {
    "proto/": ("proto/",),
    "shaders/": ("shaders/",),
    "client/": ("client/", "proto/"),
    "client/scenes/": ("client/scenes/",),
    "client/examples/": ("client/pursuit.h", "client/examples/"),
    "daemon/": ("daemon/", "proto/", "shaders/"),
    "daemon/cli/": ("daemon/", "proto/", "client/pursuit.h", "client/scenes/scene.h"),
    "daemon/engine/": ("daemon/engine/", "daemon/frame.h", "daemon/error.h", "proto/", "shaders/"),
    "daemon/engine/analysis/": ("daemon/engine/analysis/", "daemon/engine/plan.h", "daemon/engine/pool.h",
                                "daemon/frame.h", "daemon/error.h", "proto/"),
    "daemon/present/": ("daemon/present/", "daemon/error.h", "daemon/clock.h", "daemon/descriptors.h",
                        "daemon/log.h", "daemon/worker.h"),
    "daemon/lab/": ("daemon/lab/", "daemon/present/", "daemon/error.h", "daemon/clock.h",
                    "daemon/descriptors.h", "daemon/log.h", "daemon/open_at_once.h"),
    "daemon/measure/": ("daemon/measure/",),
    "daemon/record/": ("daemon/record/", "daemon/frame.h", "daemon/error.h", "proto/"),
    "tests/": FOLDERS,
}
# the engine's only faces towards the rest of the daemon
ENGINE_FACES = ("daemon/engine/engine.h", "daemon/engine/plan.h", "daemon/engine/motion_order.h",
                "daemon/engine/analysis/compose.h")
# system headers that stand behind one file of the product (examples and tests are free)
ONE_FILE = ("gpiod.h", "GLFW/glfw3.h", "xf86drm.h", "xf86drmMode.h")
# pure arithmetic: no GL, no socket, no clock
PURE = ("daemon/present/pacer.", "daemon/measure/")
IMPURE = re.compile(r"^(EGL|GL|GLES\d)/|^sys/(socket|epoll|eventfd|timerfd|time)\.h$|^(time|pthread|unistd)\.h$")


# how a build file asks for a library
LIBRARY = re.compile(r"\b(?:dependency|find_library)\('([^']+)'")
LIBRARY_PAGE = "docs/architecture.md"


def files(top):
    for folder in FOLDERS:
        for path, folders, names in os.walk(os.path.join(top, folder)):
            folders[:] = [name for name in folders if name != "__pycache__"]
            for name in sorted(names):
                yield os.path.relpath(os.path.join(path, name), top)


def allowed(path):
    best = max((prefix for prefix in MAY_INCLUDE if path.startswith(prefix)), key=len)
    return MAY_INCLUDE[best]


def resolve(top, path, target):
    """The tree's path of an include, None if it is not one of ours."""
    local = os.path.normpath(os.path.join(os.path.dirname(path), target))
    for candidate in (local, target):
        if os.path.exists(os.path.join(top, candidate)):
            return candidate
    return None


def check_includes(top, path, text, breaches, behind):
    for bracket, target in INCLUDE.findall(text):
        if bracket == "<":
            if target in ONE_FILE and path.startswith(("daemon/", "client/")) and "/examples/" not in path:
                behind.setdefault(target, []).append(path)
            if path.startswith(PURE) and IMPURE.search(target):
                breaches.append(f"{path}: pure arithmetic includes <{target}>")
            continue
        ours = resolve(top, path, target)
        if ours is None:
            continue
        if not ours.startswith(allowed(path)):
            breaches.append(f"{path}: may not include {ours}")
        inside = path.startswith(("daemon/engine/", "tests/"))
        if ours.startswith("daemon/engine/") and not inside and ours not in ENGINE_FACES:
            breaches.append(f"{path}: reaches behind the engine's face: {ours}")
        passes = re.compile(r"daemon/engine/(?:\w+/)?pass_(\w+)\.[ch]$")
        mine, theirs = passes.match(path), passes.match(ours)
        if mine and theirs and mine.group(1) != theirs.group(1):
            breaches.append(f"{path}: a pass includes another pass: {ours}")


def check_text(path, text, breaches):
    lines = text.count("\n")
    if path.endswith(SOURCE + SHADER + (".py",)):
        if lines > MAX_LINES:
            breaches.append(f"{path}: {lines} lines, at most {MAX_LINES}")
        if "SPDX-License-Identifier: MIT" not in text[:200]:
            breaches.append(f"{path}: no SPDX header")
    if path.endswith(SOURCE + SHADER) and re.search(r"[ \t]$", text, re.M):
        breaches.append(f"{path}: white space at the end of a line")
    if path.endswith(".c") and re.search(r"\b(strcpy|strcat|sprintf|gets|strtok)\s*\(", text):
        breaches.append(f"{path}: an unbounded string function")


def read(top, path):
    try:
        with open(os.path.join(top, path), encoding="utf-8") as file:
            return file.read()
    except FileNotFoundError:
        return ""


def check_libraries(top, breaches):
    builds = ["meson.build"] + [path for path in files(top) if path.endswith("meson.build")]
    used = {name: path for path in builds for name in LIBRARY.findall(read(top, path))}
    section = read(top, LIBRARY_PAGE).partition("\n## Libraries\n")[2].partition("\n## ")[0]
    rows = [row.split("|")[2] for row in section.split("\n") if row.startswith("|")]
    listed = set(re.findall(r"`([^`]+)`", " ".join(rows)))
    for name in sorted(used.keys() - listed):
        breaches.append(f"{used[name]}: library {name} is not on the list in {LIBRARY_PAGE}")
    for name in sorted(listed - used.keys()):
        breaches.append(f"{LIBRARY_PAGE}: library {name} is used by no build file")


def check(top):
    breaches, behind = [], {}
    check_libraries(top, breaches)
    for path in files(top):
        if not path.endswith(SOURCE + SHADER + (".py", ".build")):
            continue
        with open(os.path.join(top, path), encoding="utf-8") as source:
            text = source.read()
        check_text(path, text, breaches)
        if path.endswith(SOURCE):
            check_includes(top, path, text, breaches, behind)
    for header, users in behind.items():
        # versions of one backend, of which meson takes one, count once: gpio_v1.c, gpio_v2.c
        if len({re.sub(r"_v\d\.c$", ".c", user) for user in users}) > 1:
            breaches.append(f"<{header}> is included by more than one file: {', '.join(users)}")
    return breaches


SPDX = "/* SPDX-License-Identifier: MIT */\n"
GOOD = {
    "proto/wire.h": SPDX, "client/pursuit.h": SPDX, "client/scenes/scene.h": SPDX, "daemon/server.h": SPDX,
    "daemon/engine/engine.h": SPDX, "daemon/engine/gl/gl.h": SPDX, "daemon/engine/gl/pass_warp.h": SPDX,
    "daemon/engine/gl/pass_blur.h": SPDX,
    "daemon/cli/main.c": SPDX + '#include "client/pursuit.h"\n#include "daemon/engine/engine.h"\n',
}
BAD = [
    ("proto/a.h", SPDX + '#include "client/pursuit.h"\n', "may not include"),
    ("client/a.c", SPDX + '#include "daemon/server.h"\n', "may not include"),
    ("daemon/a.c", SPDX + '#include "client/pursuit.h"\n', "may not include"),
    ("daemon/a.c", SPDX + '#include "daemon/engine/gl/gl.h"\n', "reaches behind"),
    ("daemon/present/a.c", SPDX + '#include "daemon/engine/engine.h"\n', "may not include"),
    ("daemon/engine/gl/pass_warp.c", SPDX + '#include "pass_blur.h"\n', "a pass includes"),
    ("daemon/engine/a.c", SPDX + '#include "daemon/server.h"\n', "may not include"),
    ("daemon/present/pacer.c", SPDX + "#include <time.h>\n", "pure arithmetic"),
    ("daemon/measure/a.c", SPDX + "#include <GL/gl.h>\n", "pure arithmetic"),
    ("daemon/a.c", "int a;\n", "no SPDX"),
    ("daemon/a.c", SPDX + "\n" * 601, "at most"),
    ("daemon/a.c", SPDX + "int a; \n", "white space"),
    ("daemon/a.c", SPDX + "strcpy(a, b);\n", "unbounded"),
    ("client/meson.build", "# SPDX-License-Identifier: MIT\ndependency('zlib')\n", "library zlib is not on the list"),
    (LIBRARY_PAGE, "\n## Libraries\n\n| a | `zlib` | b |\n", "library zlib is used by no build file"),
    ("daemon/lab/a.c", SPDX + "#include <gpiod.h>\n", None),
]


def write(top, path, text):
    full = os.path.join(top, path)
    os.makedirs(os.path.dirname(full), exist_ok=True)
    with open(full, "w", encoding="utf-8") as out:
        out.write(text)


def self_test():
    failures = 0
    for path, text, expected in BAD:
        with tempfile.TemporaryDirectory() as top:
            for good, content in GOOD.items():
                write(top, good, content)
            if check(top):
                print("the good tree is found bad:", check(top))
                failures += 1
            write(top, path, text)
            found = check(top)
            if expected is None:
                if found:
                    print(f"one user of a header is found bad: {found}")
                    failures += 1
                write(top, "daemon/lab/b.c", text)
                found, expected = check(top), "more than one file"
            if not any(expected in breach for breach in found):
                print(f"{path}: expected '{expected}', found {found}")
                failures += 1
    print(f"{len(BAD)} planted breaches, {failures} not found")
    return failures


def main():
    if sys.argv[1:] == ["--self-test"]:
        return 1 if self_test() else 0
    breaches = check(sys.argv[1])
    for breach in breaches:
        print(breach)
    print(f"{len(breaches)} breaches of the house rules")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
