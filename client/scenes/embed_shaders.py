#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: 2026 The Pursuit authors
"""Puts the scenes' GLSL into a C header, or checks a part of it as each context gets it.

usage: embed_shaders.py OUT.h NAME=FILE[:DEFINE] ...
       embed_shaders.py --check VALIDATOR FILE[:DEFINE]   as GL 3.3, GL 4.3 and GLES 3.1

Lines `#include "file"` are replaced by that file.
"""
import os
import re
import subprocess
import sys
import tempfile

HEADERS = {
    "330 core": "#version 330 core\n",
    "430 core": "#version 430 core\n",
    "310 es": "#version 310 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2DArray;\n",
}


def expand(path):
    text = open(path, encoding="utf-8").read()
    folder = os.path.dirname(path)
    text = re.sub(r'^#include "([^"]+)"$', lambda m: expand(os.path.join(folder, m.group(1))), text, flags=re.M)
    return re.sub(r"/\*.*?\*/", "", text, flags=re.S)


def validate(validator, path, source):
    stage = os.path.splitext(path)[1][1:]
    for version, header in HEADERS.items():
        with tempfile.NamedTemporaryFile("w", suffix="." + stage) as file:
            file.write(header + source)
            file.flush()
            run = subprocess.run([validator, "-S", stage, file.name], stdout=subprocess.PIPE, text=True)
        if run.returncode != 0:
            sys.exit(f"{path} as {version}:\n{run.stdout}")


def read_part(part):
    """The path and the whole text of FILE[:DEFINE]."""
    path, _, define = part.partition(":")
    return path, (f"#define {define}\n" if define else "") + expand(path)


def literal(line):
    return '"' + line.replace("\\", "\\\\").replace('"', '\\"') + '\\n"'


def write(out, parts):
    lines = ["/* Made by embed_shaders.py; do not edit. */"]
    for part in parts:
        name, part = part.split("=", 1)
        _, source = read_part(part)
        body = "\n\t".join(literal(line.rstrip()) for line in source.split("\n") if line.strip())
        lines.append(f"static const char scene_shader_{name}[] =\n\t{body};")
    with open(out, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


if sys.argv[1] == "--check":
    validate(sys.argv[2], *read_part(sys.argv[3]))
else:
    write(sys.argv[1], sys.argv[2:])
